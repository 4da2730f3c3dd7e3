#include "estimate/track.h"

#include "math/elementary.h"
#include "space/vec3.h"

/* [J13] */
saddle_track_gains_t saddle_track_gains(float gain_1_s, float dt_s)
{
    const float pole = saddle_exp(-gain_1_s * dt_s);
    const float rest = 1.0f - pole;
    return (saddle_track_gains_t){dt_s, 1.0f - pole * pole, rest * rest / dt_s};
}

/* [J13] */
saddle_vec3_t saddle_track_step(saddle_track_t *track, const saddle_track_gains_t *gains,
                                saddle_vec3_t measured_m, saddle_vec3_t acceleration_m_s2)
{
    const float dt_s = gains->dt_s;
    const saddle_vec3_t mean_m_s =
        saddle_vec3_along(track->rate_m_s, 0.5f * dt_s, acceleration_m_s2);
    const saddle_vec3_t expected_m = saddle_vec3_along(track->value_m, dt_s, mean_m_s);
    const saddle_vec3_t error_m = saddle_vec3_sub(measured_m, expected_m);
    track->value_m = saddle_vec3_along(expected_m, gains->position, error_m);
    track->rate_m_s = saddle_vec3_along(saddle_vec3_along(track->rate_m_s, dt_s, acceleration_m_s2),
                                        gains->velocity_1_s, error_m);
    return saddle_vec3_scale(gains->position / dt_s, error_m);
}
