#include "kinematics/chain.h"

#include "kinematics/legs.h"
#include "math/elementary.h"
#include "space/axes.h"
#include "space/vec3.h"

/* A segment in motion: one of its points, its axes and how it turns. */
typedef struct {
    saddle_com_t point;
    saddle_axes_t axes;
    saddle_vec3_t turn_rad_s;
} link_t;

/* Another point of the same segment. */
static saddle_com_t point_at(const link_t *link, saddle_vec3_t offset_m)
{
    const saddle_vec3_t arm_m = saddle_to_world(&link->axes, offset_m);
    const saddle_vec3_t swing_m_s = saddle_vec3_cross(link->turn_rad_s, arm_m);
    return (saddle_com_t){saddle_vec3_add(link->point.position_m, arm_m),
                          saddle_vec3_add(link->point.velocity_m_s, swing_m_s)};
}

static saddle_com_t point_below(const link_t *link, float distance_m)
{
    return point_at(link, (saddle_vec3_t){0.0f, 0.0f, -distance_m});
}

saddle_com_t saddle_hip(const saddle_legs_t *legs, const saddle_trunk_t *trunk, saddle_side_t side)
{
    const link_t link = {{trunk->hips_m, trunk->velocity_m_s}, trunk->axes, trunk->turn_rad_s};
    const float outward_m = side == SADDLE_LEFT ? legs->hip_half_width_m : -legs->hip_half_width_m;
    return point_at(&link, (saddle_vec3_t){0.0f, outward_m, 0.0f});
}

/* The joint turns the link about an axis of its own, which it stores. */
static void turn(link_t *link, const saddle_joints_t *joints, saddle_side_t side, unsigned joint,
                 saddle_vec3_t *axis)
{
    const saddle_sin_cos_t angle = saddle_sin_cos(joints->angle_rad[side][joint]);
    if (joint == SADDLE_HIP_YAW) {
        *axis = link->axes.z;
        link->axes = saddle_axes_about_z(&link->axes, angle);
    } else if (joint == SADDLE_HIP_ROLL || joint == SADDLE_ANKLE_ROLL) {
        *axis = link->axes.x;
        link->axes = saddle_axes_about_x(&link->axes, angle);
    } else {
        *axis = link->axes.y;
        link->axes = saddle_axes_about_y(&link->axes, angle);
    }
    link->turn_rad_s = saddle_vec3_along(link->turn_rad_s, joints->rate_rad_s[side][joint], *axis);
}

/* [J7] */
void saddle_chain(const saddle_legs_t *legs, const saddle_trunk_t *trunk,
                  const saddle_joints_t *joints, saddle_side_t side, saddle_chain_t *chain)
{
    link_t link = {saddle_hip(legs, trunk, side), trunk->axes, trunk->turn_rad_s};
    chain->hip_m = link.point.position_m;
    for (unsigned joint = SADDLE_HIP_YAW; joint <= SADDLE_HIP_PITCH; joint++) {
        turn(&link, joints, side, joint, &chain->axis[joint]);
    }
    chain->segment[SADDLE_THIGH] = point_below(&link, legs->thigh_com_share * legs->thigh_m);
    link.point = point_below(&link, legs->thigh_m);
    chain->knee_m = link.point.position_m;
    turn(&link, joints, side, SADDLE_KNEE, &chain->axis[SADDLE_KNEE]);
    chain->segment[SADDLE_SHANK] = point_below(&link, legs->shank_com_share * legs->shank_m);
    link.point = point_below(&link, legs->shank_m);
    chain->ankle_m = link.point.position_m;
    turn(&link, joints, side, SADDLE_ANKLE_PITCH, &chain->axis[SADDLE_ANKLE_PITCH]);
    turn(&link, joints, side, SADDLE_ANKLE_ROLL, &chain->axis[SADDLE_ANKLE_ROLL]);
    chain->segment[SADDLE_FOOT] = point_at(
        &link, (saddle_vec3_t){legs->ankle_to_middle_m, 0.0f, -0.5f * legs->ankle_height_m});
    const saddle_com_t sole =
        point_at(&link, (saddle_vec3_t){legs->ankle_to_middle_m, 0.0f, -legs->ankle_height_m});
    chain->foot =
        (saddle_foot_pose_t){sole.position_m, sole.velocity_m_s, link.axes, link.turn_rad_s};
}

static void add_share(saddle_com_t *sum, float share, saddle_com_t part)
{
    sum->position_m = saddle_vec3_along(sum->position_m, share, part.position_m);
    sum->velocity_m_s = saddle_vec3_along(sum->velocity_m_s, share, part.velocity_m_s);
}

saddle_com_t saddle_com_of(const saddle_legs_t *legs, const saddle_trunk_t *trunk,
                           const saddle_chain_t chain[2])
{
    const float per_kg = 1.0f / saddle_legs_mass_kg(legs);
    const float share[SADDLE_LEG_SEGMENTS] = {per_kg * legs->thigh_kg, per_kg * legs->shank_kg,
                                              per_kg * legs->foot_kg};
    const link_t link = {{trunk->hips_m, trunk->velocity_m_s}, trunk->axes, trunk->turn_rad_s};
    saddle_com_t com = {{0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 0.0f}};
    add_share(&com, per_kg * legs->trunk_kg,
              point_at(&link, (saddle_vec3_t){0.0f, 0.0f, legs->trunk_com_m}));
    for (unsigned side = 0; side < 2; side++) {
        for (unsigned segment = 0; segment < SADDLE_LEG_SEGMENTS; segment++) {
            add_share(&com, share[segment], chain[side].segment[segment]);
        }
    }
    return com;
}
