#include "model/config.h"

#include "math/elementary.h"
#include "math/fields.h"

#include <saddlewalk/saddlewalk.h>

#define WIDTH_MIN_M 0.01f

/* A foot that comes earlier would almost jump where its way begins. */
#define SKEW_MIN 0.3f

/* Some walk must be feasible: the ceiling lies above this speed, twice the planner's floor. */
#define CEILING_MIN_M_S 0.02f

#define FIELD(name, min, max) {#name, offsetof(saddle_config_t, name), min, max}

static const saddle_config_field_t FIELDS[] = {
    FIELD(body_mass_kg, 5.0f, 300.0f),
    FIELD(body_height_m, 0.7f, 2.5f),
    FIELD(pendulum_ratio, 0.3f, 0.8f),
    FIELD(cop_range_m, 0.01f, 0.3f),
    FIELD(step_width_slow_m, WIDTH_MIN_M, 0.6f),
    FIELD(step_width_fast_m, WIDTH_MIN_M, 0.6f),
    FIELD(step_width_slow_speed_m_s, 0.0f, 5.0f),
    FIELD(step_width_fast_speed_m_s, 0.0f, 5.0f),
    FIELD(step_width_slope_s, -1.0f, 1.0f),
    FIELD(step_width_intercept_m, -1.0f, 1.0f),
    FIELD(half_step_slope_s, 0.001f, 1.0f),
    FIELD(half_step_intercept_m, 0.01f, 0.5f),
    FIELD(vertical_slope_s, -0.1f, 0.1f),
    FIELD(vertical_intercept_m, 0.0f, 0.1f),
    FIELD(vertical_offset_m, -0.1f, 0.1f),
    FIELD(vertical_delay_rad, -1.5f, 1.5f),
    FIELD(lateral_factor, 0.1f, 5.0f),
    FIELD(lateral_offset_m, -0.1f, 0.1f),
    FIELD(lateral_delay_rad, -1.5f, 1.5f),
    FIELD(peak_speed_m_s, 0.5f, 3.9f),
    FIELD(ankle_time_constant_s, 0.01f, 1.0f),
    FIELD(heel_strike_max_rad, 0.0f, 1.0f),
    FIELD(strike_share, 0.0f, 0.75f),
    FIELD(acceleration_m_s2, 0.01f, 5.0f),
    FIELD(turn_acceleration_rad_s2, 0.01f, 10.0f),
    FIELD(turn_step_max_rad, 0.0f, 0.7f),
    FIELD(shift_time_s, 0.1f, 10.0f),
    FIELD(step_length_factor_left, 0.5f, 1.5f),
    FIELD(step_length_factor_right, 0.5f, 1.5f),
    FIELD(step_width_factor_left, 0.5f, 2.0f),
    FIELD(step_width_factor_right, 0.5f, 2.0f),
    FIELD(swing_clearance_m, 0.0f, 0.3f),
    FIELD(swing_begin, -1.0f, 0.4f),
    FIELD(swing_end, 0.6f, 2.0f),
    FIELD(swing_skew, 0.0f, 4.0f),
    FIELD(swing_approach, 0.0f, 2.0f),
    FIELD(double_support_share, 0.02f, 0.5f),
    FIELD(cop_enter, -1.0f, 1.0f),
    FIELD(cop_leave, -1.0f, 1.0f),
    FIELD(landing_early_s, 0.0f, 0.3f),
    FIELD(landing_late_s, 0.0f, 0.3f),
    FIELD(placement_gain, 0.0f, 1.0f),
    FIELD(tick_max_s, 0.08f, 0.25f),
    FIELD(command_max_age_s, 0.001f, 3600.0f),
    FIELD(lost_inputs_stop, 0.0f, 1.0f),
    FIELD(resume_time_s, 0.0f, 60.0f),
    FIELD(resume_by_command, 0.0f, 1.0f),
    FIELD(com_max_age_s, 0.001f, 10.0f),
    FIELD(foot_max_age_s, 0.001f, 10.0f),
    FIELD(sensor_latency_s, 0.0f, 0.2f),
    FIELD(flight_max_s, 0.05f, 10.0f),
    FIELD(crossing_max_m, 0.0f, 1.0f),
    FIELD(step_time_max_s, 0.2f, 60.0f),
    FIELD(bos_factor, 0.1f, 1.0f),
    FIELD(ankle_work_factor, 0.0f, 10.0f),
    FIELD(stop_margin_m, -10.0f, 1.0f),
    FIELD(prediction_horizon_s, 0.01f, 2.0f),
    FIELD(cop_shift_ap_m, 0.0f, 0.3f),
    FIELD(cop_shift_ml_m, 0.0f, 0.3f),
    FIELD(recovery_width_min_m, 0.0f, 0.3f),
    FIELD(recovery_width_max_m, 0.1f, 1.5f),
    FIELD(recovery_margin_m, -0.3f, 0.3f),
    FIELD(recovery_follow, 0.0f, 1.0f),
    FIELD(departure_foresight, 0.0f, 2.0f),
    FIELD(departure_lateral_weight, 0.1f, 5.0f),
    FIELD(departure_step_share, 0.0f, 2.0f),
    FIELD(departure_sink_share, 0.0f, 5.0f),
    FIELD(tolerance_max, 0.01f, 2.0f),
    FIELD(tolerance_ripple_slope, 0.0f, 20.0f),
    FIELD(tolerance_min, 0.01f, 2.0f),
    FIELD(plan_weight, 0.0f, 10.0f),
    FIELD(plan_reserve, -1.0f, 1.0f),
    FIELD(caution_margin, 0.0f, 1.0f),
    FIELD(learn_time_s, 0.1f, 60.0f),
    FIELD(learn_ripple_time_s, 0.1f, 600.0f),
    FIELD(learn_ripple_start, 0.005f, 0.5f),
    FIELD(learn_margin, 0.0f, 1.0f),
    FIELD(previous_level, 0.0f, 1.0f),
    FIELD(caution_score, -10.0f, 1.0f),
    FIELD(caution_xcom_ap_m, 0.0f, 10.0f),
    FIELD(caution_xcom_ml_m, 0.0f, 10.0f),
    FIELD(level_hold_ticks, 1.0f, 100.0f),
};

#define FIELD_COUNT (sizeof FIELDS / sizeof FIELDS[0])

saddle_config_t saddle_config_default(float body_height_m, float body_mass_kg)
{
    return (saddle_config_t){
        .body_mass_kg = body_mass_kg,
        .body_height_m = body_height_m,
        .pendulum_ratio = 0.57f,
        .cop_range_m = 0.10f,
        .step_width_slow_m = 0.22f,
        .step_width_fast_m = 0.10f,
        .step_width_slow_speed_m_s = 0.6f,
        .step_width_fast_speed_m_s = 1.1f,
        .step_width_slope_s = -0.2128f,
        .step_width_intercept_m = 0.3456f,
        .half_step_slope_s = 0.1802f,
        .half_step_intercept_m = 0.1351f,
        .vertical_slope_s = 0.02656f,
        .vertical_intercept_m = 0.002575f,
        .vertical_offset_m = 0.0f,
        .vertical_delay_rad = 0.0f,
        .lateral_factor = 1.0f,
        .lateral_offset_m = 0.0f,
        .lateral_delay_rad = 0.0f,
        .peak_speed_m_s = 3.0f,
        .ankle_time_constant_s = 0.11f,
        .heel_strike_max_rad = 0.5236f,
        .strike_share = 0.0f,
        .acceleration_m_s2 = 0.5f,
        .turn_acceleration_rad_s2 = 0.25f,
        .turn_step_max_rad = 0.5f,
        .shift_time_s = 0.8f,
        .step_length_factor_left = 1.0f,
        .step_length_factor_right = 1.0f,
        .step_width_factor_left = 1.0f,
        .step_width_factor_right = 1.0f,
        .swing_clearance_m = 0.05f,
        .swing_begin = 0.0f,
        .swing_end = 1.0f,
        .swing_skew = 0.0f,
        .swing_approach = 0.0f,
        .double_support_share = 0.16f,
        .cop_enter = -0.2f,
        .cop_leave = 0.8f,
        .landing_early_s = 0.0f,
        .landing_late_s = 0.12f,
        .placement_gain = 0.0f,
        .tick_max_s = 0.2f,
        .command_max_age_s = 0.24f,
        .lost_inputs_stop = 1.0f,
        .resume_time_s = 1.0f,
        .resume_by_command = 0.0f,
        .com_max_age_s = 0.24f,
        .foot_max_age_s = 0.24f,
        .sensor_latency_s = 0.0f,
        .flight_max_s = 0.5f,
        .crossing_max_m = 0.15f,
        .step_time_max_s = 4.0f,
        .bos_factor = 1.0f,
        .ankle_work_factor = 1.0f,
        .stop_margin_m = 0.0f,
        .prediction_horizon_s = 0.4f,
        .cop_shift_ap_m = 0.10f,
        .cop_shift_ml_m = 0.03f,
        .recovery_width_min_m = 0.02f,
        .recovery_width_max_m = 0.50f,
        .recovery_margin_m = 0.0f,
        .recovery_follow = 1.0f,
        .departure_foresight = 0.333333f,
        .departure_lateral_weight = 1.2f,
        .departure_step_share = 0.2f,
        .departure_sink_share = 0.45f,
        .tolerance_max = 0.42f,
        .tolerance_ripple_slope = 2.4f,
        .tolerance_min = 0.25f,
        .plan_weight = 2.0f,
        .plan_reserve = 0.45f,
        .caution_margin = 0.1f,
        .learn_time_s = 1.0f,
        .learn_ripple_time_s = 4.0f,
        .learn_ripple_start = 0.035f,
        .learn_margin = 0.15f,
        .previous_level = 0.0f,
        .caution_score = 0.1f,
        .caution_xcom_ap_m = 0.13f,
        .caution_xcom_ml_m = 0.07f,
        .level_hold_ticks = 1.0f,
        .ankle = SADDLE_ANKLE_ERF,
    };
}

const saddle_config_field_t *saddle_config_field(size_t index)
{
    return index < FIELD_COUNT ? &FIELDS[index] : NULL;
}

/* [E4] */
float saddle_regressed_half_step_m(const saddle_config_t *config, float speed_m_s)
{
    return config->half_step_slope_s * speed_m_s + config->half_step_intercept_m;
}

/* [E3] */
float saddle_regressed_width_m(const saddle_config_t *config, float speed_m_s)
{
    return config->step_width_slope_s * speed_m_s + config->step_width_intercept_m;
}

static const char *check_step_width(const saddle_config_t *config)
{
    if (config->step_width_slow_speed_m_s > config->step_width_fast_speed_m_s) {
        return "step_width_slow_speed_m_s";
    }
    if (saddle_regressed_width_m(config, config->step_width_slow_speed_m_s) < WIDTH_MIN_M ||
        saddle_regressed_width_m(config, config->step_width_fast_speed_m_s) < WIDTH_MIN_M) {
        return "step_width_slope_s";
    }
    return NULL;
}

float saddle_longer_step_factor(const saddle_config_t *config)
{
    return saddle_larger(
        1.0f, saddle_larger(config->step_length_factor_left, config->step_length_factor_right));
}

/* The reach peak_speed / (2 w_n) must exceed the shortest half step, on the longer side, and the
 * pendulum must reach from there to the CoM without lying flat. */
static const char *check_reach(const saddle_config_t *config)
{
    const float pendulum_m = config->pendulum_ratio * config->body_height_m;
    const float reach_m2 =
        config->peak_speed_m_s * config->peak_speed_m_s * pendulum_m / (4.0f * SADDLE_GRAVITY_M_S2);
    const float shortest_m = saddle_longer_step_factor(config) * 1.05f *
                             saddle_regressed_half_step_m(config, CEILING_MIN_M_S);
    const float width_m = saddle_larger(
        saddle_larger(config->step_width_slow_m, config->step_width_fast_m),
        saddle_larger(saddle_regressed_width_m(config, config->step_width_slow_speed_m_s),
                      saddle_regressed_width_m(config, config->step_width_fast_speed_m_s)));
    if (reach_m2 < shortest_m * shortest_m) {
        return "half_step_intercept_m";
    }
    if (reach_m2 + width_m * width_m > 0.8f * pendulum_m * pendulum_m) {
        return "peak_speed_m_s";
    }
    const float aside_m = saddle_magnitude(config->lateral_offset_m) +
                          (1.0f + saddle_magnitude(config->lateral_delay_rad)) * width_m;
    if (reach_m2 + aside_m * aside_m > 0.9f * pendulum_m * pendulum_m) {
        return "lateral_offset_m";
    }
    return NULL;
}

const char *saddle_config_check(const saddle_config_t *config)
{
    const char *bad_field = saddle_bad_field(FIELDS, FIELD_COUNT, config);
    if (bad_field != NULL) {
        return bad_field;
    }
    if ((unsigned)config->ankle >= (unsigned)SADDLE_ANKLE_COUNT) {
        return "ankle";
    }
    if (config->swing_skew > 0.0f && config->swing_skew < SKEW_MIN) {
        return "swing_skew";
    }
    if (config->tolerance_min > config->tolerance_max) {
        return "tolerance_min";
    }
    if (config->learn_margin >= config->tolerance_max) {
        return "learn_margin";
    }
    if (config->recovery_width_min_m > config->recovery_width_max_m) {
        return "recovery_width_min_m";
    }
    const char *bad_width = check_step_width(config);
    return bad_width != NULL ? bad_width : check_reach(config);
}
