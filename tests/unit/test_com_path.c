/** The CoM in the transverse plane against eq:01 and its derivative in double precision. */
#include "core_test.h"

#include "math/elementary.h"
#include "model/gait_model.h"
#include "motion/com_path.h"

static saddle_config_t config;

void setUp(void)
{
    config = paper_config();
}

void tearDown(void) {}

static const float SPEEDS[] = {0.01f, 0.3f, 0.7f, 1.0f, 1.2f, 1.6f, 1.9f};

static saddle_quarter_t quarter_at(float speed, saddle_side_t stance)
{
    const float length = (float)(0.1802 * (double)speed + 0.1351);
    return saddle_quarter(model_of(&config), stance, length,
                          saddle_step_width_m(model_of(&config), speed), speed);
}

static void test_path_is_the_equation_s(void)
{
    for (size_t i = 0; i < COUNT_OF(SPEEDS); i++) {
        for (int side = SADDLE_LEFT; side <= SADDLE_RIGHT; side++) {
            const saddle_quarter_t quarter = quarter_at(SPEEDS[i], (saddle_side_t)side);
            const double sign = side == SADDLE_LEFT ? 1.0 : -1.0;
            const double rate = 0.5 * PI / (double)quarter.length_m;
            const double amplitude = sign * (double)quarter.amplitude_m;
            for (int k = -100; k <= 100; k++) {
                const double x = 0.01 * k * (double)quarter.length_m;
                const saddle_sin_cos_t phase = saddle_quarter_phase(&quarter, (float)x);
                const saddle_sample_t lateral = saddle_com_lateral(&quarter, phase);
                const double stance_y = 0.5 * sign * (double)quarter.width_m;
                TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, sin(rate * x), phase.sin);
                TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, cos(rate * x), phase.cos);
                TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, amplitude * cos(rate * x) - stance_y,
                                          lateral.value);
                TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, -amplitude * rate * sin(rate * x),
                                          lateral.slope);
            }
        }
    }
}

static void test_via_points(void)
{
    const saddle_quarter_t left = quarter_at(1.2f, SADDLE_LEFT);
    const saddle_sample_t foot = saddle_com_lateral(&left, SADDLE_PHASE_FOOT);
    ASSERT_SAME_FLOAT(left.amplitude_m - 0.5f * left.width_m, foot.value);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, foot.slope);
    const saddle_sample_t saddle = saddle_com_lateral(&left, SADDLE_PHASE_LANDING);
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, -0.05, saddle.value); /* on the walking line */
    TEST_ASSERT_TRUE(saddle.slope < 0.0f);                /* from the left foot to the right */
}

static void test_phase_ends_with_the_quarter_and_is_known_at_via_points(void)
{
    const saddle_quarter_t quarter = quarter_at(1.2f, SADDLE_LEFT);
    const struct {
        float share;
        saddle_sin_cos_t phase;
    } table[] = {{0.0f, SADDLE_PHASE_FOOT},
                 {1.0f, SADDLE_PHASE_LANDING},
                 {2.0f, SADDLE_PHASE_LANDING},
                 {-1.0f, SADDLE_PHASE_LANDED},
                 {-1.01f, SADDLE_PHASE_LANDED}};
    for (size_t i = 0; i < COUNT_OF(table); i++) {
        const saddle_sin_cos_t phase =
            saddle_quarter_phase(&quarter, table[i].share * quarter.length_m);
        ASSERT_SAME_FLOAT(table[i].phase.sin, phase.sin);
        ASSERT_SAME_FLOAT(table[i].phase.cos, phase.cos);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_path_is_the_equation_s);
    RUN_TEST(test_via_points);
    RUN_TEST(test_phase_ends_with_the_quarter_and_is_known_at_via_points);
    return UNITY_END();
}
