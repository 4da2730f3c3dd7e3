/** The swing foot: on the line through stance CoP and CoM, with a bump of minimum jerk. */
#include "core_test.h"

#include <saddlewalk/foot_swing.h>

static const float CLEARANCE_M = 0.05f;

void setUp(void) {}

void tearDown(void) {}

static saddle_swing_t swing_at(float com_x, float com_y, float progress)
{
    const saddle_vec2_t stance = {0.0f, 0.05f};
    const saddle_vec2_t com = {com_x, com_y};
    const saddle_vec2_t velocity = {1.2f, -0.1f};
    return saddle_foot_swing(stance, com, velocity, -0.05f, progress, 1.7f, CLEARANCE_M);
}

static void test_foot_lies_on_the_line_through_stance_and_com(void)
{
    uint32_t state = 3;
    for (int i = 0; i < 2000; i++) {
        const saddle_vec2_t stance = {random_in(&state, -1.0f, 1.0f), random_in(&state, 0.1f, 0.2f)};
        const saddle_vec2_t com = {random_in(&state, -1.0f, 1.0f), random_in(&state, -0.02f, 0.02f)};
        const float line_y = random_in(&state, -0.2f, -0.1f);
        const saddle_vec2_t at_rest = {0.0f, 0.0f};
        const saddle_swing_t swing =
            saddle_foot_swing(stance, com, at_rest, line_y, 0.5f, 1.0f, CLEARANCE_M);
        const double share = ((double)line_y - (double)stance.y) / ((double)com.y - (double)stance.y);
        const double x = (double)stance.x + share * ((double)com.x - (double)stance.x);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, x, swing.position_m.x); /* up to 11 m: float steps 1e-6 */
        ASSERT_SAME_FLOAT(line_y, swing.position_m.y);
        TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, swing.velocity_m_s.x);
    }
}

static void test_foot_passes_behind_beside_and_ahead(void)
{
    const float step_m = 0.7f;
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, -0.7, swing_at(-0.5f * step_m, 0, 0).position_m.x);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.0, swing_at(0, 0.013f, 0.5f).position_m.x);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.7, swing_at(0.5f * step_m, 0, 1).position_m.x);
}

static void test_horizontal_velocity_is_the_derivative(void)
{
    for (int i = -10; i <= 10; i++) {
        const double x = 0.03 * i;
        const double y = 0.0013 * (10.0 - fabs((double)i));
        const double h = 1e-6;
        const double ahead = -0.1 * (x + 1.2 * h) / (y - 0.1 * h - 0.05);
        const double behind = -0.1 * (x - 1.2 * h) / (y + 0.1 * h - 0.05);
        const saddle_swing_t swing = swing_at((float)x, (float)y, 0.3f);
        TEST_ASSERT_DOUBLE_WITHIN(5e-6, (ahead - behind) / (2 * h), swing.velocity_m_s.x); /* 5 m/s */
        ASSERT_SAME_FLOAT(0.0f, swing.velocity_m_s.y);
    }
}

static double bump(double progress)
{
    const double s = 2.0 * fmin(progress, 1.0 - progress);
    return 0.05 * (10.0 * pow(s, 3) - 15.0 * pow(s, 4) + 6.0 * pow(s, 5));
}

static void test_height_is_the_bump_and_its_velocity_the_derivative(void)
{
    for (int i = 1; i < 1000; i++) {
        const double p = 0.001 * i;
        const double h = 1e-6;
        const saddle_swing_t swing = swing_at(0.1f, 0.01f, (float)p);
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, bump(p), swing.position_m.z); /* 5 cm: steps of 4e-9 */
        const double rate = 1.7 * (bump(p + h) - bump(p - h)) / (2 * h);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, rate, swing.velocity_m_s.z);
    }
}

static void test_foot_leaves_and_lands_at_rest_on_the_ground(void)
{
    const float ends[] = {0.0f, 1.0f};
    for (size_t i = 0; i < COUNT_OF(ends); i++) {
        const saddle_swing_t swing = swing_at(0.1f, 0.01f, ends[i]);
        TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, swing.position_m.z);
        TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, swing.velocity_m_s.z);
    }
    ASSERT_SAME_FLOAT(CLEARANCE_M, swing_at(0.1f, 0.01f, 0.5f).position_m.z);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, swing_at(0.1f, 0.01f, 0.5f).velocity_m_s.z);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_foot_lies_on_the_line_through_stance_and_com);
    RUN_TEST(test_foot_passes_behind_beside_and_ahead);
    RUN_TEST(test_horizontal_velocity_is_the_derivative);
    RUN_TEST(test_height_is_the_bump_and_its_velocity_the_derivative);
    RUN_TEST(test_foot_leaves_and_lands_at_rest_on_the_ground);
    return UNITY_END();
}
