/** The fading mismatch: value and slope continuous at both ends, slope the derivative between. */
#include "core_test.h"

#include "math/blend.h"

void setUp(void) {}

void tearDown(void) {}

static saddle_blend_t example(void)
{
    const saddle_sample_t actual = {0.07f, -0.4f};
    const saddle_sample_t reference = {0.02f, 0.3f};
    return saddle_blend(actual, reference, -0.25f, 0.3f);
}

static void test_mismatch_fades_from_its_value_to_zero_and_stays_there(void)
{
    const saddle_blend_t blend = example();
    const saddle_sample_t start = saddle_blend_at(&blend, -0.25f);
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, 0.05, start.value);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, -0.7, start.slope);
    const float beyond[] = {0.051f, 0.1f, 5.0f};
    for (size_t i = 0; i < COUNT_OF(beyond); i++) {
        const saddle_sample_t end = saddle_blend_at(&blend, beyond[i]);
        TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, end.value);
        TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, end.slope);
    }
    const saddle_sample_t near = saddle_blend_at(&blend, 0.05f - 1e-5f);
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, 0.0, near.value);
    TEST_ASSERT_DOUBLE_WITHIN(5e-5, 0.0, near.slope); /* 2 x 0.7 x 1e-5 / 0.3 */
}

static double value_at(double s)
{
    const double profile = s * s * s * (10.0 + s * (6.0 * s - 15.0));
    return 0.05 * (1.0 - profile) - 0.7 * 0.3 * s * (1.0 - s) * (1.0 - s);
}

static void test_slope_is_the_derivative(void)
{
    const saddle_blend_t blend = example();
    for (int k = 1; k < 300; k++) {
        const double s = k / 300.0;
        const double h = 1e-6;
        const saddle_sample_t at = saddle_blend_at(&blend, (float)(-0.25 + 0.3 * s));
        TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, value_at(s), at.value);
        TEST_ASSERT_DOUBLE_WITHIN(2e-6, (value_at(s + h) - value_at(s - h)) / (2 * h * 0.3),
                                  at.slope);
    }
}

static void test_zero_length_gives_no_mismatch(void)
{
    const saddle_blend_t none = {{0.1f, 0.5f}, 0.0f, 0.0f};
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, saddle_blend_at(&none, 0.0f).value);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, saddle_blend_at(&none, 0.0f).slope);
}

static void test_shortest_length_fades_too(void)
{
    const saddle_blend_t shortest = {{0.1f, 0.0f}, 0.0f, 1.0e-4f};
    ASSERT_SAME_FLOAT(0.1f, saddle_blend_at(&shortest, 0.0f).value);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_mismatch_fades_from_its_value_to_zero_and_stays_there);
    RUN_TEST(test_slope_is_the_derivative);
    RUN_TEST(test_zero_length_gives_no_mismatch);
    RUN_TEST(test_shortest_length_fades_too);
    return UNITY_END();
}
