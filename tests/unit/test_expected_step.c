/** The step as it is planned, at any phase, against the walk in closed form and the planner's own
 *  plan; and how a deviation from it grows. */
#include "balance_twin.h"

#include "balance/energy.h"
#include "balance/expected_step.h"
#include "math/vec2.h"

static const float SPEEDS[] = {0.3f, 0.5f, 0.7f, 1.0f, 1.2f, 1.6f, 1.9f};

static saddle_config_t config;
static saddle_body_t body;

void setUp(void)
{
    config = paper_config();
    config.prediction_horizon_s = 2.0f; /* as far as any step here */
    body = model_of(&config)->body;
}

void tearDown(void) {}

typedef struct {
    float com_m, velocity_m_s;
} deviation_t;

static float grown_after_m(deviation_t deviation, float time_s)
{
    const saddle_growth_t growth = saddle_growth(model_of(&config), time_s, false);
    const float xcom_m = deviation.com_m + deviation.velocity_m_s / body.natural_frequency_rad_s;
    return saddle_grown_m(deviation.com_m, xcom_m, &growth);
}

/* ---- the step ------------------------------------------------------------------------------ */

/* The model page's walk, in double. */
static double step_width(double v)
{
    return v < 0.6 ? 0.22 : v > 1.1 ? 0.10 : -0.2128 * v + 0.3456;
}

static double half_step(double v)
{
    return 0.1802 * v + 0.1351;
}

static double amplitude(double width, double v)
{
    return fmin(width / (2.0 * PI * v), width / PI);
}

static saddle_expectation_t expect(const saddle_step_t *step, float x_m)
{
    const saddle_step_place_t place = saddle_step_place(step, x_m);
    saddle_expectation_t expected;
    saddle_expect(model_of(&config), step, &place, &expected);
    return expected;
}

static saddle_step_t steady_step(saddle_side_t stance, double v)
{
    const double side = stance == SADDLE_LEFT ? -1.0 : 1.0;
    return (saddle_step_t){
        .stance = stance,
        .speed_m_s = (float)v,
        .half_behind_m = (float)half_step(v),
        .width_behind_m = (float)step_width(v),
        .landing_m = {(float)(2.0 * half_step(v)), (float)(side * step_width(v))},
    };
}

/* The CoM seen from the stance foot, x_m ahead of it, in a quarter of length `half`. */
static void assert_on_path(saddle_side_t stance, double v, double width, double half, double x,
                           const saddle_com_state_t *state)
{
    const double inward = stance == SADDLE_LEFT ? -1.0 : 1.0;
    const double turn = 0.5 * PI / half;
    const double a = amplitude(width, v);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, x, state->com_m.x);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, inward * (0.5 * width - a * cos(turn * x)),
                              state->com_m.y);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, v, state->velocity_m_s.x);
    TEST_ASSERT_DOUBLE_WITHIN(2e-6, inward * a * turn * v * sin(turn * x), state->velocity_m_s.y);
}

static void test_steady_step_is_the_papers_walk_at_every_phase(void)
{
    for (size_t i = 0; i < COUNT_OF(SPEEDS); i++) {
        for (int side = 0; side < 2; side++) {
            const saddle_side_t stance = (saddle_side_t)side;
            const double v = (double)SPEEDS[i];
            const double half = half_step(v);
            const saddle_step_t step = steady_step(stance, v);
            for (int k = -20; k <= 20; k++) {
                const double x = half * k / 20.0;
                const saddle_expectation_t expected = expect(&step, (float)x);
                assert_on_path(stance, v, step_width(v), half, x, &expected.now);
                assert_on_path(stance, v, step_width(v), half, half, &expected.landing);
                TEST_ASSERT_DOUBLE_WITHIN(2e-6, (half - x) / v, expected.time_s);
                TEST_ASSERT_DOUBLE_WITHIN(2e-6, 2.0 * half / v, expected.step_time_s);
                ASSERT_SAME_FLOAT(step.landing_m.x, expected.landing_m.x);
                ASSERT_SAME_FLOAT(step.landing_m.y, expected.landing_m.y);
            }
        }
    }
}

/* The planned step as the tick reads it from a plan. */
static saddle_step_t step_of(const saddle_plan_t *plan)
{
    return (saddle_step_t){
        .stance = (saddle_side_t)plan->support,
        .speed_m_s = plan->speed_m_s,
        .half_behind_m = 0.5f * plan->step_length_m,
        .width_behind_m = plan->step_width_m,
        .landing_m = {plan->landing_m.x, plan->landing_m.y - plan->foot_m[plan->support].y},
    };
}

/* What the plan of a joined walk will be when the swing foot lands is what was expected of it. */
static void assert_plan_fulfils(const saddle_context_t *context, uint64_t now_us,
                                const saddle_plan_t *now)
{
    const saddle_vec3_t *stance = &now->foot_m[now->support];
    const saddle_step_t step = step_of(now);
    const saddle_expectation_t expected = expect(&step, now->com_m.x - stance->x);
    TEST_ASSERT_DOUBLE_WITHIN(2e-6, (double)now->com_m.y - (double)stance->y, expected.now.com_m.y);
    TEST_ASSERT_DOUBLE_WITHIN(2e-6, now->com_velocity_m_s.y, expected.now.velocity_m_s.y);
    TEST_ASSERT_DOUBLE_WITHIN(2e-6, now->time_to_toe_off_s, expected.time_s);

    saddle_plan_t later;
    const uint64_t landing_us = now_us + (uint64_t)(1e6 * (double)expected.time_s);
    TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_plan_at(context, landing_us, &later));
    const saddle_vec3_t *old_stance = &later.foot_m[now->support];
    const saddle_vec3_t *landed = &later.foot_m[saddle_other_side(step.stance)];
    const double tolerance = 5e-6; /* one or two microseconds of a swing foot at 3 m/s */
    TEST_ASSERT_DOUBLE_WITHIN(tolerance, (double)later.com_m.x - (double)old_stance->x,
                              expected.landing.com_m.x);
    TEST_ASSERT_DOUBLE_WITHIN(tolerance, (double)later.com_m.y - (double)old_stance->y,
                              expected.landing.com_m.y);
    TEST_ASSERT_DOUBLE_WITHIN(tolerance, later.com_velocity_m_s.x, expected.landing.velocity_m_s.x);
    TEST_ASSERT_DOUBLE_WITHIN(tolerance, later.com_velocity_m_s.y, expected.landing.velocity_m_s.y);
    TEST_ASSERT_DOUBLE_WITHIN(10.0 * tolerance, (double)landed->x - (double)old_stance->x,
                              expected.landing_m.x);
    TEST_ASSERT_DOUBLE_WITHIN(10.0 * tolerance, (double)landed->y - (double)old_stance->y,
                              expected.landing_m.y);
}

static void assert_landings_are_expected(void)
{
    for (size_t i = 0; i < COUNT_OF(SPEEDS); i++) {
        saddle_context_t context;
        saddle_input_t input = {.command = {SADDLE_COMMAND_WALK, SPEEDS[i], 0.1f, 0.0f},
                                .measurement = saddle_no_measurement()};
        saddle_output_t output;
        saddle_init(&context, &config);
        TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_join(&context, &input.command));
        for (int tick = 0; tick < 60; tick++, input.time_us += 37000u) {
            TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_tick(&context, &input, &output));
            assert_plan_fulfils(&context, input.time_us, &output.plan);
        }
    }
}

static void test_expected_landing_is_the_plans_next_saddle_via_point(void)
{
    assert_landings_are_expected();
}

static void test_a_person_s_steady_walk_is_as_expected(void)
{
    config.lateral_offset_m = -0.012f;
    config.lateral_delay_rad = 0.3f;
    assert_landings_are_expected();
}

/* From a long wide step into a short narrow one. */
static void test_quarters_have_shapes_of_their_own(void)
{
    const double v = 0.9;
    const saddle_step_t step = {.stance = SADDLE_RIGHT,
                                .speed_m_s = 0.9f,
                                .half_behind_m = 0.4f,
                                .width_behind_m = 0.2f,
                                .landing_m = {0.5f, 0.12f}};
    for (int k = 1; k <= 10; k++) {
        const double behind = -0.04 * k;
        const double ahead = 0.025 * k;
        const saddle_expectation_t before = expect(&step, (float)behind);
        const saddle_expectation_t after = expect(&step, (float)ahead);
        assert_on_path(SADDLE_RIGHT, v, 0.2, 0.4, behind, &before.now);
        assert_on_path(SADDLE_RIGHT, v, 0.12, 0.25, ahead, &after.now);
        assert_on_path(SADDLE_RIGHT, v, 0.12, 0.25, 0.25, &before.landing);
        TEST_ASSERT_DOUBLE_WITHIN(2e-6, (0.25 - behind) / v, before.time_s);
        TEST_ASSERT_DOUBLE_WITHIN(2e-6, 0.65 / v, before.step_time_s);
    }
}

/* Before the step and beyond its end the phase is that of its ends: no time is left, or all. */
static void test_com_outside_the_step_is_at_its_nearer_end(void)
{
    const double v = 1.2;
    const double half = half_step(v);
    const saddle_step_t step = steady_step(SADDLE_LEFT, v);
    const float far_m[] = {0.01f, 0.3f, 2.5f};
    for (size_t i = 0; i < COUNT_OF(far_m); i++) {
        const saddle_expectation_t behind = expect(&step, (float)-half - far_m[i]);
        const saddle_expectation_t beyond = expect(&step, (float)half + far_m[i]);
        assert_on_path(SADDLE_LEFT, v, step_width(v), half, -half, &behind.now);
        assert_on_path(SADDLE_LEFT, v, step_width(v), half, half, &beyond.now);
        TEST_ASSERT_DOUBLE_WITHIN(2e-6, 2.0 * half / v, behind.time_s);
        ASSERT_SAME_FLOAT(0.0f, beyond.time_s);
    }
}

static void test_time_to_the_landing_is_at_most_the_prediction_horizon(void)
{
    config.prediction_horizon_s = 0.3f;
    const saddle_step_t step = steady_step(SADDLE_LEFT, 0.3);
    const double half = half_step(0.3);
    ASSERT_SAME_FLOAT(0.3f, expect(&step, 0.0f).time_s);
    const float near_end = (float)(half - 0.03);
    TEST_ASSERT_DOUBLE_WITHIN(2e-6, 0.1, expect(&step, near_end).time_s);
}

/* A last step ends beside the stance foot: a quarter without length is not divided by. */
static void test_step_that_ends_beside_the_stance_foot_is_finite(void)
{
    const saddle_step_t step = {.stance = SADDLE_LEFT,
                                .speed_m_s = 0.2f,
                                .half_behind_m = 0.1f,
                                .width_behind_m = 0.2f,
                                .landing_m = {0.0f, -0.2f}};
    for (int k = -10; k <= 10; k++) {
        const saddle_expectation_t expected = expect(&step, 0.05f * (float)k);
        const float numbers[] = {expected.now.com_m.x,
                                 expected.now.com_m.y,
                                 expected.now.velocity_m_s.x,
                                 expected.now.velocity_m_s.y,
                                 expected.landing.com_m.x,
                                 expected.landing.com_m.y,
                                 expected.landing.velocity_m_s.y,
                                 expected.time_s};
        for (size_t i = 0; i < COUNT_OF(numbers); i++) {
            TEST_ASSERT_DOUBLE_WITHIN(1.0, 0.0, numbers[i]);
        }
        TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, expected.landing.com_m.x);
    }
}

/* ---- how a deviation grows ----------------------------------------------------------------- */

static deviation_t random_deviation(uint32_t *state)
{
    return (deviation_t){random_in(state, -0.2f, 0.2f), random_in(state, -1.0f, 1.0f)};
}

static void test_zero_deviation_stays_zero_and_zero_time_changes_nothing(void)
{
    uint32_t state = 53;
    const deviation_t none = {0.0f, 0.0f};
    ASSERT_SAME_FLOAT(0.0f, grown_after_m(none, 0.5f));
    for (int i = 0; i < 100; i++) {
        const deviation_t deviation = random_deviation(&state);
        TEST_ASSERT_DOUBLE_WITHIN(3e-8, deviation.com_m, grown_after_m(deviation, 0.0f));
    }
}

/* x'' = w^2 x by Runge and Kutta: no closed form in the expectation. */
static void fall_freely(double *x, double *v, double time_s)
{
    const double w2 = GRAVITY / PENDULUM;
    const int steps = 400;
    const double h = time_s / steps;
    for (int i = 0; i < steps; i++) {
        const double k1x = *v;
        const double k1v = w2 * *x;
        const double k2x = *v + 0.5 * h * k1v;
        const double k2v = w2 * (*x + 0.5 * h * k1x);
        const double k3x = *v + 0.5 * h * k2v;
        const double k3v = w2 * (*x + 0.5 * h * k2x);
        const double k4x = *v + h * k3v;
        const double k4v = w2 * (*x + h * k3x);
        *x += h / 6.0 * (k1x + 2.0 * k2x + 2.0 * k3x + k4x);
        *v += h / 6.0 * (k1v + 2.0 * k2v + 2.0 * k3v + k4v);
    }
}

static void test_deviation_grows_as_a_pendulum_falls(void)
{
    uint32_t state = 59;
    for (int i = 0; i < 500; i++) {
        const deviation_t deviation = random_deviation(&state);
        const float time_s = random_in(&state, 0.0f, 0.8f);
        double x = (double)deviation.com_m;
        double v = (double)deviation.velocity_m_s;
        fall_freely(&x, &v, (double)time_s);
        TEST_ASSERT_DOUBLE_WITHIN(2e-6, x, grown_after_m(deviation, time_s));
    }
}

static void test_deviation_of_the_xcom_grows_by_the_exponential(void)
{
    uint32_t state = 61;
    for (int i = 0; i < 500; i++) {
        const float time_s = random_in(&state, 0.0f, 1.0f);
        const saddle_growth_t growth = saddle_growth(model_of(&config), time_s, false);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, exp(FREQUENCY * (double)time_s), growth.factor);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_steady_step_is_the_papers_walk_at_every_phase);
    RUN_TEST(test_expected_landing_is_the_plans_next_saddle_via_point);
    RUN_TEST(test_a_person_s_steady_walk_is_as_expected);
    RUN_TEST(test_quarters_have_shapes_of_their_own);
    RUN_TEST(test_com_outside_the_step_is_at_its_nearer_end);
    RUN_TEST(test_time_to_the_landing_is_at_most_the_prediction_horizon);
    RUN_TEST(test_step_that_ends_beside_the_stance_foot_is_finite);
    RUN_TEST(test_zero_deviation_stays_zero_and_zero_time_changes_nothing);
    RUN_TEST(test_deviation_grows_as_a_pendulum_falls);
    RUN_TEST(test_deviation_of_the_xcom_grows_by_the_exponential);
    return UNITY_END();
}
