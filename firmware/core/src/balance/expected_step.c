#include "balance/expected_step.h"

#include "math/elementary.h"
#include "math/vec2.h"
#include "model/gait_model.h"
#include "model/model.h"
#include "motion/com_path.h"

/* A step that ends beside the stance foot still has a quarter with a shape. */
#define QUARTER_MIN_M 1.0e-3f

/* Where the foot lands, exactly midway between the feet. */
#define PHASE_SADDLE ((saddle_sin_cos_t){1.0f, 0.0f})

/* Where the CoM is x_m from the stance CoP, which is that phase of the quarter. */
static saddle_com_state_t state_at(const saddle_quarter_t *quarter, const saddle_shape_t *shape,
                                   float speed_m_s, float x_m, saddle_sin_cos_t phase)
{
    const saddle_sample_t lateral = saddle_shaped_lateral(quarter, shape, phase);
    const saddle_com_state_t state = {
        .com_m = {x_m, lateral.value},
        .velocity_m_s = {speed_m_s, lateral.slope * speed_m_s},
    };
    return state;
}

static float quarter_ahead_m(const saddle_step_t *step)
{
    return saddle_larger(0.5f * step->landing_m.x, QUARTER_MIN_M);
}

saddle_step_place_t saddle_step_place(const saddle_step_t *step, float x_m)
{
    const float within_m = saddle_clamp(x_m, -step->half_behind_m, 0.5f * step->landing_m.x);
    const float quarter_m = within_m < 0.0f ? step->half_behind_m : quarter_ahead_m(step);
    return (saddle_step_place_t){within_m, saddle_quarter_phase(quarter_m, within_m)};
}

/* [E28] */
SADDLE_NOINLINE void saddle_expect(const saddle_model_t *model, const saddle_step_t *step,
                                   const saddle_step_place_t *place, saddle_expectation_t *expected)
{
    const float half_ahead_m = 0.5f * step->landing_m.x;
    const saddle_quarter_t ahead =
        saddle_quarter(model, step->stance, quarter_ahead_m(step),
                       saddle_magnitude(step->landing_m.y), step->speed_m_s);
    saddle_quarter_t running = ahead;
    if (place->x_m < 0.0f) {
        running = saddle_quarter(model, step->stance, step->half_behind_m, step->width_behind_m,
                                 step->speed_m_s);
    }
    const bool last_swing = half_ahead_m <= QUARTER_MIN_M;
    const saddle_shape_t *shape = saddle_shape(model, last_swing);
    expected->now = state_at(&running, shape, step->speed_m_s, place->x_m, place->phase);
    expected->landing = state_at(&ahead, shape, step->speed_m_s, half_ahead_m,
                                 last_swing ? SADDLE_PHASE_FOOT : PHASE_SADDLE);
    expected->landing_m = step->landing_m;
    expected->time_s = saddle_smaller((half_ahead_m - place->x_m) / step->speed_m_s,
                                      model->config.prediction_horizon_s);
    expected->step_time_s = (half_ahead_m + step->half_behind_m) / step->speed_m_s;
}

/* [E29] */
saddle_growth_t saddle_growth(const saddle_model_t *model, float time_s, bool trailing)
{
    const saddle_body_t *body = &model->body;
    const bool latest = time_s == model->config.prediction_horizon_s;
    saddle_growth_t growth = {
        .factor =
            latest ? body->horizon_growth : saddle_exp(body->natural_frequency_rad_s * time_s),
    };
    if (trailing) {
        growth.trailing =
            saddle_smaller(growth.factor - 1.0f, growth.factor * body->trailing_share);
    }
    return growth;
}

/* [E29] */
float saddle_grown_m(float com_m, float xcom_m, const saddle_growth_t *growth)
{
    const float receding_m = 2.0f * com_m - xcom_m;
    return 0.5f * (growth->factor * xcom_m + receding_m / growth->factor);
}
