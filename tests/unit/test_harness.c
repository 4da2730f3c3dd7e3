/** The comparisons that the other tests rest on can fail: on NaN, on infinity, out of tolerance. */
#include "core_test.h"

#include <setjmp.h>

void setUp(void) {}

void tearDown(void) {}

/* Runs an assertion that must fail, and takes the failure back. */
#define MUST_FAIL(assertion)                                           \
    do {                                                               \
        jmp_buf outer;                                                 \
        memcpy(outer, Unity.AbortFrame, sizeof outer);                 \
        volatile bool failed = true;                                   \
        if (TEST_PROTECT()) {                                          \
            assertion;                                                 \
            failed = false;                                            \
        }                                                              \
        memcpy(Unity.AbortFrame, outer, sizeof outer);                 \
        Unity.CurrentTestFailed = 0;                                   \
        TEST_ASSERT_TRUE_MESSAGE(failed, "did not fail: " #assertion); \
    } while (0)

static const double TOLERANCE = 0.1;

static void test_value_out_of_tolerance_fails(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(TOLERANCE, 1.0, 1.05);
    MUST_FAIL(TEST_ASSERT_DOUBLE_WITHIN(TOLERANCE, 1.0, 1.15));
    MUST_FAIL(TEST_ASSERT_DOUBLE_WITHIN(TOLERANCE, 1.0, 0.85));
}

static void test_nan_fails(void)
{
    const double nan_value = (double)NAN;
    MUST_FAIL(TEST_ASSERT_DOUBLE_WITHIN(TOLERANCE, 1.0, nan_value));
    MUST_FAIL(TEST_ASSERT_DOUBLE_WITHIN(TOLERANCE, nan_value, 1.0));
    MUST_FAIL(TEST_ASSERT_DOUBLE_WITHIN(TOLERANCE, nan_value, nan_value));
}

static void test_infinity_fails(void)
{
    const double infinity = (double)INFINITY;
    MUST_FAIL(TEST_ASSERT_DOUBLE_WITHIN(TOLERANCE, 1.0, infinity));
    MUST_FAIL(TEST_ASSERT_DOUBLE_WITHIN(TOLERANCE, 1.0, -infinity));
    MUST_FAIL(TEST_ASSERT_DOUBLE_WITHIN(TOLERANCE, infinity, -infinity));
}

static void test_order_fails_on_nan(void)
{
    const double nan_value = (double)NAN;
    MUST_FAIL(TEST_ASSERT_LESS_THAN_DOUBLE(1.0, nan_value));
    MUST_FAIL(TEST_ASSERT_GREATER_THAN_DOUBLE(1.0, nan_value));
    MUST_FAIL(TEST_ASSERT_LESS_THAN_DOUBLE(1.0, 1.0));
}

static void test_same_float_distinguishes_adjacent_floats_and_zeros(void)
{
    ASSERT_SAME_FLOAT(1.0f, 1.0f);
    MUST_FAIL(ASSERT_SAME_FLOAT(1.0f, nextafterf(1.0f, 2.0f)));
    MUST_FAIL(ASSERT_SAME_FLOAT(0.0f, -0.0f));
    MUST_FAIL(ASSERT_SAME_FLOAT(0.0f, NAN));
}

static void test_random_numbers_fill_their_range(void)
{
    uint32_t state = 1;
    float low = 1.0f;
    float high = 0.0f;
    for (int i = 0; i < 1000; i++) {
        const float value = random_in(&state, -2.0f, 3.0f);
        TEST_ASSERT_TRUE(value >= -2.0f && value <= 3.0f);
        low = fminf(low, value);
        high = fmaxf(high, value);
    }
    TEST_ASSERT_TRUE(low < -1.9f && high > 2.9f);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_value_out_of_tolerance_fails);
    RUN_TEST(test_nan_fails);
    RUN_TEST(test_infinity_fails);
    RUN_TEST(test_order_fails_on_nan);
    RUN_TEST(test_same_float_distinguishes_adjacent_floats_and_zeros);
    RUN_TEST(test_random_numbers_fill_their_range);
    return UNITY_END();
}
