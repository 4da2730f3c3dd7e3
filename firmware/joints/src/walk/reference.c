#include "walk/reference.h"

#include "kinematics/inverse.h"
#include "kinematics/legs.h"
#include "math/bytes.h"
#include "math/elementary.h"
#include "space/vec3.h"

/* The reference accelerates no faster. */
#define ACCELERATION_MAX_RAD_S2 200.0f

static const saddle_vec3_t AT_REST = {0.0f, 0.0f, 0.0f};
static const saddle_axes_t UPRIGHT_TRUNK = {
    {1.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, {0.0f, 0.0f, 1.0f}};

/* [J24] The planned height, which may jump, by a critically damped filter. */
static void follow_height(saddle_joint_walk_t *walk, const saddle_moment_t *moment)
{
    const float planned_m = moment->plan != NULL ? moment->plan->com_m.z : walk->height_m;
    const float rate = walk->config.height_rate_rad_s;
    const float pull_m_s2 =
        rate * rate * (planned_m - walk->height_m) - 2.0f * rate * walk->height_rate_m_s;
    walk->height_rate_m_s += pull_m_s2 * moment->dt_s;
    walk->height_m += walk->height_rate_m_s * moment->dt_s;
}

/* [J24] The trunk of legs that stand: upright, under it the hips from which the last reference has the
 * CoM at its height, over the place where it is. */
static saddle_trunk_t upright_trunk(const saddle_joint_walk_t *walk, const saddle_moment_t *moment)
{
    const saddle_com_t *com = &moment->estimate->body.com;
    const saddle_vec3_t wanted_m = {com->position_m.x, com->position_m.y, walk->height_m};
    const saddle_vec3_t rate_m_s = {com->velocity_m_s.x, com->velocity_m_s.y,
                                    walk->height_rate_m_s};
    const saddle_trunk_t hips = {AT_REST, AT_REST, UPRIGHT_TRUNK, AT_REST};
    saddle_whole_body_t body;
    saddle_forward(&walk->legs, &hips, &walk->joints, &body);
    return (saddle_trunk_t){saddle_vec3_sub(wanted_m, body.com.position_m), rate_m_s, UPRIGHT_TRUNK,
                            AT_REST};
}

/* A foot in the air, or on its way down after its time. */
static void swinging_foot(saddle_joint_walk_t *walk, const saddle_moment_t *moment, unsigned side,
                          saddle_foot_t *foot)
{
    const saddle_joint_walk_config_t *config = &walk->config;
    saddle_swing_path_t *swing = &walk->swing[side];
    if (walk->stands[side]) {
        const bool deepest = swing->position_m.z <= -config->reach_down_max_m;
        swing->velocity_m_s = (saddle_vec3_t){0.0f, 0.0f, deepest ? 0.0f : -config->reach_down_m_s};
        swing->position_m.z += swing->velocity_m_s.z * moment->dt_s;
        swing->pitch_rate_rad_s = -swing->pitch_rad / config->pitch_time_s;
        swing->pitch_rad +=
            swing->pitch_rate_rad_s * saddle_smaller(moment->dt_s, config->pitch_time_s);
    }
    const saddle_vec3_t *other_m = &moment->estimate->body.foot[1u - side].sole_m;
    foot->position_m = (saddle_vec3_t){other_m->x + swing->position_m.x,
                                       other_m->y + swing->position_m.y, swing->position_m.z};
    foot->velocity_m_s = swing->velocity_m_s;
    foot->pitch_rad = swing->pitch_rad;
    foot->pitch_rate_rad_s = swing->pitch_rate_rad_s;
    /* The toe of a tilted foot does not go through the ground. */
    const float toe_m = saddle_sole_point_m(&walk->legs, SADDLE_SOLE_TOE);
    const saddle_sin_cos_t pitch = saddle_sin_cos(swing->pitch_rad);
    if (!walk->stands[side] && foot->position_m.z < toe_m * pitch.sin) {
        foot->position_m.z = toe_m * pitch.sin;
        foot->velocity_m_s.z = toe_m * pitch.cos * swing->pitch_rate_rad_s;
    }
}

/* Where a foot should be: one that stands stays where it is. */
static saddle_foot_t wanted_foot(saddle_joint_walk_t *walk, const saddle_moment_t *moment,
                                 unsigned side, uint8_t role)
{
    const saddle_foot_pose_t *measured = &moment->estimate->body.foot[side];
    saddle_foot_t foot = {SADDLE_SOLE_MIDDLE, measured->sole_m, AT_REST, 0.0f, 0.0f, 0.0f, 0.0f};
    if (role == SADDLE_LEG_SWINGS) {
        swinging_foot(walk, moment, side, &foot);
        return foot;
    }
    if (role == SADDLE_LEG_TRAILS) {
        foot.point = SADDLE_SOLE_TOE;
        foot.position_m = saddle_vec3_along(
            measured->sole_m, saddle_sole_point_m(&walk->legs, SADDLE_SOLE_TOE), measured->axes.x);
        foot.pitch_rad = moment->plan != NULL ? moment->plan->foot_pitch_rad[side] : 0.0f;
    }
    foot.position_m.z = 0.0f;
    return foot;
}

/* [J25] The jump of a reference whose leg has another role now fades. */
static void fade(saddle_joint_walk_t *walk, const saddle_joints_t *raw, unsigned side, float dt_s,
                 saddle_intent_t *intent)
{
    saddle_leg_reference_t *leg = &walk->leg[side];
    const bool changed = leg->role != intent->role[side];
    const float before_s = leg->fading_s;
    leg->fading_s = changed ? 0.0f : saddle_smaller(leg->fading_s + dt_s, walk->config.fade_s);
    const saddle_jerk_t faded = saddle_min_jerk_both(leg->fading_s / walk->config.fade_s);
    const float slope_1_s = faded.slope / walk->config.fade_s;
    const saddle_jerk_t before = saddle_min_jerk_both(before_s / walk->config.fade_s);
    const float keep = saddle_smaller(dt_s / walk->config.acceleration_time_s, 1.0f);
    for (unsigned joint = 0; joint < SADDLE_LEG_JOINTS; joint++) {
        const float raw_rad = raw->angle_rad[side][joint];
        if (!leg->has_role) {
            leg->offset_rad[joint] = 0.0f;
        } else if (changed) {
            leg->offset_rad[joint] = walk->joints.angle_rad[side][joint] +
                                     (1.0f - before.value) * leg->offset_rad[joint] - raw_rad;
        }
        const float rate_rad_s = raw->rate_rad_s[side][joint] - slope_1_s * leg->offset_rad[joint];
        const float gained = changed
                                 ? 0.0f
                                 : saddle_clamp((rate_rad_s - leg->rate_rad_s[joint]) / dt_s,
                                                -ACCELERATION_MAX_RAD_S2, ACCELERATION_MAX_RAD_S2);
        leg->acceleration_rad_s2[joint] += keep * (gained - leg->acceleration_rad_s2[joint]);
        leg->rate_rad_s[joint] = rate_rad_s;
        intent->joints.angle_rad[side][joint] =
            raw_rad + (1.0f - faded.value) * leg->offset_rad[joint];
        intent->joints.rate_rad_s[side][joint] = rate_rad_s;
        intent->acceleration_rad_s2[side][joint] = leg->acceleration_rad_s2[joint];
    }
    leg->role = intent->role[side];
    leg->has_role = true;
}

bool saddle_reference_update(saddle_joint_walk_t *walk, const saddle_moment_t *moment,
                             saddle_intent_t *intent)
{
    follow_height(walk, moment);
    const saddle_trunk_t upright = upright_trunk(walk, moment);
    saddle_joints_t raw;
    for (unsigned side = 0; side < 2; side++) {
        const uint8_t role = saddle_leg_role(walk, moment, side);
        const saddle_foot_t foot = wanted_foot(walk, moment, side, role);
        const saddle_trunk_t *trunk =
            role == SADDLE_LEG_SWINGS ? &moment->estimate->trunk : &upright;
        intent->role[side] = role;
        if (!saddle_inverse_leg(&walk->legs, trunk, &foot, (saddle_side_t)side, &raw).valid) {
            return false;
        }
    }
    for (unsigned side = 0; side < 2; side++) {
        fade(walk, &raw, side, moment->dt_s, intent);
    }
    saddle_copy(&walk->joints, &raw, sizeof raw);
    intent->com_height_m = walk->height_m;
    intent->com_rise_m_s = walk->height_rate_m_s;
    return true;
}
