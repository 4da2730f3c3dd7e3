#include "balance/recovery_step.h"

#include "balance/saddle_space.h"
#include "math/elementary.h"
#include "math/vec2.h"

/* Where on an axis the foot may land; empty when max < min. */
typedef struct {
    float min_m, max_m;
} interval_t;

static interval_t common(interval_t a, interval_t b)
{
    return (interval_t){saddle_larger(a.min_m, b.min_m), saddle_smaller(a.max_m, b.max_m)};
}

/* Forward: the XCoM no further ahead than steps of full reach sustain, nor further behind than the
 * heel or, in a slow walk, than planned. growth: in the time of a step. */
static interval_t along(const saddle_model_t *model, const saddle_recovery_target_t *target,
                        float xcom_m, float growth)
{
    const float reach_m = 2.0f * model->body.half_step_max_m;
    const float sustained_m = growth > 1.0f ? reach_m / (growth - 1.0f) : 2.0f * reach_m;
    const float planned_m = target->landing_m.x - target->xcom_m.x;
    const float behind_m = saddle_larger(planned_m, model->config.cop_range_m);
    const interval_t reached = {-reach_m, reach_m};
    const interval_t caught = {xcom_m - sustained_m, xcom_m + behind_m};
    return common(reached, caught);
}

/* Outward from the stance foot: beyond the XCoM, but so that the step after it reaches back over
 * it. growth: in the time of that step, which may be as quick as prediction_horizon_s. */
static interval_t across(const saddle_model_t *model, float xcom_m, float growth)
{
    const saddle_config_t *config = &model->config;
    const interval_t reached = {config->recovery_width_min_m, config->recovery_width_max_m};
    const interval_t caught = {xcom_m + config->recovery_margin_m,
                               xcom_m + config->recovery_width_max_m / growth};
    return common(reached, caught);
}

static bool stops_at(const saddle_model_t *model, saddle_vec2_t xcom_m, saddle_vec2_t landing_m)
{
    const saddle_vec2_t cop_m[2] = {{0.0f, 0.0f}, landing_m};
    const saddle_bos_t bos = saddle_bos(cop_m, model->config.cop_range_m, model->config.bos_factor);
    return saddle_bos_contains(&bos, xcom_m);
}

/* [E30] */
void saddle_recovery_step(const saddle_model_t *model, const saddle_recovery_target_t *target,
                          saddle_recovery_t *recovery)
{
    const saddle_side_t foot = saddle_other_side(target->stance);
    const float outward = saddle_outward(foot);
    const saddle_vec2_t departure_m = target->departure_m;
    const saddle_vec2_t xcom_m = saddle_vec2_add(target->xcom_m, departure_m);
    const saddle_vec2_t followed_m = saddle_vec2_add(
        target->landing_m, saddle_vec2_scale(model->config.recovery_follow, departure_m));
    const saddle_vec2_t wanted_m = saddle_vec2_add(followed_m, target->placement_m);
    const float step_time_s = target->step_time_s;
    const float growth = saddle_exp(model->body.natural_frequency_rad_s * step_time_s);
    const float quick_growth =
        step_time_s < model->config.prediction_horizon_s ? growth : model->body.horizon_growth;
    const interval_t x = along(model, target, xcom_m.x, growth);
    const interval_t y = across(model, outward * xcom_m.y, quick_growth);
    const float room_x_m = x.max_m - x.min_m;
    const float room_y_m = y.max_m - y.min_m;
    recovery->found = room_x_m >= 0.0f && room_y_m >= 0.0f;
    recovery->stops = false;
    recovery->landing_m.x = 0.0f;
    recovery->landing_m.y = 0.0f;
    recovery->foot = (uint8_t)foot;
    recovery->margin_m = saddle_smaller(room_x_m, room_y_m);
    if (recovery->found) {
        recovery->landing_m.x = saddle_clamp(wanted_m.x, x.min_m, x.max_m);
        recovery->landing_m.y = outward * saddle_clamp(outward * wanted_m.y, y.min_m, y.max_m);
        recovery->stops = stops_at(model, xcom_m, recovery->landing_m);
    }
}

/* [E30] */
float saddle_least_deviation_m(float deviation_m, saddle_cop_shift_t shift,
                               const saddle_growth_t *growth)
{
    const float grown_m = deviation_m * growth->factor;
    const float foot_m = shift.foot_m * (growth->factor - 1.0f);
    const float trailing_m = saddle_magnitude(shift.trailing_m) * growth->trailing;
    const bool towards_trailing = deviation_m * shift.trailing_m > 0.0f;
    const float corrected_m = towards_trailing ? foot_m + trailing_m : foot_m;
    return grown_m - saddle_clamp(grown_m, -corrected_m, corrected_m);
}
