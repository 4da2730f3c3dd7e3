/** Each coefficient of the model against its definition in double, for random configurations. */
#include "core_test.h"

void setUp(void) {}

void tearDown(void) {}

static double micrometres(saddle_fixed_t position)
{
    return (double)position / 4398046511104.0;
}

/* A configuration that the check accepts, with every field that a coefficient depends on changed. */
static saddle_config_t random_config(uint32_t *state)
{
    saddle_config_t config;
    do {
        config =
            saddle_config_default(random_in(state, 0.9f, 2.2f), random_in(state, 20.0f, 150.0f));
        config.cop_range_m = random_in(state, 0.05f, 0.2f);
        config.half_step_slope_s = random_in(state, 0.05f, 0.4f);
        config.half_step_intercept_m = random_in(state, 0.05f, 0.2f);
        config.step_length_factor_left = random_in(state, 0.7f, 1.3f);
        config.step_length_factor_right = random_in(state, 0.7f, 1.3f);
        config.acceleration_m_s2 = random_in(state, 0.1f, 2.0f);
        config.ankle_work_factor = random_in(state, 0.5f, 3.0f);
        config.prediction_horizon_s = random_in(state, 0.02f, 1.0f);
        config.tick_max_s = random_in(state, 0.08f, 0.25f);
        config.shift_time_s = random_in(state, 0.1f, 2.0f);
        config.command_max_age_s = random_in(state, 0.1f, 2.0f);
        config.com_max_age_s = random_in(state, 0.1f, 2.0f);
        config.foot_max_age_s = random_in(state, 0.1f, 2.0f);
        config.sensor_latency_s = random_in(state, 0.0f, 0.2f);
    } while (saddle_config_check(&config) != NULL);
    return config;
}

static void assert_near(double expected, double actual)
{
    TEST_ASSERT_DOUBLE_WITHIN(2e-6 * fabs(expected) + 1e-12, expected, actual); /* ten roundings */
}

static void test_balance_coefficients(void)
{
    uint32_t state = 61;
    for (int i = 0; i < 2000; i++) {
        const saddle_config_t config = random_config(&state);
        const saddle_body_t *body = &model_of(&config)->body;
        const double pendulum = (double)config.pendulum_ratio * (double)config.body_height_m;
        const double frequency = sqrt(GRAVITY / pendulum);
        const double horizon = (double)config.prediction_horizon_s;
        const double range = (double)config.cop_range_m;
        assert_near(pendulum, body->pendulum_m);
        assert_near(frequency, body->natural_frequency_rad_s);
        assert_near((double)config.ankle_work_factor * (double)config.body_mass_kg * GRAVITY *
                        range * range / pendulum,
                    body->ankle_work_j);
        assert_near(exp(frequency * horizon), body->horizon_growth);
        assert_near(1.0 - exp(-0.1 * frequency), body->trailing_share);
        assert_near(0.285 * (double)config.body_height_m, body->com_height_min_m);
    }
}

static void test_walking_coefficients(void)
{
    uint32_t state = 62;
    for (int i = 0; i < 2000; i++) {
        const saddle_config_t config = random_config(&state);
        const saddle_body_t *body = &model_of(&config)->body;
        const double factors[2] = {(double)config.step_length_factor_left,
                                   (double)config.step_length_factor_right};
        const double slope = (double)config.half_step_slope_s;
        const double intercept = (double)config.half_step_intercept_m;
        const double rate = (double)config.acceleration_m_s2;
        for (int foot = 0; foot < 2; foot++) {
            assert_near(factors[foot] * slope, (double)body->half_step_slope[foot] / 2147483648.0);
            assert_near(1e6 * factors[foot] * intercept,
                        micrometres(body->half_step_intercept[foot]));
        }
        /* At this speed v^2 = 2 a l(v), and nine tenths of it are used. */
        const double braked = (double)body->braked_in_a_step_m_s / 0.9;
        assert_near(2.0 * rate * (slope * braked + intercept), braked * braked);
        assert_near(rate * (double)config.tick_max_s, body->braked_in_a_tick_m_s);
        assert_near(fmin(fmin(sqrt(rate * intercept), 0.3), 0.99 * (double)body->speed_ceiling_m_s),
                    body->crawl_m_s);
        /* Just below the ceiling the longer side is within reach. */
        const double longer = fmax(1.0, fmax(factors[0], factors[1]));
        const double speed = 0.999 * (double)body->speed_ceiling_m_s;
        TEST_ASSERT_TRUE(longer * (slope * speed + intercept) < (double)body->half_step_max_m);
    }
}

static void test_times_in_microseconds(void)
{
    uint32_t state = 63;
    for (int i = 0; i < 2000; i++) {
        const saddle_config_t config = random_config(&state);
        const saddle_body_t *body = &model_of(&config)->body;
        assert_near(1e6 * (double)config.command_max_age_s, body->command_max_age_us);
        assert_near(1e6 * (double)config.com_max_age_s, body->com_max_age_us);
        assert_near(1e6 * (double)config.foot_max_age_s, body->foot_max_age_us);
        TEST_ASSERT_UINT32_WITHIN(1, (uint32_t)(1e6 * (double)config.tick_max_s),
                                  body->tick_max_us);
        TEST_ASSERT_UINT32_WITHIN(1, (uint32_t)(1e6 * (double)config.shift_time_s), body->shift_us);
        TEST_ASSERT_UINT32_WITHIN(1, (uint32_t)(1e6 * (double)config.sensor_latency_s),
                                  body->latency_us);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_balance_coefficients);
    RUN_TEST(test_walking_coefficients);
    RUN_TEST(test_times_in_microseconds);
    return UNITY_END();
}
