/** The swing foot: on the line through stance CoP and CoM, fading in from where it lifted off. */
#include "core_test.h"

#include "motion/foot_swing.h"

static saddle_swing_t swing;

static saddle_swing_state_t foot_at(const saddle_swing_t *line, float progress, float x_m,
                                    saddle_sample_t lateral, float speed_m_s, float rate_hz)
{
    saddle_swing_state_t foot;
    const saddle_swing_place_t place = {progress, rate_hz, speed_m_s,
                                        saddle_swing_line(line, x_m, lateral), 0.7f};
    saddle_foot_swing(line, &place, &foot);
    return foot;
}

void setUp(void)
{
    swing = (saddle_swing_t){.lift_progress = 0.0f,
                             .land_progress = 1.0f,
                             .line_y_m = -0.1f,
                             .clearance_m = 0.05f,
                             .path_width_m = 0.1f};
}

void tearDown(void) {}

static void test_foot_lies_on_the_line_through_stance_and_com(void)
{
    uint32_t state = 3;
    for (int i = 0; i < 2000; i++) {
        const float x = random_in(&state, -1.0f, 1.0f);
        const saddle_sample_t lateral = {random_in(&state, -0.1f, -0.02f), 0.0f};
        swing.line_y_m = random_in(&state, -0.3f, -0.15f);
        swing.path_width_m = -swing.line_y_m;
        const saddle_swing_state_t foot = foot_at(&swing, 0.5f, x, lateral, 0.0f, 1.0f);
        const double expected = (double)swing.line_y_m * (double)x / (double)lateral.value;
        TEST_ASSERT_DOUBLE_WITHIN(2e-6, expected,
                                  foot.position_m.x); /* up to 15 m: steps of 1e-6 */
        ASSERT_SAME_FLOAT(swing.line_y_m, foot.position_m.y);
        TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, foot.velocity_m_s.x);
    }
}

static void test_foot_passes_behind_beside_and_ahead(void)
{
    const saddle_sample_t midway = {-0.05f, 0.0f};
    const saddle_sample_t beside = {-0.037f, 0.0f};
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, -0.7,
                              saddle_swing_line(&swing, -0.35f, midway).value);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, saddle_swing_line(&swing, 0.0f, beside).value);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.7, saddle_swing_line(&swing, 0.35f, midway).value);
}

/* After a narrow step the foot goes to a wide line without running behind where it stood. */
static void test_foot_follows_the_path_s_width_to_any_line(void)
{
    const saddle_sample_t midway = {-0.05f, 0.0f};
    for (int side = -1; side <= 1; side += 2) {
        const saddle_sample_t lateral = {(float)-side * midway.value, 0.0f};
        swing.line_y_m = (float)side * 0.4f;
        TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, -0.7,
                                  saddle_swing_line(&swing, -0.35f, lateral).value);
    }
}

static void test_slope_of_the_line_is_its_derivative(void)
{
    for (int i = -10; i <= 10; i++) {
        const double x = 0.03 * i;
        const double y = -0.05 + 0.0013 * (10.0 - fabs((double)i));
        const double slope = -0.08;
        const double h = 1e-6;
        const double ahead = -0.1 * (x + h) / (y + slope * h);
        const double behind = -0.1 * (x - h) / (y - slope * h);
        const saddle_sample_t lateral = {(float)y, (float)slope};
        TEST_ASSERT_DOUBLE_WITHIN(5e-6, (ahead - behind) / (2 * h),
                                  saddle_swing_line(&swing, (float)x, lateral).slope); /* up to 4 */
    }
}

static double min_jerk(double s)
{
    const double in = fmin(fmax(s, 0.0), 1.0);
    return 10.0 * pow(in, 3) - 15.0 * pow(in, 4) + 6.0 * pow(in, 5);
}

/* Position in double at a progress, for a CoM that moves at 1.2 m/s and 1.7 quarters a second. */
static void expected_at(double progress, double at[3])
{
    const double duration = (double)swing.land_progress - (double)swing.lift_progress;
    const double air = fmin(fmax((progress - (double)swing.lift_progress) / duration, 0.0), 1.0);
    const double fade = 1.0 - min_jerk(2.0 * air);
    const double x = 1.2 * (progress - 0.4) / 1.7;
    const double y = -0.04 - 0.02 * x;
    at[0] = (double)swing.line_y_m * x / y + (double)swing.offset_m.x * fade;
    at[1] = (double)swing.line_y_m + (double)swing.offset_m.y * fade;
    at[2] = (double)swing.clearance_m * min_jerk(2.0 * fmin(air, 1.0 - air));
}

static void test_swing_and_its_velocity_whole_and_half(void)
{
    static const float ends[][2] = {{0.0f, 1.0f}, {0.5f, 1.0f}, {0.0f, 0.5f}};
    swing.offset_m = (saddle_vec2_t){-0.08f, 0.03f};
    for (size_t i = 0; i < COUNT_OF(ends); i++) {
        swing.lift_progress = ends[i][0];
        swing.land_progress = ends[i][1];
        for (int k = 1; k < 500; k++) {
            const double h = 1e-6;
            const double p = (double)ends[i][0] + 0.002 * k * (double)(ends[i][1] - ends[i][0]);
            double at[3];
            double ahead[3];
            double behind[3];
            expected_at(p, at);
            expected_at(p + h, ahead);
            expected_at(p - h, behind);
            const double x = 1.2 * (p - 0.4) / 1.7;
            const saddle_sample_t lateral = {(float)(-0.04 - 0.02 * x), -0.02f};
            const saddle_swing_state_t foot =
                foot_at(&swing, (float)p, (float)x, lateral, 1.2f, 1.7f);
            const float position[] = {foot.position_m.x, foot.position_m.y, foot.position_m.z};
            const float velocity[] = {foot.velocity_m_s.x, foot.velocity_m_s.y,
                                      foot.velocity_m_s.z};
            for (int axis = 0; axis < 3; axis++) {
                TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, at[axis], position[axis]);
                TEST_ASSERT_DOUBLE_WITHIN(6e-6, 1.7 * (ahead[axis] - behind[axis]) / (2 * h),
                                          velocity[axis]); /* up to 4 m/s, float progress */
            }
        }
    }
}

static void test_foot_leaves_where_it_stood_and_lands_on_the_line_both_at_rest(void)
{
    const saddle_sample_t lateral = {-0.05f, 0.0f};
    swing.offset_m = (saddle_vec2_t){-0.08f, 0.03f};
    const saddle_swing_state_t lift = foot_at(&swing, 0.0f, -0.35f, lateral, 0.0f, 1.7f);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, -0.78, lift.position_m.x);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, -0.07, lift.position_m.y);
    const saddle_swing_state_t land = foot_at(&swing, 1.0f, 0.35f, lateral, 0.0f, 1.7f);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.7, land.position_m.x);
    ASSERT_SAME_FLOAT(swing.line_y_m, land.position_m.y);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, lift.position_m.z);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, land.position_m.z);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, lift.velocity_m_s.z);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, land.velocity_m_s.z);
    ASSERT_SAME_FLOAT(swing.clearance_m,
                      foot_at(&swing, 0.5f, 0.0f, lateral, 0.0f, 1.7f).position_m.z);
}

static const struct {
    double begin, end, skew;
} WAYS[] = {
    {-0.32, 1.04, 1.47}, {0.0, 1.0, 1.0}, {-1.0, 2.0, 4.0}, {0.4, 0.6, 0.3}, {0.15, 1.2, 0.9}};

static saddle_swing_profile_t profile_of(size_t i)
{
    saddle_config_t config = paper_config();
    config.swing_begin = (float)WAYS[i].begin;
    config.swing_end = (float)WAYS[i].end;
    config.swing_skew = (float)WAYS[i].skew;
    TEST_ASSERT_NULL(saddle_config_check(&config));
    return model_of(&config)->body.swing;
}

static double share_at(size_t i, double progress)
{
    const double length = WAYS[i].end - WAYS[i].begin;
    const double s = fmin(fmax((progress - WAYS[i].begin) / length, 0.0), 1.0);
    return min_jerk(pow(s, WAYS[i].skew));
}

static void test_share_of_a_person_s_way_and_its_slope(void)
{
    for (size_t i = 0; i < COUNT_OF(WAYS); i++) {
        const saddle_swing_profile_t profile = profile_of(i);
        for (int k = 0; k <= 1000; k++) {
            const double p = 0.001 * k;
            const double h = 1e-6;
            const double slope = (share_at(i, p + h) - share_at(i, p - h)) / (2.0 * h);
            const saddle_jerk_t share = saddle_swing_share(&profile, (float)p);
            /* Float progress, on a slope of up to 20 in a way that begins late. */
            TEST_ASSERT_DOUBLE_WITHIN(5e-6, share_at(i, p) / share_at(i, 1.0), share.value);
            if (fabs(p - WAYS[i].begin) > 0.01 && fabs(p - WAYS[i].end) > 0.01) {
                TEST_ASSERT_DOUBLE_WITHIN(1e-3, slope / share_at(i, 1.0), share.slope);
            }
        }
        TEST_ASSERT_DOUBLE_WITHIN(1.2e-7, 1.0, saddle_swing_share(&profile, 1.0f).value);
    }
}

/* What the new step's length changes at the foot via point fades out until the landing. */
static void test_stretch_fades_out_in_the_second_half(void)
{
    const saddle_sample_t beside = {-0.037f, 0.0f};
    swing.stretch_m = 0.02f;
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.02,
                              foot_at(&swing, 0.5f, 0.0f, beside, 0.0f, 1.7f).position_m.x);
    for (int k = 1; k < 100; k++) {
        const double p = 0.5 + 0.005 * k;
        const saddle_swing_state_t foot = foot_at(&swing, (float)p, 0.0f, beside, 0.0f, 1.7f);
        const double h = 1e-6;
        const double rate =
            (min_jerk(2.0 * (p - h) - 1.0) - min_jerk(2.0 * (p + h) - 1.0)) / (2 * h);
        TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.02 * (1.0 - min_jerk(2.0 * p - 1.0)),
                                  foot.position_m.x);
        TEST_ASSERT_DOUBLE_WITHIN(6e-6, 1.7 * 0.02 * rate, foot.velocity_m_s.x);
    }
    ASSERT_SAME_FLOAT(0.0f, foot_at(&swing, 1.0f, 0.0f, beside, 0.0f, 1.7f).position_m.x);
}

/** On the slope near the landing, level before it, and as by the clearance alone before mid-swing. */
static void test_foot_comes_down_on_a_slope(void)
{
    const saddle_sample_t lateral = {-0.05f, 0.0f};
    saddle_swing_t sloping = swing;
    sloping.approach = 0.25f;
    sloping.approach_max_m = 0.03f;
    for (float progress = 0.02f; progress < 1.0f; progress += 0.02f) {
        const float x = 0.35f * progress; /* the foot at 0.7 of the progress */
        const saddle_swing_state_t low = foot_at(&swing, progress, x, lateral, 1.0f, 1.0f);
        const saddle_swing_state_t foot = foot_at(&sloping, progress, x, lateral, 1.0f, 1.0f);
        const float slope_m = 0.25f * (0.7f - low.position_m.x);
        const float least_m = progress <= 0.5f ? 0.0f : slope_m < 0.03f ? slope_m : 0.03f;
        ASSERT_SAME_FLOAT(low.position_m.x, foot.position_m.x);
        TEST_ASSERT_FLOAT_WITHIN(1e-7f, low.position_m.z > least_m ? low.position_m.z : least_m,
                                 foot.position_m.z);
        if (foot.position_m.z > low.position_m.z) {
            TEST_ASSERT_FLOAT_WITHIN(1e-6f, slope_m < 0.03f ? -0.25f * foot.velocity_m_s.x : 0.0f,
                                     foot.velocity_m_s.z);
        }
    }
    const saddle_swing_state_t beyond = foot_at(&sloping, 1.0f, 0.5f, lateral, 1.0f, 1.0f);
    ASSERT_SAME_FLOAT(0.0f, beyond.position_m.z);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_share_of_a_person_s_way_and_its_slope);
    RUN_TEST(test_stretch_fades_out_in_the_second_half);
    RUN_TEST(test_foot_lies_on_the_line_through_stance_and_com);
    RUN_TEST(test_foot_passes_behind_beside_and_ahead);
    RUN_TEST(test_foot_follows_the_path_s_width_to_any_line);
    RUN_TEST(test_slope_of_the_line_is_its_derivative);
    RUN_TEST(test_swing_and_its_velocity_whole_and_half);
    RUN_TEST(test_foot_comes_down_on_a_slope);
    RUN_TEST(test_foot_leaves_where_it_stood_and_lands_on_the_line_both_at_rest);
    return UNITY_END();
}
