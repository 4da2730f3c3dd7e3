#include "estimate/readings.h"

#include "math/elementary.h"
#include "space/vec3.h"

/* Of full scale: from here on a reading may be cut off. */
#define SATURATION 0.98f

/* No sensor measures more. */
#define READING_MAX 10000.0f

/* Less load than this is none. */
#define LOAD_MIN_N 1.0f

static uint32_t max_age_us(const saddle_estimator_t *estimator)
{
    return (uint32_t)(1.0e6f * estimator->config.max_age_s);
}

static float largest(saddle_vec3_t v)
{
    return saddle_larger(saddle_magnitude(v.x),
                         saddle_larger(saddle_magnitude(v.y), saddle_magnitude(v.z)));
}

static bool is_reading(saddle_vec3_t v)
{
    return saddle_in_range(v.x, -READING_MAX, READING_MAX) &&
           saddle_in_range(v.y, -READING_MAX, READING_MAX) &&
           saddle_in_range(v.z, -READING_MAX, READING_MAX);
}

saddle_imu_t saddle_imu_reading(const saddle_estimator_t *estimator,
                                const saddle_sensors_t *sensors)
{
    const saddle_estimator_config_t *config = &estimator->config;
    const bool stale = sensors->imu_age_us > max_age_us(estimator);
    const bool usable = is_reading(sensors->gyro_rad_s) && is_reading(sensors->accelerometer_m_s2);
    saddle_imu_t imu = {estimator->gyro_rad_s, {0.0f, 0.0f, 0.0f}, false, 0u};
    if (stale || !usable) {
        imu.faults = stale ? (uint32_t)SADDLE_SENSOR_IMU_STALE : (uint32_t)SADDLE_SENSOR_IMU_RANGE;
        return imu;
    }
    imu.measured = true;
    imu.gyro_rad_s = sensors->gyro_rad_s;
    imu.accelerometer_m_s2 = sensors->accelerometer_m_s2;
    if (largest(imu.gyro_rad_s) >= SATURATION * config->gyro_range_rad_s) {
        imu.faults |= (uint32_t)SADDLE_SENSOR_GYRO_SATURATED;
    }
    if (largest(imu.accelerometer_m_s2) >= SATURATION * config->accelerometer_range_m_s2) {
        imu.faults |= (uint32_t)SADDLE_SENSOR_ACCELEROMETER_SATURATED;
    }
    return imu;
}

static void follow_contact(saddle_estimator_t *estimator, unsigned side, bool contact,
                           uint64_t time_us)
{
    if (contact != estimator->contact[side] || time_us < estimator->contact_from_us[side]) {
        estimator->contact_from_us[side] = time_us;
    }
    estimator->contact[side] = contact;
}

uint32_t saddle_load_readings(saddle_estimator_t *estimator, const saddle_sensors_t *sensors)
{
    const saddle_estimator_config_t *config = &estimator->config;
    uint32_t faults = 0;
    for (unsigned side = 0; side < 2; side++) {
        const float load_n = sensors->load_n[side];
        if (sensors->load_age_us[side] > max_age_us(estimator) ||
            !saddle_in_range(load_n, -config->load_max_n, config->load_max_n)) {
            faults |= (uint32_t)SADDLE_SENSOR_LEFT_LOAD << side;
            continue;
        }
        const float threshold_n =
            estimator->contact[side] ? config->contact_off_n : config->contact_on_n;
        estimator->load_n[side] = saddle_larger(load_n, 0.0f);
        follow_contact(estimator, side, load_n > threshold_n, sensors->time_us);
    }
    return faults;
}

float saddle_load_share(const saddle_estimator_t *estimator, unsigned side)
{
    const float both_n = estimator->load_n[SADDLE_LEFT] + estimator->load_n[SADDLE_RIGHT];
    return both_n > LOAD_MIN_N ? estimator->load_n[side] / both_n : 0.0f;
}
