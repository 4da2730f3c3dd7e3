/** The stability supervisor: scores the measured posture, compares it with the walk that is
 *  planned, and says how far the wearer is from falling. */
#ifndef SADDLEWALK_SUPERVISOR_H
#define SADDLEWALK_SUPERVISOR_H

#include <saddlewalk/energy.h>
#include <saddlewalk/expected_step.h>
#include <saddlewalk/gait_model.h>
#include <saddlewalk/measurement.h>
#include <saddlewalk/recovery_step.h>
#include <saddlewalk/saddle_space.h>
#include <saddlewalk/saddle_types.h>
#include <saddlewalk/step_tracker.h>
#include <stdbool.h>
#include <stdint.h>

/** Which fields of saddle_scores_t hold a result; the others are 0. xcom_m is known whenever the
 *  velocity is, and bos says so itself (bos.defined). */
typedef enum {
    SADDLE_VALID_V_COMP = 1u << 0,
    SADDLE_VALID_STEP = 1u << 1, /**< s_pend and s_jump */
    SADDLE_VALID_S_SW = 1u << 2,
    SADDLE_VALID_MOS_COM = 1u << 3,
    SADDLE_VALID_MOS_XCOM = 1u << 4,
    SADDLE_VALID_GRAVITY = 1u << 5,
    SADDLE_VALID_STOP = 1u << 6, /**< excess_stop_j and can_stop: a leg reaches the CoM */
    SADDLE_VALID_ALL = (1u << 7) - 1u
} saddle_valid_t;

/** Scores of a posture, in its frame. */
typedef struct {
    uint32_t valid;    /**< saddle_valid_t bits */
    float v_comp_m_s;  /**< mean AP speed over the last completed step, else the planner's */
    float s_pend, s_jump; /**< [E20] */
    float s_sw;        /**< [E21] */
    float mos_com_m, mos_xcom_m; /**< margins in the instantaneous BoS, [E17] */
    saddle_vec2_t gravity_n;     /**< [E18] */
    float excess_stop_j;         /**< [E26] */
    bool can_stop;               /**< [E27] the ankles can absorb that */
    bool paper_stable;           /**< the paper's verdict: can_stop, or all three scores > 0 */
    saddle_vec2_t xcom_m;        /**< [E19] */
    saddle_bos_t bos;            /**< instantaneous (I-BoS) */
} saddle_scores_t;

typedef enum {
    SADDLE_KNOWN_FEET = 1u << 0,
    SADDLE_KNOWN_VELOCITY = 1u << 1,
    SADDLE_KNOWN_SPEED = 1u << 2,     /**< v_comp_m_s */
    SADDLE_KNOWN_HALF_STEP = 1u << 3,
    SADDLE_KNOWN_ALL = (1u << 4) - 1u
} saddle_known_t;

/** A posture to score, in any frame with x forward and y left. */
typedef struct {
    saddle_vec2_t com_m, com_velocity_m_s, cop_m[2];
    float v_comp_m_s;  /**< walking speed that the scores refer to */
    float half_step_m; /**< half the AP distance of the CoPs at the last heel strike */
    uint32_t known;    /**< saddle_known_t bits; the numbers of the others are not read */
} saddle_posture_t;

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

/** What the supervisor takes from the planner: where the wearer is to be. */
typedef struct {
    bool leads;        /**< a walk is planned, or has been walked since the start */
    bool walking;      /**< else both feet stand */
    saddle_step_t step;      /**< the planned one, while walking */
    saddle_com_state_t com;  /**< planned, from the planned stance CoP; while both feet stand from
                                  midway between them */
} saddle_intent_t;

/** Supervisor state, part of the context. */
typedef struct {
    saddle_watch_t watch;
    saddle_step_tracker_t steps;
    uint8_t level, reason;       /**< announced */
    uint8_t caution_reason;      /**< of the last caution */
    uint8_t at_least_ticks[4];   /**< for how long the level has been this one or worse */
    uint8_t at_most_ticks[4];    /**< and this one or better */
} saddle_supervisor_t;

/** Score a posture. Whatever is not known is not scored. Writes all of *scores. */
void saddle_score_posture(const saddle_config_t *config, const saddle_body_t *body,
                          const saddle_posture_t *posture, saddle_scores_t *scores);

/** What happened in the last gap_s is not known: no level holds over it. */
void saddle_supervisor_gap(saddle_supervisor_t *supervisor, float gap_s);

/** Follow the steps, score the posture in the frame of the CoM and give the verdict. While a plan has
 *  both feet stand there is no walk to score: v_comp_m_s, the step scores and s_sw are not valid.
 *  faults: what saddle_judge() said. Returns the faults and those of the scores. */
uint32_t saddle_supervisor_update(saddle_supervisor_t *supervisor, const saddle_config_t *config,
                                  const saddle_body_t *body,
                                  const saddle_measurement_t *measurement, uint32_t faults,
                                  float dt_s, const saddle_intent_t *intent,
                                  saddle_scores_t *scores, saddle_verdict_t *verdict);

#endif
