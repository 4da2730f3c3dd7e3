/** [E23] Motion along x: the speed goes to its target at a constant rate and stays there. */
#ifndef SADDLEWALK_SPEED_PROFILE_H
#define SADDLEWALK_SPEED_PROFILE_H

#include <saddlewalk/private/context.h>

/** From now on at that speed, >= 0. */
void saddle_profile_set_speed(saddle_speed_profile_t *profile, saddle_fixed_t speed);

/** From now on towards a speed at a rate. */
void saddle_profile_aim(saddle_speed_profile_t *profile, float speed_m_s, float rate_m_s2);

/** Advance by dt_us; returns the distance. Exact at constant speed, else to about 1e-10 m. */
saddle_fixed_t saddle_profile_advance(saddle_speed_profile_t *profile, uint32_t dt_us);

/** The rate at which the speed changes now, signed; 0 at the target. */
float saddle_profile_acceleration_m_s2(const saddle_speed_profile_t *profile);

/** The speed after a further distance_m >= 0. */
saddle_fixed_t saddle_profile_speed_after(const saddle_speed_profile_t *profile, float distance_m);

/** Whether distance_m is enough to come to rest no harder than at rate_m_s2. */
bool saddle_can_brake(float speed_m_s, float rate_m_s2, float distance_m);

/** A profile in floats, for predictions. */
typedef struct {
    float speed_m_s, target_m_s;
    float acceleration_m_s2; /**< signed, until the target is reached */
    float change_m;          /**< distance on which it is reached, */
    float change_s;          /**< and time */
} saddle_pace_t;

saddle_pace_t saddle_pace(const saddle_speed_profile_t *profile);

/** Seconds until a further distance_m >= 0 is covered, at most SADDLE_TIME_MAX_S. */
float saddle_pace_time_s(const saddle_pace_t *pace, float distance_m);

#endif
