/** The paper's scores of one posture, measured or planned. */
#ifndef SADDLEWALK_SCORES_H
#define SADDLEWALK_SCORES_H

#include <saddlewalk/gait_model.h>
#include <saddlewalk/measurement.h>
#include <saddlewalk/model.h>
#include <saddlewalk/saddle_space.h>
#include <saddlewalk/saddle_types.h>
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

/** Score a posture. Whatever is not known is not scored. Writes all of *scores. */
void saddle_score_posture(const saddle_model_t *model,
                          const saddle_posture_t *posture, saddle_scores_t *scores);

/** Whether all of these saddle_valid_t results are there. */
bool saddle_scores_hold(const saddle_scores_t *scores, uint32_t results);

/** saddle_fault_t bits for what was known and gave no score all the same. */
uint32_t saddle_score_faults(uint32_t known, const saddle_scores_t *scores);

#endif
