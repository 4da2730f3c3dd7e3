#include "walk/footing.h"

#include "math/elementary.h"
#include "math/vec2.h"
#include "walk/swing.h"

#include <math.h>

/* No CoM of a person is lower or higher. */
#define HEIGHT_MIN_M 0.1f
#define HEIGHT_MAX_M 4.0f

/* Sine of the pitch from which a foot on its toe is not put down flat at once. */
#define HEEL_UP_MIN 0.02f

/* Since nobody knows when. */
#define LONG_AGO_S 1000.0f

bool saddle_both_stand(const saddle_plan_t *plan)
{
    return plan == NULL || !(plan->speed_m_s > 0.0f);
}

static saddle_vec2_t sole_m(const saddle_moment_t *moment, unsigned side)
{
    const saddle_foot_pose_t *foot = moment->estimate->body.foot;
    const saddle_vec3_t *sole = &foot[side == 0u ? SADDLE_LEFT : SADDLE_RIGHT].sole_m;
    return (saddle_vec2_t){sole->x, sole->y};
}

/* The running swing is the last one and ends beside the stance foot. */
static bool lands_beside(const saddle_plan_t *plan)
{
    return plan->landing_m.x <= 0.0f;
}

static float landing_in_s(const saddle_plan_t *plan)
{
    return lands_beside(plan) ? plan->time_to_via_point_s : plan->time_to_toe_off_s;
}

/* The plan's frame against the foot that it steps on or, once that has landed, steps to; without a
 * plan against the middle between the feet. */
static void hold(const saddle_joint_walk_t *walk, saddle_moment_t *moment)
{
    const saddle_plan_t *plan = moment->plan;
    if (plan == NULL) {
        moment->origin_m = saddle_vec2_scale(
            0.5f, saddle_vec2_add(sole_m(moment, SADDLE_LEFT), sole_m(moment, SADDLE_RIGHT)));
        moment->planned_cop_m = moment->planned_xcom_m = moment->origin_m;
        return;
    }
    const unsigned swing = 1u - moment->stance;
    const bool ahead = walk->since_landing_s <= 0.0f && walk->leading == swing;
    const saddle_vec2_t place_m = ahead ? plan->landing_m : moment->planned_stance_m;
    moment->origin_m = saddle_vec2_sub(sole_m(moment, ahead ? swing : moment->stance), place_m);
    moment->planned_cop_m = saddle_vec2_add(moment->origin_m, plan->reference.cop_m);
    moment->planned_xcom_m = saddle_vec2_add(moment->origin_m, plan->reference.xcom_m);
}

static void land(saddle_joint_walk_t *walk, unsigned side, float early_s)
{
    walk->stands[side] = true;
    walk->leading = (uint8_t)side;
    walk->first_swing = false;
    walk->since_landing_s = -early_s;
    walk->recovery_shift_m = (saddle_vec2_t){0.0f, 0.0f};
    walk->in_need = false;
}

/* What the plan alone says of the feet. */
static void follow_plan(saddle_joint_walk_t *walk, const saddle_moment_t *moment)
{
    const saddle_plan_t *plan = moment->plan;
    if (saddle_both_stand(plan)) {
        walk->stands[SADDLE_LEFT] = walk->stands[SADDLE_RIGHT] = true;
    }
    if (plan == NULL) {
        return;
    }
    if (saddle_both_stand(plan) || plan->mode == (uint8_t)SADDLE_MODE_STARTING) {
        walk->leading = (uint8_t)moment->stance;
        walk->first_swing = true;
        walk->since_landing_s = LONG_AGO_S;
    } else if (!walk->stands[moment->stance]) {
        land(walk, moment->stance, 0.0f);
    }
}

saddle_moment_t saddle_moment(saddle_joint_walk_t *walk, const saddle_joint_walk_input_t *input,
                              const saddle_estimate_t *estimate, float dt_s)
{
    const bool planned =
        input->plan != NULL && input->plan->valid && input->plan->support <= SADDLE_RIGHT;
    const saddle_com_t *com = &estimate->body.com;
    saddle_moment_t moment;
    moment.plan = planned ? input->plan : NULL;
    moment.stance = planned && input->plan->support == (uint8_t)SADDLE_RIGHT ? 1u : 0u;
    moment.planned_stance_m = (saddle_vec2_t){0.0f, 0.0f};
    if (planned) {
        const saddle_vec3_t *place_m = &input->plan->foot_m[moment.stance];
        moment.planned_stance_m = (saddle_vec2_t){place_m->x, place_m->y};
    }
    moment.verdict = input->verdict;
    moment.estimate = estimate;
    moment.dt_s = dt_s;
    moment.frequency_rad_s =
        sqrtf(SADDLE_GRAVITY_M_S2 / saddle_clamp(com->position_m.z, HEIGHT_MIN_M, HEIGHT_MAX_M));
    moment.xcom_m =
        (saddle_vec2_t){com->position_m.x + com->velocity_m_s.x / moment.frequency_rad_s,
                        com->position_m.y + com->velocity_m_s.y / moment.frequency_rad_s};
    walk->since_landing_s = saddle_smaller(walk->since_landing_s + dt_s, LONG_AGO_S);
    follow_plan(walk, &moment);
    hold(walk, &moment);
    return moment;
}

/* [J21] The last swing is slow: while it lasts the XCoM must fall neither out nor past it. */
static bool must_wait(const saddle_joint_walk_t *walk, const saddle_moment_t *moment)
{
    const saddle_plan_t *plan = moment->plan;
    if (!lands_beside(plan)) {
        return false;
    }
    const float half_width_m = 0.5f * (plan->landing_m.y - moment->planned_stance_m.y);
    const float lever_m = moment->xcom_m.y - sole_m(moment, moment->stance).y;
    const float inward_m = half_width_m < 0.0f ? -lever_m : lever_m;
    const float edge_m = walk->config.sole_half_width_m;
    const float grown =
        saddle_exp(moment->frequency_rad_s * saddle_larger(landing_in_s(plan), 0.0f));
    return inward_m < -edge_m ||
           edge_m + (inward_m - edge_m) * grown > saddle_magnitude(half_width_m);
}

float saddle_trailing_share(const saddle_joint_walk_t *walk, const saddle_moment_t *moment)
{
    const saddle_plan_t *plan = moment->plan;
    if (saddle_both_stand(plan) || must_wait(walk, moment)) {
        return 1.0f;
    }
    const float step_s = plan->step_length_m / plan->speed_m_s;
    const float handover_s = walk->config.double_support_share * step_s;
    return saddle_clamp(1.0f - walk->since_landing_s / handover_s, 0.0f, 1.0f);
}

/* [J21] The trailing foot carries nothing any more, before its time. */
static bool may_lift(const saddle_joint_walk_t *walk, const saddle_moment_t *moment, unsigned side)
{
    const saddle_plan_t *plan = moment->plan;
    if (saddle_both_stand(plan) || lands_beside(plan) || walk->first_swing) {
        return false;
    }
    const unsigned other = 1u - side;
    return walk->stands[side] && moment->stance == other && walk->leading == other &&
           walk->since_landing_s > 0.0f && walk->light_s[side] > walk->config.lifted_s &&
           moment->estimate->load_n[other] > walk->config.carrying_n;
}

/* [J23] From the planned landing to where the XCoM asks for it. */
static saddle_vec2_t landing_shift_m(saddle_joint_walk_t *walk, const saddle_moment_t *moment,
                                     unsigned side)
{
    const saddle_joint_walk_config_t *config = &walk->config;
    const saddle_plan_t *plan = moment->plan;
    const saddle_verdict_t *verdict = moment->verdict;
    if (verdict != NULL && verdict->recovery.found && verdict->recovery.foot == side) {
        const saddle_vec2_t landing_m = verdict->recovery.landing_m;
        const saddle_vec2_t within_m = {
            saddle_clamp(landing_m.x, -config->reach_along_m, config->reach_along_m),
            saddle_clamp(landing_m.y, -config->reach_across_m, config->reach_across_m)};
        const saddle_vec2_t planned_m = saddle_vec2_sub(plan->landing_m, moment->planned_stance_m);
        const saddle_vec2_t shift_m = saddle_vec2_sub(within_m, planned_m);
        const bool nearby = saddle_magnitude(shift_m.x) <= config->nearby_along_m &&
                            saddle_magnitude(shift_m.y) <= config->nearby_across_m;
        walk->recovery_shift_m = nearby ? (saddle_vec2_t){0.0f, 0.0f} : shift_m;
        walk->in_need =
            !nearby && (saddle_magnitude(verdict->xcom_deviation_m.x) > config->need_along_m ||
                        saddle_magnitude(verdict->xcom_deviation_m.y) > config->need_across_m);
    }
    return walk->in_need
               ? walk->recovery_shift_m
               : saddle_vec2_scale(config->step_gain,
                                   saddle_vec2_sub(moment->xcom_m, moment->planned_xcom_m));
}

/* A point from the other foot's sole, which stays. */
static saddle_vec3_t from_other_m(const saddle_moment_t *moment, unsigned side,
                                  saddle_vec3_t point_m)
{
    const saddle_vec2_t other_m = sole_m(moment, 1u - side);
    return (saddle_vec3_t){point_m.x - other_m.x, point_m.y - other_m.y, point_m.z};
}

/* A foot in the air. */
static void move(saddle_joint_walk_t *walk, const saddle_moment_t *moment, unsigned side)
{
    const saddle_plan_t *plan = moment->plan;
    const saddle_vec3_t *foot = &plan->foot_m[side];
    const saddle_vec2_t shift_m = landing_shift_m(walk, moment, side);
    saddle_swing_path_t *swing = &walk->swing[side];
    saddle_planned_swing_t planned;
    planned.path_m = from_other_m(
        moment, side,
        (saddle_vec3_t){moment->origin_m.x + foot->x, moment->origin_m.y + foot->y, foot->z});
    planned.rate_m_s = plan->swing_velocity_m_s;
    planned.landing_in_s = landing_in_s(plan);
    planned.pitch_rad = saddle_larger(plan->foot_pitch_rad[side], 0.0f);
    if (planned.landing_in_s >= walk->config.landing_frozen_s) {
        swing->shift_m = shift_m;
    }
    saddle_swing_path_step(swing, &walk->config, &planned, moment->dt_s);
}

/* [J21] By the plan: the swing foot lifts when the other has the load, and lands in time. */
static void by_plan(saddle_joint_walk_t *walk, saddle_moment_t *moment)
{
    const saddle_plan_t *plan = moment->plan;
    if (saddle_both_stand(plan)) {
        return;
    }
    const unsigned side = 1u - moment->stance;
    const bool due = landing_in_s(plan) <= 0.0f;
    if (walk->stands[side]) {
        const bool trails = walk->leading != side;
        walk->stands[side] = due || !trails || saddle_trailing_share(walk, moment) > 0.0f;
        return;
    }
    move(walk, moment, side);
    if (due) {
        land(walk, side, 0.0f);
        hold(walk, moment);
    }
}

/* [J21] The ground has a foot that stands now, or one that comes down before its time. */
static void touch_down(saddle_joint_walk_t *walk, saddle_moment_t *moment, unsigned side)
{
    const float load_n = moment->estimate->load_n[side];
    if (walk->stands[side]) {
        walk->swings[side] = walk->swings[side] && load_n <= walk->config.landed_n;
        return;
    }
    const float early_s = landing_in_s(moment->plan); /* by a plan a foot is in the air */
    if (load_n > walk->config.landed_early_n && !walk->first_swing &&
        early_s < walk->config.early_max_s) {
        land(walk, side, early_s);
        hold(walk, moment);
        walk->swings[side] = false;
    }
}

void saddle_footing_update(saddle_joint_walk_t *walk, saddle_moment_t *moment)
{
    const saddle_foot_pose_t *foot = moment->estimate->body.foot;
    const bool stood[2] = {walk->stands[SADDLE_LEFT], walk->stands[SADDLE_RIGHT]};
    by_plan(walk, moment);
    for (unsigned side = 0; side < 2; side++) {
        const bool light = moment->estimate->load_n[side] < walk->config.lifted_n;
        walk->light_s[side] =
            light ? saddle_smaller(walk->light_s[side] + moment->dt_s, LONG_AGO_S) : 0.0f;
        if (may_lift(walk, moment, side)) {
            walk->stands[side] = false;
        }
    }
    for (unsigned side = 0; side < 2; side++) {
        if (!stood[side] || walk->stands[side]) {
            touch_down(walk, moment, side);
        }
    }
    for (unsigned side = 0; side < 2; side++) {
        if (stood[side] && !walk->stands[side]) {
            walk->stands[side] = walk->swings[1u - side]; /* which has not found the ground yet */
            if (!walk->stands[side]) {
                walk->swings[side] = true;
                saddle_swing_path_begin(&walk->swing[side],
                                        from_other_m(moment, side, foot[side].sole_m),
                                        saddle_asin(-foot[side].axes.x.z));
            }
        }
    }
}

uint8_t saddle_leg_role(const saddle_joint_walk_t *walk, const saddle_moment_t *moment,
                        unsigned side)
{
    if (walk->swings[side]) {
        return SADDLE_LEG_SWINGS;
    }
    const float heel_up = -moment->estimate->body.foot[side].axes.x.z;
    const bool on_toe = walk->leg[side].role == SADDLE_LEG_TRAILS && heel_up > HEEL_UP_MIN;
    const bool may_trail = side != walk->leading && !walk->swings[walk->leading];
    const bool trails = on_toe || (may_trail && !saddle_both_stand(moment->plan) &&
                                   !walk->first_swing && !must_wait(walk, moment));
    return trails ? SADDLE_LEG_TRAILS : SADDLE_LEG_STANDS;
}
