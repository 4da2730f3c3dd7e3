/** Which joint angles can be believed. */
#ifndef SADDLEWALK_ENCODERS_H
#define SADDLEWALK_ENCODERS_H

#include <saddlewalk/estimator.h>

/** Take the first angles as they are. */
void saddle_encoders_start(saddle_estimator_t *estimator, const saddle_sensors_t *sensors);

/** [J15] The angles to use, after dt_s; a lost encoder's is its last sound one. The result is the lost
 *  encoders' SADDLE_JOINT_BITs. */
uint32_t saddle_encoders_update(saddle_estimator_t *estimator, const saddle_sensors_t *sensors,
                                float dt_s);

#endif
