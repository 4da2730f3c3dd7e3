#include "kinematics/inverse.h"

#include "kinematics/chain.h"
#include "kinematics/legs.h"
#include "math/bytes.h"
#include "math/elementary.h"
#include "space/arctangent.h"
#include "space/axes.h"
#include "space/vec3.h"

#include <math.h>

/* Positions, velocities, angles and rates beyond this are no body's. */
#define ABSURD 1000.0f

/* What a length or a cosine is at least where it divides a rate. */
#define LENGTH_MIN_M 0.001f
#define COSINE_MIN 0.01f

/* [J8] */
#define CORRECTIONS 3

static const saddle_axes_t WORLD = {{1.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, {0.0f, 0.0f, 1.0f}};

static const saddle_reach_t REFUSED = {false, {false, false}, 0u, 0u};

/* A foot with its ankle, as it should be. */
typedef struct {
    saddle_com_t ankle;
    saddle_axes_t axes;
    saddle_vec3_t turn_rad_s;
} wanted_foot_t;

/* Ankle to hip, along the foot's axes. */
typedef struct {
    saddle_vec3_t d_m, rate_m_s;
} leg_line_t;

/* One joint's angle and rate. */
typedef struct {
    float rad, rad_s;
} motion_t;

/* [J2] */
static void want_foot(const saddle_legs_t *legs, const saddle_foot_t *foot, wanted_foot_t *wanted)
{
    const saddle_axes_t heading = saddle_axes_about_z(&WORLD, saddle_sin_cos(foot->yaw_rad));
    wanted->axes = saddle_axes_about_y(&heading, saddle_sin_cos(foot->pitch_rad));
    wanted->turn_rad_s = saddle_vec3_along(saddle_vec3_scale(foot->yaw_rate_rad_s, WORLD.z),
                                           foot->pitch_rate_rad_s, heading.y);
    const float forward_m = -legs->ankle_to_middle_m - saddle_sole_point_m(legs, foot->point);
    const saddle_vec3_t arm_m =
        saddle_to_world(&wanted->axes, (saddle_vec3_t){forward_m, 0.0f, legs->ankle_height_m});
    wanted->ankle.position_m = saddle_vec3_add(foot->position_m, arm_m);
    wanted->ankle.velocity_m_s =
        saddle_vec3_add(foot->velocity_m_s, saddle_vec3_cross(wanted->turn_rad_s, arm_m));
}

/* [J2] */
static leg_line_t leg_line(const wanted_foot_t *foot, const saddle_com_t *hip)
{
    const saddle_vec3_t d_m = saddle_vec3_sub(hip->position_m, foot->ankle.position_m);
    const saddle_vec3_t rate_m_s = saddle_vec3_sub(hip->velocity_m_s, foot->ankle.velocity_m_s);
    return (leg_line_t){
        saddle_to_body(&foot->axes, d_m),
        saddle_to_body(&foot->axes,
                       saddle_vec3_sub(rate_m_s, saddle_vec3_cross(foot->turn_rad_s, d_m)))};
}

/* Hip to ankle with a knee that is bent so far. */
static float leg_length_m(const saddle_legs_t *legs, float knee_rad)
{
    const float a = legs->thigh_m;
    const float b = legs->shank_m;
    return sqrtf(a * a + b * b + 2.0f * a * b * saddle_cos(knee_rad));
}

/* [J3] The line as long as the knee allows, and of constant length where that changed it; false if it
 * was too long. */
static bool fit_line(const saddle_legs_t *legs, leg_line_t *line)
{
    const float longest_m = leg_length_m(legs, legs->joint[SADDLE_KNEE].min_rad);
    const float shortest_m = leg_length_m(legs, legs->joint[SADDLE_KNEE].max_rad);
    const float length_m = saddle_larger(saddle_vec3_length(line->d_m), LENGTH_MIN_M);
    const float fit_m = saddle_clamp(length_m, shortest_m, longest_m);
    if (fit_m != length_m) {
        const float share = fit_m / length_m;
        const float along = saddle_vec3_dot(line->d_m, line->rate_m_s) / (length_m * length_m);
        line->rate_m_s =
            saddle_vec3_scale(share, saddle_vec3_along(line->rate_m_s, -along, line->d_m));
        line->d_m = saddle_vec3_scale(share, line->d_m);
    }
    return fit_m >= length_m;
}

/* [J4] */
static motion_t knee_of(const saddle_legs_t *legs, const leg_line_t *line)
{
    const float a = legs->thigh_m;
    const float b = legs->shank_m;
    const float straight_m = a + b;
    const float missing_m2 = straight_m * straight_m - saddle_vec3_dot(line->d_m, line->d_m);
    const float half_sine_2 = saddle_clamp(missing_m2 / (4.0f * a * b), 0.0f, 1.0f);
    const float knee_rad = 2.0f * saddle_asin(sqrtf(half_sine_2));
    const float range_rad =
        saddle_clamp(knee_rad, legs->joint[SADDLE_KNEE].min_rad, legs->joint[SADDLE_KNEE].max_rad);
    const float sine = saddle_larger(saddle_sin(range_rad), COSINE_MIN);
    return (motion_t){range_rad, -saddle_vec3_dot(line->d_m, line->rate_m_s) / (a * b * sine)};
}

/* [J5] Ankle roll and pitch. */
static void ankle_of(const saddle_legs_t *legs, const leg_line_t *line, motion_t knee,
                     motion_t ankle[2])
{
    const saddle_vec3_t d = line->d_m;
    const saddle_vec3_t rate = line->rate_m_s;
    const saddle_sin_cos_t bend = saddle_sin_cos(knee.rad);
    const float a = legs->thigh_m;
    const float b = legs->shank_m;
    const float height_m = saddle_larger(sqrtf(d.y * d.y + d.z * d.z), LENGTH_MIN_M);
    const float height_rate_m_s = (d.y * rate.y + d.z * rate.z) / height_m;
    const float length_m2 = saddle_larger(saddle_vec3_dot(d, d), LENGTH_MIN_M * LENGTH_MIN_M);
    const float shank_rad = saddle_arctangent(a * bend.sin, b + a * bend.cos);
    const float shank_rate_rad_s = knee.rad_s * a * (a + b * bend.cos) / length_m2;
    const float lean_rate_rad_s = (height_m * rate.x - d.x * height_rate_m_s) / length_m2;
    ankle[0] = (motion_t){saddle_arctangent(d.y, d.z),
                          (d.z * rate.y - d.y * rate.z) / (height_m * height_m)};
    ankle[1] = (motion_t){-shank_rad - saddle_arctangent(d.x, height_m),
                          -shank_rate_rad_s - lean_rate_rad_s};
}

/* [J6] Yaw, roll and pitch of the hip that has the thigh so. */
static void hip_of(const saddle_trunk_t *trunk, const saddle_axes_t *thigh,
                   saddle_vec3_t thigh_turn_rad_s, motion_t hip[3])
{
    const saddle_vec3_t across = saddle_to_body(&trunk->axes, thigh->y);
    const float cosine =
        saddle_larger(sqrtf(across.x * across.x + across.y * across.y), COSINE_MIN);
    const float sin_yaw = -across.x / cosine;
    const float cos_yaw = across.y / cosine;
    const saddle_vec3_t turn_rad_s =
        saddle_to_body(&trunk->axes, saddle_vec3_sub(thigh_turn_rad_s, trunk->turn_rad_s));
    const float pitch_rad_s = (cos_yaw * turn_rad_s.y - sin_yaw * turn_rad_s.x) / cosine;
    hip[SADDLE_HIP_YAW] =
        (motion_t){saddle_arctangent(-across.x, across.y), turn_rad_s.z - pitch_rad_s * across.z};
    hip[SADDLE_HIP_ROLL] =
        (motion_t){saddle_asin(across.z), cos_yaw * turn_rad_s.x + sin_yaw * turn_rad_s.y};
    hip[SADDLE_HIP_PITCH] = (motion_t){saddle_arctangent(-saddle_vec3_dot(trunk->axes.z, thigh->x),
                                                         saddle_vec3_dot(trunk->axes.z, thigh->z)),
                                       pitch_rad_s};
}

static void leg_of(const saddle_legs_t *legs, const saddle_trunk_t *trunk,
                   const wanted_foot_t *foot, const leg_line_t *line,
                   motion_t motion[SADDLE_LEG_JOINTS])
{
    motion_t ankle[2];
    const motion_t knee = knee_of(legs, line);
    ankle_of(legs, line, knee, ankle);
    const float back_rad = saddle_clamp(ankle[1].rad + knee.rad, -SADDLE_TWO_PI, SADDLE_TWO_PI);
    const saddle_axes_t rolled = saddle_axes_about_x(&foot->axes, saddle_sin_cos(-ankle[0].rad));
    const saddle_axes_t thigh = saddle_axes_about_y(&rolled, saddle_sin_cos(-back_rad));
    saddle_vec3_t turn_rad_s = saddle_vec3_along(foot->turn_rad_s, -ankle[0].rad_s, foot->axes.x);
    turn_rad_s = saddle_vec3_along(turn_rad_s, -ankle[1].rad_s - knee.rad_s, thigh.y);
    hip_of(trunk, &thigh, turn_rad_s, motion);
    motion[SADDLE_KNEE] = knee;
    motion[SADDLE_ANKLE_PITCH] = ankle[1];
    motion[SADDLE_ANKLE_ROLL] = ankle[0];
}

/* The joints as they may be: at rest at the end of a range, and no faster than they can turn. */
static void hold_ranges(const saddle_legs_t *legs, saddle_side_t side,
                        const motion_t motion[SADDLE_LEG_JOINTS], saddle_joints_t *joints,
                        saddle_reach_t *reach)
{
    for (unsigned joint = 0; joint < SADDLE_LEG_JOINTS; joint++) {
        const saddle_joint_range_t range = saddle_joint_range(legs, side, joint);
        const motion_t wanted = motion[joint];
        const float rad = saddle_clamp(wanted.rad, range.min_rad, range.max_rad);
        const float rate_rad_s =
            saddle_clamp(wanted.rad_s, -range.rate_max_rad_s, range.rate_max_rad_s);
        const uint32_t bit = SADDLE_JOINT_BIT(side, joint);
        reach->angle_limits |= rad != wanted.rad ? bit : 0u;
        reach->rate_limits |= rad == wanted.rad && rate_rad_s != wanted.rad_s ? bit : 0u;
        joints->angle_rad[side][joint] = rad;
        joints->rate_rad_s[side][joint] = rad == wanted.rad ? rate_rad_s : 0.0f;
    }
}

static bool usable(float value)
{
    return saddle_in_range(value, -ABSURD, ABSURD);
}

static bool usable_vec3(saddle_vec3_t v)
{
    return usable(v.x) && usable(v.y) && usable(v.z);
}

static bool usable_trunk(const saddle_trunk_t *trunk)
{
    return usable_vec3(trunk->hips_m) && usable_vec3(trunk->velocity_m_s) &&
           usable_vec3(trunk->turn_rad_s) && usable_vec3(trunk->axes.x) &&
           usable_vec3(trunk->axes.y) && usable_vec3(trunk->axes.z);
}

static bool usable_foot(const saddle_foot_t *foot)
{
    return foot->point <= SADDLE_SOLE_TOE && usable_vec3(foot->position_m) &&
           usable_vec3(foot->velocity_m_s) && usable(foot->yaw_rate_rad_s) &&
           usable(foot->pitch_rate_rad_s) &&
           saddle_in_range(foot->yaw_rad, -SADDLE_TWO_PI, SADDLE_TWO_PI) &&
           saddle_in_range(foot->pitch_rad, -SADDLE_TWO_PI, SADDLE_TWO_PI);
}

saddle_reach_t saddle_inverse_leg(const saddle_legs_t *legs, const saddle_trunk_t *trunk,
                                  const saddle_foot_t *foot, saddle_side_t side,
                                  saddle_joints_t *joints)
{
    if (!usable_trunk(trunk) || !usable_foot(foot)) {
        return REFUSED;
    }
    saddle_reach_t reach = {true, {false, false}, 0u, 0u};
    motion_t motion[SADDLE_LEG_JOINTS];
    wanted_foot_t wanted;
    want_foot(legs, foot, &wanted);
    const saddle_com_t hip = saddle_hip(legs, trunk, side);
    leg_line_t line = leg_line(&wanted, &hip);
    reach.out_of_reach[side] = !fit_line(legs, &line);
    leg_of(legs, trunk, &wanted, &line, motion);
    hold_ranges(legs, side, motion, joints, &reach);
    return reach;
}

saddle_reach_t saddle_inverse(const saddle_legs_t *legs, const saddle_trunk_t *trunk,
                              const saddle_foot_t foot[2], saddle_joints_t *joints)
{
    const saddle_reach_t left =
        saddle_inverse_leg(legs, trunk, &foot[SADDLE_LEFT], SADDLE_LEFT, joints);
    const saddle_reach_t right =
        saddle_inverse_leg(legs, trunk, &foot[SADDLE_RIGHT], SADDLE_RIGHT, joints);
    if (!left.valid || !right.valid) {
        saddle_clear(joints, sizeof *joints);
        return REFUSED;
    }
    return (saddle_reach_t){true,
                            {left.out_of_reach[SADDLE_LEFT], right.out_of_reach[SADDLE_RIGHT]},
                            left.angle_limits | right.angle_limits,
                            left.rate_limits | right.rate_limits};
}

/* [J8] */
saddle_reach_t saddle_inverse_of_com(const saddle_legs_t *legs, const saddle_com_t *com,
                                     const saddle_foot_t foot[2], saddle_trunk_t *trunk,
                                     saddle_joints_t *joints)
{
    if (!usable_vec3(com->position_m) || !usable_vec3(com->velocity_m_s)) {
        saddle_clear(joints, sizeof *joints);
        return REFUSED;
    }
    for (unsigned i = 0; i < CORRECTIONS; i++) {
        saddle_whole_body_t posture;
        if (!saddle_inverse(legs, trunk, foot, joints).valid) {
            return REFUSED;
        }
        saddle_forward(legs, trunk, joints, &posture);
        trunk->hips_m = saddle_vec3_add(trunk->hips_m,
                                        saddle_vec3_sub(com->position_m, posture.com.position_m));
        trunk->velocity_m_s = saddle_vec3_add(
            trunk->velocity_m_s, saddle_vec3_sub(com->velocity_m_s, posture.com.velocity_m_s));
    }
    return saddle_inverse(legs, trunk, foot, joints);
}
