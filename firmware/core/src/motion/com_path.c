#include "motion/com_path.h"

#include "math/vec2.h"

#include <math.h>

const saddle_shape_t *saddle_shape(const saddle_model_t *model, bool last_swing)
{
    static const saddle_shape_t paper = {.lateral_cos = 1.0f, .vertical_cos = 1.0f};
    return last_swing ? &paper : &model->body.shape;
}

saddle_sin_cos_t saddle_quarter_phase(float quarter_m, float x_m)
{
    return saddle_sin_cos(SADDLE_HALF_PI * saddle_clamp(x_m / quarter_m, -1.0f, 1.0f));
}

/* [E7] */
saddle_sample_t saddle_com_lateral(const saddle_quarter_t *quarter, saddle_sin_cos_t phase)
{
    const float inward_m = 0.5f * quarter->width_m - quarter->amplitude_m * phase.cos;
    const float slope = quarter->amplitude_m * phase.sin * SADDLE_HALF_PI / quarter->length_m;
    if (quarter->stance == SADDLE_LEFT) {
        return (saddle_sample_t){-inward_m, -slope};
    }
    return (saddle_sample_t){inward_m, slope};
}

/* A phase that lags by an angle of that sine and cosine. */
static saddle_sin_cos_t delayed(saddle_sin_cos_t phase, float sine, float cosine)
{
    return (saddle_sin_cos_t){
        .sin = phase.sin * cosine - phase.cos * sine,
        .cos = phase.cos * cosine + phase.sin * sine,
    };
}

/* [E7] */
saddle_sample_t saddle_shaped_lateral(const saddle_quarter_t *quarter, const saddle_shape_t *shape,
                                      saddle_sin_cos_t phase)
{
    saddle_sample_t lateral =
        saddle_com_lateral(quarter, delayed(phase, shape->lateral_sin, shape->lateral_cos));
    lateral.value += shape->lateral_m;
    return lateral;
}

/* [E24] */
saddle_sample_t saddle_shaped_height(const saddle_quarter_t *quarter, const saddle_shape_t *shape,
                                     float pendulum_m, saddle_sin_cos_t phase)
{
    const saddle_sin_cos_t lagging = delayed(phase, shape->vertical_sin, shape->vertical_cos);
    const float offset_m = 0.5f * quarter->width_m - quarter->amplitude_m;
    const float top_m = sqrtf(pendulum_m * pendulum_m - offset_m * offset_m) + shape->vertical_m;
    saddle_sample_t height;
    height.value = top_m - quarter->vertical_m * lagging.sin * lagging.sin;
    height.slope = -SADDLE_PI * quarter->vertical_m * lagging.sin * lagging.cos / quarter->length_m;
    return height;
}
