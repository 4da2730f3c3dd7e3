#include "math/fields.h"

#include <saddlewalk/joint_command.h>

#define FIELD(name, min, max) {#name, offsetof(saddle_drive_config_t, name), min, max}
#define OF_JOINT(name, index, field, max) \
    {#name "_" #field, offsetof(saddle_drive_config_t, joint[index].field), 0.0f, max}
#define JOINT_FIELDS(name, index)                         \
    OF_JOINT(name, index, stance_stiffness, 10000.0f),    \
        OF_JOINT(name, index, stance_damping, 1000.0f),   \
        OF_JOINT(name, index, swing_stiffness, 10000.0f), \
        OF_JOINT(name, index, swing_damping, 1000.0f),    \
        OF_JOINT(name, index, torque_max_nm, 1000.0f)

static const saddle_config_field_t DRIVE_FIELDS[] = {
    FIELD(xcom_gain, 0.0f, 5.0f),
    FIELD(cop_along_m, 0.0f, 0.3f),
    FIELD(cop_across_m, 0.0f, 0.2f),
    FIELD(trunk_stiffness, 0.0f, 10000.0f),
    FIELD(trunk_damping, 0.0f, 1000.0f),
    FIELD(heading_stiffness, 0.0f, 10000.0f),
    FIELD(heading_damping, 0.0f, 1000.0f),
    FIELD(height_stiffness_1_s2, 0.0f, 500.0f),
    FIELD(height_damping_1_s, 0.0f, 100.0f),
    FIELD(edge_inset_m, 0.0f, 0.1f),
    FIELD(edge_across_m, 0.0f, 0.2f),
    FIELD(full_load_share, 0.05f, 1.0f),
    FIELD(swing_roll_kg_m2, 0.0f, 20.0f),
    FIELD(swing_pitch_kg_m2, 0.0f, 20.0f),
    FIELD(swing_knee_kg_m2, 0.0f, 5.0f),
    FIELD(max_age_s, 0.0f, 1.0f),
    FIELD(fallback_damping, 0.0f, 5.0f),
    FIELD(fallback_stiffness, 0.0f, 5.0f),
    JOINT_FIELDS(hip_yaw, SADDLE_HIP_YAW),
    JOINT_FIELDS(hip_roll, SADDLE_HIP_ROLL),
    JOINT_FIELDS(hip_pitch, SADDLE_HIP_PITCH),
    JOINT_FIELDS(knee, SADDLE_KNEE),
    JOINT_FIELDS(ankle_pitch, SADDLE_ANKLE_PITCH),
    JOINT_FIELDS(ankle_roll, SADDLE_ANKLE_ROLL),
};

#define DRIVE_FIELD_COUNT (sizeof DRIVE_FIELDS / sizeof DRIVE_FIELDS[0])

static saddle_joint_drive_t drive(saddle_vec2_t stance, saddle_vec2_t swing, float torque_max_nm)
{
    return (saddle_joint_drive_t){stance.x, stance.y, swing.x, swing.y, torque_max_nm};
}

static saddle_vec2_t gains(float stiffness, float damping)
{
    return (saddle_vec2_t){stiffness, damping};
}

saddle_drive_config_t saddle_drive_default(void)
{
    saddle_drive_config_t config; /* field by field: copied whole it would call memcpy */
    config.xcom_gain = 1.0f;
    config.cop_along_m = 0.09f;
    config.cop_across_m = 0.035f;
    config.trunk_stiffness = 1200.0f;
    config.trunk_damping = 110.0f;
    config.heading_stiffness = 200.0f;
    config.heading_damping = 20.0f;
    config.height_stiffness_1_s2 = 0.0f;
    config.height_damping_1_s = 0.0f;
    config.edge_inset_m = 0.015f;
    config.edge_across_m = 0.045f;
    config.full_load_share = 0.4f;
    config.swing_roll_kg_m2 = 1.2f;
    config.swing_pitch_kg_m2 = 1.2f;
    config.swing_knee_kg_m2 = 0.3f;
    config.max_age_s = 0.24f;
    config.fallback_damping = 1.0f;
    config.fallback_stiffness = 0.0f;
    config.joint[SADDLE_HIP_YAW] = drive(gains(350.0f, 10.0f), gains(200.0f, 10.0f), 80.0f);
    config.joint[SADDLE_HIP_ROLL] = drive(gains(850.0f, 50.0f), gains(1000.0f, 25.0f), 180.0f);
    config.joint[SADDLE_HIP_PITCH] = drive(gains(1300.0f, 75.0f), gains(800.0f, 35.0f), 220.0f);
    config.joint[SADDLE_KNEE] = drive(gains(375.0f, 25.0f), gains(800.0f, 20.0f), 220.0f);
    config.joint[SADDLE_ANKLE_PITCH] = drive(gains(62.0f, 6.0f), gains(150.0f, 3.0f), 180.0f);
    config.joint[SADDLE_ANKLE_ROLL] = drive(gains(75.0f, 0.75f), gains(120.0f, 2.0f), 60.0f);
    return config;
}

const saddle_config_field_t *saddle_drive_field(size_t index)
{
    return index < DRIVE_FIELD_COUNT ? &DRIVE_FIELDS[index] : NULL;
}

const char *saddle_drive_check(const saddle_drive_config_t *config)
{
    return saddle_bad_field(DRIVE_FIELDS, DRIVE_FIELD_COUNT, config);
}
