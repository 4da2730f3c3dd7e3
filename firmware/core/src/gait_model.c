#include <math.h>
#include <saddlewalk/gait_model.h>
#include <saddlewalk/saddle_math.h>
#include <saddlewalk/saddle_types.h>

/* Narrower steps are taken as this wide: the swing foot's line needs the CoM off the
 * stance foot. */
#define WIDTH_MIN_M 0.02f

static float half_step_m(const saddle_config_t *config, float speed_m_s)
{
    return config->half_step_slope_s * speed_m_s + config->half_step_intercept_m;
}

/* Where the regression, on the side of the longer steps, meets the reach, or the XCoM limit
 * v / (2 w_n) if that comes first. */
static float speed_ceiling_m_s(const saddle_config_t *config, const saddle_body_t *body)
{
    const float xcom_slope_s = 0.5f / body->natural_frequency_rad_s;
    const float slope_s = config->half_step_slope_s;
    const float longest_m = body->half_step_max_m / saddle_longer_step_factor(config);
    const float reached_m_s = (longest_m - config->half_step_intercept_m) / slope_s;
    if (half_step_m(config, reached_m_s) < xcom_slope_s * reached_m_s) {
        return config->half_step_intercept_m / (xcom_slope_s - slope_s);
    }
    return reached_m_s;
}

saddle_body_t saddle_body(const saddle_config_t *config)
{
    saddle_body_t body;
    body.pendulum_m = config->pendulum_ratio * config->body_height_m;
    body.natural_frequency_rad_s = sqrtf(SADDLE_GRAVITY_M_S2 / body.pendulum_m);
    body.half_step_max_m = config->peak_speed_m_s / (2.0f * body.natural_frequency_rad_s);
    body.speed_ceiling_m_s = speed_ceiling_m_s(config, &body);
    return body;
}

float saddle_step_width_m(const saddle_config_t *config, float speed_m_s)
{
    if (speed_m_s < config->step_width_slow_speed_m_s) {
        return config->step_width_slow_m;
    }
    if (speed_m_s > config->step_width_fast_speed_m_s) {
        return config->step_width_fast_m;
    }
    return config->step_width_slope_s * speed_m_s + config->step_width_intercept_m;
}

saddle_quarter_t saddle_quarter(const saddle_config_t *config, saddle_side_t stance, float length_m,
                                float width_m, float speed_m_s)
{
    const float factor = config->lateral_factor;
    const float tangency_speed_m_s = 0.5f * factor;
    const float amplitude_speed_m_s =
        speed_m_s > tangency_speed_m_s ? speed_m_s : tangency_speed_m_s;
    saddle_quarter_t quarter;
    quarter.stance = stance;
    quarter.length_m = length_m;
    quarter.width_m = width_m > WIDTH_MIN_M ? width_m : WIDTH_MIN_M;
    quarter.amplitude_m = factor * quarter.width_m / (2.0f * SADDLE_PI * amplitude_speed_m_s);
    quarter.vertical_m = config->vertical_slope_s * speed_m_s + config->vertical_intercept_m;
    return quarter;
}

saddle_fixed_t saddle_half_step(const saddle_config_t *config, saddle_side_t foot,
                                saddle_fixed_t speed)
{
    const float factor =
        foot == SADDLE_LEFT ? config->step_length_factor_left : config->step_length_factor_right;
    return saddle_position_sum(saddle_speed_times_s(speed, factor * config->half_step_slope_s),
                               saddle_position_from_m(factor * config->half_step_intercept_m));
}

float saddle_landing_y_m(const saddle_config_t *config, saddle_side_t foot, float speed_m_s)
{
    const float half_width_m = 0.5f * saddle_step_width_m(config, speed_m_s);
    return foot == SADDLE_LEFT ? config->step_width_factor_left * half_width_m
                               : -config->step_width_factor_right * half_width_m;
}

saddle_step_bounds_t saddle_step_bounds(const saddle_config_t *config, const saddle_body_t *body,
                                        float speed_m_s)
{
    saddle_step_bounds_t bounds;
    bounds.min_m = speed_m_s / (2.0f * body->natural_frequency_rad_s);
    bounds.reference_m = half_step_m(config, speed_m_s);
    bounds.max_m = body->half_step_max_m;
    bounds.feasible = speed_m_s > 0.0f && bounds.min_m < bounds.reference_m &&
                      bounds.reference_m < bounds.max_m;
    return bounds;
}

saddle_side_t saddle_other_side(saddle_side_t side)
{
    return side == SADDLE_LEFT ? SADDLE_RIGHT : SADDLE_LEFT;
}
