#include <saddlewalk/com_path.h>
#include <saddlewalk/saddle_math.h>

saddle_com_path_t saddle_com_path(const saddle_gait_t *gait, saddle_side_t stance,
                                  float step_phase_rad)
{
    const float amplitude_m =
        stance == SADDLE_LEFT ? gait->lateral_amplitude_m : -gait->lateral_amplitude_m;
    const float phase_rate_rad_s = SADDLE_PI * gait->cadence_hz;
    saddle_com_path_t path;
    path.position_m.x = gait->step_length_m * (step_phase_rad / SADDLE_PI);
    path.position_m.y = amplitude_m * saddle_cos(step_phase_rad);
    path.velocity_m_s.x = gait->speed_m_s;
    path.velocity_m_s.y = -amplitude_m * phase_rate_rad_s * saddle_sin(step_phase_rad);
    return path;
}
