#include "motion/standing.h"

#include "math/elementary.h"
#include "math/vec2.h"
#include "model/gait_model.h"
#include "motion/gait_cycle.h"
#include "motion/way.h"

#include <math.h>

/* Feet that a walk can start from are at least this far apart across. */
#define START_WIDTH_MIN_M 0.05f

bool saddle_stands(const saddle_planner_t *planner)
{
    return planner->shifting || planner->mode == (uint8_t)SADDLE_MODE_STANDING;
}

void saddle_begin_shift(saddle_planner_t *planner, saddle_mode_t mode, saddle_vec2_t to_m)
{
    planner->mode = (uint8_t)mode;
    planner->shifting = true;
    planner->shift_us = 0;
    planner->shift_from_m = planner->shift_to_m;
    planner->shift_to_m = to_m;
}

saddle_vec2_t saddle_between_feet_m(const saddle_planner_t *planner)
{
    return saddle_vec2_scale(0.5f, planner->other_m);
}

static bool can_start_from(const saddle_model_t *model, const saddle_measurement_t *measured)
{
    const saddle_vec2_t step_m =
        saddle_vec2_sub(measured->foot[SADDLE_LEFT].cop_m, measured->foot[SADDLE_RIGHT].cop_m);
    const float reach_m = 2.0f * model->body.half_step_max_m;
    return measured->foot[SADDLE_LEFT].contact && measured->foot[SADDLE_RIGHT].contact &&
           saddle_in_range(step_m.x, -reach_m, reach_m) &&
           saddle_in_range(step_m.y, START_WIDTH_MIN_M, 2.0f * model->config.step_width_slow_m);
}

/* Stand on the measured feet from now on. */
static void stand_on(saddle_planner_t *planner, const saddle_measurement_t *measured)
{
    const saddle_vec2_t left = measured->foot[SADDLE_LEFT].cop_m;
    const saddle_vec2_t right = measured->foot[SADDLE_RIGHT].cop_m;
    const saddle_side_t front = right.x > left.x ? SADDLE_RIGHT : SADDLE_LEFT;
    const saddle_vec2_t stance = front == SADDLE_RIGHT ? right : left;
    const saddle_vec2_t other = front == SADDLE_RIGHT ? left : right;
    saddle_cycle_stand(&planner->cycle, front, 0.5f * (stance.y - other.y));
    planner->other_m = saddle_vec2_sub(other, stance);
    planner->shift_to_m = saddle_between_feet_m(planner);
}

/* From standing: feet further apart than the shortest half step are midway through a step; else the
 * weight goes to the stance leg. */
static void begin_start(saddle_planner_t *planner, const saddle_model_t *model)
{
    const bool left = planner->cycle.quarter.stance == SADDLE_LEFT;
    const bool midway = -planner->other_m.x > model->config.half_step_intercept_m;
    const saddle_quarter_t beside =
        saddle_quarter(model, planner->cycle.quarter.stance, model->config.half_step_intercept_m,
                       left ? -planner->other_m.y : planner->other_m.y, 0.0f);
    const float gap_m = 0.5f * beside.width_m - beside.amplitude_m;
    const saddle_vec2_t over_foot_m = {0.0f, left ? -gap_m : gap_m};
    if (midway) {
        planner->start_phase = left ? 3u : 1u;
        saddle_begin_shift(planner, SADDLE_MODE_STARTING, planner->shift_to_m);
        return;
    }
    planner->start_phase = left ? 0u : 2u;
    saddle_begin_shift(planner, SADDLE_MODE_STARTING, over_foot_m);
}

uint32_t saddle_start_walk(saddle_planner_t *planner, const saddle_model_t *model,
                           const saddle_measurement_t *measured)
{
    if (measured != NULL) {
        if (!can_start_from(model, measured)) {
            return (uint32_t)SADDLE_LIMIT_FEET;
        }
        stand_on(planner, measured);
    }
    begin_start(planner, model);
    return 0;
}

float saddle_standing_height_m(const saddle_planner_t *planner, const saddle_model_t *model,
                               saddle_vec2_t com_m)
{
    const saddle_vec2_t from_other_m = saddle_vec2_sub(com_m, planner->other_m);
    const float nearer_m2 =
        saddle_smaller(saddle_vec2_dot(com_m, com_m), saddle_vec2_dot(from_other_m, from_other_m));
    return sqrtf(saddle_larger(model->body.pendulum_m * model->body.pendulum_m - nearer_m2, 0.0f));
}

void saddle_stand_beside(saddle_planner_t *planner, float com_y_m)
{
    saddle_cycle_t *cycle = &planner->cycle;
    saddle_way_begin(&cycle->way);
    planner->other_m.x = 0.0f;
    planner->other_m.y = cycle->swing.line_y_m;
    planner->start_phase = cycle->quarter.stance == SADDLE_LEFT ? 0u : 2u;
    planner->braking = false;
    planner->shift_to_m.x = 0.0f;
    planner->shift_to_m.y = com_y_m;
}
