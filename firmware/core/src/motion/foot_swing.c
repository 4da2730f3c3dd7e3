#include "motion/foot_swing.h"

#include "math/elementary.h"

#include <stdbool.h>

/* [E9] */
saddle_sample_t saddle_swing_line(const saddle_swing_t *swing, float x_m, saddle_sample_t lateral)
{
    const float rise_m = lateral.value;
    const float across_m = swing->line_y_m < 0.0f ? -swing->path_width_m : swing->path_width_m;
    saddle_sample_t line;
    line.value = across_m * x_m / rise_m;
    line.slope = across_m * (rise_m - lateral.slope * x_m) / (rise_m * rise_m);
    return line;
}

/* [E10] Rises and sinks by one minimum-jerk profile each. air: 0 at lift-off, 1 at landing. */
static void swing_height(float air, float air_rate_hz, float clearance_m,
                         saddle_swing_state_t *foot)
{
    const bool rising = air < 0.5f;
    const float profile = 2.0f * (rising ? air : 1.0f - air);
    const float rate_hz = 2.0f * (rising ? air_rate_hz : -air_rate_hz);
    const saddle_jerk_t rise = saddle_min_jerk_both(profile);
    foot->position_m.z = clearance_m * rise.value;
    foot->velocity_m_s.z = clearance_m * rise.slope * rate_hz;
}

/* [E44] s^skew, and its change with s. */
saddle_jerk_t saddle_swing_share(const saddle_swing_profile_t *profile, float progress)
{
    const float s = saddle_clamp((progress - profile->begin) * profile->rate, 0.0f, 1.0f);
    if (s <= 0.0f) {
        return (saddle_jerk_t){0.0f, 0.0f};
    }
    const float late = saddle_exp(profile->skew * saddle_log(s));
    const saddle_jerk_t jerk = saddle_min_jerk_both(late);
    const float steepness = profile->skew * late / s * profile->rate;
    return (saddle_jerk_t){profile->scale * jerk.value, profile->scale * jerk.slope * steepness};
}

/* [E10] Comes down from above: no lower than a slope of the way that is left. */
static void approach(const saddle_swing_t *swing, float left_m, saddle_swing_state_t *foot)
{
    const bool above = left_m * swing->approach > swing->approach_max_m;
    const float height_m =
        above ? swing->approach_max_m : saddle_larger(left_m, 0.0f) * swing->approach;
    if (height_m > foot->position_m.z) {
        foot->position_m.z = height_m;
        foot->velocity_m_s.z = above ? 0.0f : -swing->approach * foot->velocity_m_s.x;
    }
}

/* [E9] [E44] The offset fades out in the first half, the stretch in the second. */
void saddle_foot_swing(const saddle_swing_t *swing, const saddle_swing_place_t *place,
                       saddle_swing_state_t *foot)
{
    const float duration = swing->land_progress - swing->lift_progress;
    const float air = saddle_clamp((place->progress - swing->lift_progress) / duration, 0.0f, 1.0f);
    const float air_rate_hz = place->rate_hz / duration;
    const saddle_jerk_t return_to_way = saddle_min_jerk_both(2.0f * air);
    const float fade = 1.0f - return_to_way.value;
    const float fade_rate_hz = -2.0f * return_to_way.slope * air_rate_hz;
    foot->position_m.x = place->way.value + swing->offset_m.x * fade;
    foot->position_m.y = swing->line_y_m + swing->offset_m.y * fade;
    foot->velocity_m_s.x = place->way.slope * place->speed_m_s + swing->offset_m.x * fade_rate_hz;
    foot->velocity_m_s.y = swing->offset_m.y * fade_rate_hz;
    if (saddle_magnitude(swing->stretch_m) > 0.0f) {
        const saddle_jerk_t gone = saddle_min_jerk_both(2.0f * air - 1.0f);
        foot->position_m.x += swing->stretch_m * (1.0f - gone.value);
        foot->velocity_m_s.x -= 2.0f * swing->stretch_m * gone.slope * air_rate_hz;
    }
    swing_height(air, air_rate_hz, swing->clearance_m, foot);
    if (air > 0.5f) {
        approach(swing, place->landing_x_m - foot->position_m.x, foot);
    }
}
