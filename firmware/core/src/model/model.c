#include "model/model.h"

#include "math/bytes.h"
#include "math/elementary.h"
#include "math/fixed.h"
#include "model/config.h"

#include <math.h>

/* Below it lies no CoM of a person who stands or walks: the knees' share of the body's height,
 * Drillis and Contini 1966. */
#define KNEE_HEIGHT 0.285f

/* A stop speeds a slower walk up to this at most before it brakes. */
#define CRAWL_MAX_M_S 0.3f

/* A stop goes on at this share of the speed from which a steady step is just long enough to
 * brake. */
#define BRAKING_MARGIN 0.9f

static float us_of_s(float time_s)
{
    return time_s * 1.0e6f;
}

/* [E6] Where the regression, on the side of the longer steps, meets the reach, or the XCoM limit
 * v / (2 w_n) if that comes first. */
static float speed_ceiling_m_s(const saddle_config_t *config, const saddle_body_t *body)
{
    const float xcom_slope_s = 0.5f / body->natural_frequency_rad_s;
    const float slope_s = config->half_step_slope_s;
    const float longest_m = body->half_step_max_m / saddle_longer_step_factor(config);
    const float reached_m_s = (longest_m - config->half_step_intercept_m) / slope_s;
    if (saddle_regressed_half_step_m(config, reached_m_s) < xcom_slope_s * reached_m_s) {
        return config->half_step_intercept_m / (xcom_slope_s - slope_s);
    }
    return reached_m_s;
}

/* Slow, feasible, and such that every step is long enough to brake. */
static float crawl_m_s(const saddle_config_t *config, const saddle_body_t *body)
{
    const float feasible_m_s = SADDLE_CEILING_MARGIN * body->speed_ceiling_m_s;
    const float braked_m_s = sqrtf(config->acceleration_m_s2 * config->half_step_intercept_m);
    return saddle_clamp(braked_m_s, 0.0f, saddle_clamp(feasible_m_s, 0.0f, CRAWL_MAX_M_S));
}

/* At it, v^2 = 2 a l(v), l(v) the steady half step. */
static float braked_in_a_step_m_s(const saddle_config_t *config)
{
    const float rate_m_s2 = config->acceleration_m_s2;
    const float by_slope_m_s = rate_m_s2 * config->half_step_slope_s;
    const float by_intercept_m2_s2 = 2.0f * rate_m_s2 * config->half_step_intercept_m;
    return BRAKING_MARGIN *
           (by_slope_m_s + sqrtf(by_slope_m_s * by_slope_m_s + by_intercept_m2_s2));
}

/* [E1] [E2] [E4] [E6] */
static void derive_walk(const saddle_config_t *config, saddle_body_t *body)
{
    const float factors[2] = {config->step_length_factor_left, config->step_length_factor_right};
    body->pendulum_m = config->pendulum_ratio * config->body_height_m;
    body->natural_frequency_rad_s = sqrtf(SADDLE_GRAVITY_M_S2 / body->pendulum_m);
    body->half_step_max_m = config->peak_speed_m_s / (2.0f * body->natural_frequency_rad_s);
    body->speed_ceiling_m_s = speed_ceiling_m_s(config, body);
    for (int foot = 0; foot < 2; foot++) {
        body->half_step_slope[foot] = saddle_time_from_s(factors[foot] * config->half_step_slope_s);
        body->half_step_intercept[foot] =
            saddle_position_from_m(factors[foot] * config->half_step_intercept_m);
    }
}

/* [E25] Beside the foot, where the ankles change over, no leg is longer: there the CoM is at most
 * aside_m farther to the side than in the paper's path, in steps of at most twice a step width. */
static float flat_leg_m(const saddle_config_t *config, const saddle_body_t *body)
{
    if (config->ankle != SADDLE_ANKLE_CYCLOID) {
        return body->pendulum_m;
    }
    const float width_m =
        2.0f * saddle_larger(config->step_width_slow_m, config->step_width_fast_m);
    const float aside_m = saddle_magnitude(body->shape.lateral_m) +
                          (1.0f - body->shape.lateral_cos) * width_m / SADDLE_PI;
    return body->pendulum_m + saddle_larger(0.0f, body->shape.vertical_m) +
           aside_m * (aside_m + width_m) / (2.0f * body->pendulum_m);
}

/* [E7] [E24] [E38] The wave of the height has twice the frequency of the phase. */
static void derive_shape(const saddle_config_t *config, saddle_body_t *body)
{
    const saddle_sin_cos_t lateral = saddle_sin_cos(config->lateral_delay_rad);
    const saddle_sin_cos_t vertical = saddle_sin_cos(0.5f * config->vertical_delay_rad);
    body->shape = (saddle_shape_t){
        .lateral_m = config->lateral_offset_m,
        .lateral_sin = lateral.sin,
        .lateral_cos = lateral.cos,
        .vertical_m = config->vertical_offset_m,
        .vertical_sin = vertical.sin,
        .vertical_cos = vertical.cos,
    };
    body->strike_lead = 1.0f - 2.0f * config->strike_share;
    body->leg_m = flat_leg_m(config, body);
}

/* [E44] */
static void derive_swing(const saddle_config_t *config, saddle_body_t *body)
{
    const float rate = 1.0f / (config->swing_end - config->swing_begin);
    const float end = saddle_clamp((1.0f - config->swing_begin) * rate, 0.0f, 1.0f);
    const float late = saddle_exp(config->swing_skew * saddle_log(end));
    body->swing = (saddle_swing_profile_t){
        .begin = config->swing_begin,
        .rate = rate,
        .skew = config->swing_skew,
        .scale = 1.0f / saddle_min_jerk(late),
    };
}

static void derive_stop(const saddle_config_t *config, saddle_body_t *body)
{
    body->crawl_m_s = crawl_m_s(config, body);
    body->braked_in_a_step_m_s = braked_in_a_step_m_s(config);
    body->braked_in_a_tick_m_s = config->acceleration_m_s2 * config->tick_max_s;
}

/* [E27] [E29] */
static void derive_balance(const saddle_config_t *config, saddle_body_t *body)
{
    body->ankle_work_j = config->ankle_work_factor * config->body_mass_kg * SADDLE_GRAVITY_M_S2 *
                         config->cop_range_m * config->cop_range_m / body->pendulum_m;
    body->horizon_growth = saddle_exp(body->natural_frequency_rad_s * config->prediction_horizon_s);
    body->trailing_share = 1.0f - saddle_exp(-body->natural_frequency_rad_s * SADDLE_TRAILING_S);
    body->com_height_min_m = KNEE_HEIGHT * config->body_height_m;
}

static void derive_times(const saddle_config_t *config, saddle_body_t *body)
{
    body->command_max_age_us = us_of_s(config->command_max_age_s);
    body->com_max_age_us = us_of_s(config->com_max_age_s);
    body->foot_max_age_us = us_of_s(config->foot_max_age_s);
    body->latency_us = (uint32_t)us_of_s(config->sensor_latency_s);
    body->tick_max_us = (uint32_t)us_of_s(config->tick_max_s);
    body->shift_us = (uint32_t)us_of_s(config->shift_time_s);
}

void saddle_model_init(saddle_model_t *model, const saddle_config_t *config)
{
    saddle_copy(&model->config, config, sizeof *config);
    derive_walk(config, &model->body);
    derive_shape(config, &model->body);
    derive_swing(config, &model->body);
    derive_stop(config, &model->body);
    derive_balance(config, &model->body);
    derive_times(config, &model->body);
}
