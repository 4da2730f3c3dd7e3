/** The CoM in the transverse plane against eq:01 and its derivative in double precision. */
#include "core_test.h"

#include <saddlewalk/com_path.h>

static saddle_config_t config;

void setUp(void) { config = paper_config(); }

void tearDown(void) {}

static const float SPEEDS[] = {0.01f, 0.3f, 0.7f, 1.0f, 1.2f, 1.6f, 1.9f};

static void test_path_is_the_equation_s(void)
{
    for (size_t i = 0; i < COUNT_OF(SPEEDS); i++) {
        const saddle_gait_t gait = saddle_gait(&config, SPEEDS[i]);
        const double step_time = (double)gait.step_length_m / (double)gait.speed_m_s;
        for (int k = -100; k <= 100; k++) {
            const double t = 0.005 * k * step_time; /* from the foot via point */
            const float phase = (float)(PI * t / step_time);
            for (int side = SADDLE_LEFT; side <= SADDLE_RIGHT; side++) {
                const double sign = side == SADDLE_LEFT ? 1.0 : -1.0;
                const double rate = PI / step_time;
                const double amplitude = sign * (double)gait.lateral_amplitude_m;
                const saddle_com_path_t path = saddle_com_path(&gait, (saddle_side_t)side, phase);
                TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, (double)gait.speed_m_s * t,
                                          path.position_m.x);
                TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, amplitude * cos(rate * t),
                                          path.position_m.y);
                ASSERT_SAME_FLOAT(gait.speed_m_s, path.velocity_m_s.x);
                TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, -amplitude * rate * sin(rate * t),
                                          path.velocity_m_s.y);
            }
        }
    }
}

static void test_via_points(void)
{
    const saddle_gait_t gait = saddle_gait(&config, 1.2f);
    const saddle_com_path_t foot = saddle_com_path(&gait, SADDLE_RIGHT, 0.0f);
    ASSERT_SAME_FLOAT(0.0f, foot.position_m.x);
    ASSERT_SAME_FLOAT(-gait.lateral_amplitude_m, foot.position_m.y);
    const saddle_com_path_t saddle = saddle_com_path(&gait, SADDLE_LEFT, 1.57079633f);
    ASSERT_SAME_FLOAT(0.5f * gait.step_length_m, saddle.position_m.x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, 0.0, saddle.position_m.y); /* cos(pi/2) is off by 9e-8 x A_y */
    TEST_ASSERT_TRUE(saddle.velocity_m_s.y < 0.0f);            /* from the left foot to the right */
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_path_is_the_equation_s);
    RUN_TEST(test_via_points);
    return UNITY_END();
}
