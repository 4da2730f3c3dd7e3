/** Standing on both feet, and shifting the weight between them. */
#ifndef SADDLEWALK_STANDING_H
#define SADDLEWALK_STANDING_H

#include <saddlewalk/private/context.h>

/** Whether both feet carry and no step is under way. */
bool saddle_stands(const saddle_planner_t *planner);

/** Midway between the feet, from the stance CoP. */
saddle_vec2_t saddle_between_feet_m(const saddle_planner_t *planner);

/** Height of a CoM over the leg that carries, the nearer one. */
float saddle_standing_height_m(const saddle_planner_t *planner, const saddle_model_t *model,
                               saddle_vec2_t com_m);

/** Bring the CoM to a place, from the stance CoP, in a mode. */
void saddle_begin_shift(saddle_planner_t *planner, saddle_mode_t mode, saddle_vec2_t to_m);

/** Begin a walk: from the measured feet, or where they are planned if `measured` is NULL. Returns
 *  SADDLE_LIMIT_FEET and goes on standing if no walk can start from them. */
uint32_t saddle_start_walk(saddle_planner_t *planner, const saddle_model_t *model,
                           const saddle_measurement_t *measured);

/** Stand after a last swing, which ended beside the stance foot. */
void saddle_stand_beside(saddle_planner_t *planner, float com_y_m);

#endif
