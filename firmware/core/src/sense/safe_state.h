/** What is done when commands or measurements stop: the plan stops the walk. */
#ifndef SADDLEWALK_SAFE_STATE_H
#define SADDLEWALK_SAFE_STATE_H

#include <saddlewalk/private/context.h>

typedef struct {
    uint32_t faults; /**< of the inputs, saddle_fault_t */
    bool unstable;   /**< announced by the last tick */
    bool stands;     /**< the command is a stand */
} saddle_safe_inputs_t;

/** Follow the inputs' saddle_fault_t bits. True while the walk must stop: from the tick in which the
 *  command is stale, a measurement is stale or frozen, or measurements have been unusable in another
 *  way for com_max_age_s, until all have been good, and the wearer was not announced unstable, for
 *  resume_time_s; with resume_by_command a stand must have been commanded as well. A plan that never was given any measurement (SADDLE_AGE_NEVER_US) does not need them;
 *  feet that are together are no loss. */
bool saddle_safe_state_update(saddle_safe_state_t *state, const saddle_model_t *model,
                              const saddle_safe_inputs_t *inputs, float dt_s);

/** No tick for gap_s: a walk does not go on over one longer than step_time_max_s, after which nobody is
 *  known to walk. Call it before that tick's update. */
void saddle_safe_state_gap(saddle_safe_state_t *state, const saddle_model_t *model, float gap_s);

#endif
