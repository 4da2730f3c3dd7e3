/** The trunk's orientation. */
#ifndef SADDLEWALK_TILT_H
#define SADDLEWALK_TILT_H

#include "estimate/readings.h"

#include <saddlewalk/estimator.h>

/** [J9] Upright by the sole that carries, or with both feet in the air by the accelerometer; feet along
 *  the trunk's axes. */
void saddle_tilt_start(saddle_estimator_t *estimator, const saddle_imu_t *imu,
                       const saddle_foot_pose_t foot[2]);

/** [J10] to [J12] The attitude, and the gyroscope's bias, after dt_s; feet along the trunk's axes. */
void saddle_tilt_update(saddle_estimator_t *estimator, const saddle_imu_t *imu,
                        const saddle_foot_pose_t foot[2], float dt_s);

/** Whether the loaded anchor seems tilted sideways further than any foot. */
bool saddle_sole_is_absurd(const saddle_estimator_t *estimator, const saddle_axes_t *sole);

#endif
