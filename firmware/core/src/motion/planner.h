/** The walking planner: standing, starting, walking, stopping, over the gait cycle. */
#ifndef SADDLEWALK_PLANNER_H
#define SADDLEWALK_PLANNER_H

#include "math/elementary.h"

#include <saddlewalk/private/context.h>

/** Standing, feet side by side at the width of slow walking, CoM between them. */
void saddle_planner_reset(saddle_planner_t *planner, const saddle_model_t *model);

/** Join a steady walk at the left foot via point (theta = 0, Phase0 = 0), at full speed: what the
 *  paper plans. Returns saddle_limit_t bits. */
uint32_t saddle_planner_join(saddle_planner_t *planner, const saddle_model_t *model,
                             const saddle_command_t *command);

/** Advance by dt_us; then apply a usable command and take over measured feet, unless `measured` is
 *  NULL. A walk starts from
 *  measured feet only if both are on the ground and no further apart than a step; else the plan stands
 *  and says SADDLE_LIMIT_FEET. Returns saddle_limit_t bits. */
uint32_t saddle_planner_update(saddle_planner_t *planner, const saddle_model_t *model,
                               const saddle_command_t *command,
                               const saddle_measurement_t *measured, uint32_t dt_us);

/** The measured feet and CoM as a straight walk would have them: along the way and across it, without
 *  the lean of a turn. `measured` is in the wearer's heading. While the way is straight, the same. */
void saddle_planner_along(const saddle_planner_t *planner, const saddle_model_t *model,
                          const saddle_measurement_t *measured, saddle_measurement_t *along);

/** Let time pass, nothing else. */
void saddle_planner_advance(saddle_planner_t *planner, const saddle_model_t *model, uint32_t dt_us);

/** Phase angle of the running quarter, com_path.h. */
saddle_sin_cos_t saddle_planner_phase(const saddle_planner_t *planner);

/** Speed of the walk; 0 while both feet stand. */
float saddle_planner_speed_m_s(const saddle_planner_t *planner);

#endif
