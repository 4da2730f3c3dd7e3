#include "walk/swing.h"

#include "math/elementary.h"
#include "math/vec2.h"
#include "space/vec3.h"

/* A lift-off fades over some time even of a swing that is about to end. */
#define LEFT_MIN_S 0.05f

static const saddle_vec3_t NOTHING = {0.0f, 0.0f, 0.0f};

void saddle_swing_path_begin(saddle_swing_path_t *swing, saddle_vec3_t sole_m, float pitch_rad)
{
    const saddle_vec2_t none = {0.0f, 0.0f};
    swing->position_m = sole_m;
    swing->mismatch_m = swing->velocity_m_s = NOTHING;
    swing->fade_s = swing->age_s = swing->pitch_rate_rad_s = 0.0f;
    swing->shift_m = swing->detour_m = swing->detour_rate_m_s = none;
    swing->pitch_rad = pitch_rad;
}

/* [J23] The detour follows the shift, critically damped. */
static void turn_aside(saddle_swing_path_t *swing, float rate_rad_s, float dt_s)
{
    const saddle_vec2_t left_m = saddle_vec2_sub(swing->shift_m, swing->detour_m);
    const saddle_vec2_t pull_m_s2 =
        saddle_vec2_sub(saddle_vec2_scale(rate_rad_s * rate_rad_s, left_m),
                        saddle_vec2_scale(2.0f * rate_rad_s, swing->detour_rate_m_s));
    swing->detour_rate_m_s =
        saddle_vec2_add(swing->detour_rate_m_s, saddle_vec2_scale(dt_s, pull_m_s2));
    swing->detour_m =
        saddle_vec2_add(swing->detour_m, saddle_vec2_scale(dt_s, swing->detour_rate_m_s));
}

/* [J22] */
void saddle_swing_path_step(saddle_swing_path_t *swing, const saddle_joint_walk_config_t *config,
                            const saddle_planned_swing_t *planned, float dt_s)
{
    if (!(swing->fade_s > 0.0f)) {
        swing->mismatch_m = saddle_vec3_sub(swing->position_m, planned->path_m);
        swing->fade_s = config->lift_off_share * saddle_larger(planned->landing_in_s, LEFT_MIN_S);
    }
    const saddle_jerk_t faded = saddle_min_jerk_both(swing->age_s / swing->fade_s);
    turn_aside(swing, config->detour_rate_rad_s, dt_s);
    const saddle_vec3_t detour_m = {swing->detour_m.x, swing->detour_m.y, 0.0f};
    const saddle_vec3_t detour_m_s = {swing->detour_rate_m_s.x, swing->detour_rate_m_s.y, 0.0f};
    swing->position_m = saddle_vec3_add(
        saddle_vec3_along(planned->path_m, 1.0f - faded.value, swing->mismatch_m), detour_m);
    swing->position_m.z = saddle_larger(swing->position_m.z, 0.0f);
    swing->velocity_m_s = saddle_vec3_add(
        saddle_vec3_along(planned->rate_m_s, -faded.slope / swing->fade_s, swing->mismatch_m),
        detour_m_s);
    swing->pitch_rate_rad_s = (planned->pitch_rad - swing->pitch_rad) / config->pitch_time_s;
    swing->pitch_rad += swing->pitch_rate_rad_s * saddle_smaller(dt_s, config->pitch_time_s);
    swing->age_s += dt_s;
}
