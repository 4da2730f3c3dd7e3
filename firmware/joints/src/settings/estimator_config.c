#include "math/fields.h"

#include <saddlewalk/estimator.h>

#define FIELD(name, min, max) {#name, offsetof(saddle_estimator_config_t, name), min, max}

static const saddle_config_field_t ESTIMATOR_FIELDS[] = {
    FIELD(imu_x_m, -0.5f, 0.5f),
    FIELD(imu_y_m, -0.5f, 0.5f),
    FIELD(imu_z_m, -0.5f, 1.0f),
    FIELD(gyro_range_rad_s, 1.0f, 100.0f),
    FIELD(accelerometer_range_m_s2, 15.0f, 1000.0f),
    FIELD(contact_gain_1_s, 1.0f, 200.0f),
    FIELD(posture_gain_1_s, 1.0f, 500.0f),
    FIELD(gravity_gain_1_s, 0.0f, 5.0f),
    FIELD(sole_gain_1_s, 0.0f, 20.0f),
    FIELD(heading_gain_1_s, 0.01f, 5.0f),
    FIELD(flat_max_rad, 0.01f, 0.5f),
    FIELD(roll_min_rad, 0.005f, 0.5f),
    FIELD(bias_time_s, 0.1f, 600.0f),
    FIELD(still_max_rad_s, 0.0f, 1.0f),
    FIELD(settle_time_s, 0.05f, 10.0f),
    FIELD(contact_on_n, 1.0f, 500.0f),
    FIELD(contact_off_n, 0.5f, 500.0f),
    FIELD(stance_share, 0.5f, 1.0f),
    FIELD(sole_share, 0.5f, 1.0f),
    FIELD(load_max_n, 500.0f, 20000.0f),
    FIELD(slip_m_s, 0.05f, 5.0f),
    FIELD(max_age_s, 0.001f, 0.2f),
    FIELD(frozen_time_s, 0.01f, 1.0f),
    FIELD(frozen_travel_m, 0.01f, 1.0f),
    FIELD(angle_margin_rad, 0.01f, 1.0f),
};

#define ESTIMATOR_FIELD_COUNT (sizeof ESTIMATOR_FIELDS / sizeof ESTIMATOR_FIELDS[0])

saddle_estimator_config_t saddle_estimator_default(void)
{
    saddle_estimator_config_t config; /* field by field: copied whole it would call memcpy */
    config.imu_x_m = 0.0f;
    config.imu_y_m = 0.0f;
    config.imu_z_m = 0.10f;
    config.gyro_range_rad_s = 17.4f;
    config.accelerometer_range_m_s2 = 156.0f;
    config.contact_gain_1_s = 25.0f;
    config.posture_gain_1_s = 120.0f;
    config.gravity_gain_1_s = 0.3f;
    config.sole_gain_1_s = 2.5f;
    config.heading_gain_1_s = 0.5f;
    config.flat_max_rad = 0.12f;
    config.roll_min_rad = 0.03f;
    config.bias_time_s = 30.0f;
    config.still_max_rad_s = 0.05f;
    config.settle_time_s = 0.4f;
    config.contact_on_n = 30.0f;
    config.contact_off_n = 20.0f;
    config.stance_share = 0.6f;
    config.sole_share = 0.9f;
    config.load_max_n = 5000.0f;
    config.slip_m_s = 0.25f;
    config.max_age_s = 0.02f;
    config.frozen_time_s = 0.1f;
    config.frozen_travel_m = 0.15f;
    config.angle_margin_rad = 0.2f;
    return config;
}

const saddle_config_field_t *saddle_estimator_field(size_t index)
{
    return index < ESTIMATOR_FIELD_COUNT ? &ESTIMATOR_FIELDS[index] : NULL;
}

const char *saddle_estimator_check(const saddle_estimator_config_t *config)
{
    const char *bad_field = saddle_bad_field(ESTIMATOR_FIELDS, ESTIMATOR_FIELD_COUNT, config);
    if (bad_field == NULL && config->contact_off_n > config->contact_on_n) {
        return "contact_off_n";
    }
    return bad_field;
}
