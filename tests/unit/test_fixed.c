/** Fixed point against integers and doubles, to the ends of its range. */
#include "core_test.h"

#include "math/fixed.h"

/* 2^42: units of speed in 1 m/s, of position in 1 um. */
static const double UNITS = 4398046511104.0;

void setUp(void) {}

void tearDown(void) {}

static double metres(saddle_fixed_t position)
{
    return (double)position / (1e6 * UNITS);
}

static void test_speed_is_exact_to_its_unit(void)
{
    uint32_t state = 5;
    for (int i = 0; i < 100000; i++) {
        const float value =
            random_in(&state, -4.0f, 4.0f) / (float)(1u << (random_bits(&state) % 24u));
        const saddle_fixed_t speed = saddle_speed_from_m_s(value);
        TEST_ASSERT_DOUBLE_WITHIN(1.0, (double)value * UNITS, (double)speed);
        TEST_ASSERT_DOUBLE_WITHIN(1.9e-9 + 6e-8 * fabs((double)value), (double)value,
                                  saddle_speed_to_m_s(speed));
        TEST_ASSERT_TRUE(saddle_speed_from_m_s(-value) == -speed);
    }
    TEST_ASSERT_TRUE(saddle_speed_from_m_s(1.5f) == (saddle_fixed_t)(1.5 * UNITS));
    TEST_ASSERT_TRUE(saddle_speed_from_m_s(0.0f) == 0);
    const float fastest = nextafterf(4.0f, 0.0f);
    ASSERT_SAME_FLOAT(fastest, saddle_speed_to_m_s(saddle_speed_from_m_s(fastest)));
    ASSERT_SAME_FLOAT(-fastest, saddle_speed_to_m_s(saddle_speed_from_m_s(-fastest)));
}

static void test_position_is_exact_to_a_picometre(void)
{
    uint32_t state = 6;
    for (int i = 0; i < 100000; i++) {
        const float value =
            random_in(&state, -2.0f, 2.0f) / (float)(1u << (random_bits(&state) % 24u));
        const saddle_fixed_t position = saddle_position_from_m(value);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, (double)value, metres(position));
        /* Three roundings: of the integer, of the unit and of their product. */
        TEST_ASSERT_DOUBLE_WITHIN(1e-9 + 1.8e-7 * fabs((double)value), (double)value,
                                  saddle_position_to_m(position));
        TEST_ASSERT_TRUE(saddle_position_from_m(-value) == -position);
    }
    const float furthest = nextafterf(2.0f, 0.0f);
    TEST_ASSERT_DOUBLE_WITHIN(2.4e-7, (double)furthest,
                              saddle_position_to_m(saddle_position_from_m(furthest)));
    TEST_ASSERT_DOUBLE_WITHIN(2.4e-7, -(double)furthest,
                              saddle_position_to_m(saddle_position_from_m(-furthest)));
}

static void test_nanometres_are_the_nearest(void)
{
    uint32_t state = 7;
    for (int i = 0; i < 100000; i++) {
        const float value = random_in(&state, 0.0f, 2.0f);
        const double nm = 1e9 * metres(saddle_position_from_m(value));
        TEST_ASSERT_DOUBLE_WITHIN(0.5 + 1e-3, nm,
                                  (double)saddle_position_to_nm(saddle_position_from_m(value)));
    }
    const saddle_fixed_t nanometre = (saddle_fixed_t)(1e-3 * UNITS);
    TEST_ASSERT_TRUE(saddle_position_to_nm(49 * nanometre / 100) == 0);
    TEST_ASSERT_TRUE(saddle_position_to_nm(51 * nanometre / 100) == 1);
    TEST_ASSERT_TRUE(saddle_position_to_nm(1000000 * nanometre) == 1000000);
}

static void test_distance_is_speed_times_time(void)
{
    uint32_t state = 8;
    for (int i = 0; i < 100000; i++) {
        const float speed = random_in(&state, 0.0f, 4.0f);
        const float time = random_in(&state, 0.0f, fminf(2.0f, 1.99f / speed));
        const double way =
            metres(saddle_distance(saddle_speed_from_m_s(speed), saddle_time_from_s(time)));
        /* Time is counted in 2^-31 s, the way to 2^-41 m. */
        TEST_ASSERT_DOUBLE_WITHIN(5e-10 * (double)speed + 1e-12, (double)speed * (double)time, way);
    }
}

static void test_angle_is_curvature_times_way(void)
{
    uint32_t state = 12;
    for (int i = 0; i < 100000; i++) {
        const float curvature = random_in(&state, -3.9f, 3.9f);
        const int64_t nm = (int64_t)(random_bits(&state) % 2000000000u);
        const double expected = (double)curvature * (1e-9 * (double)nm);
        const double angle = (double)saddle_angle(saddle_speed_from_m_s(curvature), nm) / UNITS;
        TEST_ASSERT_DOUBLE_WITHIN(1e-12 + 2e-9 * fabs((double)curvature), expected, angle);
    }
    TEST_ASSERT_TRUE(saddle_angle(saddle_speed_from_m_s(1.0f), -5) == 0);
    TEST_ASSERT_TRUE(saddle_angle(saddle_speed_from_m_s(1.0f), 3000000000) ==
                     saddle_angle(saddle_speed_from_m_s(1.0f), 1999999999));
}

static void test_sum_of_angles_stays_within_half_a_turn(void)
{
    const double pi = 3.14159265358979323846;
    uint32_t state = 13;
    for (int i = 0; i < 100000; i++) {
        const float a = random_in(&state, -3.14159f, 3.14159f);
        const float b = random_in(&state, -3.14159f, 3.14159f);
        const double sum =
            (double)saddle_angle_sum(saddle_speed_from_m_s(a), saddle_speed_from_m_s(b)) / UNITS;
        TEST_ASSERT_TRUE(fabs(sum) <= pi + 1e-12);
        TEST_ASSERT_DOUBLE_WITHIN(1e-11, 0.0, remainder((double)a + (double)b - sum, 2.0 * pi));
    }
    const saddle_fixed_t half_turn = saddle_speed_from_m_s(3.2f); /* limited */
    TEST_ASSERT_TRUE(saddle_angle_sum(half_turn, 0) > 0 && saddle_angle_sum(-half_turn, 0) < 0);
}

static void test_share_of_a_length(void)
{
    uint32_t state = 14;
    for (int i = 0; i < 100000; i++) {
        const float factor = random_in(&state, -1.0f, 1.0f);
        const int64_t nm = (int64_t)(random_bits(&state) % 2000000000u) - 1000000000;
        TEST_ASSERT_DOUBLE_WITHIN(2.0, (double)factor * (double)nm,
                                  (double)saddle_share_nm(nm, factor));
    }
    TEST_ASSERT_TRUE(saddle_share_nm(1234567890, 1.0f) == 1234567890);
    TEST_ASSERT_TRUE(saddle_share_nm(-1234567890, 1.0f) == -1234567890);
    TEST_ASSERT_TRUE(saddle_share_nm(1234567890, 2.0f) == 1234567890);
}

static void test_change_is_rate_times_time(void)
{
    uint32_t state = 9;
    for (int i = 0; i < 100000; i++) {
        const float wanted =
            random_in(&state, -15.9f, 15.9f) / (float)(1u << (random_bits(&state) % 8u));
        const float rate = (float)(int32_t)(wanted * 134217728.0f) / 134217728.0f;
        const uint32_t dt_us = random_bits(&state) % 10000001u;
        const double expected = (double)rate * dt_us * 1e-6;
        TEST_ASSERT_DOUBLE_WITHIN(5e-13 + 2e-10 * fabs(expected), expected,
                                  (double)saddle_speed_change(rate, dt_us) / UNITS);
    }
    TEST_ASSERT_TRUE(saddle_speed_change(0.5f, 0) == 0);
    TEST_ASSERT_TRUE(saddle_speed_change(0.0f, 80000) == 0);
}

/* Numbers of any bits: an answer within the range, and nothing that C leaves undefined, which the
 * sanitizers of make test-sanitize see. */
static void test_any_bits_give_a_number_within_the_range(void)
{
    static const float speeds[] = {4.0f, 1e9f, HUGE_VALF, NAN, 2147483648.0f};
    const saddle_fixed_t position_max = saddle_position_from_m(2.0f);
    const saddle_fixed_t speed_max = saddle_speed_from_m_s(4.0f);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 2.0, metres(position_max));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 4.0, (double)speed_max / UNITS);
    for (size_t i = 0; i < COUNT_OF(speeds); i++) {
        const bool number = speeds[i] == speeds[i];
        TEST_ASSERT_TRUE(saddle_speed_from_m_s(speeds[i]) == (number ? speed_max : 0));
        TEST_ASSERT_TRUE(saddle_speed_from_m_s(-speeds[i]) == (number ? -speed_max : 0));
        TEST_ASSERT_TRUE(saddle_position_from_m(speeds[i]) == (number ? position_max : 0));
    }
    uint32_t state = 11;
    for (int i = 0; i < 100000; i++) {
        const float value = float_of_bits(random_bits(&state));
        const int64_t bits =
            (int64_t)random_bits(&state) * 2147483648 + (int64_t)random_bits(&state);
        const saddle_fixed_t any = random_bits(&state) % 2u == 0u ? bits : -bits;
        const uint32_t dt_us = random_bits(&state);
        const saddle_fixed_t position = saddle_position_from_m(value);
        const saddle_fixed_t speed = saddle_speed_from_m_s(value);
        TEST_ASSERT_TRUE(position >= -position_max && position <= position_max);
        TEST_ASSERT_TRUE(speed >= -speed_max && speed <= speed_max);
        const saddle_fixed_t way = saddle_distance(any, saddle_time_from_s(value));
        TEST_ASSERT_TRUE(way >= -position_max && way <= position_max);
        const saddle_fixed_t sum = saddle_position_sum(any, position);
        TEST_ASSERT_TRUE(sum >= -position_max && sum <= position_max);
        const double change = (double)saddle_speed_change(value, dt_us) / UNITS;
        TEST_ASSERT_TRUE(fabs(change) <= 160.0);
        TEST_ASSERT_TRUE(fabsf(saddle_position_to_m(any)) <= 2.1f);
        TEST_ASSERT_TRUE(fabsf(saddle_speed_to_m_s(any)) <= 4.0f);
        (void)saddle_position_to_nm(any);
        (void)saddle_angle(any, any);
        (void)saddle_angle_sum(any, speed);
        (void)saddle_share_nm(any, value);
    }
}

static void test_ends_of_the_range(void)
{
    const uint32_t second = saddle_time_from_s(1.0f);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 4.0, saddle_speed_to_m_s(INT64_MAX));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -4.0, saddle_speed_to_m_s(INT64_MIN));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 2.0, metres(saddle_distance(INT64_MAX, second)));
    TEST_ASSERT_TRUE(saddle_distance(0, second) == 0);
    TEST_ASSERT_TRUE(saddle_distance(-1, second) == 0);
    TEST_ASSERT_EQUAL_UINT32(0, saddle_time_from_s(-1.0f));
    TEST_ASSERT_TRUE(saddle_speed_change(1.0f, UINT32_MAX) == saddle_speed_change(1.0f, 10000000u));
    const saddle_fixed_t speed_max = saddle_speed_from_m_s(4.0f);
    TEST_ASSERT_TRUE(saddle_speed_sum(speed_max, speed_max) == speed_max);
    TEST_ASSERT_TRUE(saddle_speed_sum(-speed_max, -speed_max) == -speed_max);
    const saddle_fixed_t max = saddle_position_from_m(2.0f);
    TEST_ASSERT_TRUE(saddle_position_sum(max, 1) == max);
    TEST_ASSERT_TRUE(saddle_position_sum(-max, -1) == -max);
    TEST_ASSERT_TRUE(saddle_position_sum(max - 2, 1) == max - 1);
    TEST_ASSERT_TRUE(saddle_position_sum(2 - max, -1) == 1 - max);
    TEST_ASSERT_TRUE(saddle_position_sum(max, INT64_MIN) == 0);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_speed_is_exact_to_its_unit);
    RUN_TEST(test_position_is_exact_to_a_picometre);
    RUN_TEST(test_nanometres_are_the_nearest);
    RUN_TEST(test_distance_is_speed_times_time);
    RUN_TEST(test_angle_is_curvature_times_way);
    RUN_TEST(test_sum_of_angles_stays_within_half_a_turn);
    RUN_TEST(test_share_of_a_length);
    RUN_TEST(test_change_is_rate_times_time);
    RUN_TEST(test_any_bits_give_a_number_within_the_range);
    RUN_TEST(test_ends_of_the_range);
    return UNITY_END();
}
