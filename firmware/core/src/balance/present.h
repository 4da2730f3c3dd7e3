/** From what was measured some time ago to what has become of it. */
#ifndef SADDLEWALK_PRESENT_H
#define SADDLEWALK_PRESENT_H

#include <saddlewalk/private/context.h>

/** Remember this tick's plan along the way, by dt_us after the last one's. walked_nm: to its stance foot,
 *  wraps. */
void saddle_remember_plan(saddle_past_t *past, const saddle_plan_t *plan, uint32_t walked_nm,
                          uint32_t dt_us);

/** [E46] A usable measurement, each part brought forward by its age or 0.2 s, whichever is less; ages and
 *  height stay. Returns the planned stance foot of the time when the CoM was measured. */
saddle_side_t saddle_bring_forward(const saddle_past_t *past, const saddle_model_t *model,
                                   const saddle_measurement_t *measured,
                                   saddle_measurement_t *present);

#endif
