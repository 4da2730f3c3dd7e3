#include "motion/com_path.h"

#include "math/elementary.h"
#include "math/vec2.h"

float saddle_quarter_angle_rad(const saddle_quarter_t *quarter, float x_m)
{
    return SADDLE_HALF_PI * saddle_clamp(x_m / quarter->length_m, -1.0f, 1.0f);
}

saddle_sample_t saddle_com_lateral(const saddle_quarter_t *quarter, float angle_rad)
{
    const float outward = saddle_outward(quarter->stance);
    const float amplitude_m = outward * quarter->amplitude_m;
    const saddle_sin_cos_t angle = saddle_sin_cos(angle_rad);
    saddle_sample_t lateral;
    lateral.value = amplitude_m * angle.cos - outward * 0.5f * quarter->width_m;
    lateral.slope = -amplitude_m * angle.sin * SADDLE_HALF_PI / quarter->length_m;
    return lateral;
}
