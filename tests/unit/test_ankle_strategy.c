/** Toe-off and heel strike: the model page's angles, eq:05 to eq:08 in double, rates by difference. */
#include "core_test.h"

#include "math/elementary.h"
#include "model/gait_model.h"
#include "motion/ankle_strategy.h"

#define DEGREE (PI / 180.0)

static saddle_config_t config;
static saddle_body_t body;

void setUp(void)
{
    config = paper_config();
    body = model_of(&config)->body;
}

void tearDown(void) {}

static saddle_quarter_t quarter_at(float speed)
{
    const float length = (float)(0.1802 * (double)speed + 0.1351);
    return saddle_quarter(model_of(&config), SADDLE_LEFT, length,
                          saddle_step_width_m(model_of(&config), speed), speed);
}

static saddle_transition_t transition_at(float speed, double heel_strike_deg)
{
    const saddle_quarter_t quarter = quarter_at(speed);
    const saddle_heel_strike_t strike =
        saddle_heel_strike(model_of(&config), (float)(heel_strike_deg * DEGREE));
    return saddle_transition(model_of(&config), &quarter, strike);
}

static void test_toe_off_angles_at_the_papers_speeds(void)
{
    static const struct {
        float speed;
        double toe_off_deg;
    } table[] = {{0.7f, 9.6}, {1.0f, 12.3}, {1.2f, 15.5}, {1.6f, 25.1}};
    for (size_t i = 0; i < COUNT_OF(table); i++) {
        const saddle_transition_t transition = transition_at(table[i].speed, 10.0);
        const double degrees = (double)transition.toe_off_rad / DEGREE;
        TEST_ASSERT_DOUBLE_WITHIN(0.05, table[i].toe_off_deg, degrees);
        TEST_ASSERT_FALSE(transition.toe_off_limited);
    }
}

static void test_heel_strikes_before_the_saddle(void)
{
    const double lead = 0.1 * (1.0 - cos(15.0 * DEGREE));
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, lead, transition_at(1.2f, 15.0).strike.lead_m);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, transition_at(1.2f, 0.0).strike.lead_m);
}

static void test_toe_off_beyond_the_geometry_is_limited_and_reported(void)
{
    config.cop_range_m = 0.01f; /* eq:08 asks for 0.028 m from a chord of at most 0.02 m */
    const saddle_transition_t long_step = transition_at(1.6f, 10.0);
    TEST_ASSERT_TRUE(long_step.toe_off_limited);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, PI, long_step.toe_off_rad);

    config = paper_config();
    config.vertical_intercept_m = 0.1f; /* the CoM sinks more than the step's geometry does */
    const saddle_transition_t short_step = transition_at(0.3f, 10.0);
    TEST_ASSERT_TRUE(short_step.toe_off_limited);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, short_step.toe_off_rad);
}

static saddle_ankle_state_t ankle_at(const saddle_transition_t *transition, float since_strike_s,
                                     bool before)
{
    saddle_ankle_state_t ankle;
    saddle_ankle(model_of(&config), transition, since_strike_s, before, &ankle);
    return ankle;
}

/* Leg length in double, t since heel strike; before the saddle towards toe-off. */
static double leg_length(const saddle_transition_t *transition, double t, bool before)
{
    const double rise = erf(t / 0.11);
    const double angle = before ? (double)transition->toe_off_rad * (1.0 + rise)
                                : (double)transition->strike.angle_rad * (1.0 - rise);
    return 0.57 * 1.79 + 2.0 * 0.1 * sin(0.5 * angle);
}

static void test_profiles_are_the_equations_and_rates_their_derivatives(void)
{
    const saddle_transition_t transition = transition_at(1.2f, 10.0);
    for (int i = -600; i < 600; i++) {
        const float t = 0.001f * (float)i;
        const bool before = t < 0.0f;
        const saddle_ankle_state_t ankle = ankle_at(&transition, t, t < 0.0f);
        const double rise = erf((double)t / 0.11);
        const double toe_off = (double)transition.toe_off_rad * (1.0 + rise);
        const double heel_strike = 10.0 * DEGREE * (1.0 - rise);
        TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, toe_off, ankle.toe_off_rad);
        TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, heel_strike, ankle.heel_strike_rad);
        TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, leg_length(&transition, (double)t, before),
                                  ankle.leg_length_m);
        const double h = 1e-6;
        const double rate = (leg_length(&transition, (double)t + h, before) -
                             leg_length(&transition, (double)t - h, before)) /
                            (2 * h);
        TEST_ASSERT_DOUBLE_WITHIN(2e-6, rate, ankle.leg_rate_m_s); /* below 1 m/s; t is a float */
    }
}

/* Θ_TO of 0.9 rad would turn the sole by 1.8 rad after the heel strike. */
static void test_sole_turns_no_further_than_upright_and_reports_it(void)
{
    saddle_transition_t transition = transition_at(1.2f, 10.0);
    transition.toe_off_rad = 0.9f;
    const saddle_ankle_state_t far = ankle_at(&transition, 0.3f, true);
    TEST_ASSERT_TRUE(far.limited);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.5 * PI, far.toe_off_rad);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.57 * 1.79 + 0.2 * sin(0.25 * PI),
                              far.leg_length_m);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, far.leg_rate_m_s);
    const saddle_ankle_state_t near = ankle_at(&transition, 0.0f, true);
    TEST_ASSERT_FALSE(near.limited);
    ASSERT_SAME_FLOAT(0.9f, near.toe_off_rad);
}

static void test_far_from_the_transition_the_leg_has_its_length(void)
{
    const saddle_transition_t transition = transition_at(0.01f, 10.0);
    const saddle_ankle_state_t before = ankle_at(&transition, -100.0f, true);
    const saddle_ankle_state_t after = ankle_at(&transition, 100.0f, false);
    ASSERT_SAME_FLOAT(body.pendulum_m, before.leg_length_m);
    ASSERT_SAME_FLOAT(body.pendulum_m, after.leg_length_m);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, before.leg_rate_m_s);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, after.leg_rate_m_s);
}

static void test_rigid_leg_keeps_its_length(void)
{
    config.ankle = SADDLE_ANKLE_RIGID;
    const saddle_transition_t transition = transition_at(1.2f, 10.0);
    for (float t = -0.5f; t < 0.5f; t += 0.01f) {
        const saddle_ankle_state_t ankle = ankle_at(&transition, t, t < 0.0f);
        ASSERT_SAME_FLOAT(body.pendulum_m, ankle.leg_length_m);
        ASSERT_SAME_FLOAT(0.0f, ankle.leg_rate_m_s);
        ASSERT_SAME_FLOAT(0.0f, ankle.toe_off_rad);
        ASSERT_SAME_FLOAT(0.0f, ankle.heel_strike_rad);
    }
}

static void test_height_closes_the_triangle_and_its_rate_is_the_derivative(void)
{
    const saddle_ankle_state_t ankle = {.leg_length_m = 1.04f, .leg_rate_m_s = 0.3f};
    const saddle_vec2_t offset = {0.3f, -0.05f};
    const saddle_vec2_t velocity = {1.2f, -0.1f};
    float height;
    float rate;
    saddle_com_height(&ankle, offset, velocity, &height, &rate);
    const double z = sqrt(1.04 * 1.04 - 0.3 * 0.3 - 0.05 * 0.05);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, z, height);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, (1.04 * 0.3 - 0.3 * 1.2 - 0.05 * 0.1) / z, rate);
}

static saddle_ankle_state_t ankle_for(float leg_m, bool toe_off, bool *limited)
{
    saddle_ankle_state_t ankle;
    *limited = !saddle_ankle_for_leg(model_of(&config), leg_m, toe_off, &ankle);
    return ankle;
}

static void test_ankle_angle_gives_the_leg_its_length(void)
{
    for (int k = 0; k <= 141; k++) { /* 2 d_h sin(pi/4) = 0.1414 m: the sole upright */
        const float leg = body.pendulum_m + 0.001f * (float)k;
        bool limited = true;
        const saddle_ankle_state_t off = ankle_for(leg, true, &limited);
        const double chord = 2.0 * 0.1 * sin(0.5 * (double)off.toe_off_rad);
        TEST_ASSERT_DOUBLE_WITHIN(2 * FLOAT_TOLERANCE, (double)leg - (double)body.pendulum_m,
                                  chord);
        ASSERT_SAME_FLOAT(0.0f, off.heel_strike_rad);
        ASSERT_SAME_FLOAT(0.0f, off.knee_flexion_m);
        TEST_ASSERT_FALSE(limited);
        const saddle_ankle_state_t heel = ankle_for(leg, false, &limited);
        ASSERT_SAME_FLOAT(off.toe_off_rad, heel.heel_strike_rad);
        ASSERT_SAME_FLOAT(0.0f, heel.toe_off_rad);
        ASSERT_SAME_FLOAT(leg, heel.leg_length_m);
    }
}

static void test_leg_outside_the_ankles_range_flexes_the_knee_or_is_reported(void)
{
    bool limited = true;
    const saddle_ankle_state_t bent = ankle_for(body.pendulum_m - 0.003f, true, &limited);
    TEST_ASSERT_FALSE(limited);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.003, bent.knee_flexion_m);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, bent.toe_off_rad);
    for (float elongation = 0.142f; elongation < 0.3f; elongation += 0.02f) {
        const saddle_ankle_state_t toe = ankle_for(body.pendulum_m + elongation, true, &limited);
        TEST_ASSERT_TRUE(limited);
        ASSERT_SAME_FLOAT(SADDLE_HALF_PI, toe.toe_off_rad);
        const saddle_ankle_state_t heel = ankle_for(body.pendulum_m + elongation, false, &limited);
        TEST_ASSERT_TRUE(limited);
        ASSERT_SAME_FLOAT(SADDLE_HALF_PI, heel.heel_strike_rad);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_toe_off_angles_at_the_papers_speeds);
    RUN_TEST(test_heel_strikes_before_the_saddle);
    RUN_TEST(test_toe_off_beyond_the_geometry_is_limited_and_reported);
    RUN_TEST(test_profiles_are_the_equations_and_rates_their_derivatives);
    RUN_TEST(test_sole_turns_no_further_than_upright_and_reports_it);
    RUN_TEST(test_far_from_the_transition_the_leg_has_its_length);
    RUN_TEST(test_rigid_leg_keeps_its_length);
    RUN_TEST(test_height_closes_the_triangle_and_its_rate_is_the_derivative);
    RUN_TEST(test_ankle_angle_gives_the_leg_its_length);
    RUN_TEST(test_leg_outside_the_ankles_range_flexes_the_knee_or_is_reported);
    return UNITY_END();
}
