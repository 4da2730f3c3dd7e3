/** What the supervisor says of the measured posture against the walk that is planned. */
#ifndef SADDLEWALK_VERDICT_H
#define SADDLEWALK_VERDICT_H

#include <saddlewalk/recovery_step.h>
#include <saddlewalk/saddle_types.h>
#include <stdbool.h>
#include <stdint.h>

/** How far the wearer is from falling, [E31]. */
typedef enum {
    SADDLE_LEVEL_UNKNOWN = 0,
    SADDLE_LEVEL_STABLE = 1,
    SADDLE_LEVEL_CAUTION = 2, /**< departs from the walk, but can stop or step */
    SADDLE_LEVEL_UNSTABLE = 3 /**< can neither stop nor reach a place to step to */
} saddle_level_t;

/** What decided the level. */
typedef enum {
    SADDLE_REASON_NONE = 0,
    SADDLE_REASON_INPUT = 1,     /**< unknown: the faults say which input */
    SADDLE_REASON_NO_WALK = 2,   /**< unknown: nothing is planned, and nobody was seen to stand or to
                                      complete a step */
    SADDLE_REASON_NO_STEP = 3,   /**< unstable: no place within reach catches the XCoM */
    SADDLE_REASON_SPEED = 4,     /**< caution, here and below: v_CoMp cannot be walked */
    SADDLE_REASON_S_PEND = 5,
    SADDLE_REASON_S_JUMP = 6,
    SADDLE_REASON_S_SW = 7,
    SADDLE_REASON_XCOM_AP = 8,   /**< the XCoM is off the planned one */
    SADDLE_REASON_XCOM_ML = 9,
    SADDLE_REASON_OFF_TRACK = 10, /**< more energy than the ankles can bring back to the plan's */
    SADDLE_REASON_SETTLING = 11   /**< unknown: no level has held for level_hold_ticks yet */
} saddle_reason_t;

/** The measured posture against the walk that is planned. Where compared is false all else but
 *  level and reason is 0. */
typedef struct {
    uint8_t level;  /**< saddle_level_t that is announced */
    uint8_t reason; /**< saddle_reason_t of it */
    bool compared;
    bool on_track;          /**< [E27] the ankles can absorb excess_track_j */
    float excess_track_j;   /**< [E26]; it and on_track only with SADDLE_VALID_STOP */
    float ebos_com_m, ebos_xcom_m;  /**< margins expected in the BoS of the next heel strike (E-BoS),
                                         [E29] */
    saddle_vec2_t xcom_deviation_m; /**< from the planned XCoM at the same phase */
    saddle_recovery_t recovery;     /**< [E30] */
} saddle_verdict_t;

#endif
