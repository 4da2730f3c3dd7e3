#include "motion/speed_profile.h"

#include "math/elementary.h"
#include "math/fixed.h"

#include <math.h>

/* What fixed point can count: more than any configuration accepts, but for a stop's last instants. */
#define RATE_MAX_M_S2 15.9f

/* A target that is not approached. */
#define DISTANCE_NEVER_M 1.0e9f

/* [E23] */
saddle_fixed_t saddle_profile_advance(saddle_speed_profile_t *profile, uint32_t dt_us)
{
    const float rate_m_s2 = saddle_clamp(profile->rate_m_s2, 0.0f, RATE_MAX_M_S2);
    const float wanted_m_s = saddle_speed_to_m_s(profile->target - profile->speed);
    const float dt_s = (float)dt_us * 1.0e-6f;
    float change_m_s = wanted_m_s;
    float change_time_s = dt_s;
    if (saddle_magnitude(wanted_m_s) <= rate_m_s2 * dt_s) {
        change_time_s = rate_m_s2 > 0.0f ? saddle_magnitude(wanted_m_s) / rate_m_s2 : 0.0f;
        profile->speed = profile->target;
    } else {
        const saddle_fixed_t change = saddle_speed_change(rate_m_s2, dt_us);
        change_m_s = saddle_speed_to_m_s(wanted_m_s < 0.0f ? -change : change);
        profile->speed += wanted_m_s < 0.0f ? -change : change;
    }
    return profile->speed * (int64_t)dt_us -
           saddle_position_from_m(0.5f * change_m_s * change_time_s);
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

saddle_pace_t saddle_pace(const saddle_speed_profile_t *profile)
{
    saddle_pace_t pace;
    pace.speed_m_s = saddle_speed_to_m_s(profile->speed);
    pace.target_m_s = saddle_speed_to_m_s(profile->target);
    pace.acceleration_m_s2 =
        profile->target < profile->speed ? -profile->rate_m_s2 : profile->rate_m_s2;
    pace.change_m = change_distance_m(&pace);
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
    return profile->speed + saddle_speed_from_m_s(change_m_s);
}

float saddle_pace_time_s(const saddle_pace_t *pace, float distance_m)
{
    const bool changing = distance_m < pace->change_m;
    const float changing_m = changing ? distance_m : pace->change_m;
    const float then_m_s = changing ? speed_after_m_s(pace, distance_m) : pace->target_m_s;
    const float mean_m_s = 0.5f * (pace->speed_m_s + then_m_s);
    const float rest_m = distance_m - changing_m;
    float time_s = 0.0f;
    if (changing_m > 0.0f) {
        time_s += mean_m_s > 0.0f ? changing_m / mean_m_s : SADDLE_TIME_MAX_S;
    }
    if (rest_m > 0.0f) {
        time_s += pace->target_m_s > 0.0f ? rest_m / pace->target_m_s : SADDLE_TIME_MAX_S;
    }
    return saddle_clamp(time_s, 0.0f, SADDLE_TIME_MAX_S);
}
