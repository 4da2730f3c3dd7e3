#include <saddlewalk/recovery_step.h>
#include <saddlewalk/saddle_math.h>
#include <saddlewalk/saddle_space.h>

/* Where on an axis the foot may land; empty when max < min. */
typedef struct {
    float min_m, max_m;
} interval_t;

static interval_t common(interval_t a, interval_t b)
{
    const interval_t both = {a.min_m > b.min_m ? a.min_m : b.min_m,
                             a.max_m < b.max_m ? a.max_m : b.max_m};
    return both;
}

/* Forward: the XCoM no further ahead than steps of full reach sustain, nor further behind than the
 * heel or, in a slow walk, than planned. */
static interval_t along(const saddle_config_t *config, const saddle_body_t *body,
                        const saddle_catch_t *to_catch, float xcom_m)
{
    const float reach_m = 2.0f * body->half_step_max_m;
    const float growth = saddle_exp(body->natural_frequency_rad_s * to_catch->step_time_s);
    const float sustained_m = growth > 1.0f ? reach_m / (growth - 1.0f) : 2.0f * reach_m;
    const float planned_m = to_catch->landing_m.x - to_catch->xcom_m.x;
    const float behind_m = planned_m > config->cop_range_m ? planned_m : config->cop_range_m;
    const interval_t reached = {-reach_m, reach_m};
    const interval_t caught = {xcom_m - sustained_m, xcom_m + behind_m};
    return common(reached, caught);
}

/* Outward from the stance foot: beyond the XCoM, but so that the step after it reaches back over
 * it. That one may be as quick as foresight_s. */
static interval_t across(const saddle_config_t *config, const saddle_body_t *body,
                         const saddle_catch_t *to_catch, float xcom_m)
{
    const float quick_s = to_catch->step_time_s < config->foresight_s ? to_catch->step_time_s
                                                                      : config->foresight_s;
    const float growth = saddle_exp(body->natural_frequency_rad_s * quick_s);
    const interval_t reached = {config->recovery_width_min_m, config->recovery_width_max_m};
    const interval_t caught = {xcom_m + config->recovery_margin_m,
                               xcom_m + config->recovery_width_max_m / growth};
    return common(reached, caught);
}

static bool stops_at(const saddle_config_t *config, saddle_vec2_t xcom_m, saddle_vec2_t landing_m)
{
    const saddle_vec2_t cop_m[2] = {{0.0f, 0.0f}, landing_m};
    const saddle_bos_t bos = saddle_bos(cop_m, config->cop_range_m, config->bos_factor);
    return bos.defined && saddle_bos_margin_m(&bos, xcom_m) >= 0.0f;
}

void saddle_recovery_step(const saddle_config_t *config, const saddle_body_t *body,
                          const saddle_catch_t *to_catch, saddle_recovery_t *recovery)
{
    const float outward = to_catch->stance == SADDLE_LEFT ? -1.0f : 1.0f;
    const saddle_vec2_t departure_m = to_catch->departure_m;
    const saddle_vec2_t xcom_m = {to_catch->xcom_m.x + departure_m.x,
                                  to_catch->xcom_m.y + departure_m.y};
    const saddle_vec2_t wanted_m = {
        to_catch->landing_m.x + config->recovery_follow * departure_m.x,
        to_catch->landing_m.y + config->recovery_follow * departure_m.y};
    const interval_t x = along(config, body, to_catch, xcom_m.x);
    const interval_t y = across(config, body, to_catch, outward * xcom_m.y);
    const float room_x_m = x.max_m - x.min_m;
    const float room_y_m = y.max_m - y.min_m;
    recovery->found = room_x_m >= 0.0f && room_y_m >= 0.0f;
    recovery->stops = false;
    recovery->landing_m.x = 0.0f;
    recovery->landing_m.y = 0.0f;
    recovery->foot = (uint8_t)saddle_other_side(to_catch->stance);
    recovery->margin_m = room_x_m < room_y_m ? room_x_m : room_y_m;
    if (recovery->found) {
        recovery->landing_m.x = saddle_clamp(wanted_m.x, x.min_m, x.max_m);
        recovery->landing_m.y = outward * saddle_clamp(outward * wanted_m.y, y.min_m, y.max_m);
        recovery->stops = stops_at(config, xcom_m, recovery->landing_m);
    }
}

float saddle_least_deviation_m(float deviation_m, saddle_cop_shift_t shift,
                               const saddle_growth_t *growth)
{
    const float grown_m = deviation_m * growth->factor;
    const float foot_m = shift.foot_m * (growth->factor - 1.0f);
    const float trailing_m = saddle_magnitude(shift.trailing_m) * growth->trailing;
    const bool towards_trailing = deviation_m * shift.trailing_m > 0.0f;
    const float mended_m = towards_trailing ? foot_m + trailing_m : foot_m;
    return grown_m - saddle_clamp(grown_m, -mended_m, mended_m);
}
