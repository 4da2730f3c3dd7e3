/** How a walk comes to its end: beside the stance foot, braking no harder than allowed. */
#ifndef SADDLEWALK_STOPPING_H
#define SADDLEWALK_STOPPING_H

#include <saddlewalk/private/context.h>

/** Choose, once in every tick of a stop, whether the next swing is the last, and the pace. */
void saddle_plan_stop(saddle_planner_t *planner, const saddle_model_t *model);

#endif
