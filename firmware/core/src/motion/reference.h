/** The motion of a pendulum that takes the planned steps: what a CoP within the feet can make of the
 *  plan. It follows from a plan alone, so a controller that has only the last one can go on from it. */
#ifndef SADDLEWALK_REFERENCE_H
#define SADDLEWALK_REFERENCE_H

#include <saddlewalk/private/context.h>

/** Where the walk alone has the running swing land: plan->landing_m unless that was moved, [E45]. */
saddle_vec2_t saddle_unmoved_landing_m(const saddle_plan_t *plan);

/** The reference after_s >= 0 after a valid plan along the way: the speed changes on as it does now,
 *  and a landing begins a step like the one before. [E39] [E40] in a step, [E41] in a first or
 *  last swing, [E42] while both feet stand. */
void saddle_reference(const saddle_model_t *model, const saddle_plan_t *plan, float after_s,
                      saddle_reference_t *reference);

/** [E47] From along the way to the axes of the plan's stance foot. */
void saddle_reference_bend(const saddle_model_t *model, const saddle_plan_t *plan,
                           saddle_reference_t *reference);

/** Both, after a plan as the output has it, in its axes. */
void saddle_reference_after_plan(const saddle_model_t *model, const saddle_plan_t *plan,
                                 float after_s, saddle_reference_t *reference);

#endif
