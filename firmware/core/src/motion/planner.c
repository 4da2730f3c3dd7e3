#include "motion/planner.h"

#include "math/bytes.h"
#include "math/elementary.h"
#include "math/fixed.h"
#include "math/vec2.h"
#include "model/gait_model.h"
#include "model/model.h"
#include "motion/gait_cycle.h"
#include "motion/standing.h"
#include "motion/stopping.h"
#include "motion/way.h"

#include <saddlewalk/saddlewalk.h>

/* A landing that is due within this was on time. */
#define LANDING_TOLERANCE_S 0.002f

/* A last swing, a shift and a first step may follow each other within one long tick. */
#define MODES_A_TICK 4

bool saddle_command_usable(const saddle_command_t *command)
{
    const float finite_max = 1.0e6f;
    if (command->mode == (uint8_t)SADDLE_COMMAND_STAND) {
        return true;
    }
    return command->mode == (uint8_t)SADDLE_COMMAND_WALK &&
           saddle_in_range(command->speed_m_s, -finite_max, finite_max) &&
           saddle_in_range(command->turn_rate_rad_s, -finite_max, finite_max) &&
           saddle_in_range(command->heel_strike_rad, -finite_max, finite_max);
}

static float clamp_command(float value, float min, float max, saddle_limit_t limit,
                           uint32_t *limits)
{
    const float inside = saddle_clamp(value, min, max);
    if (inside != value) {
        *limits |= (uint32_t)limit;
    }
    return inside;
}

static float feasible_speed_m_s(const saddle_model_t *model, float wanted_m_s, uint32_t *limits)
{
    const float ceiling_m_s = model->body.speed_ceiling_m_s;
    if (wanted_m_s < 0.0f || wanted_m_s >= ceiling_m_s) {
        *limits |= (uint32_t)SADDLE_LIMIT_SPEED;
        return wanted_m_s < 0.0f ? 0.0f : SADDLE_CEILING_MARGIN * ceiling_m_s;
    }
    return clamp_command(wanted_m_s, SADDLE_SPEED_FLOOR_M_S, ceiling_m_s, SADDLE_LIMIT_SPEED,
                         limits);
}

/* The turning rate that a walk at a speed bears. */
static float feasible_turn_rad_s(const saddle_model_t *model, float wanted_rad_s, float speed_m_s,
                                 uint32_t *limits)
{
    if (wanted_rad_s == 0.0f) {
        return 0.0f;
    }
    const float max_rad_s = saddle_turn_max_rad_s(model, speed_m_s);
    return clamp_command(wanted_rad_s, -max_rad_s, max_rad_s, SADDLE_LIMIT_TURN, limits);
}

/* The wanted speed, turning rate and angle, feasible. */
static uint32_t apply_command(saddle_planner_t *planner, const saddle_model_t *model,
                              const saddle_command_t *command)
{
    uint32_t limits = 0;
    planner->cycle.way.wanted_rad_s = 0.0f;
    if (command->mode == (uint8_t)SADDLE_COMMAND_STAND || command->speed_m_s == 0.0f) {
        planner->speed_m_s = 0.0f;
        return 0;
    }
    planner->speed_m_s = feasible_speed_m_s(model, command->speed_m_s, &limits);
    planner->heel_strike_rad =
        clamp_command(command->heel_strike_rad, 0.0f, model->config.heel_strike_max_rad,
                      SADDLE_LIMIT_HEEL_STRIKE, &limits);
    planner->cycle.way.wanted_rad_s =
        feasible_turn_rad_s(model, command->turn_rate_rad_s, planner->speed_m_s, &limits);
    return limits;
}

void saddle_planner_reset(saddle_planner_t *planner, const saddle_model_t *model)
{
    const float left_y_m = saddle_landing_y_m(model, SADDLE_LEFT, 0.0f);
    const float right_y_m = saddle_landing_y_m(model, SADDLE_RIGHT, 0.0f);
    saddle_clear(planner, sizeof *planner);
    saddle_cycle_stand(&planner->cycle, SADDLE_LEFT, left_y_m);
    planner->other_m.y = right_y_m - left_y_m;
    planner->shift_to_m.y = 0.5f * planner->other_m.y;
}

/* Towards the wanted speed. */
static void walk_on(saddle_planner_t *planner, const saddle_model_t *model)
{
    planner->braking = false;
    saddle_cycle_set_last_swing(&planner->cycle, false);
    saddle_cycle_set_pace(&planner->cycle, planner->speed_m_s, model->config.acceleration_m_s2);
}

/* The CoM stands over the first stance leg: take the first step. */
static SADDLE_NOINLINE void begin_steps(saddle_planner_t *planner, const saddle_model_t *model)
{
    saddle_cycle_start_t start;
    start.phase = planner->start_phase;
    start.stance_y_m = planner->cycle.stance_y_m;
    start.other_m = planner->other_m;
    start.com_y_m = planner->shift_to_m.y;
    start.com_z_m = saddle_standing_height_m(planner, model, planner->shift_to_m);
    start.speed = 0;
    start.heel_strike_rad = planner->heel_strike_rad;
    start.under_way = false;
    planner->mode = (uint8_t)SADDLE_MODE_STARTING;
    planner->shifting = false;
    planner->landing_open = false;
    planner->foot_lifted = false;
    saddle_cycle_begin(&planner->cycle, model, &start);
    walk_on(planner, model);
}

/* Once a last swing has landed: step on if a walk is wanted again, else bring the CoM between. */
static void after_last_swing(saddle_planner_t *planner, const saddle_model_t *model, float com_y_m)
{
    saddle_stand_beside(planner, com_y_m);
    if (planner->speed_m_s > 0.0f) {
        begin_steps(planner, model);
    } else {
        saddle_begin_shift(planner, SADDLE_MODE_STOPPING, saddle_between_feet_m(planner));
    }
}

/* A shift of weight is complete. */
static void after_shift(saddle_planner_t *planner, const saddle_model_t *model)
{
    const bool over_leg = planner->mode == (uint8_t)SADDLE_MODE_STARTING;
    const bool wanted = planner->speed_m_s > 0.0f;
    if (over_leg && wanted) {
        begin_steps(planner, model);
    } else if (over_leg) {
        saddle_begin_shift(planner, SADDLE_MODE_STOPPING, saddle_between_feet_m(planner));
    } else {
        planner->mode = (uint8_t)SADDLE_MODE_STANDING;
        planner->shifting = false;
    }
}

/* Returns the microseconds left for what follows the shift. */
static uint32_t advance_shift(saddle_planner_t *planner, const saddle_model_t *model,
                              uint32_t dt_us)
{
    const uint32_t duration_us = model->body.shift_us;
    planner->shift_us += dt_us;
    if (planner->shift_us < duration_us) {
        return 0;
    }
    const uint32_t rest_us = planner->shift_us - duration_us;
    after_shift(planner, model);
    return rest_us;
}

static void choose_profile(saddle_planner_t *planner, const saddle_model_t *model)
{
    saddle_cycle_t *cycle = &planner->cycle;
    const bool must_end = cycle->last_swing && !saddle_cycle_before_landing(cycle);
    if (planner->speed_m_s > 0.0f && !must_end) {
        if (planner->mode == (uint8_t)SADDLE_MODE_STOPPING) {
            planner->mode = (uint8_t)SADDLE_MODE_WALKING;
        }
        walk_on(planner, model);
        return;
    }
    planner->mode = (uint8_t)SADDLE_MODE_STOPPING;
    saddle_plan_stop(planner, model);
}

/* The walk has begun a step. */
static void after_landing(saddle_planner_t *planner)
{
    planner->landing_open = true;
    planner->foot_lifted = false;
    planner->cycle.foot_is_late = false;
    if (planner->mode == (uint8_t)SADDLE_MODE_STARTING) {
        planner->mode = (uint8_t)SADDLE_MODE_WALKING;
    }
}

/* Returns the microseconds left for what follows a last swing. */
static uint32_t advance_cycle(saddle_planner_t *planner, const saddle_model_t *model,
                              uint32_t dt_us)
{
    saddle_cycle_t *cycle = &planner->cycle;
    const uint32_t steps_before = cycle->step_count;
    bool arrived;
    const uint32_t rest_us =
        saddle_cycle_advance(cycle, model, planner->heel_strike_rad, dt_us, &arrived);
    if (cycle->step_count != steps_before) {
        after_landing(planner);
    }
    if (arrived) {
        after_last_swing(planner, model, saddle_cycle_com_y_m(cycle, model));
    }
    return rest_us;
}

void saddle_planner_advance(saddle_planner_t *planner, const saddle_model_t *model, uint32_t dt_us)
{
    uint32_t rest_us = dt_us;
    for (int i = 0; i < MODES_A_TICK && rest_us > 0u; i++) {
        if (planner->shifting) {
            rest_us = advance_shift(planner, model, rest_us);
        } else if (planner->mode != (uint8_t)SADDLE_MODE_STANDING) {
            rest_us = advance_cycle(planner, model, rest_us);
        } else {
            return;
        }
        rest_us = rest_us < dt_us ? rest_us : dt_us;
    }
}

float saddle_planner_speed_m_s(const saddle_planner_t *planner)
{
    return saddle_stands(planner) ? 0.0f : planner->cycle.profile.speed_m_s;
}

saddle_sin_cos_t saddle_planner_phase(const saddle_planner_t *planner)
{
    return saddle_cycle_phase(&planner->cycle);
}

/* The measured landing, once, as soon as the new stance foot is on the ground. */
static uint32_t take_landing(saddle_planner_t *planner, const saddle_model_t *model,
                             const saddle_measurement_t *measured)
{
    const saddle_side_t stance = planner->cycle.quarter.stance;
    const bool waiting = planner->landing_open && !saddle_cycle_before_landing(&planner->cycle);
    if (!waiting || measured == NULL || !measured->foot[stance].contact) {
        return 0;
    }
    planner->landing_open = false;
    if (!measured->foot[saddle_other_side(stance)].contact) {
        return 0;
    }
    const saddle_vec2_t step_m = saddle_vec2_sub(measured->foot[stance].cop_m,
                                                 measured->foot[saddle_other_side(stance)].cop_m);
    return saddle_cycle_land(&planner->cycle, model, step_m) ? 0u : (uint32_t)SADDLE_LIMIT_FEET;
}

uint32_t saddle_planner_join(saddle_planner_t *planner, const saddle_model_t *model,
                             const saddle_command_t *command)
{
    const uint32_t limits = apply_command(planner, model, command);
    const float left_y_m = saddle_landing_y_m(model, SADDLE_LEFT, planner->speed_m_s);
    const float right_y_m = saddle_landing_y_m(model, SADDLE_RIGHT, planner->speed_m_s);
    saddle_cycle_start_t start;
    start.phase = 0;
    start.stance_y_m = left_y_m;
    start.other_m.x = 0.0f;
    start.other_m.y = right_y_m - left_y_m;
    start.com_y_m = 0.0f;
    start.com_z_m = 0.0f;
    start.speed = saddle_speed_from_m_s(planner->speed_m_s);
    start.heel_strike_rad = planner->heel_strike_rad;
    start.under_way = true;
    planner->mode = (uint8_t)SADDLE_MODE_WALKING;
    planner->shifting = false;
    const float wanted_rad_s = planner->cycle.way.wanted_rad_s;
    saddle_clear(&planner->cycle, sizeof planner->cycle);
    planner->cycle.way.wanted_rad_s = wanted_rad_s;
    saddle_cycle_begin(&planner->cycle, model, &start);
    return limits;
}

/* [E43] A foot that is still in the air, when it was to have landed, is waited for; its measurement has an
 * age. */
static void watch_swing(saddle_planner_t *planner, const saddle_measurement_t *measured,
                        uint32_t dt_us)
{
    saddle_cycle_t *cycle = &planner->cycle;
    const saddle_side_t stance = cycle->quarter.stance;
    const saddle_side_t swing = saddle_other_side(stance);
    cycle->foot_is_late = false;
    if (measured == NULL || saddle_stands(planner) || !measured->foot[stance].contact) {
        return;
    }
    if (measured->foot[swing].contact) {
        return;
    }
    planner->foot_lifted = true;
    if (saddle_cycle_before_landing(cycle)) {
        const float seen_s = 1.0e-6f * ((float)dt_us - (float)measured->foot[swing].age_us);
        const float way_m = saddle_cycle_distance_to_via_point_m(cycle);
        cycle->foot_is_late = way_m < cycle->profile.speed_m_s * (seen_s - LANDING_TOLERANCE_S);
    }
}

/* [E43] A foot that was in the air and is on the ground, a little before its time, carries from now on. */
static SADDLE_NOINLINE void take_early_landing(saddle_planner_t *planner,
                                               const saddle_model_t *model,
                                               const saddle_measurement_t *measured)
{
    saddle_cycle_t *cycle = &planner->cycle;
    const float early_m = model->config.landing_early_s * cycle->profile.speed_m_s;
    if (measured != NULL && planner->foot_lifted && saddle_cycle_before_landing(cycle) &&
        measured->foot[saddle_other_side(cycle->quarter.stance)].contact &&
        saddle_cycle_distance_to_via_point_m(cycle) <= early_m &&
        saddle_cycle_touch_down(cycle, model, planner->heel_strike_rad)) {
        after_landing(planner);
    }
}

void saddle_planner_along(const saddle_planner_t *planner, const saddle_model_t *model,
                          const saddle_measurement_t *measured, saddle_measurement_t *along)
{
    const saddle_cycle_t *cycle = &planner->cycle;
    const saddle_vec2_t com_m = {cycle->x_m,
                                 cycle->stance_y_m + saddle_cycle_com_y_m(cycle, model)};
    const saddle_sample_t lean = saddle_cycle_lean(cycle);
    saddle_copy(along, measured, sizeof *along);
    saddle_way_measured(cycle->way.arcs, com_m, along);
    along->com.velocity_m_s.y -= lean.slope * cycle->profile.speed_m_s;
    for (int side = 0; side < 2; side++) {
        along->foot[side].cop_m.y += lean.value;
    }
}

/* What is measured along the way, or NULL. */
static uint32_t follow(saddle_planner_t *planner, const saddle_model_t *model,
                       const saddle_command_t *command, const saddle_measurement_t *measured)
{
    uint32_t limits = apply_command(planner, model, command);
    if (planner->mode == (uint8_t)SADDLE_MODE_STANDING) {
        return limits |
               (planner->speed_m_s > 0.0f ? saddle_start_walk(planner, model, measured) : 0u);
    }
    if (!planner->shifting) {
        take_early_landing(planner, model, measured);
        limits |= take_landing(planner, model, measured);
        choose_profile(planner, model);
    }
    return limits;
}

uint32_t saddle_planner_update(saddle_planner_t *planner, const saddle_model_t *model,
                               const saddle_command_t *command,
                               const saddle_measurement_t *measured, uint32_t dt_us)
{
    watch_swing(planner, measured, dt_us);
    saddle_planner_advance(planner, model, dt_us);
    if (planner->cycle.way.bent && measured != NULL) {
        saddle_measurement_t along;
        saddle_planner_along(planner, model, measured, &along);
        return follow(planner, model, command, &along);
    }
    return follow(planner, model, command, measured);
}
