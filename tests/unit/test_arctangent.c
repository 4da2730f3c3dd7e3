/** The arctangent of two arguments against the host's, all round and at every scale. */
#include "core_test.h"

#include "space/arctangent.h"

#define TOLERANCE_RAD 4e-7 /* as the header has it */

void setUp(void) {}

void tearDown(void) {}

static void test_every_direction_at_every_scale(void)
{
    for (int exponent = -15; exponent <= 15; exponent++) {
        for (int i = 0; i <= MANY(20000); i++) {
            const double angle = PI * (2.0 * i / MANY(20000) - 1.0);
            const float y = (float)(pow(10.0, exponent) * sin(angle));
            const float x = (float)(pow(10.0, exponent) * cos(angle));
            const double expected = atan2((double)y, (double)x);
            TEST_ASSERT_DOUBLE_WITHIN(TOLERANCE_RAD, expected, (double)saddle_arctangent(y, x));
        }
    }
}

static void test_axes_and_the_origin(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, (double)saddle_arctangent(0.0f, 1.0f));
    TEST_ASSERT_DOUBLE_WITHIN(TOLERANCE_RAD, PI / 2.0, (double)saddle_arctangent(1.0f, 0.0f));
    TEST_ASSERT_DOUBLE_WITHIN(TOLERANCE_RAD, -PI / 2.0, (double)saddle_arctangent(-1.0f, 0.0f));
    TEST_ASSERT_DOUBLE_WITHIN(TOLERANCE_RAD, PI, (double)saddle_arctangent(0.0f, -1.0f));
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, (double)saddle_arctangent(0.0f, 0.0f));
}

static void test_zero_vector_has_direction_0(void)
{
    const float absurd[] = {NAN, INFINITY, -INFINITY, 3e38f};
    for (size_t i = 0; i < COUNT_OF(absurd); i++) {
        TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, (double)saddle_arctangent(absurd[i], 1.0f));
        TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, (double)saddle_arctangent(1.0f, absurd[i]));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_every_direction_at_every_scale);
    RUN_TEST(test_axes_and_the_origin);
    RUN_TEST(test_zero_vector_has_direction_0);
    return UNITY_END();
}
