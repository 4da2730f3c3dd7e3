/** What the proof reads in place of a function is that function, bit for bit. */
#include "../proof/models.h"
#include "core_test.h"

void setUp(void) {}

void tearDown(void) {}

/** Zeros, ends of ranges, infinities, NaN of both signs, and numbers between. */
static const float VALUES[] = {
    0.0f,  -0.0f,    1.0e-45f, -1.0e-45f, 1.0f, -1.0f, 2.5f, -2.5f, 1000.0f,
    3e38f, INFINITY, -3e38f,   -INFINITY, NAN,  -NAN,  5.0f, -5.0f,
};

static void test_the_larger_and_the_smaller(void)
{
    for (size_t i = 0; i < COUNT_OF(VALUES); i++) {
        for (size_t k = 0; k < COUNT_OF(VALUES); k++) {
            const float a = VALUES[i];
            const float b = VALUES[k];
            ASSERT_SAME_FLOAT(saddle_larger(a, b), model_larger(a, b));
            ASSERT_SAME_FLOAT(saddle_smaller(a, b), model_smaller(a, b));
        }
    }
}

static void test_ranges(void)
{
    uint32_t state = 17;
    for (int i = 0; i < MANY(20000); i++) {
        const float x = i < (int)COUNT_OF(VALUES) ? VALUES[i] : float_of_bits(random_bits(&state));
        for (size_t k = 0; k < COUNT_OF(VALUES); k++) {
            const float lo = VALUES[k] == VALUES[k] ? VALUES[k] : 0.0f;
            const float hi = lo + 3.0f;
            ASSERT_SAME_FLOAT(saddle_clamp(x, lo, hi), model_clamp(x, lo, hi));
            TEST_ASSERT_EQUAL(saddle_in_range(x, lo, hi), MODEL_IN_RANGE(x, lo, hi));
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_larger_and_the_smaller);
    RUN_TEST(test_ranges);
    return UNITY_END();
}
