#include "motion/plan_output.h"

#include "math/elementary.h"
#include "math/fixed.h"
#include "math/vec2.h"
#include "model/gait_model.h"
#include "motion/gait_cycle.h"
#include "motion/reference.h"
#include "motion/speed_profile.h"
#include "motion/standing.h"
#include "motion/way.h"

#include <math.h>

/* The largest float below 2 pi. */
#define THETA_MAX_RAD 6.28318500f

/* How far ahead a plan can be asked for: within the range of fixed-point positions, and of use. */
#define DISTANCE_MAX_M 1.9f
#define HORIZON_MAX_S 5.0f
#define STANDING_HORIZON_US 500000u

uint32_t saddle_plan_horizon_us(const saddle_planner_t *planner)
{
    const saddle_cycle_t *cycle = &planner->cycle;
    if (saddle_stands(planner)) {
        return STANDING_HORIZON_US;
    }
    const float step_m = saddle_cycle_before_landing(cycle) ? 2.0f : 3.0f;
    const float distance_m =
        saddle_clamp(saddle_cycle_distance_to_via_point_m(cycle) + step_m * cycle->quarter.length_m,
                     0.0f, DISTANCE_MAX_M);
    const saddle_pace_t pace = saddle_pace(&cycle->profile);
    const float time_s = saddle_pace_time_s(&pace, distance_m);
    return (uint32_t)(1.0e6f * saddle_clamp(time_s, 0.0f, HORIZON_MAX_S));
}

/* Half of the step after the next via point, or of the running one; 0 beside the stance foot. */
static float half_step_to_landing_m(const saddle_cycle_t *cycle, const saddle_model_t *model,
                                    float distance_m)
{
    if (saddle_cycle_before_landing(cycle)) {
        return cycle->quarter.length_m;
    }
    if (cycle->last_swing) {
        return 0.0f;
    }
    const saddle_fixed_t speed = saddle_profile_speed_after(&cycle->profile, distance_m);
    return saddle_position_to_m(
        saddle_half_step(model, saddle_other_side(cycle->quarter.stance), speed));
}

/* A last swing brakes evenly, to rest at its end: twice the time that its speed would take. */
static float time_of_last_swing_s(const saddle_cycle_t *cycle, float distance_m)
{
    const float speed_m_s = cycle->profile.speed_m_s;
    return speed_m_s > 0.0f ? saddle_clamp(2.0f * distance_m / speed_m_s, 0.0f, SADDLE_TIME_MAX_S)
                            : 0.0f;
}

/* Of the CoM until the next heel strike. One that comes after its landing, [E38], is due for a while. */
static float way_to_heel_strike_m(const saddle_cycle_t *cycle, const saddle_model_t *model,
                                  float distance_m, float half_step_m)
{
    const bool before = saddle_cycle_before_landing(cycle);
    const float quarter_m = cycle->quarter.length_m;
    const float late_m = -model->body.strike_lead * quarter_m;
    const float walked_m = quarter_m - distance_m;
    if (!before && late_m > walked_m) {
        return late_m - walked_m;
    }
    const float landing_m = before ? distance_m : distance_m + half_step_m;
    const float lead_m = saddle_cycle_strike_lead_m(cycle, model, half_step_m);
    return landing_m > lead_m ? landing_m - lead_m : 0.0f;
}

static void write_step_events(const saddle_cycle_t *cycle, const saddle_model_t *model,
                              saddle_plan_t *plan)
{
    const float distance_m = saddle_cycle_distance_to_via_point_m(cycle);
    const float half_step_m = half_step_to_landing_m(cycle, model, distance_m);
    plan->landing_m.x = 2.0f * half_step_m + cycle->swing.moved_m.x;
    plan->landing_m.y = cycle->stance_y_m + cycle->swing.line_y_m + cycle->swing.moved_m.y;
    if (cycle->last_swing && !saddle_cycle_before_landing(cycle) && cycle->profile.target == 0) {
        plan->time_to_via_point_s = time_of_last_swing_s(cycle, distance_m);
        plan->time_to_heel_strike_s = SADDLE_TIME_MAX_S;
        plan->time_to_toe_off_s = SADDLE_TIME_MAX_S;
        return;
    }
    const float landing_m =
        saddle_cycle_before_landing(cycle) ? distance_m : distance_m + half_step_m;
    const float heel_m = way_to_heel_strike_m(cycle, model, distance_m, half_step_m);
    const saddle_pace_t pace = saddle_pace(&cycle->profile);
    plan->time_to_via_point_s = saddle_pace_time_s(&pace, distance_m);
    plan->time_to_toe_off_s = saddle_pace_time_s(&pace, landing_m);
    plan->time_to_heel_strike_s = saddle_pace_time_s(&pace, heel_m);
}

static void write_events(const saddle_planner_t *planner, const saddle_model_t *model,
                         saddle_plan_t *plan)
{
    if (!saddle_stands(planner)) {
        write_step_events(&planner->cycle, model, plan);
        return;
    }
    const float shifted_s = (float)planner->shift_us * 1.0e-6f;
    plan->time_to_via_point_s = planner->shifting ? model->config.shift_time_s - shifted_s : 0.0f;
    plan->time_to_heel_strike_s = SADDLE_TIME_MAX_S;
    plan->time_to_toe_off_s = SADDLE_TIME_MAX_S;
}

/* While both feet stand there is no step, and its ankles rest. */
static void write_no_step(const saddle_model_t *model, saddle_plan_t *plan)
{
    plan->phase = 0;
    plan->theta_rad = 0.0f;
    plan->speed_m_s = 0.0f;
    plan->acceleration_m_s2 = 0.0f;
    plan->step_length_m = 0.0f;
    plan->step_width_m = 0.0f;
    plan->foot_pitch_rad[SADDLE_LEFT] = 0.0f;
    plan->foot_pitch_rad[SADDLE_RIGHT] = 0.0f;
    plan->swing_velocity_m_s.x = 0.0f;
    plan->swing_velocity_m_s.y = 0.0f;
    plan->swing_velocity_m_s.z = 0.0f;
    plan->knee_flexion_m = model->body.leg_m - model->body.pendulum_m;
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
    const saddle_vec2_t shifted_m =
        saddle_vec2_add(planner->shift_from_m, saddle_vec2_scale(share, shift_m));
    const saddle_vec2_t com_m = planner->shifting ? shifted_m : planner->shift_to_m;
    const float z_m = saddle_standing_height_m(planner, model, com_m);
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
    write_no_step(model, plan);
}

/* [E8] */
static SADDLE_NOINLINE uint32_t write_walking(const saddle_planner_t *planner,
                                              const saddle_model_t *model, saddle_plan_t *plan)
{
    const saddle_cycle_t *cycle = &planner->cycle;
    const saddle_side_t stance = cycle->quarter.stance;
    saddle_pose_t pose;
    saddle_cycle_pose(cycle, model, &pose);
    const float theta_rad = SADDLE_HALF_PI * ((float)cycle->phase + pose.progress);
    plan->speed_m_s = cycle->profile.speed_m_s;
    plan->acceleration_m_s2 = saddle_profile_acceleration_m_s2(&cycle->profile);
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

uint32_t saddle_plan_write(const saddle_planner_t *planner, const saddle_model_t *model,
                           saddle_plan_t *plan)
{
    const saddle_cycle_t *cycle = &planner->cycle;
    uint32_t limits = 0;
    plan->valid = true;
    plan->mode = planner->mode;
    plan->support = (uint8_t)cycle->quarter.stance;
    plan->step_count = cycle->step_count;
    plan->stride_count = cycle->stride_count;
    plan->origin_x_nm = cycle->way.origin_x_nm;
    plan->origin_y_nm = cycle->way.origin_y_nm;
    plan->heading_rad = saddle_speed_to_m_s(cycle->way.heading);
    plan->curvature_1_m[0] = cycle->way.arcs[0].curvature_1_m;
    plan->curvature_1_m[1] = cycle->way.arcs[1].curvature_1_m;
    plan->foot_yaw_rad[SADDLE_LEFT] = 0.0f;
    plan->foot_yaw_rad[SADDLE_RIGHT] = 0.0f;
    plan->pelvis_yaw_rad = 0.0f;
    plan->last_step_m = cycle->last_step_m;
    if (saddle_stands(planner)) {
        write_standing(planner, model, plan);
    } else {
        limits = write_walking(planner, model, plan);
    }
    write_events(planner, model, plan);
    saddle_reference(model, plan, 0.0f, &plan->reference);
    return limits;
}

static saddle_course_t course_of(saddle_vec3_t place_m, saddle_vec3_t rate_m_s)
{
    return (saddle_course_t){{place_m.x, place_m.y}, {rate_m_s.x, rate_m_s.y}};
}

static void put(saddle_on_ground_t ground, saddle_vec3_t *position_m, saddle_vec3_t *velocity_m_s)
{
    position_m->x = ground.position_m.x;
    position_m->y = ground.position_m.y;
    velocity_m_s->x = ground.velocity_m_s.x;
    velocity_m_s->y = ground.velocity_m_s.y;
}

static void bend_com(const saddle_way_t *way, saddle_plan_t *plan)
{
    const saddle_vec3_t *stance_m = &plan->foot_m[plan->support];
    const saddle_course_t course = course_of(plan->com_m, plan->com_velocity_m_s);
    const saddle_on_ground_t com = saddle_way_to_ground(way->arcs, &course);
    put(com, &plan->com_m, &plan->com_velocity_m_s);
    plan->pelvis_yaw_rad = com.yaw_rad;
    const saddle_vec3_t leg_m = {plan->com_m.x - stance_m->x, plan->com_m.y - stance_m->y,
                                 plan->com_m.z};
    plan->leg_length_m = sqrtf(leg_m.x * leg_m.x + leg_m.y * leg_m.y + leg_m.z * leg_m.z);
}

static void bend_feet(const saddle_way_t *way, saddle_plan_t *plan)
{
    const saddle_side_t stance = (saddle_side_t)plan->support;
    const saddle_side_t swing = saddle_other_side(stance);
    const saddle_vec2_t stance_m = {plan->foot_m[stance].x, plan->foot_m[stance].y};
    const saddle_course_t course = course_of(plan->foot_m[swing], plan->swing_velocity_m_s);
    const saddle_on_ground_t foot = saddle_way_to_ground(way->arcs, &course);
    put(foot, &plan->foot_m[swing], &plan->swing_velocity_m_s);
    plan->foot_yaw_rad[swing] = foot.yaw_rad;
    plan->landing_m = saddle_way_point_to_ground(way->arcs, plan->landing_m);
    plan->last_step_m = saddle_vec2_sub(
        stance_m,
        saddle_way_point_to_ground(way->arcs, saddle_vec2_sub(stance_m, plan->last_step_m)));
}

void saddle_plan_bend(const saddle_way_t *way, const saddle_model_t *model, saddle_plan_t *plan)
{
    if (way->bent) {
        bend_com(way, plan);
        bend_feet(way, plan);
        saddle_reference_bend(model, plan, &plan->reference);
    }
}
