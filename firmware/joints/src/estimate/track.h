/** A position and its velocity that follow a measured position. */
#ifndef SADDLEWALK_TRACK_H
#define SADDLEWALK_TRACK_H

#include <saddlewalk/estimator.h>

/** Gains of one step, [J13]. */
typedef struct {
    float dt_s;
    float position, velocity_1_s;
} saddle_track_gains_t;

/** Both poles at exp(-gain_1_s dt_s), whatever dt_s > 0 is. */
saddle_track_gains_t saddle_track_gains(float gain_1_s, float dt_s);

/** One step under an acceleration; the velocity that the measured position has beyond the expected
 *  one, as far as a single step tells. */
saddle_vec3_t saddle_track_step(saddle_track_t *track, const saddle_track_gains_t *gains,
                                saddle_vec3_t measured_m, saddle_vec3_t acceleration_m_s2);

#endif
