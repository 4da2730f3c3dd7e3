/** The paper's scores of one posture, measured or planned. */
#ifndef SADDLEWALK_SCORES_H
#define SADDLEWALK_SCORES_H

#include "balance/energy.h"
#include "balance/saddle_space.h"

#include <saddlewalk/private/context.h>

typedef enum {
    SADDLE_KNOWN_FEET = 1u << 0,
    SADDLE_KNOWN_VELOCITY = 1u << 1,
    SADDLE_KNOWN_SPEED = 1u << 2, /**< v_comp_m_s */
    SADDLE_KNOWN_HALF_STEP = 1u << 3,
    SADDLE_KNOWN_ALL = (1u << 4) - 1u
} saddle_known_t;

/** A posture to score, in any frame with x forward and y left. */
typedef struct {
    saddle_com_state_t com;
    saddle_vec2_t cop_m[2];
    float v_comp_m_s;  /**< walking speed that the scores refer to */
    float half_step_m; /**< half the AP distance of the CoPs at the last heel strike */
    uint32_t known;    /**< saddle_known_t bits; the numbers of the others are not read */
} saddle_posture_t;

/** Score a posture. Whatever is not known is not scored. Writes all of *scores, and what
 *  carries the CoM, not reached if the feet are not known: it points to the posture's feet and the
 *  scores' BoS. */
void saddle_score_posture(const saddle_model_t *model, const saddle_posture_t *posture,
                          saddle_scores_t *scores, saddle_support_t *support);

/** Whether all of these saddle_valid_t results are there. */
bool saddle_scores_hold(const saddle_scores_t *scores, uint32_t results);

/** saddle_fault_t bits for what was known and gave no score all the same. */
uint32_t saddle_score_faults(uint32_t known, const saddle_scores_t *scores);

#endif
