#include "model/gait_model.h"

#include "math/elementary.h"
#include "math/fixed.h"
#include "model/config.h"

/* Narrower steps are taken as this wide: the swing foot's line needs the CoM off the
 * stance foot. */
#define WIDTH_MIN_M 0.02f

/* [E3] */
float saddle_step_width_m(const saddle_model_t *model, float speed_m_s)
{
    if (speed_m_s < model->config.step_width_slow_speed_m_s) {
        return model->config.step_width_slow_m;
    }
    if (speed_m_s > model->config.step_width_fast_speed_m_s) {
        return model->config.step_width_fast_m;
    }
    return saddle_regressed_width_m(&model->config, speed_m_s);
}

/* [E5] [E7] */
saddle_quarter_t saddle_quarter(const saddle_model_t *model, saddle_side_t stance, float length_m,
                                float width_m, float speed_m_s)
{
    const float factor = model->config.lateral_factor;
    const float tangency_speed_m_s = 0.5f * factor;
    const float amplitude_speed_m_s =
        speed_m_s > tangency_speed_m_s ? speed_m_s : tangency_speed_m_s;
    saddle_quarter_t quarter;
    quarter.stance = stance;
    quarter.length_m = length_m;
    quarter.width_m = width_m > WIDTH_MIN_M ? width_m : WIDTH_MIN_M;
    quarter.amplitude_m = factor * quarter.width_m / (2.0f * SADDLE_PI * amplitude_speed_m_s);
    quarter.vertical_m =
        model->config.vertical_slope_s * speed_m_s + model->config.vertical_intercept_m;
    return quarter;
}

/* No way bends more: what fixed point holds. */
#define CURVATURE_MAX_1_M 3.9f

/* [E48] */
float saddle_turn_max_rad_s(const saddle_model_t *model, float speed_m_s)
{
    const float width_m = saddle_step_width_m(model, speed_m_s);
    const saddle_quarter_t quarter = saddle_quarter(model, SADDLE_LEFT, 1.0f, width_m, speed_m_s);
    const float half_m = saddle_longer_step_factor(&model->config) *
                         saddle_regressed_half_step_m(&model->config, speed_m_s);
    const float reach_rad = 4.0f * (model->body.half_step_max_m - half_m) / quarter.width_m;
    const float step_rad =
        saddle_clamp(model->config.turn_step_max_rad, 0.0f, saddle_larger(reach_rad, 0.0f));
    const float curvature_1_m = saddle_smaller(
        CURVATURE_MAX_1_M, saddle_smaller(0.5f * step_rad / half_m, 1.0f / quarter.width_m));
    const float lean_max_m = 0.5f * quarter.width_m - quarter.amplitude_m;
    const float w = model->body.natural_frequency_rad_s;
    if (!(speed_m_s > 0.0f)) {
        return 0.0f;
    }
    return saddle_smaller(curvature_1_m * speed_m_s, lean_max_m * w * w / speed_m_s);
}

/* [E4] */
SADDLE_NOINLINE saddle_fixed_t saddle_half_step(const saddle_model_t *model, saddle_side_t foot,
                                                saddle_fixed_t speed)
{
    return saddle_position_sum(saddle_distance(speed, model->body.half_step_slope[foot]),
                               model->body.half_step_intercept[foot]);
}

/* [E3] */
float saddle_landing_y_m(const saddle_model_t *model, saddle_side_t foot, float speed_m_s)
{
    const float half_width_m = 0.5f * saddle_step_width_m(model, speed_m_s);
    return foot == SADDLE_LEFT ? model->config.step_width_factor_left * half_width_m
                               : -model->config.step_width_factor_right * half_width_m;
}

/* [E6] */
saddle_step_bounds_t saddle_step_bounds(const saddle_model_t *model, float speed_m_s)
{
    saddle_step_bounds_t bounds;
    bounds.min_m = speed_m_s / (2.0f * model->body.natural_frequency_rad_s);
    bounds.reference_m = saddle_regressed_half_step_m(&model->config, speed_m_s);
    bounds.max_m = model->body.half_step_max_m;
    bounds.feasible =
        speed_m_s > 0.0f && bounds.min_m < bounds.reference_m && bounds.reference_m < bounds.max_m;
    return bounds;
}
