/** The vertical velocity of the CoM, from heights that come slower than the ticks or stop coming. */
#include "core_test.h"

#include "balance/learned_walk.h"

static const float DT_S = 0.08f;

static saddle_config_t config;
static saddle_learning_t learning;

void setUp(void)
{
    config = paper_config();
    saddle_learning_init(&learning, model_of(&config));
}

void tearDown(void) {}

static void watch(float height_m)
{
    const saddle_measurement_t measured = {.com = {.height_m = height_m}};
    saddle_learning_watch(&learning, &measured, DT_S);
}

static void test_climb_is_the_rise_over_the_time(void)
{
    watch(1.0f);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, learning.climb_m_s);
    watch(1.008f);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.1, learning.climb_m_s);
    watch(0.992f);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, -0.2, learning.climb_m_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.1, learning.last_climb_m_s);
}

static void test_slow_sensor_rises_over_its_own_time(void)
{
    watch(1.0f);
    watch(1.0f);
    watch(1.016f);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.1, learning.climb_m_s);
}

/* Three ticks are 0.24 s, four are more. */
static void test_height_that_stays_does_not_climb(void)
{
    watch(1.0f);
    watch(1.008f);
    watch(1.008f);
    watch(1.008f);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.1, learning.climb_m_s);
    watch(1.008f);
    watch(1.008f);
    ASSERT_SAME_FLOAT(0.0f, learning.climb_m_s);
    ASSERT_SAME_FLOAT(0.0f, learning.last_climb_m_s);
}

static void test_nothing_climbs_over_a_gap(void)
{
    watch(1.0f);
    watch(1.008f);
    watch(1.016f);
    saddle_learning_gap(&learning);
    ASSERT_SAME_FLOAT(0.0f, learning.climb_m_s);
    ASSERT_SAME_FLOAT(0.0f, learning.last_climb_m_s);
    watch(2.0f);
    ASSERT_SAME_FLOAT(0.0f, learning.climb_m_s);
    watch(2.008f);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.1, learning.climb_m_s);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_climb_is_the_rise_over_the_time);
    RUN_TEST(test_slow_sensor_rises_over_its_own_time);
    RUN_TEST(test_height_that_stays_does_not_climb);
    RUN_TEST(test_nothing_climbs_over_a_gap);
    return UNITY_END();
}
