#include "math/fields.h"

#include <saddlewalk/joint_walk.h>

#define FIELD(name, min, max) {#name, offsetof(saddle_joint_walk_config_t, name), min, max}

static const saddle_config_field_t WALK_FIELDS[] = {
    FIELD(double_support_share, 0.01f, 0.9f),
    FIELD(sole_half_width_m, 0.0f, 0.2f),
    FIELD(lifted_n, 0.0f, 500.0f),
    FIELD(lifted_s, 0.0f, 1.0f),
    FIELD(carrying_n, 0.0f, 2000.0f),
    FIELD(landed_n, 0.0f, 500.0f),
    FIELD(landed_early_n, 0.0f, 1000.0f),
    FIELD(early_max_s, 0.0f, 1.0f),
    FIELD(step_gain, 0.0f, 5.0f),
    FIELD(nearby_along_m, 0.0f, 1.0f),
    FIELD(nearby_across_m, 0.0f, 1.0f),
    FIELD(need_along_m, 0.0f, 2.0f),
    FIELD(need_across_m, 0.0f, 2.0f),
    FIELD(reach_along_m, 0.0f, 2.0f),
    FIELD(reach_across_m, 0.0f, 2.0f),
    FIELD(landing_frozen_s, 0.0f, 1.0f),
    FIELD(detour_rate_rad_s, 0.0f, 100.0f),
    FIELD(lift_off_share, 0.05f, 1.0f),
    FIELD(pitch_time_s, 0.01f, 1.0f),
    FIELD(reach_down_m_s, 0.0f, 2.0f),
    FIELD(reach_down_max_m, 0.0f, 0.3f),
    FIELD(fade_s, 0.01f, 1.0f),
    FIELD(height_rate_rad_s, 0.5f, 100.0f),
    FIELD(acceleration_time_s, 0.001f, 1.0f),
};

#define WALK_FIELD_COUNT (sizeof WALK_FIELDS / sizeof WALK_FIELDS[0])

saddle_joint_walk_config_t saddle_joint_walk_default(void)
{
    saddle_joint_walk_config_t config; /* field by field: copied whole it would call memcpy */
    config.double_support_share = 0.16f;
    config.sole_half_width_m = 0.03f;
    config.lifted_n = 10.0f;
    config.lifted_s = 0.015f;
    config.carrying_n = 200.0f;
    config.landed_n = 20.0f;
    config.landed_early_n = 60.0f;
    config.early_max_s = 0.12f;
    config.step_gain = 1.5f;
    config.nearby_along_m = 0.08f;
    config.nearby_across_m = 0.05f;
    config.need_along_m = 0.13f;
    config.need_across_m = 0.07f;
    config.reach_along_m = 1.0f;
    config.reach_across_m = 0.54f;
    config.landing_frozen_s = 0.06f;
    config.detour_rate_rad_s = 20.0f;
    config.lift_off_share = 0.6f;
    config.pitch_time_s = 0.04f;
    config.reach_down_m_s = 0.3f;
    config.reach_down_max_m = 0.04f;
    config.fade_s = 0.08f;
    config.height_rate_rad_s = 12.0f;
    config.acceleration_time_s = 0.01f;
    return config;
}

const saddle_config_field_t *saddle_joint_walk_field(size_t index)
{
    return index < WALK_FIELD_COUNT ? &WALK_FIELDS[index] : NULL;
}

const char *saddle_joint_walk_check(const saddle_joint_walk_config_t *config)
{
    return saddle_bad_field(WALK_FIELDS, WALK_FIELD_COUNT, config);
}
