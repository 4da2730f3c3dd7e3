#include "drive/ground_force.h"
#include "kinematics/chain.h"
#include "kinematics/legs.h"
#include "math/bytes.h"
#include "math/elementary.h"
#include "space/arctangent.h"
#include "space/vec3.h"

#include <math.h>
#include <saddlewalk/joint_command.h>

/* No reference is larger. */
#define ABSURD 10000.0f

/* A foot that carries less has ankles that may still do this much. */
#define LOAD_MIN_N 50.0f

/* One leg on its way to its commands. */
typedef struct {
    unsigned side;
    float load; /* 0 in the air to 1 where it carries its share */
    float torque_nm[SADDLE_LEG_JOINTS];
} leg_t;

/* [J19] Of the chain below each joint: its own weight. */
static void add_weight(const saddle_legs_t *legs, const saddle_chain_t *chain, leg_t *leg)
{
    const float mass_kg[SADDLE_LEG_SEGMENTS] = {legs->thigh_kg, legs->shank_kg, legs->foot_kg};
    static const unsigned JOINTS_ABOVE[SADDLE_LEG_SEGMENTS] = {3, 4, 6};
    for (unsigned segment = 0; segment < SADDLE_LEG_SEGMENTS; segment++) {
        const saddle_vec3_t weight_n = {0.0f, 0.0f, -SADDLE_GRAVITY_M_S2 * mass_kg[segment]};
        for (unsigned joint = 0; joint < JOINTS_ABOVE[segment]; joint++) {
            const saddle_vec3_t origin_m = joint < SADDLE_KNEE    ? chain->hip_m
                                           : joint == SADDLE_KNEE ? chain->knee_m
                                                                  : chain->ankle_m;
            const saddle_vec3_t arm_m =
                saddle_vec3_sub(chain->segment[segment].position_m, origin_m);
            leg->torque_nm[joint] -=
                saddle_vec3_dot(chain->axis[joint], saddle_vec3_cross(arm_m, weight_n));
        }
    }
}

/* [J19] What accelerates a swinging leg as its reference. */
static void add_inertia(const saddle_drive_config_t *config, const saddle_intent_t *intent,
                        leg_t *leg)
{
    const float *acceleration = intent->acceleration_rad_s2[leg->side];
    const float hip = acceleration[SADDLE_HIP_PITCH];
    const float knee = acceleration[SADDLE_KNEE];
    leg->torque_nm[SADDLE_HIP_ROLL] += config->swing_roll_kg_m2 * acceleration[SADDLE_HIP_ROLL];
    leg->torque_nm[SADDLE_HIP_PITCH] +=
        config->swing_pitch_kg_m2 * hip + config->swing_knee_kg_m2 * knee;
    leg->torque_nm[SADDLE_KNEE] += config->swing_knee_kg_m2 * (hip + knee);
}

/* [J18] Ground force and trunk moment through massless segments. */
static void add_ground(const saddle_chain_t *chain, const saddle_ground_force_t *ground,
                       saddle_vec3_t moment_nm, leg_t *leg)
{
    for (unsigned joint = 0; joint < SADDLE_LEG_JOINTS; joint++) {
        const saddle_vec3_t origin_m = joint < SADDLE_KNEE    ? chain->hip_m
                                       : joint == SADDLE_KNEE ? chain->knee_m
                                                              : chain->ankle_m;
        const saddle_vec3_t arm_m = saddle_vec3_sub(ground->cop_m, origin_m);
        const saddle_vec3_t load_nm =
            saddle_vec3_along(saddle_vec3_cross(arm_m, ground->force_n), ground->share, moment_nm);
        leg->torque_nm[joint] -= saddle_vec3_dot(chain->axis[joint], load_nm);
    }
}

/* [J18] What turns the trunk upright and its front to x. */
static saddle_vec3_t trunk_moment_nm(const saddle_drive_config_t *config,
                                     const saddle_trunk_t *trunk)
{
    const saddle_axes_t *axes = &trunk->axes;
    const float roll_rad = saddle_arctangent(axes->y.z, axes->z.z);
    const float pitch_rad = saddle_asin(-axes->x.z);
    const float yaw_rad = saddle_arctangent(axes->x.y, axes->x.x);
    return (saddle_vec3_t){
        -config->trunk_stiffness * roll_rad - config->trunk_damping * trunk->turn_rad_s.x,
        -config->trunk_stiffness * pitch_rad - config->trunk_damping * trunk->turn_rad_s.y,
        -config->heading_stiffness * yaw_rad - config->heading_damping * trunk->turn_rad_s.z};
}

/* [J20] Between swing and stance by the load. */
static float blend(const leg_t *leg, float swing, float stance)
{
    return swing + leg->load * (stance - swing);
}

/* [J20] The torques that keep the CoP of a sole within its edges; of other joints those of the drive. */
static void limit_torques(const saddle_legs_t *legs, const saddle_drive_config_t *config,
                          float load_n, bool on_sole, saddle_joint_command_t *command)
{
    const float carried_n = saddle_larger(load_n, LOAD_MIN_N);
    const float half_m = saddle_larger(0.5f * legs->foot_length_m - config->edge_inset_m, 0.0f);
    for (unsigned joint = 0; joint < SADDLE_LEG_JOINTS; joint++) {
        const float most_nm = config->joint[joint].torque_max_nm;
        command[joint].torque_min_nm = -most_nm;
        command[joint].torque_max_nm = most_nm;
        if (on_sole && joint == SADDLE_ANKLE_PITCH) {
            const float heel_m = half_m - legs->ankle_to_middle_m;
            const float toe_m = half_m + legs->ankle_to_middle_m;
            command[joint].torque_min_nm = saddle_clamp(-heel_m * carried_n, -most_nm, most_nm);
            command[joint].torque_max_nm = saddle_clamp(toe_m * carried_n, -most_nm, most_nm);
        } else if (on_sole && joint == SADDLE_ANKLE_ROLL) {
            const float edge_nm = saddle_smaller(config->edge_across_m * carried_n, most_nm);
            command[joint].torque_min_nm = -edge_nm;
            command[joint].torque_max_nm = edge_nm;
        }
    }
}

/* [J20] */
static void write_leg(const saddle_legs_t *legs, const saddle_drive_config_t *config,
                      const saddle_intent_t *intent, const leg_t *leg,
                      saddle_joint_command_t *command)
{
    for (unsigned joint = 0; joint < SADDLE_LEG_JOINTS; joint++) {
        const saddle_joint_range_t range =
            saddle_joint_range(legs, (saddle_side_t)leg->side, joint);
        const saddle_joint_drive_t *gains = &config->joint[joint];
        command[joint].angle_rad =
            saddle_clamp(intent->joints.angle_rad[leg->side][joint], range.min_rad, range.max_rad);
        command[joint].rate_rad_s = saddle_clamp(intent->joints.rate_rad_s[leg->side][joint],
                                                 -range.rate_max_rad_s, range.rate_max_rad_s);
        command[joint].stiffness = blend(leg, gains->swing_stiffness, gains->stance_stiffness);
        command[joint].damping = blend(leg, gains->swing_damping, gains->stance_damping);
        command[joint].torque_nm = saddle_clamp(leg->torque_nm[joint], command[joint].torque_min_nm,
                                                command[joint].torque_max_nm);
    }
}

/* Nothing to go by: the drives hold or damp by themselves. */
static void fall_back(const saddle_legs_t *legs, const saddle_drive_config_t *config,
                      const saddle_estimate_t *estimate, saddle_joint_commands_t *commands)
{
    saddle_clear(commands, sizeof *commands);
    commands->fallback = true;
    for (unsigned i = 0; i < 2u * SADDLE_LEG_JOINTS; i++) {
        const unsigned side = i / SADDLE_LEG_JOINTS;
        const unsigned joint = i % SADDLE_LEG_JOINTS;
        const saddle_joint_range_t range = saddle_joint_range(legs, (saddle_side_t)side, joint);
        const saddle_joint_drive_t *gains = &config->joint[joint];
        saddle_joint_command_t *command = &commands->joint[side][joint];
        command->angle_rad =
            saddle_clamp(estimate->joints.angle_rad[side][joint], range.min_rad, range.max_rad);
        command->stiffness = config->fallback_stiffness * gains->stance_stiffness;
        command->damping = config->fallback_damping * gains->stance_damping;
        command->torque_min_nm = -gains->torque_max_nm;
        command->torque_max_nm = gains->torque_max_nm;
    }
}

static bool all_usable(const float *values, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (!saddle_in_range(values[i], -ABSURD, ABSURD)) {
            return false;
        }
    }
    return true;
}

static bool usable_intent(const saddle_intent_t *intent)
{
    return intent->role[SADDLE_LEFT] <= SADDLE_LEG_TRAILS &&
           intent->role[SADDLE_RIGHT] <= SADDLE_LEG_TRAILS && intent->leading <= SADDLE_RIGHT &&
           all_usable(&intent->trailing_share_max, 1) && all_usable(&intent->xcom_m.x, 1) &&
           all_usable(&intent->xcom_m.y, 1) && all_usable(&intent->cop_m.x, 1) &&
           all_usable(&intent->cop_m.y, 1) && all_usable(&intent->com_height_m, 1) &&
           all_usable(&intent->com_rise_m_s, 1) &&
           all_usable(intent->joints.angle_rad[SADDLE_LEFT], SADDLE_LEG_JOINTS) &&
           all_usable(intent->joints.angle_rad[SADDLE_RIGHT], SADDLE_LEG_JOINTS) &&
           all_usable(intent->joints.rate_rad_s[SADDLE_LEFT], SADDLE_LEG_JOINTS) &&
           all_usable(intent->joints.rate_rad_s[SADDLE_RIGHT], SADDLE_LEG_JOINTS) &&
           all_usable(intent->acceleration_rad_s2[SADDLE_LEFT], SADDLE_LEG_JOINTS) &&
           all_usable(intent->acceleration_rad_s2[SADDLE_RIGHT], SADDLE_LEG_JOINTS);
}

static leg_t bare_leg(const saddle_legs_t *legs, const saddle_drive_config_t *config,
                      const saddle_estimate_t *estimate, const saddle_intent_t *intent,
                      unsigned side)
{
    const float full_n = config->full_load_share * SADDLE_GRAVITY_M_S2 * saddle_legs_mass_kg(legs);
    const bool swings = intent->role[side] == SADDLE_LEG_SWINGS;
    const float load = swings ? 0.0f : saddle_clamp(estimate->load_n[side] / full_n, 0.0f, 1.0f);
    return (leg_t){side, load, {0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f}};
}

void saddle_joint_commands(const saddle_legs_t *legs, const saddle_drive_config_t *config,
                           const saddle_estimate_t *estimate, const saddle_intent_t *intent,
                           saddle_joint_commands_t *commands)
{
    const uint32_t max_age_us = (uint32_t)(1.0e6f * config->max_age_s);
    if (estimate->measurement.com.age_us > max_age_us || !usable_intent(intent)) {
        fall_back(legs, config, estimate, commands);
        return;
    }
    saddle_ground_force_t ground[2];
    saddle_chain_t chain[2];
    leg_t leg[2];
    commands->fallback = false;
    commands->cop_m = saddle_ground_forces(legs, config, estimate, intent, ground);
    const saddle_vec3_t moment_nm = trunk_moment_nm(config, &estimate->trunk);
    for (unsigned side = 0; side < 2; side++) {
        saddle_chain(legs, &estimate->trunk, &estimate->joints, (saddle_side_t)side, &chain[side]);
        leg[side] = bare_leg(legs, config, estimate, intent, side);
        if (intent->role[side] == SADDLE_LEG_SWINGS) {
            add_inertia(config, intent, &leg[side]);
        }
        add_weight(legs, &chain[side], &leg[side]);
    }
    for (unsigned side = 0; side < 2; side++) {
        const uint8_t role = intent->role[side];
        if (role != SADDLE_LEG_SWINGS) {
            add_ground(&chain[side], &ground[side], moment_nm, &leg[side]);
        }
        limit_torques(legs, config, estimate->load_n[side], role == SADDLE_LEG_STANDS,
                      commands->joint[side]);
        write_leg(legs, config, intent, &leg[side], commands->joint[side]);
        commands->load_share[side] = role == SADDLE_LEG_SWINGS ? 0.0f : ground[side].share;
    }
}
