/** The plan at one instant, as the output has it. */
#ifndef SADDLEWALK_PLAN_OUTPUT_H
#define SADDLEWALK_PLAN_OUTPUT_H

#include <saddlewalk/private/context.h>

/** How far saddle_planner_advance() may go in one call: to the end of the next step, 0.5 s standing. */
uint32_t saddle_plan_horizon_us(const saddle_planner_t *planner);

/** The plan of the present state, along the way and across it. Returns SADDLE_LIMIT_TOE_OFF or 0. */
uint32_t saddle_plan_write(const saddle_planner_t *planner, const saddle_model_t *model,
                           saddle_plan_t *plan);

/** [E47] From along the way to the axes of the stance foot: from what saddle_plan_write() wrote to what
 *  the output has. */
void saddle_plan_bend(const saddle_way_t *way, const saddle_model_t *model, saddle_plan_t *plan);

#endif
