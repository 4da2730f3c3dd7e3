/** XCoM and the scores: 1 on the reference, 0 on the bound, straight in between. */
#include "core_test.h"

#include "balance/stability_scores.h"

void setUp(void) {}

void tearDown(void) {}

static void test_xcom_runs_ahead_by_velocity_over_frequency(void)
{
    const saddle_vec2_t com = {0.2f, -0.01f};
    const saddle_vec2_t velocity = {1.2f, -0.3f};
    const saddle_vec2_t xcom = saddle_xcom_m(com, velocity, 3.1f);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.2 + 1.2 / 3.1, xcom.x);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, -0.01 - 0.3 / 3.1, xcom.y);
}

/* The default body at 1.2 m/s: d_min 0.1935, d 0.3513, d_Max 0.4838. */
static void test_step_score_is_one_on_the_reference_and_zero_on_the_bound(void)
{
    const float reference = 0.3513f;
    const float bounds[] = {0.1935f, 0.4838f};
    for (size_t i = 0; i < COUNT_OF(bounds); i++) {
        ASSERT_SAME_FLOAT(1.0f, saddle_step_score(reference, reference, bounds[i]));
        TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, saddle_step_score(bounds[i], reference, bounds[i]));
        const float middle = 0.5f * (reference + bounds[i]);
        TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.5,
                                  saddle_step_score(middle, reference, bounds[i]));
    }
    TEST_ASSERT_DOUBLE_WITHIN(2e-6, -0.0935 / 0.1578,
                              saddle_step_score(0.1f, reference, bounds[0]));
    TEST_ASSERT_DOUBLE_WITHIN(2e-6, -0.0162 / 0.1325,
                              saddle_step_score(0.5f, reference, bounds[1]));
    TEST_ASSERT_TRUE(saddle_step_score(0.4f, reference, bounds[0]) > 1.0f); /* longer: no jump */
}

static void test_width_score_falls_to_zero_above_either_foot(void)
{
    ASSERT_SAME_FLOAT(1.0f, saddle_width_score(0.0f, 0.1f));
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.0, saddle_width_score(0.05f, 0.1f));
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.0, saddle_width_score(-0.05f, 0.1f));
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.6, saddle_width_score(-0.02f, 0.1f));
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, -1.0, saddle_width_score(0.1f, 0.1f));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_xcom_runs_ahead_by_velocity_over_frequency);
    RUN_TEST(test_step_score_is_one_on_the_reference_and_zero_on_the_bound);
    RUN_TEST(test_width_score_falls_to_zero_above_either_foot);
    return UNITY_END();
}
