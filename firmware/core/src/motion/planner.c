#include "motion/planner.h"

#include "math/bytes.h"
#include "math/elementary.h"
#include "math/fixed.h"
#include "math/vec2.h"
#include "model/gait_model.h"
#include "model/model.h"
#include "motion/gait_cycle.h"
#include "motion/speed_profile.h"

#include <math.h>
#include <saddlewalk/saddlewalk.h>

/* The largest float below 2 pi. */
#define THETA_MAX_RAD 6.28318500f

/* Feet that a walk can start from are at least this far apart across. */
#define START_WIDTH_MIN_M 0.05f

/* A last swing, a shift and a first step may follow each other within one long tick. */
#define MODES_A_TICK 4

/* How far a plan is foretold: within the range of fixed-point positions, and of use. */
#define WAY_MAX_M 1.9f
#define HORIZON_MAX_S 5.0f
#define STANDING_HORIZON_US 500000u

bool saddle_command_usable(const saddle_command_t *command)
{
    const float finite_max = 1.0e6f;
    if (command->mode == (uint8_t)SADDLE_COMMAND_STAND) {
        return true;
    }
    return command->mode == (uint8_t)SADDLE_COMMAND_WALK &&
           saddle_in_range(command->speed_m_s, -finite_max, finite_max) &&
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

/* The wanted speed and angle, feasible. */
static uint32_t obey(saddle_planner_t *planner, const saddle_model_t *model,
                     const saddle_command_t *command)
{
    uint32_t limits = 0;
    if (command->mode == (uint8_t)SADDLE_COMMAND_STAND || command->speed_m_s == 0.0f) {
        planner->speed_m_s = 0.0f;
        return 0;
    }
    planner->speed_m_s = feasible_speed_m_s(model, command->speed_m_s, &limits);
    planner->heel_strike_rad =
        clamp_command(command->heel_strike_rad, 0.0f, model->config.heel_strike_max_rad,
                      SADDLE_LIMIT_HEEL_STRIKE, &limits);
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

static void begin_shift(saddle_planner_t *planner, saddle_mode_t mode, saddle_vec2_t to_m)
{
    planner->mode = (uint8_t)mode;
    planner->shifting = true;
    planner->shift_us = 0;
    planner->shift_from_m = planner->shift_to_m;
    planner->shift_to_m = to_m;
}

static bool can_start_from(const saddle_model_t *model, const saddle_feet_t *feet)
{
    const saddle_vec2_t step_m =
        saddle_vec2_sub(feet->cop_m[SADDLE_LEFT], feet->cop_m[SADDLE_RIGHT]);
    const float reach_m = 2.0f * model->body.half_step_max_m;
    return feet->contact[SADDLE_LEFT] && feet->contact[SADDLE_RIGHT] &&
           saddle_in_range(step_m.x, -reach_m, reach_m) &&
           saddle_in_range(step_m.y, START_WIDTH_MIN_M, 2.0f * model->config.step_width_slow_m);
}

static saddle_vec2_t between_feet_m(const saddle_planner_t *planner)
{
    return saddle_vec2_scale(0.5f, planner->other_m);
}

/* Stand on the measured feet from now on. */
static void stand_on(saddle_planner_t *planner, const saddle_feet_t *feet)
{
    const saddle_vec2_t left = feet->cop_m[SADDLE_LEFT];
    const saddle_vec2_t right = feet->cop_m[SADDLE_RIGHT];
    const saddle_side_t front = right.x > left.x ? SADDLE_RIGHT : SADDLE_LEFT;
    const saddle_vec2_t stance = feet->cop_m[front];
    const saddle_vec2_t other = feet->cop_m[saddle_other_side(front)];
    saddle_cycle_stand(&planner->cycle, front, 0.5f * (stance.y - other.y));
    planner->other_m = saddle_vec2_sub(other, stance);
    planner->shift_to_m = between_feet_m(planner);
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
        begin_shift(planner, SADDLE_MODE_STARTING, planner->shift_to_m);
        return;
    }
    planner->start_phase = left ? 0u : 2u;
    begin_shift(planner, SADDLE_MODE_STARTING, over_foot_m);
}

/* A walk is wanted: from the measured feet, if they are known. */
static uint32_t start(saddle_planner_t *planner, const saddle_model_t *model,
                      const saddle_feet_t *feet)
{
    if (feet->known && !can_start_from(model, feet)) {
        return (uint32_t)SADDLE_LIMIT_FEET;
    }
    if (feet->known) {
        stand_on(planner, feet);
    }
    begin_start(planner, model);
    return 0;
}

/* Both feet on the ground: the CoM's height over the leg that carries, the nearer one. */
static float standing_height_m(const saddle_planner_t *planner, const saddle_model_t *model,
                               saddle_vec2_t com_m)
{
    const saddle_vec2_t from_other_m = saddle_vec2_sub(com_m, planner->other_m);
    const float nearer_m2 =
        saddle_smaller(saddle_vec2_dot(com_m, com_m), saddle_vec2_dot(from_other_m, from_other_m));
    return sqrtf(model->body.pendulum_m * model->body.pendulum_m - nearer_m2);
}

/* Towards the wanted speed. */
static void walk_on(saddle_planner_t *planner, const saddle_model_t *model)
{
    planner->braking = false;
    saddle_cycle_set_last_swing(&planner->cycle, false);
    saddle_cycle_set_pace(&planner->cycle, planner->speed_m_s, model->config.acceleration_m_s2);
}

/* The CoM stands over the first stance leg: take the first step. */
static void begin_steps(saddle_planner_t *planner, const saddle_model_t *model)
{
    saddle_cycle_start_t start;
    start.phase = planner->start_phase;
    start.stance_y_m = planner->cycle.stance_y_m;
    start.other_m = planner->other_m;
    start.com_y_m = planner->shift_to_m.y;
    start.com_z_m = standing_height_m(planner, model, planner->shift_to_m);
    start.speed = 0;
    start.heel_strike_rad = planner->heel_strike_rad;
    start.under_way = false;
    planner->mode = (uint8_t)SADDLE_MODE_STARTING;
    planner->shifting = false;
    planner->landing_open = false;
    saddle_cycle_begin(&planner->cycle, model, &start);
    walk_on(planner, model);
}

/* A last swing has come down beside the stance foot. */
static void stand_beside(saddle_planner_t *planner)
{
    const saddle_cycle_t *cycle = &planner->cycle;
    planner->other_m.x = 0.0f;
    planner->other_m.y = cycle->swing.line_y_m;
    planner->start_phase = cycle->quarter.stance == SADDLE_LEFT ? 0u : 2u;
    planner->braking = false;
}

/* Once a last swing has landed: step on if a walk is wanted again, else bring the CoM between. */
static void after_last_swing(saddle_planner_t *planner, const saddle_model_t *model, float com_y_m)
{
    stand_beside(planner);
    planner->shift_to_m.x = 0.0f;
    planner->shift_to_m.y = com_y_m;
    if (planner->speed_m_s > 0.0f) {
        begin_steps(planner, model);
    } else {
        begin_shift(planner, SADDLE_MODE_STOPPING, between_feet_m(planner));
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
        begin_shift(planner, SADDLE_MODE_STOPPING, between_feet_m(planner));
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

/* Way to the place where a stop can end: the foot via point after the next landing. */
static float stopping_way_m(const saddle_cycle_t *cycle)
{
    const float way_m = saddle_cycle_way_to_via_point_m(cycle);
    return saddle_cycle_before_landing(cycle) ? way_m + cycle->quarter.length_m : way_m;
}

/* May the step after the next landing be the last, braking no harder than allowed? */
static void choose_last_swing(saddle_planner_t *planner, const saddle_model_t *model,
                              float speed_m_s)
{
    saddle_cycle_t *cycle = &planner->cycle;
    if (saddle_cycle_before_landing(cycle)) {
        const float way_m = stopping_way_m(cycle);
        saddle_cycle_set_last_swing(
            cycle, saddle_can_brake(speed_m_s, model->config.acceleration_m_s2, way_m));
        planner->braking = planner->braking && cycle->last_swing;
    }
}

/* The speed from which, after the longest tick at it, a stop within way_m brakes as hard as allowed:
 * below it there is time until the next tick. */
static float latest_braking_speed_m_s(const saddle_model_t *model, float way_m)
{
    const float rate_m_s2 = model->config.acceleration_m_s2;
    const float in_a_tick_m_s = model->body.braked_in_a_tick_m_s;
    return sqrtf(in_a_tick_m_s * in_a_tick_m_s + 2.0f * rate_m_s2 * way_m) - in_a_tick_m_s;
}

static void profile_of_stop(saddle_planner_t *planner, const saddle_model_t *model)
{
    saddle_cycle_t *cycle = &planner->cycle;
    const float speed_m_s = saddle_speed_to_m_s(cycle->profile.speed);
    choose_last_swing(planner, model, speed_m_s);
    const float way_m = stopping_way_m(cycle);
    const float latest_m_s = latest_braking_speed_m_s(model, way_m);
    const float crawl = model->body.crawl_m_s;
    const float slow_m_s = cycle->last_swing && latest_m_s < crawl ? latest_m_s : crawl;
    planner->braking = cycle->last_swing && (planner->braking || speed_m_s >= slow_m_s);
    if (planner->braking) {
        saddle_cycle_set_pace(cycle, 0.0f,
                              way_m > 0.0f ? speed_m_s * speed_m_s / (2.0f * way_m) : 0.0f);
    } else {
        const float fast_m_s = saddle_larger(model->body.braked_in_a_step_m_s, slow_m_s);
        saddle_cycle_set_pace(cycle, saddle_clamp(speed_m_s, slow_m_s, fast_m_s),
                              model->config.acceleration_m_s2);
    }
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
    profile_of_stop(planner, model);
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
        planner->landing_open = true;
        if (planner->mode == (uint8_t)SADDLE_MODE_STARTING) {
            planner->mode = (uint8_t)SADDLE_MODE_WALKING;
        }
    }
    if (arrived) {
        after_last_swing(planner, model, saddle_cycle_com_y_m(cycle));
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
    }
}

/* Both feet carry, and no step is under way. */
static bool stands(const saddle_planner_t *planner)
{
    return planner->shifting || planner->mode == (uint8_t)SADDLE_MODE_STANDING;
}

float saddle_planner_speed_m_s(const saddle_planner_t *planner)
{
    return stands(planner) ? 0.0f : saddle_speed_to_m_s(planner->cycle.profile.speed);
}

uint32_t saddle_planner_horizon_us(const saddle_planner_t *planner)
{
    const saddle_cycle_t *cycle = &planner->cycle;
    if (stands(planner)) {
        return STANDING_HORIZON_US;
    }
    const float step_m = saddle_cycle_before_landing(cycle) ? 2.0f : 3.0f;
    const float way_m = saddle_clamp(
        saddle_cycle_way_to_via_point_m(cycle) + step_m * cycle->quarter.length_m, 0.0f, WAY_MAX_M);
    const saddle_pace_t pace = saddle_pace(&cycle->profile);
    const float time_s = saddle_pace_time_s(&pace, way_m);
    return (uint32_t)(1.0e6f * saddle_clamp(time_s, 0.0f, HORIZON_MAX_S));
}

/* The measured landing, once, as soon as the new stance foot is on the ground. */
static uint32_t take_landing(saddle_planner_t *planner, const saddle_model_t *model,
                             const saddle_feet_t *feet)
{
    const saddle_side_t stance = planner->cycle.quarter.stance;
    const bool waiting = planner->landing_open && !planner->shifting &&
                         !saddle_cycle_before_landing(&planner->cycle);
    if (!waiting || !feet->known || !feet->contact[stance]) {
        return 0;
    }
    planner->landing_open = false;
    if (!feet->contact[saddle_other_side(stance)]) {
        return 0;
    }
    const saddle_vec2_t step_m =
        saddle_vec2_sub(feet->cop_m[stance], feet->cop_m[saddle_other_side(stance)]);
    return saddle_cycle_land(&planner->cycle, model, step_m) ? 0u : (uint32_t)SADDLE_LIMIT_FEET;
}

uint32_t saddle_planner_join(saddle_planner_t *planner, const saddle_model_t *model,
                             const saddle_command_t *command)
{
    const uint32_t limits = obey(planner, model, command);
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
    saddle_clear(&planner->cycle, sizeof planner->cycle);
    saddle_cycle_begin(&planner->cycle, model, &start);
    return limits;
}

uint32_t saddle_planner_update(saddle_planner_t *planner, const saddle_model_t *model,
                               const saddle_command_t *command, const saddle_feet_t *feet,
                               uint32_t dt_us)
{
    saddle_planner_advance(planner, model, dt_us);
    uint32_t limits = obey(planner, model, command);
    if (planner->mode == (uint8_t)SADDLE_MODE_STANDING) {
        return limits | (planner->speed_m_s > 0.0f ? start(planner, model, feet) : 0u);
    }
    if (!planner->shifting) {
        limits |= take_landing(planner, model, feet);
        choose_profile(planner, model);
    }
    return limits;
}

/* Half of the step after the next via point, or of the running one; 0 beside the stance foot. */
static float half_step_to_landing_m(const saddle_cycle_t *cycle, const saddle_model_t *model,
                                    float way_m)
{
    if (saddle_cycle_before_landing(cycle)) {
        return cycle->quarter.length_m;
    }
    if (cycle->last_swing) {
        return 0.0f;
    }
    const saddle_fixed_t speed = saddle_profile_speed_after(&cycle->profile, way_m);
    return saddle_position_to_m(
        saddle_half_step(model, saddle_other_side(cycle->quarter.stance), speed));
}

/* A last swing brakes evenly, to rest at its end: twice the time that its speed would take. */
static float time_of_last_swing_s(const saddle_cycle_t *cycle, float way_m)
{
    const float speed_m_s = saddle_speed_to_m_s(cycle->profile.speed);
    return speed_m_s > 0.0f ? saddle_clamp(2.0f * way_m / speed_m_s, 0.0f, SADDLE_TIME_MAX_S)
                            : 0.0f;
}

static void write_step_events(const saddle_cycle_t *cycle, const saddle_model_t *model,
                              saddle_plan_t *plan)
{
    const float way_m = saddle_cycle_way_to_via_point_m(cycle);
    const float half_step_m = half_step_to_landing_m(cycle, model, way_m);
    plan->landing_m.x = 2.0f * half_step_m;
    plan->landing_m.y = cycle->stance_y_m + cycle->swing.line_y_m;
    if (cycle->last_swing && !saddle_cycle_before_landing(cycle) && cycle->profile.target == 0) {
        plan->time_to_via_point_s = time_of_last_swing_s(cycle, way_m);
        plan->time_to_heel_strike_s = SADDLE_TIME_MAX_S;
        plan->time_to_toe_off_s = SADDLE_TIME_MAX_S;
        return;
    }
    const float landing_m = saddle_cycle_before_landing(cycle) ? way_m : way_m + half_step_m;
    const float lead_m = cycle->next_lead_m;
    const float heel_m = landing_m > lead_m ? landing_m - lead_m : 0.0f;
    const saddle_pace_t pace = saddle_pace(&cycle->profile);
    plan->time_to_via_point_s = saddle_pace_time_s(&pace, way_m);
    plan->time_to_toe_off_s = saddle_pace_time_s(&pace, landing_m);
    plan->time_to_heel_strike_s = saddle_pace_time_s(&pace, heel_m);
}

static void write_events(const saddle_planner_t *planner, const saddle_model_t *model,
                         saddle_plan_t *plan)
{
    if (!stands(planner)) {
        write_step_events(&planner->cycle, model, plan);
        return;
    }
    const float shifted_s = (float)planner->shift_us * 1.0e-6f;
    plan->time_to_via_point_s = planner->shifting ? model->config.shift_time_s - shifted_s : 0.0f;
    plan->time_to_heel_strike_s = SADDLE_TIME_MAX_S;
    plan->time_to_toe_off_s = SADDLE_TIME_MAX_S;
}

/* While both feet stand there is no step, and its ankles rest. */
static void write_no_step(saddle_plan_t *plan)
{
    plan->phase = 0;
    plan->theta_rad = 0.0f;
    plan->speed_m_s = 0.0f;
    plan->step_length_m = 0.0f;
    plan->step_width_m = 0.0f;
    plan->foot_pitch_rad[SADDLE_LEFT] = 0.0f;
    plan->foot_pitch_rad[SADDLE_RIGHT] = 0.0f;
    plan->swing_velocity_m_s.x = 0.0f;
    plan->swing_velocity_m_s.y = 0.0f;
    plan->swing_velocity_m_s.z = 0.0f;
    plan->knee_flexion_m = 0.0f;
    plan->toe_off_rad = 0.0f;
    plan->heel_strike_rad = 0.0f;
}

static void write_standing(const saddle_planner_t *planner, const saddle_model_t *model,
                           saddle_plan_t *plan)
{
    const saddle_side_t stance = planner->cycle.quarter.stance;
    const float duration_s = model->config.shift_time_s;
    const float s = planner->shifting ? (float)planner->shift_us * 1.0e-6f / duration_s : 1.0f;
    const saddle_jerk_t profile = saddle_min_jerk_both(s);
    const float share = profile.value;
    const float rate_hz = profile.slope / duration_s;
    const saddle_vec2_t shift_m = saddle_vec2_sub(planner->shift_to_m, planner->shift_from_m);
    const saddle_vec2_t on_the_way_m =
        saddle_vec2_add(planner->shift_from_m, saddle_vec2_scale(share, shift_m));
    const saddle_vec2_t com_m = planner->shifting ? on_the_way_m : planner->shift_to_m;
    const float z_m = standing_height_m(planner, model, com_m);
    const float leg_m = sqrtf(saddle_vec2_dot(com_m, com_m) + z_m * z_m);
    const saddle_vec2_t near_m = leg_m > model->body.pendulum_m * 1.00001f
                                     ? saddle_vec2_sub(com_m, planner->other_m)
                                     : com_m;
    const float stance_y_m = planner->cycle.stance_y_m;
    saddle_vec3_t *stance_foot_m = &plan->foot_m[stance];
    saddle_vec3_t *other_foot_m = &plan->foot_m[saddle_other_side(stance)];
    plan->com_m.x = com_m.x;
    plan->com_m.y = stance_y_m + com_m.y;
    plan->com_m.z = z_m;
    plan->com_velocity_m_s.x = rate_hz * shift_m.x;
    plan->com_velocity_m_s.y = rate_hz * shift_m.y;
    plan->com_velocity_m_s.z =
        -(near_m.x * plan->com_velocity_m_s.x + near_m.y * plan->com_velocity_m_s.y) / z_m;
    stance_foot_m->x = 0.0f;
    stance_foot_m->y = stance_y_m;
    stance_foot_m->z = 0.0f;
    other_foot_m->x = planner->other_m.x;
    other_foot_m->y = stance_y_m + planner->other_m.y;
    other_foot_m->z = 0.0f;
    plan->leg_length_m = leg_m;
    plan->landing_m.x = planner->other_m.x;
    plan->landing_m.y = stance_y_m + planner->other_m.y;
    write_no_step(plan);
}

static uint32_t write_walking(const saddle_planner_t *planner, const saddle_model_t *model,
                              saddle_plan_t *plan)
{
    const saddle_cycle_t *cycle = &planner->cycle;
    const saddle_side_t stance = cycle->quarter.stance;
    saddle_pose_t pose;
    saddle_cycle_pose(cycle, model, &pose);
    const float theta_rad = SADDLE_HALF_PI * ((float)cycle->phase + pose.progress);
    plan->speed_m_s = saddle_speed_to_m_s(cycle->profile.speed);
    plan->step_length_m = 2.0f * cycle->quarter.length_m;
    plan->step_width_m = cycle->quarter.width_m;
    plan->phase = cycle->phase;
    plan->theta_rad = saddle_clamp(theta_rad, 0.0f, THETA_MAX_RAD);
    plan->com_m = pose.com_m;
    plan->com_m.y += cycle->stance_y_m;
    plan->com_velocity_m_s = pose.com_velocity_m_s;
    plan->foot_m[stance].x = 0.0f;
    plan->foot_m[stance].y = cycle->stance_y_m;
    plan->foot_m[stance].z = 0.0f;
    plan->foot_m[saddle_other_side(stance)] = pose.swing.position_m;
    plan->foot_m[saddle_other_side(stance)].y += cycle->stance_y_m;
    plan->foot_pitch_rad[stance] = pose.stance_pitch_rad;
    plan->foot_pitch_rad[saddle_other_side(stance)] = pose.swing_pitch_rad;
    plan->swing_velocity_m_s = pose.swing.velocity_m_s;
    plan->leg_length_m = pose.ankle.leg_length_m;
    plan->knee_flexion_m = pose.ankle.knee_flexion_m;
    plan->toe_off_rad = pose.ankle.toe_off_rad;
    plan->heel_strike_rad = pose.ankle.heel_strike_rad;
    return pose.ankle_limited ? (uint32_t)SADDLE_LIMIT_TOE_OFF : 0u;
}

uint32_t saddle_planner_write(const saddle_planner_t *planner, const saddle_model_t *model,
                              saddle_plan_t *plan)
{
    const saddle_cycle_t *cycle = &planner->cycle;
    uint32_t limits = 0;
    plan->valid = true;
    plan->mode = planner->mode;
    plan->support = (uint8_t)cycle->quarter.stance;
    plan->step_count = cycle->step_count;
    plan->stride_count = cycle->stride_count;
    plan->origin_x_nm = cycle->origin_x_nm;
    if (stands(planner)) {
        write_standing(planner, model, plan);
    } else {
        limits = write_walking(planner, model, plan);
    }
    write_events(planner, model, plan);
    return limits;
}
