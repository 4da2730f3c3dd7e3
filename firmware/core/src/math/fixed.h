/** Fixed-point position and speed: sums of them are exact, so that nothing drifts in a day's walk.
 *
 *  A speed counts 2^-42 m/s and a position 2^-42 um, so that speed times microseconds is position.
 *  Range: +-2 m, +-4 m/s; every function limits its arguments and its result to that, and takes NaN
 *  for 0. No 64-bit division, no conversion between 64 bits and float. */
#ifndef SADDLEWALK_FIXED_H
#define SADDLEWALK_FIXED_H

#include <saddlewalk/private/context.h>

/** Exact to 2^-40 m. */
saddle_fixed_t saddle_position_from_m(float value_m);

/** Exact to 2^-10 um. */
float saddle_position_to_m(saddle_fixed_t position);

/** To the nearest nanometre; position >= 0. */
int64_t saddle_position_to_nm(saddle_fixed_t position);

/** Exact to 2^-42 m/s. */
saddle_fixed_t saddle_speed_from_m_s(float value_m_s);

float saddle_speed_to_m_s(saddle_fixed_t speed);

/** Limited to +-4 m/s, as both must be. */
saddle_fixed_t saddle_speed_sum(saddle_fixed_t a, saddle_fixed_t b);

/** What a rate, |rate_m_s2| < 16, makes in dt_us <= 10^7, both limited to that: up to 160 m/s; exact
 *  to 2^-41 m/s and 2 parts in 10^10 of it, for a rate that is a multiple of 2^-27. */
saddle_fixed_t saddle_speed_change(float rate_m_s2, uint32_t dt_us);

/** A time, limited to [0, 2), in 2^-31 s. */
uint32_t saddle_time_from_s(float time_s);

/** An angle, too, counts 2^-42 rad, and is converted as a speed is. That of a way at a curvature in 2^-42
 *  rad/m, |curvature| < 4 rad/m, 0 <= way_nm < 2 * 10^9, limited to that: exact to 2^-41 rad and 4 parts
 *  in 10^10. */
saddle_fixed_t saddle_angle(saddle_fixed_t curvature, int64_t way_nm);

/** Sum of two angles in [-pi, pi], within that again. */
saddle_fixed_t saddle_angle_sum(saddle_fixed_t a, saddle_fixed_t b);

/** What of a length in nm, |length_nm| < 2^31, a factor in [-1, 1] leaves; exact to 2^-24 of it. */
int64_t saddle_share_nm(int64_t length_nm, float factor);

/** Distance in such a time at a constant speed >= 0, a negative one counts as 0; exact to 2^-41 m. */
saddle_fixed_t saddle_distance(saddle_fixed_t speed, uint32_t time_q31);

saddle_fixed_t saddle_position_sum(saddle_fixed_t a, saddle_fixed_t b);

#endif
