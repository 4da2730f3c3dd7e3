/** The orientation of a body that turns. */
#ifndef SADDLEWALK_QUATERNION_H
#define SADDLEWALK_QUATERNION_H

#include <saddlewalk/estimator.h>

/** Upright by an upward direction of any length, along the body's axes; its x axis points forward. */
saddle_quaternion_t saddle_quaternion_of_up(saddle_vec3_t up);

/** Turned for dt_s at a rate along the body's axes, and of length 1 again. */
saddle_quaternion_t saddle_quaternion_turned(saddle_quaternion_t q, saddle_vec3_t rate_rad_s,
                                             float dt_s);

/** Its axes, seen from the world. */
saddle_axes_t saddle_quaternion_axes(saddle_quaternion_t q);

#endif
