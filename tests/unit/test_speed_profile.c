/** Motion along x against its closed forms in double. */
#include "core_test.h"

#include "math/fixed.h"
#include "motion/speed_profile.h"

static const double UNITS = 4398046511104.0;

static uint32_t state;
static saddle_speed_profile_t profile;

void setUp(void)
{
    state = 11;
}

void tearDown(void) {}

static double speed_of(saddle_fixed_t speed)
{
    return (double)speed / UNITS;
}

static double metres(saddle_fixed_t position)
{
    return (double)position / (1e6 * UNITS);
}

static saddle_speed_profile_t profile_of(float speed, float target, float rate)
{
    saddle_speed_profile_t made = {.speed = 0};
    saddle_profile_set_speed(&made, saddle_speed_from_m_s(speed));
    saddle_profile_aim(&made, target, rate);
    return made;
}

static float time_s(const saddle_speed_profile_t *p, float way_m)
{
    const saddle_pace_t pace = saddle_pace(p);
    return saddle_pace_time_s(&pace, way_m);
}

/* Speed and way after t seconds. */
static double closed_form(const saddle_speed_profile_t *p, double t, double *speed)
{
    const double v = speed_of(p->speed);
    const double target = speed_of(p->target);
    const double rate = target < v ? -(double)p->rate_m_s2 : (double)p->rate_m_s2;
    const double reached = target == v ? 0.0 : rate == 0.0 ? INFINITY : (target - v) / rate;
    const double changing = fmin(t, reached);
    *speed = t >= reached ? target : v + rate * t;
    return v * changing + 0.5 * rate * changing * changing + target * (t - changing);
}

static saddle_speed_profile_t random_profile(void)
{
    const uint32_t kind = random_bits(&state) % 8u;
    const float speed = kind == 0u ? 0.0f : random_in(&state, 0.0f, 1.9f);
    const float target = kind == 1u ? 0.0f : kind == 2u ? speed : random_in(&state, 0.0f, 1.9f);
    return profile_of(speed, target, kind == 3u ? 0.0f : random_in(&state, 0.01f, 5.0f));
}

static void test_advance_is_the_closed_form_targets_inside_the_interval_or_not(void)
{
    int reached = 0;
    for (int i = 0; i < 50000; i++) {
        const saddle_speed_profile_t before = profile = random_profile();
        const uint32_t dt_us = random_bits(&state) % 250001u;
        double speed;
        const double way = closed_form(&before, dt_us * 1e-6, &speed);
        const double walked = metres(saddle_profile_advance(&profile, dt_us));
        /* A rounding of the change of speed, and of its share of the way. */
        TEST_ASSERT_DOUBLE_WITHIN(2e-7, speed, speed_of(profile.speed));
        TEST_ASSERT_DOUBLE_WITHIN(6e-8, way, walked);
        reached += profile.speed == before.target && before.speed != before.target ? 1 : 0;
    }
    TEST_ASSERT_GREATER_THAN_INT(5000, reached);
}

static void test_constant_speed_is_exact_in_any_ticks(void)
{
    profile = profile_of(1.2f, 1.2f, 0.5f);
    saddle_fixed_t way = 0;
    for (int i = 0; i < 1000; i++) {
        way += saddle_profile_advance(&profile, 1000);
    }
    TEST_ASSERT_TRUE(way == profile.speed * 1000000);
}

static void test_no_rate_keeps_the_speed_and_no_speed_keeps_the_place(void)
{
    profile = profile_of(1.0f, 0.2f, 0.0f);
    TEST_ASSERT_TRUE(saddle_profile_advance(&profile, 80000) == profile.speed * 80000);
    TEST_ASSERT_TRUE(profile.speed == saddle_speed_from_m_s(1.0f));
    profile = profile_of(0.0f, 0.0f, 0.5f);
    TEST_ASSERT_TRUE(saddle_profile_advance(&profile, 250000) == 0);
    ASSERT_SAME_FLOAT(SADDLE_TIME_MAX_S, time_s(&profile, 0.1f));
    ASSERT_SAME_FLOAT(0.0f, time_s(&profile, 0.0f));
}

/* Where a quotient would be 0/0. */
static void test_from_rest_and_at_no_rate_everything_stays_a_number(void)
{
    profile = profile_of(1.0f, 1.0f, 0.0f);
    TEST_ASSERT_TRUE(saddle_profile_advance(&profile, 80000) == profile.speed * 80000);
    profile.speed -= 1; /* a difference that is none as a float */
    (void)saddle_profile_advance(&profile, 80000);
    TEST_ASSERT_TRUE(profile.speed == profile.target);
    profile = profile_of(0.0f, 1.0f, 0.5f);
    TEST_ASSERT_TRUE(saddle_profile_speed_after(&profile, 0.0f) == 0);
    profile = profile_of(0.0f, 1.0f, 1.0e-45f); /* the speed after 0.1 m underflows */
    ASSERT_SAME_FLOAT(SADDLE_TIME_MAX_S, time_s(&profile, 0.1f));
}

static void test_time_is_the_inverse_of_advance(void)
{
    for (int i = 0; i < 50000; i++) {
        const saddle_speed_profile_t before = random_profile();
        const double t = (double)random_in(&state, 0.0f, 1.0f);
        double speed;
        const double way = closed_form(&before, t, &speed);
        if (speed < 0.01) {
            continue; /* nearly at rest the time is not determined by the way */
        }
        const double slowest = fmin(speed, speed_of(before.speed));
        const double tolerance = 3e-7 + 6e-7 / (0.5 * (speed + slowest));
        TEST_ASSERT_DOUBLE_WITHIN(tolerance, t, time_s(&before, (float)way));
        TEST_ASSERT_DOUBLE_WITHIN(1e-6 / speed, speed,
                                  speed_of(saddle_profile_speed_after(&before, (float)way)));
    }
}

static void test_distance_beyond_a_stop_is_never_reached(void)
{
    profile = profile_of(0.5f, 0.0f, 0.5f); /* stops after 0.25 m */
    ASSERT_SAME_FLOAT(SADDLE_TIME_MAX_S, time_s(&profile, 0.26f));
    TEST_ASSERT_TRUE(saddle_profile_speed_after(&profile, 0.26f) == 0);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 1.0, time_s(&profile, 0.25f));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_advance_is_the_closed_form_targets_inside_the_interval_or_not);
    RUN_TEST(test_constant_speed_is_exact_in_any_ticks);
    RUN_TEST(test_no_rate_keeps_the_speed_and_no_speed_keeps_the_place);
    RUN_TEST(test_from_rest_and_at_no_rate_everything_stays_a_number);
    RUN_TEST(test_time_is_the_inverse_of_advance);
    RUN_TEST(test_distance_beyond_a_stop_is_never_reached);
    return UNITY_END();
}
