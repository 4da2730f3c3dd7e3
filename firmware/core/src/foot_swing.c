#include <saddlewalk/foot_swing.h>
#include <saddlewalk/saddle_math.h>
#include <stdbool.h>

/* Rises and sinks by one minimum-jerk profile each, [E10]. */
static void swing_height(float progress, float rate_hz, float clearance_m, saddle_swing_t *swing)
{
    const bool rising = progress < 0.5f;
    const float profile = 2.0f * (rising ? progress : 1.0f - progress);
    const float rest = 1.0f - profile;
    const float slope = 30.0f * profile * profile * rest * rest;
    swing->position_m.z = clearance_m * saddle_min_jerk(profile);
    swing->velocity_m_s.z = clearance_m * slope * 2.0f * (rising ? rate_hz : -rate_hz);
}

saddle_swing_t saddle_foot_swing(saddle_vec2_t stance_m, saddle_vec2_t com_m,
                                 saddle_vec2_t com_velocity_m_s, float swing_y_m, float progress,
                                 float progress_rate_hz, float clearance_m)
{
    const float run_m = com_m.x - stance_m.x;
    const float rise_m = com_m.y - stance_m.y;
    const float width_m = swing_y_m - stance_m.y;
    saddle_swing_t swing;
    swing.position_m.x = stance_m.x + width_m * run_m / rise_m;
    swing.position_m.y = swing_y_m;
    swing.velocity_m_s.x = width_m *
                           (com_velocity_m_s.x * rise_m - com_velocity_m_s.y * run_m) /
                           (rise_m * rise_m);
    swing.velocity_m_s.y = 0.0f;
    swing_height(progress, progress_rate_hz, clearance_m, &swing);
    return swing;
}
