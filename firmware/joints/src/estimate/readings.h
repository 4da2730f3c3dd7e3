/** IMU and foot loads: what of them is usable. */
#ifndef SADDLEWALK_READINGS_H
#define SADDLEWALK_READINGS_H

#include <saddlewalk/estimator.h>

/** The IMU as it can be used: without a reading it keeps turning and does not accelerate. */
typedef struct {
    saddle_vec3_t gyro_rad_s;
    saddle_vec3_t accelerometer_m_s2;
    bool measured; /**< false: both were made up */
    uint32_t faults;
} saddle_imu_t;

saddle_imu_t saddle_imu_reading(const saddle_estimator_t *estimator,
                                const saddle_sensors_t *sensors);

/** Loads and contacts with hysteresis; a lost load stays as it was. The result is faults. */
uint32_t saddle_load_readings(saddle_estimator_t *estimator, const saddle_sensors_t *sensors);

/** A foot's share of all load; 0 where there is none. */
float saddle_load_share(const saddle_estimator_t *estimator, unsigned side);

#endif
