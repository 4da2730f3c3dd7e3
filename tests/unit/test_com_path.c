/** The CoM's path, the paper's and a person's, against the equations and their derivatives in double
 *  precision. */
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

static void test_path_follows_the_equation(void)
{
    for (size_t i = 0; i < COUNT_OF(SPEEDS); i++) {
        for (int side = SADDLE_LEFT; side <= SADDLE_RIGHT; side++) {
            const saddle_quarter_t quarter = quarter_at(SPEEDS[i], (saddle_side_t)side);
            const double sign = side == SADDLE_LEFT ? 1.0 : -1.0;
            const double rate = 0.5 * PI / (double)quarter.length_m;
            const double amplitude = sign * (double)quarter.amplitude_m;
            for (int k = -100; k <= 100; k++) {
                const double x = 0.01 * k * (double)quarter.length_m;
                const saddle_sin_cos_t phase = saddle_quarter_phase(quarter.length_m, (float)x);
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
            saddle_quarter_phase(quarter.length_m, table[i].share * quarter.length_m);
        ASSERT_SAME_FLOAT(table[i].phase.sin, phase.sin);
        ASSERT_SAME_FLOAT(table[i].phase.cos, phase.cos);
    }
}

static const struct {
    float lateral_m, lateral_rad, vertical_m, vertical_rad;
} SHAPES[] = {{0.0f, 0.0f, 0.0f, 0.0f},
              {0.012f, 0.18f, -0.008f, 0.19f},
              {-0.1f, -1.5f, 0.1f, 1.5f},
              {0.03f, 0.6f, 0.02f, -0.9f}};

static const saddle_shape_t *shape_at(size_t i)
{
    config.lateral_offset_m = SHAPES[i].lateral_m;
    config.lateral_delay_rad = SHAPES[i].lateral_rad;
    config.vertical_offset_m = SHAPES[i].vertical_m;
    config.vertical_delay_rad = SHAPES[i].vertical_rad;
    return &model_of(&config)->body.shape;
}

/* y = c +- A cos(angle - delay), from midway between the feet. */
static void test_sway_of_a_person_is_offset_and_late(void)
{
    for (size_t i = 0; i < COUNT_OF(SHAPES); i++) {
        for (int side = SADDLE_LEFT; side <= SADDLE_RIGHT; side++) {
            const saddle_quarter_t quarter = quarter_at(1.2f, (saddle_side_t)side);
            const saddle_shape_t *shape = shape_at(i);
            const double sign = side == SADDLE_LEFT ? 1.0 : -1.0;
            const double amplitude = sign * (double)quarter.amplitude_m;
            const double middle = -0.5 * sign * (double)quarter.width_m;
            for (int k = -20; k <= 20; k++) {
                const double angle = 0.025 * PI * k;
                const double late = angle - (double)SHAPES[i].lateral_rad;
                const saddle_sample_t lateral =
                    saddle_shaped_lateral(&quarter, shape, saddle_sin_cos((float)angle));
                TEST_ASSERT_DOUBLE_WITHIN(
                    FLOAT_TOLERANCE, middle + (double)SHAPES[i].lateral_m + amplitude * cos(late),
                    lateral.value);
                TEST_ASSERT_DOUBLE_WITHIN(
                    FLOAT_TOLERANCE, -amplitude * sin(late) * 0.5 * PI / (double)quarter.length_m,
                    lateral.slope);
            }
        }
    }
}

/* z = mean + dZ / 2 cos(2 angle - delay), the human amplitude; without offset and delay highest at the
 * foot via point, where the pendulum has it. */
static void test_height_has_the_human_amplitude_offset_and_late(void)
{
    for (size_t i = 0; i < COUNT_OF(SHAPES); i++) {
        for (float speed = 0.05f; speed < 1.93f; speed += 0.05f) {
            const saddle_quarter_t quarter = quarter_at(speed, SADDLE_LEFT);
            const saddle_shape_t *shape = shape_at(i);
            const double gap = 0.5 * (double)quarter.width_m - (double)quarter.amplitude_m;
            const double excursion = 0.02656 * (double)speed + 0.002575;
            const double mean = sqrt(pow(0.57 * 1.79, 2) - gap * gap) - 0.5 * excursion +
                                (double)SHAPES[i].vertical_m;
            for (int k = -20; k <= 20; k++) {
                const double angle = 0.025 * PI * k;
                const double late = 2.0 * angle - (double)SHAPES[i].vertical_rad;
                const saddle_sample_t height = saddle_shaped_height(&quarter, shape, 0.57f * 1.79f,
                                                                    saddle_sin_cos((float)angle));
                TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, mean + 0.5 * excursion * cos(late),
                                          height.value);
                TEST_ASSERT_DOUBLE_WITHIN(
                    FLOAT_TOLERANCE, -excursion * sin(late) * 0.5 * PI / (double)quarter.length_m,
                    height.slope);
            }
        }
    }
}

static void test_default_shape_is_the_papers_bit_for_bit(void)
{
    const saddle_quarter_t quarter = quarter_at(1.2f, SADDLE_RIGHT);
    const saddle_model_t *model = model_of(&config);
    for (int k = -100; k <= 100; k++) {
        const saddle_sin_cos_t phase =
            saddle_quarter_phase(quarter.length_m, 0.01f * (float)k * quarter.length_m);
        const saddle_sample_t paper = saddle_com_lateral(&quarter, phase);
        for (int last_swing = 0; last_swing <= 1; last_swing++) {
            const saddle_sample_t person =
                saddle_shaped_lateral(&quarter, saddle_shape(model, last_swing != 0), phase);
            ASSERT_SAME_FLOAT(paper.value, person.value);
            ASSERT_SAME_FLOAT(paper.slope, person.slope);
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_path_follows_the_equation);
    RUN_TEST(test_via_points);
    RUN_TEST(test_phase_ends_with_the_quarter_and_is_known_at_via_points);
    RUN_TEST(test_sway_of_a_person_is_offset_and_late);
    RUN_TEST(test_height_has_the_human_amplitude_offset_and_late);
    RUN_TEST(test_default_shape_is_the_papers_bit_for_bit);
    return UNITY_END();
}
