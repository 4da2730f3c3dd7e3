/** Regressions, amplitudes and limits against the model page's numbers. */
#include "core_test.h"

#include "math/fixed.h"
#include "model/gait_model.h"

static saddle_config_t config;
static saddle_body_t body;

void setUp(void)
{
    config = paper_config();
    body = model_of(&config)->body;
}

void tearDown(void) {}

static double double_of(saddle_fixed_t position)
{
    return (double)position / (1e6 * 4398046511104.0);
}

static saddle_quarter_t quarter_at(float speed)
{
    return saddle_quarter(model_of(&config), SADDLE_LEFT, 0.3f,
                          saddle_step_width_m(model_of(&config), speed), speed);
}

static void test_body_constants(void)
{
    /* Four decimals are printed: half of the last. */
    TEST_ASSERT_DOUBLE_WITHIN(5e-5, 1.0203, body.pendulum_m);
    TEST_ASSERT_DOUBLE_WITHIN(5e-5, 3.1002, body.natural_frequency_rad_s);
    TEST_ASSERT_DOUBLE_WITHIN(5e-5, 0.4838, body.half_step_max_m);
    TEST_ASSERT_DOUBLE_WITHIN(5e-4, 1.935, body.speed_ceiling_m_s);
}

static void test_step_width_is_piecewise_with_the_ends_in_the_middle_piece(void)
{
    static const struct {
        double speed, width;
    } table[] = {{-1.0, 0.22},  {0.0, 0.22}, {0.5, 0.22}, {0.7, 0.19664},
                 {1.0, 0.1328}, {1.2, 0.10}, {5.0, 0.10}};
    for (size_t i = 0; i < COUNT_OF(table); i++) {
        TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, table[i].width,
                                  saddle_step_width_m(model_of(&config), (float)table[i].speed));
    }
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.21792,
                              saddle_step_width_m(model_of(&config), 0.6f));
    ASSERT_SAME_FLOAT(0.22f, saddle_step_width_m(model_of(&config), nextafterf(0.6f, 0.0f)));
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.11152,
                              saddle_step_width_m(model_of(&config), 1.1f));
    ASSERT_SAME_FLOAT(0.10f, saddle_step_width_m(model_of(&config), nextafterf(1.1f, 2.0f)));
}

static void test_half_step_is_the_regressions_to_the_nanometre(void)
{
    for (float speed = 0.0f; speed < 1.93f; speed += 0.013f) {
        const saddle_fixed_t fixed = saddle_speed_from_m_s(speed);
        const double slope = (double)config.half_step_slope_s;
        const double expected = slope * (double)speed + (double)config.half_step_intercept_m;
        TEST_ASSERT_DOUBLE_WITHIN(
            2e-10, expected, /* the slope is counted in 2^-31 s */
            double_of(saddle_half_step(model_of(&config), SADDLE_LEFT, fixed)));
        TEST_ASSERT_TRUE(saddle_half_step(model_of(&config), SADDLE_LEFT, fixed) ==
                         saddle_half_step(model_of(&config), SADDLE_RIGHT, fixed));
    }
}

static void test_quarter_at_the_papers_speeds(void)
{
    static const float speeds[] = {0.7f, 1.0f, 1.2f, 1.6f};
    for (size_t i = 0; i < COUNT_OF(speeds); i++) {
        const saddle_quarter_t quarter = quarter_at(speeds[i]);
        const double v = (double)speeds[i];
        TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.02656 * v + 0.002575, quarter.vertical_m);
        TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, (double)quarter.width_m / (2.0 * PI * v),
                                  quarter.amplitude_m);
        ASSERT_SAME_FLOAT(saddle_step_width_m(model_of(&config), speeds[i]), quarter.width_m);
        ASSERT_SAME_FLOAT(0.3f, quarter.length_m);
        TEST_ASSERT_EQUAL_INT(SADDLE_LEFT, quarter.stance);
    }
    ASSERT_SAME_FLOAT(0.02f,
                      saddle_quarter(model_of(&config), SADDLE_LEFT, 0.3f, 0.001f, 1.0f).width_m);
}

static void test_sides_have_their_own_step_length_and_width(void)
{
    config.step_length_factor_left = 0.8f;
    config.step_length_factor_right = 1.1f;
    config.step_width_factor_left = 0.7f;
    config.step_width_factor_right = 1.6f;
    const saddle_fixed_t speed = saddle_speed_from_m_s(1.0f);
    const double left = double_of(saddle_half_step(model_of(&config), SADDLE_LEFT, speed));
    const double right = double_of(saddle_half_step(model_of(&config), SADDLE_RIGHT, speed));
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.8 * 0.3153, left);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 1.1 * 0.3153, right);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.7 * 0.0664,
                              saddle_landing_y_m(model_of(&config), SADDLE_LEFT, 1.0f));
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, -1.6 * 0.0664,
                              saddle_landing_y_m(model_of(&config), SADDLE_RIGHT, 1.0f));
}

/* min S_SW = 1 - 2 A_y / d_SW = 1 - 1/(pi v), the paper's finding. */
static void test_lateral_amplitude_gives_the_papers_stability(void)
{
    static const struct {
        float speed;
        double s_sw;
    } table[] = {{0.7f, 0.545}, {1.0f, 0.682}, {1.2f, 0.735}, {1.6f, 0.801}};
    for (size_t i = 0; i < COUNT_OF(table); i++) {
        const saddle_quarter_t gait = quarter_at(table[i].speed);
        const double s_sw = 1.0 - 2.0 * (double)gait.amplitude_m / (double)gait.width_m;
        TEST_ASSERT_DOUBLE_WITHIN(5e-4, table[i].s_sw, s_sw);
    }
}

static void test_lateral_amplitude_is_tangency_below_half_a_metre_per_second(void)
{
    const float slow[] = {0.01f, 0.318f, 0.5f};
    for (size_t i = 0; i < COUNT_OF(slow); i++) {
        TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.22 / PI, quarter_at(slow[i]).amplitude_m);
    }
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.22 / (2.0 * PI * 0.55),
                              quarter_at(0.55f).amplitude_m);
}

static void test_lateral_factor_scales_the_amplitude_up_to_tangency(void)
{
    const float printed = quarter_at(1.2f).amplitude_m;
    config.lateral_factor = 1.8f;
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 1.8 * (double)printed, quarter_at(1.2f).amplitude_m);
    config.lateral_factor = 0.4f;
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.4 * (double)printed, quarter_at(1.2f).amplitude_m);
    config.lateral_factor = 2.4f;
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.10 / PI, quarter_at(1.2f).amplitude_m);
    config.lateral_factor = 5.0f;
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.10 / PI, quarter_at(1.2f).amplitude_m);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.22 / PI, quarter_at(0.0f).amplitude_m);
}

static void test_com_never_passes_tangency(void)
{
    const float factors[] = {0.1f, 1.0f, 5.0f};
    for (size_t i = 0; i < COUNT_OF(factors); i++) {
        config.lateral_factor = factors[i];
        for (float speed = 0.01f; speed < 5.0f; speed += 0.01f) {
            const saddle_quarter_t quarter = quarter_at(speed);
            TEST_ASSERT_TRUE(quarter.amplitude_m < 0.3184f * quarter.width_m); /* 1/pi = 0.31831 */
        }
    }
}

static void test_step_bounds(void)
{
    const saddle_step_bounds_t bounds = saddle_step_bounds(model_of(&config), 1.2f);
    const double frequency = sqrt(GRAVITY / (0.57 * 1.79));
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 1.2 / (2.0 * frequency), bounds.min_m);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.1802 * 1.2 + 0.1351, bounds.reference_m);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 3.0 / (2.0 * frequency), bounds.max_m);
    TEST_ASSERT_TRUE(bounds.feasible);
}

static void test_feasible_speeds_lie_between_zero_and_the_ceiling(void)
{
    const struct {
        float speed;
        bool feasible;
    } table[] = {{-1.0f, false},  {-0.0f, false},  {0.0f, false}, {1e-6f, true}, {1.9f, true},
                 {1.9345f, true}, {1.936f, false}, {3.0f, false}, {1e6f, false}};
    for (size_t i = 0; i < COUNT_OF(table); i++) {
        TEST_ASSERT_EQUAL(table[i].feasible,
                          saddle_step_bounds(model_of(&config), table[i].speed).feasible);
    }
}

/* Whichever of the two limits comes first, in every configuration that passes the check. */
static void test_ceiling_separates_feasible_from_infeasible_speeds(void)
{
    uint32_t state = 7;
    int reach_first = 0;
    int xcom_first = 0;
    for (int i = 0; i < 20000; i++) {
        config = paper_config();
        config.body_height_m = random_in(&state, 0.7f, 2.5f);
        config.half_step_slope_s = random_in(&state, 0.001f, 0.4f);
        config.half_step_intercept_m = random_in(&state, 0.01f, 0.5f);
        config.peak_speed_m_s = random_in(&state, 0.5f, 5.0f);
        if (saddle_config_check(&config) != NULL) {
            continue;
        }
        body = model_of(&config)->body;
        const float ceiling = body.speed_ceiling_m_s;
        TEST_ASSERT_TRUE(saddle_step_bounds(model_of(&config), 0.99f * ceiling).feasible);
        const saddle_step_bounds_t above = saddle_step_bounds(model_of(&config), 1.001f * ceiling);
        TEST_ASSERT_FALSE(above.feasible);
        if (above.reference_m < above.max_m) {
            xcom_first++;
        } else {
            reach_first++;
        }
    }
    TEST_ASSERT_GREATER_THAN_INT(1000, reach_first);
    TEST_ASSERT_GREATER_THAN_INT(1000, xcom_first);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_body_constants);
    RUN_TEST(test_step_width_is_piecewise_with_the_ends_in_the_middle_piece);
    RUN_TEST(test_half_step_is_the_regressions_to_the_nanometre);
    RUN_TEST(test_quarter_at_the_papers_speeds);
    RUN_TEST(test_sides_have_their_own_step_length_and_width);
    RUN_TEST(test_lateral_amplitude_gives_the_papers_stability);
    RUN_TEST(test_lateral_amplitude_is_tangency_below_half_a_metre_per_second);
    RUN_TEST(test_lateral_factor_scales_the_amplitude_up_to_tangency);
    RUN_TEST(test_com_never_passes_tangency);
    RUN_TEST(test_step_bounds);
    RUN_TEST(test_feasible_speeds_lie_between_zero_and_the_ceiling);
    RUN_TEST(test_ceiling_separates_feasible_from_infeasible_speeds);
    return UNITY_END();
}
