#include "kinematics/legs.h"

#include "math/fields.h"

#define FIELD(name, min, max) {#name, offsetof(saddle_legs_t, name), min, max}
/* These come last in LEGS_FIELDS: three of each joint, in the joints' order. */
#define JOINT_FIELDS(name, index)                                                             \
    {#name "_min_rad", offsetof(saddle_legs_t, joint[index].min_rad), -3.0f, 3.0f},           \
        {#name "_max_rad", offsetof(saddle_legs_t, joint[index].max_rad), -3.0f, 3.0f},       \
        {#name "_rate_max_rad_s", offsetof(saddle_legs_t, joint[index].rate_max_rad_s), 0.1f, \
         100.0f}

/* The least bend of a knee at which rates stay finite. */
#define KNEE_MIN_RAD 0.01f

static const saddle_config_field_t LEGS_FIELDS[] = {
    FIELD(thigh_m, 0.1f, 0.8f),
    FIELD(shank_m, 0.1f, 0.8f),
    FIELD(ankle_height_m, 0.01f, 0.3f),
    FIELD(hip_half_width_m, 0.02f, 0.4f),
    FIELD(foot_length_m, 0.05f, 0.6f),
    FIELD(ankle_to_middle_m, -0.2f, 0.3f),
    FIELD(trunk_com_m, 0.01f, 1.0f),
    FIELD(thigh_com_share, 0.05f, 0.95f),
    FIELD(shank_com_share, 0.05f, 0.95f),
    FIELD(trunk_kg, 1.0f, 400.0f),
    FIELD(thigh_kg, 0.1f, 60.0f),
    FIELD(shank_kg, 0.1f, 60.0f),
    FIELD(foot_kg, 0.05f, 30.0f),
    JOINT_FIELDS(hip_yaw, SADDLE_HIP_YAW),
    JOINT_FIELDS(hip_roll, SADDLE_HIP_ROLL),
    JOINT_FIELDS(hip_pitch, SADDLE_HIP_PITCH),
    JOINT_FIELDS(knee, SADDLE_KNEE),
    JOINT_FIELDS(ankle_pitch, SADDLE_ANKLE_PITCH),
    JOINT_FIELDS(ankle_roll, SADDLE_ANKLE_ROLL),
};

#define LEGS_FIELD_COUNT (sizeof LEGS_FIELDS / sizeof LEGS_FIELDS[0])

/* [J1] */
saddle_legs_t saddle_legs_default(float body_height_m, float body_mass_kg)
{
    const float foot_m = 0.152f * body_height_m;
    return (saddle_legs_t){
        .thigh_m = 0.245f * body_height_m,
        .shank_m = 0.246f * body_height_m,
        .ankle_height_m = 0.039f * body_height_m,
        .hip_half_width_m = 0.055f * body_height_m,
        .foot_length_m = foot_m,
        .ankle_to_middle_m = 0.25f * foot_m,
        .trunk_com_m = 0.626f * 0.288f * body_height_m,
        .thigh_com_share = 0.433f,
        .shank_com_share = 0.433f,
        .trunk_kg = 0.678f * body_mass_kg,
        .thigh_kg = 0.100f * body_mass_kg,
        .shank_kg = 0.0465f * body_mass_kg,
        .foot_kg = 0.0145f * body_mass_kg,
        .joint = {[SADDLE_HIP_YAW] = {-0.70f, 0.70f, 10.0f},
                  [SADDLE_HIP_ROLL] = {-0.79f, 0.79f, 10.0f},
                  [SADDLE_HIP_PITCH] = {-2.09f, 0.70f, 15.0f},
                  [SADDLE_KNEE] = {0.10f, 2.44f, 15.0f},
                  [SADDLE_ANKLE_PITCH] = {-0.70f, 1.05f, 15.0f},
                  [SADDLE_ANKLE_ROLL] = {-0.52f, 0.52f, 15.0f}},
    };
}

const saddle_config_field_t *saddle_legs_field(size_t index)
{
    return index < LEGS_FIELD_COUNT ? &LEGS_FIELDS[index] : NULL;
}

const char *saddle_legs_check(const saddle_legs_t *legs)
{
    const char *bad_field = saddle_bad_field(LEGS_FIELDS, LEGS_FIELD_COUNT, legs);
    if (bad_field != NULL) {
        return bad_field;
    }
    if (legs->joint[SADDLE_KNEE].min_rad < KNEE_MIN_RAD) {
        return "knee_min_rad";
    }
    for (unsigned joint = 0; joint < SADDLE_LEG_JOINTS; joint++) {
        if (legs->joint[joint].min_rad > legs->joint[joint].max_rad) {
            return LEGS_FIELDS[LEGS_FIELD_COUNT - (size_t)3u * (SADDLE_LEG_JOINTS - joint)].name;
        }
    }
    return NULL;
}

float saddle_legs_mass_kg(const saddle_legs_t *legs)
{
    return legs->trunk_kg + 2.0f * (legs->thigh_kg + legs->shank_kg + legs->foot_kg);
}

static bool is_mirrored(unsigned joint)
{
    return joint == SADDLE_HIP_YAW || joint == SADDLE_HIP_ROLL || joint == SADDLE_ANKLE_ROLL;
}

saddle_joint_range_t saddle_joint_range(const saddle_legs_t *legs, saddle_side_t side,
                                        unsigned joint)
{
    const saddle_joint_range_t left = legs->joint[joint];
    if (side == SADDLE_LEFT || !is_mirrored(joint)) {
        return left;
    }
    return (saddle_joint_range_t){-left.max_rad, -left.min_rad, left.rate_max_rad_s};
}

float saddle_sole_point_m(const saddle_legs_t *legs, uint8_t point)
{
    if (point == SADDLE_SOLE_HEEL) {
        return -0.5f * legs->foot_length_m;
    }
    return point == SADDLE_SOLE_TOE ? 0.5f * legs->foot_length_m : 0.0f;
}
