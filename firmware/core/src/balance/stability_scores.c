#include "balance/stability_scores.h"

/* [E19] */
saddle_vec2_t saddle_xcom_m(saddle_vec2_t com_m, saddle_vec2_t com_velocity_m_s,
                            float natural_frequency_rad_s)
{
    saddle_vec2_t xcom_m;
    xcom_m.x = com_m.x + com_velocity_m_s.x / natural_frequency_rad_s;
    xcom_m.y = com_m.y + com_velocity_m_s.y / natural_frequency_rad_s;
    return xcom_m;
}

/* [E20] */
float saddle_step_score(float half_step_m, float reference_m, float bound_m)
{
    return (half_step_m - bound_m) / (reference_m - bound_m);
}

/* [E21] */
float saddle_width_score(float offset_from_midline_m, float step_width_m)
{
    const float offset_m =
        offset_from_midline_m < 0.0f ? -offset_from_midline_m : offset_from_midline_m;
    return 1.0f - 2.0f * offset_m / step_width_m;
}
