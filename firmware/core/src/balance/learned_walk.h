/** [E32] The wearer's own walk, learned while it is steady: what "usual" means wherever a number is. */
#ifndef SADDLEWALK_LEARNED_WALK_H
#define SADDLEWALK_LEARNED_WALK_H

#include <saddlewalk/private/context.h>

/** Before anything is learned. */
void saddle_learning_init(saddle_learning_t *learning, const saddle_model_t *model);

/** The CoM was not measured, or ticks are missing: nothing is known of its vertical velocity. */
void saddle_learning_gap(saddle_learning_t *learning);

/** Take a measured CoM and how fast it rises. */
void saddle_learning_watch(saddle_learning_t *learning, const saddle_measurement_t *measurement,
                           float dt_s);

/** At the first watched CoM with known feet all that is usual is as measured. */
void saddle_learning_begin(saddle_learning_t *learning);

/** Learn mean and ripple from a CoM that was watched. own_margin: of this tick, before the plan has a
 *  say. The mean follows whatever happens, the ripple only above learn_margin. */
void saddle_learning_update(saddle_learning_t *learning, const saddle_model_t *model,
                            float own_margin, float dt_s);

/** Learn the last step at a heel strike, unless its own margin was not above 0 in some tick. */
void saddle_learning_step(saddle_learning_t *learning, const saddle_step_tracker_t *steps,
                          float own_margin);

#endif
