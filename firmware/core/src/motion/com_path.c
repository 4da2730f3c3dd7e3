#include "motion/com_path.h"

#include "math/vec2.h"

saddle_sin_cos_t saddle_quarter_phase(const saddle_quarter_t *quarter, float x_m)
{
    return saddle_sin_cos(SADDLE_HALF_PI * saddle_clamp(x_m / quarter->length_m, -1.0f, 1.0f));
}

/* [E7] */
saddle_sample_t saddle_com_lateral(const saddle_quarter_t *quarter, saddle_sin_cos_t phase)
{
    const float outward = saddle_outward(quarter->stance);
    const float amplitude_m = outward * quarter->amplitude_m;
    saddle_sample_t lateral;
    lateral.value = amplitude_m * phase.cos - outward * 0.5f * quarter->width_m;
    lateral.slope = -amplitude_m * phase.sin * SADDLE_HALF_PI / quarter->length_m;
    return lateral;
}
