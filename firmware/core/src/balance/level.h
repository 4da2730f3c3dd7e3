/** [E31] The level of balance, why, and when it is announced. */
#ifndef SADDLEWALK_LEVEL_H
#define SADDLEWALK_LEVEL_H

#include <saddlewalk/private/context.h>

/** Decide and announce. faults: of the inputs and of the scores. Reads the margin and what the
 *  comparison wrote to *verdict and writes its level and reason. */
void saddle_level_update(saddle_level_state_t *state, const saddle_model_t *model, uint32_t faults,
                         const saddle_scores_t *scores, saddle_verdict_t *verdict);

/** No level holds over what is not known: begin again. */
void saddle_level_reset(saddle_level_state_t *state);

#endif
