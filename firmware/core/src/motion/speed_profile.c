#include "motion/speed_profile.h"

#include "math/elementary.h"
#include "math/fixed.h"

#include <math.h>

/* What fixed point can count: more than any configuration accepts, but for a stop's last instants. */
#define RATE_MAX_M_S2 15.9f

/* A target that is not approached. */
#define DISTANCE_NEVER_M 1.0e9f

void saddle_profile_set_speed(saddle_speed_profile_t *profile, saddle_fixed_t speed)
{
    profile->speed = speed;
    profile->speed_m_s = saddle_speed_to_m_s(speed);
}

void saddle_profile_aim(saddle_speed_profile_t *profile, float speed_m_s, float rate_m_s2)
{
    if (speed_m_s != profile->target_m_s) {
        profile->target = saddle_speed_from_m_s(speed_m_s);
        profile->target_m_s = saddle_speed_to_m_s(profile->target);
    }
    profile->rate_m_s2 = rate_m_s2;
}

/* [E23] */
saddle_fixed_t saddle_profile_advance(saddle_speed_profile_t *profile, uint32_t dt_us)
{
    if (profile->speed == profile->target) {
        return profile->speed * (int64_t)dt_us;
    }
    const float rate_m_s2 = saddle_clamp(profile->rate_m_s2, 0.0f, RATE_MAX_M_S2);
    const float wanted_m_s = saddle_speed_to_m_s(profile->target - profile->speed);
    const float dt_s = (float)dt_us * 1.0e-6f;
    float change_m_s = wanted_m_s;
    float change_time_s = dt_s;
    if (saddle_magnitude(wanted_m_s) <= rate_m_s2 * dt_s) {
        change_time_s = rate_m_s2 > 0.0f ? saddle_magnitude(wanted_m_s) / rate_m_s2 : 0.0f;
        saddle_profile_set_speed(profile, profile->target);
    } else {
        const saddle_fixed_t rise = saddle_speed_change(rate_m_s2, dt_us);
        const saddle_fixed_t change = wanted_m_s < 0.0f ? -rise : rise;
        change_m_s = saddle_speed_to_m_s(change);
        saddle_profile_set_speed(profile, saddle_speed_sum(profile->speed, change));
    }
    return profile->speed * (int64_t)dt_us -
           saddle_position_from_m(0.5f * change_m_s * change_time_s);
}

float saddle_profile_acceleration_m_s2(const saddle_speed_profile_t *profile)
{
    if (profile->speed == profile->target) {
        return 0.0f;
    }
    return profile->target < profile->speed ? -profile->rate_m_s2 : profile->rate_m_s2;
}

bool saddle_can_brake(float speed_m_s, float rate_m_s2, float distance_m)
{
    return speed_m_s * speed_m_s <= 2.0f * rate_m_s2 * distance_m;
}

/* Way on which the target is reached. */
static float change_distance_m(const saddle_pace_t *pace)
{
    const float difference_m2_s2 =
        (pace->target_m_s - pace->speed_m_s) * (pace->target_m_s + pace->speed_m_s);
    if (difference_m2_s2 == 0.0f) {
        return 0.0f;
    }
    if (pace->acceleration_m_s2 == 0.0f) {
        return DISTANCE_NEVER_M;
    }
    return difference_m2_s2 / (2.0f * pace->acceleration_m_s2);
}

/* Time in which the speed goes from one to another over a distance at an even rate. */
static float even_change_s(float from_m_s, float to_m_s, float distance_m)
{
    const float mean_m_s = 0.5f * (from_m_s + to_m_s);
    return mean_m_s > 0.0f ? distance_m / mean_m_s : SADDLE_TIME_MAX_S;
}

saddle_pace_t saddle_pace(const saddle_speed_profile_t *profile)
{
    saddle_pace_t pace;
    pace.speed_m_s = profile->speed_m_s;
    pace.target_m_s = profile->target_m_s;
    pace.acceleration_m_s2 =
        pace.target_m_s < pace.speed_m_s ? -profile->rate_m_s2 : profile->rate_m_s2;
    pace.change_m = change_distance_m(&pace);
    pace.change_s =
        pace.change_m > 0.0f ? even_change_s(pace.speed_m_s, pace.target_m_s, pace.change_m) : 0.0f;
    return pace;
}

static float speed_after_m_s(const saddle_pace_t *pace, float distance_m)
{
    const float square =
        pace->speed_m_s * pace->speed_m_s + 2.0f * pace->acceleration_m_s2 * distance_m;
    return square > 0.0f ? sqrtf(square) : 0.0f;
}

saddle_fixed_t saddle_profile_speed_after(const saddle_speed_profile_t *profile, float distance_m)
{
    if (profile->speed == profile->target) {
        return profile->target;
    }
    const saddle_pace_t pace = saddle_pace(profile);
    if (distance_m >= pace.change_m) {
        return profile->target;
    }
    const float sum_m_s = pace.speed_m_s + speed_after_m_s(&pace, distance_m);
    if (sum_m_s <= 0.0f) {
        return 0;
    }
    /* The change alone is rounded: the steps' lengths follow from this speed and add up. */
    const float change_m_s = 2.0f * pace.acceleration_m_s2 * distance_m / sum_m_s;
    return saddle_speed_sum(profile->speed, saddle_speed_from_m_s(change_m_s));
}

float saddle_pace_time_s(const saddle_pace_t *pace, float distance_m)
{
    float time_s = 0.0f;
    if (distance_m >= pace->change_m) {
        const float rest_m = distance_m - pace->change_m;
        time_s = pace->change_s;
        if (rest_m > 0.0f) {
            time_s += pace->target_m_s > 0.0f ? rest_m / pace->target_m_s : SADDLE_TIME_MAX_S;
        }
    } else if (distance_m > 0.0f) {
        time_s = even_change_s(pace->speed_m_s, speed_after_m_s(pace, distance_m), distance_m);
    }
    return saddle_smaller(time_s, SADDLE_TIME_MAX_S);
}
