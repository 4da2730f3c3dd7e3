/** The last check: one number that is not finite, wherever it is, is found. */
#include "core_test.h"

#include "math/finite.h"
#include "output_fields.h"

static saddle_output_t output;

static void put(size_t offset, float value)
{
    memcpy((char *)&output + offset, &value, sizeof value);
}

/* Large, of alternating signs: neither size nor sign is what is looked for. */
void setUp(void)
{
    float value = 1.0e30f;
    memset(&output, 0xFF, sizeof output); /* NaN, were it a number: what is none is not looked at */
    for (size_t i = 0; i < COUNT_OF(FIELDS); i++) {
        for (size_t k = 0; FIELDS[i].kind == FLOATS && k < FIELDS[i].size; k += sizeof value) {
            put(FIELDS[i].offset + k, value);
            value = -value;
        }
    }
}

void tearDown(void) {}

static void test_finite_numbers_pass(void)
{
    TEST_ASSERT_TRUE(saddle_output_finite(&output));
    TEST_ASSERT_TRUE(saddle_plan_finite(&output.plan));
}

static void test_each_number_is_looked_at(void)
{
    const float others[] = {NAN, INFINITY, -INFINITY};
    for (size_t i = 0; i < COUNT_OF(FIELDS); i++) {
        const bool of_plan = FIELDS[i].offset >= offsetof(saddle_output_t, plan) &&
                             FIELDS[i].offset < offsetof(saddle_output_t, scores);
        for (size_t k = 0; FIELDS[i].kind == FLOATS && k < FIELDS[i].size; k += sizeof(float)) {
            for (size_t n = 0; n < COUNT_OF(others); n++) {
                setUp();
                put(FIELDS[i].offset + k, others[n]);
                TEST_ASSERT_FALSE(saddle_output_finite(&output));
                TEST_ASSERT_EQUAL(!of_plan, saddle_plan_finite(&output.plan));
            }
        }
    }
}

/* What one adds to a sum the other takes from it. */
static void test_opposite_infinities_do_not_cancel(void)
{
    output.plan.speed_m_s = INFINITY;
    output.walk.height_m = -INFINITY;
    TEST_ASSERT_FALSE(saddle_output_finite(&output));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_finite_numbers_pass);
    RUN_TEST(test_each_number_is_looked_at);
    RUN_TEST(test_opposite_infinities_do_not_cancel);
    return UNITY_END();
}
