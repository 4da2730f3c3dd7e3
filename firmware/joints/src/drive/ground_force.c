#include "drive/ground_force.h"

#include "kinematics/legs.h"
#include "math/elementary.h"
#include "math/vec2.h"
#include "space/vec3.h"

#include <math.h>

/* A CoM lower than this carries nobody. */
#define HEIGHT_MIN_M 0.1f

/* Feet closer together than this share the load as they stand. */
#define APART_MIN_M 0.01f

/* The toe carries this far behind the end of the foot. */
#define TOE_INSET_M 0.02f

/* A leg that pushes no more than this share of the weight would let the body drop. */
#define WEIGHT_MIN 0.3f

static bool carries(const saddle_intent_t *intent, unsigned side)
{
    return intent->role[side] != SADDLE_LEG_SWINGS;
}

/* Where a foot carries: the middle of its sole, or its toe. */
static saddle_vec2_t support_point_m(const saddle_legs_t *legs, const saddle_estimate_t *estimate,
                                     const saddle_intent_t *intent, unsigned side)
{
    const saddle_foot_pose_t *foot = &estimate->body.foot[side];
    const float forward_m = intent->role[side] == SADDLE_LEG_TRAILS
                                ? saddle_sole_point_m(legs, SADDLE_SOLE_TOE) - TOE_INSET_M
                                : 0.0f;
    const saddle_vec3_t point_m = saddle_vec3_along(foot->sole_m, forward_m, foot->axes.x);
    return (saddle_vec2_t){point_m.x, point_m.y};
}

/* [J16] Beyond the planned CoP by the error of the XCoM. */
static saddle_vec2_t wanted_cop_m(const saddle_drive_config_t *config,
                                  const saddle_estimate_t *estimate, const saddle_intent_t *intent)
{
    const saddle_com_t *com = &estimate->body.com;
    const float height_m = saddle_larger(com->position_m.z, HEIGHT_MIN_M);
    const float time_s = sqrtf(height_m / SADDLE_GRAVITY_M_S2);
    const saddle_vec2_t xcom_m = {com->position_m.x + time_s * com->velocity_m_s.x,
                                  com->position_m.y + time_s * com->velocity_m_s.y};
    const saddle_vec2_t error_m = saddle_vec2_sub(xcom_m, intent->xcom_m);
    return saddle_vec2_add(intent->cop_m, saddle_vec2_scale(1.0f + config->xcom_gain, error_m));
}

/* [J16] The trailing foot's share that puts the CoP nearest to the wanted one. */
static float trailing_share(saddle_vec2_t wanted_m, saddle_vec2_t leading_m,
                            saddle_vec2_t trailing_m, float most)
{
    const saddle_vec2_t back_m = saddle_vec2_sub(trailing_m, leading_m);
    const float apart_m2 = saddle_vec2_dot(back_m, back_m);
    if (apart_m2 < APART_MIN_M * APART_MIN_M) {
        return 0.5f * most;
    }
    const float share = saddle_vec2_dot(saddle_vec2_sub(wanted_m, leading_m), back_m) / apart_m2;
    return saddle_clamp(share, 0.0f, most);
}

/* [J17] Through the CoM from the CoP; as strong as weight and height ask. */
static saddle_vec3_t force_n(const saddle_legs_t *legs, const saddle_drive_config_t *config,
                             const saddle_estimate_t *estimate, const saddle_intent_t *intent,
                             saddle_vec2_t cop_m)
{
    const saddle_com_t *com = &estimate->body.com;
    const float mass_kg = saddle_legs_mass_kg(legs);
    const float rise_m_s2 =
        config->height_stiffness_1_s2 * (intent->com_height_m - com->position_m.z) +
        config->height_damping_1_s * (intent->com_rise_m_s - com->velocity_m_s.z);
    const float up_n =
        mass_kg * saddle_larger(SADDLE_GRAVITY_M_S2 + rise_m_s2, WEIGHT_MIN * SADDLE_GRAVITY_M_S2);
    const float slope_1_m = up_n / saddle_larger(com->position_m.z, HEIGHT_MIN_M);
    return (saddle_vec3_t){slope_1_m * (com->position_m.x - cop_m.x),
                           slope_1_m * (com->position_m.y - cop_m.y), up_n};
}

saddle_vec2_t saddle_ground_forces(const saddle_legs_t *legs, const saddle_drive_config_t *config,
                                   const saddle_estimate_t *estimate, const saddle_intent_t *intent,
                                   saddle_ground_force_t ground[2])
{
    const unsigned lead = intent->leading;
    const unsigned trail = 1u - lead;
    const saddle_vec2_t wanted_m = wanted_cop_m(config, estimate, intent);
    const saddle_vec2_t lead_m = support_point_m(legs, estimate, intent, lead);
    const saddle_vec2_t trail_m = support_point_m(legs, estimate, intent, trail);
    const float most = carries(intent, lead) ? intent->trailing_share_max : 1.0f;
    const float share =
        carries(intent, trail)
            ? (carries(intent, lead) ? trailing_share(wanted_m, lead_m, trail_m, most) : 1.0f)
            : 0.0f;
    const saddle_vec2_t base_m =
        saddle_vec2_add(lead_m, saddle_vec2_scale(share, saddle_vec2_sub(trail_m, lead_m)));
    const saddle_vec2_t beyond_m = saddle_vec2_sub(wanted_m, base_m);
    const saddle_vec2_t rest_m = {
        saddle_clamp(beyond_m.x, -config->cop_along_m, config->cop_along_m),
        saddle_clamp(beyond_m.y, -config->cop_across_m, config->cop_across_m)};
    const saddle_vec2_t cop_m = saddle_vec2_add(base_m, rest_m);
    const saddle_vec3_t force = force_n(legs, config, estimate, intent, cop_m);
    const float along_m = intent->role[trail] == SADDLE_LEG_TRAILS ? 0.0f : rest_m.x;
    ground[lead] = (saddle_ground_force_t){saddle_vec3_scale(1.0f - share, force),
                                           {lead_m.x + rest_m.x, lead_m.y + rest_m.y, 0.0f},
                                           1.0f - share};
    ground[trail] = (saddle_ground_force_t){
        saddle_vec3_scale(share, force), {trail_m.x + along_m, trail_m.y + rest_m.y, 0.0f}, share};
    return cop_m;
}
