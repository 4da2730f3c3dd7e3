#include "motion/ankle_strategy.h"

#include <math.h>

#define TWO_OVER_SQRT_PI 1.12837917f

/* [E11] A foot turned by an angle about a pivot d_h away lengthens the leg by the chord. */
static float elongation_m(const saddle_model_t *model, float angle_rad)
{
    return 2.0f * model->config.cop_range_m * saddle_sin(0.5f * angle_rad);
}

/* [E13] The stance leg's elongation at heel strike that gives the CoM its height there. */
static float toe_off_elongation_m(const saddle_model_t *model, const saddle_quarter_t *quarter,
                                  float lead_m)
{
    const float height_m = model->body.pendulum_m - quarter->vertical_m;
    const float x_m = quarter->length_m - lead_m;
    const float y_m =
        quarter->amplitude_m * saddle_sin(SADDLE_HALF_PI * lead_m / quarter->length_m) -
        0.5f * quarter->width_m;
    return sqrtf(height_m * height_m + x_m * x_m + y_m * y_m) - model->body.pendulum_m;
}

/* [E12] */
saddle_heel_strike_t saddle_heel_strike(const saddle_model_t *model, float angle_rad)
{
    const float lead_m = model->config.cop_range_m * (1.0f - saddle_cos(angle_rad));
    return (saddle_heel_strike_t){angle_rad, lead_m};
}

saddle_transition_t saddle_transition(const saddle_model_t *model, const saddle_quarter_t *quarter,
                                      saddle_heel_strike_t strike)
{
    const float sine =
        toe_off_elongation_m(model, quarter, strike.lead_m) / (2.0f * model->config.cop_range_m);
    const float limited = saddle_clamp(sine, 0.0f, 1.0f);
    saddle_transition_t transition;
    transition.strike = strike;
    transition.toe_off_rad = 2.0f * saddle_asin(limited);
    transition.toe_off_limited = sine < 0.0f || sine > 1.0f;
    return transition;
}

static void at_rest(const saddle_model_t *model, saddle_ankle_state_t *ankle)
{
    ankle->toe_off_rad = 0.0f;
    ankle->heel_strike_rad = 0.0f;
    ankle->leg_length_m = model->body.pendulum_m;
    ankle->knee_flexion_m = 0.0f;
    ankle->leg_rate_m_s = 0.0f;
    ankle->limited = false;
}

/* [E12] */
saddle_ankle_angles_t saddle_ankle_angles(const saddle_model_t *model,
                                          const saddle_transition_t *transition,
                                          float since_strike_s)
{
    saddle_ankle_angles_t angles = {0.0f, 0.0f, false};
    if (model->config.ankle != SADDLE_ANKLE_RIGID) {
        const float progress = saddle_erf(since_strike_s / model->config.ankle_time_constant_s);
        const float toe_off_rad = transition->toe_off_rad * (1.0f + progress);
        angles.limited = toe_off_rad > SADDLE_HALF_PI;
        angles.toe_off_rad = angles.limited ? SADDLE_HALF_PI : toe_off_rad;
        angles.heel_strike_rad = transition->strike.angle_rad * (1.0f - progress);
    }
    return angles;
}

void saddle_ankle(const saddle_model_t *model, const saddle_transition_t *transition,
                  float since_strike_s, bool toe_off_acts, saddle_ankle_state_t *ankle)
{
    const saddle_ankle_angles_t angles = saddle_ankle_angles(model, transition, since_strike_s);
    at_rest(model, ankle);
    if (model->config.ankle == SADDLE_ANKLE_RIGID) {
        return;
    }
    const float u = since_strike_s / model->config.ankle_time_constant_s;
    const float progress_rate =
        TWO_OVER_SQRT_PI * saddle_exp(-u * u) / model->config.ankle_time_constant_s;
    const float angle_rad = toe_off_acts ? angles.toe_off_rad : angles.heel_strike_rad;
    const float toe_off_rate = angles.limited ? 0.0f : transition->toe_off_rad;
    const float angle_rate =
        progress_rate * (toe_off_acts ? toe_off_rate : -transition->strike.angle_rad);
    ankle->limited = angles.limited;
    ankle->toe_off_rad = angles.toe_off_rad;
    ankle->heel_strike_rad = angles.heel_strike_rad;
    ankle->leg_length_m += elongation_m(model, angle_rad);
    ankle->leg_rate_m_s = model->config.cop_range_m * saddle_cos(0.5f * angle_rad) * angle_rate;
}

/* Of a CoM that no leg reaches, where any configuration and feet measured anywhere can bring it. */
#define HEIGHT_MIN_M2 1.0e-4f

/* [E14] */
void saddle_com_height(const saddle_ankle_state_t *ankle, saddle_vec2_t offset_m,
                       saddle_vec2_t velocity_m_s, float *height_m, float *height_rate_m_s)
{
    const float horizontal_m2 = offset_m.x * offset_m.x + offset_m.y * offset_m.y;
    const float length_m = ankle->leg_length_m;
    const float height = sqrtf(saddle_larger(length_m * length_m - horizontal_m2, HEIGHT_MIN_M2));
    *height_m = height;
    *height_rate_m_s = (length_m * ankle->leg_rate_m_s - offset_m.x * velocity_m_s.x -
                        offset_m.y * velocity_m_s.y) /
                       height;
}

/* [E25] */
bool saddle_ankle_for_leg(const saddle_model_t *model, float leg_length_m, bool toe_off_acts,
                          saddle_ankle_state_t *ankle)
{
    const float elongation = leg_length_m - model->body.leg_m;
    const float sine = elongation / (2.0f * model->config.cop_range_m);
    const float wanted_rad = 2.0f * saddle_asin(saddle_clamp(sine, 0.0f, 1.0f));
    const bool limited = wanted_rad > SADDLE_HALF_PI;
    const float angle_rad = limited ? SADDLE_HALF_PI : wanted_rad;
    at_rest(model, ankle);
    ankle->leg_length_m = leg_length_m;
    if (toe_off_acts) {
        ankle->toe_off_rad = angle_rad;
    } else {
        ankle->heel_strike_rad = angle_rad;
    }
    ankle->knee_flexion_m = elongation < 0.0f ? -elongation : 0.0f;
    return !limited;
}
