/** The configuration: defaults are the paper's, every field has a range, a bad one is named. */
#include "core_test.h"

static saddle_config_t config;

void setUp(void)
{
    config = paper_config();
}

void tearDown(void) {}

static size_t field_count(void)
{
    size_t count = 0;
    while (saddle_config_field(count) != NULL) {
        count++;
    }
    return count;
}

static void test_default_is_the_papers_and_passes(void)
{
    TEST_ASSERT_NULL(saddle_config_check(&config));
    ASSERT_SAME_FLOAT(63.3f, config.body_mass_kg);
    ASSERT_SAME_FLOAT(1.79f, config.body_height_m);
    ASSERT_SAME_FLOAT(0.57f, config.pendulum_ratio);
    ASSERT_SAME_FLOAT(0.10f, config.cop_range_m);
    ASSERT_SAME_FLOAT(0.22f, config.step_width_slow_m);
    ASSERT_SAME_FLOAT(0.10f, config.step_width_fast_m);
    ASSERT_SAME_FLOAT(0.6f, config.step_width_slow_speed_m_s);
    ASSERT_SAME_FLOAT(1.1f, config.step_width_fast_speed_m_s);
    ASSERT_SAME_FLOAT(-0.2128f, config.step_width_slope_s);
    ASSERT_SAME_FLOAT(0.3456f, config.step_width_intercept_m);
    ASSERT_SAME_FLOAT(0.1802f, config.half_step_slope_s);
    ASSERT_SAME_FLOAT(0.1351f, config.half_step_intercept_m);
    ASSERT_SAME_FLOAT(0.02656f, config.vertical_slope_s);
    ASSERT_SAME_FLOAT(0.002575f, config.vertical_intercept_m);
    ASSERT_SAME_FLOAT(1.0f, config.lateral_factor);
    ASSERT_SAME_FLOAT(3.0f, config.peak_speed_m_s);
    ASSERT_SAME_FLOAT(0.11f, config.ankle_time_constant_s);
    ASSERT_SAME_FLOAT(0.05f, config.swing_clearance_m);
    ASSERT_SAME_FLOAT(0.5f, config.acceleration_m_s2);
    ASSERT_SAME_FLOAT(0.8f, config.shift_time_s);
    ASSERT_SAME_FLOAT(1.0f, config.step_length_factor_left);
    ASSERT_SAME_FLOAT(1.0f, config.step_length_factor_right);
    ASSERT_SAME_FLOAT(1.0f, config.step_width_factor_left);
    ASSERT_SAME_FLOAT(1.0f, config.step_width_factor_right);
    ASSERT_SAME_FLOAT(1.0f, config.bos_factor);
    ASSERT_SAME_FLOAT(1.0f, config.ankle_work_factor);
    ASSERT_SAME_FLOAT(0.0f, config.recovery_margin_m);
    ASSERT_SAME_FLOAT(0.1f, config.caution_score);
    ASSERT_SAME_FLOAT(0.13f, config.caution_xcom_ap_m);
    ASSERT_SAME_FLOAT(0.07f, config.caution_xcom_ml_m);
    TEST_ASSERT_EQUAL_INT(SADDLE_ANKLE_ERF, config.ankle);
}

static void test_all_zero_fails(void)
{
    const saddle_config_t zero = {0};
    TEST_ASSERT_EQUAL_STRING("body_mass_kg", saddle_config_check(&zero));
}

static void test_fields_cover_every_float_once(void)
{
    const size_t count = field_count();
    TEST_ASSERT_EQUAL_size_t(offsetof(saddle_config_t, ankle), count * sizeof(float));
    for (size_t i = 0; i < count; i++) {
        TEST_ASSERT_EQUAL_size_t(i * sizeof(float), saddle_config_field(i)->offset);
        TEST_ASSERT_TRUE(saddle_config_field(i)->min < saddle_config_field(i)->max);
    }
    TEST_ASSERT_NULL(saddle_config_field(count));
    TEST_ASSERT_NULL(saddle_config_field(SIZE_MAX));
}

static void test_field_names_belong_to_their_offsets(void)
{
    TEST_ASSERT_EQUAL_STRING("body_mass_kg", saddle_config_field(0)->name);
    TEST_ASSERT_EQUAL_STRING(
        "half_step_slope_s",
        saddle_config_field(offsetof(saddle_config_t, half_step_slope_s) / sizeof(float))->name);
    TEST_ASSERT_EQUAL_STRING("level_hold_ticks", saddle_config_field(field_count() - 1)->name);
}

static void test_every_field_out_of_range_is_named(void)
{
    for (size_t i = 0; i < field_count(); i++) {
        const saddle_config_field_t *field = saddle_config_field(i);
        const float bad[] = {nextafterf(field->min, -INFINITY),
                             nextafterf(field->max, INFINITY),
                             -1.0e30f,
                             1.0e30f,
                             NAN,
                             -NAN,
                             INFINITY,
                             -INFINITY};
        for (size_t k = 0; k < COUNT_OF(bad); k++) {
            config = paper_config();
            *config_field(&config, i) = bad[k];
            TEST_ASSERT_EQUAL_STRING(field->name, saddle_config_check(&config));
        }
    }
}

static void test_ends_of_every_range_belong_to_it(void)
{
    for (size_t i = 0; i < field_count(); i++) {
        const saddle_config_field_t *field = saddle_config_field(i);
        const float ends[] = {field->min, field->max};
        for (size_t k = 0; k < COUNT_OF(ends); k++) {
            saddle_config_t probe = {0};
            /* Fields are checked in order: with all before it good and all after it zero, this one
             * is accepted if and only if a later field is named. */
            memcpy(&probe, &config, field->offset);
            *config_field(&probe, i) = ends[k];
            const char *named = saddle_config_check(&probe);
            TEST_ASSERT_TRUE_MESSAGE(named == NULL || strcmp(field->name, named) != 0, field->name);
        }
    }
}

static void test_unknown_ankle_is_named(void)
{
    config.ankle = SADDLE_ANKLE_COUNT;
    TEST_ASSERT_EQUAL_STRING("ankle", saddle_config_check(&config));
    config.ankle = SADDLE_ANKLE_RIGID;
    TEST_ASSERT_NULL(saddle_config_check(&config));
}

static void test_width_thresholds_in_the_wrong_order_are_named(void)
{
    config.step_width_slow_speed_m_s = 1.2f;
    TEST_ASSERT_EQUAL_STRING("step_width_slow_speed_m_s", saddle_config_check(&config));
}

static void test_width_that_falls_below_a_centimetre_is_named(void)
{
    config.step_width_fast_speed_m_s = 1.6f; /* 0.3456 - 0.2128 * 1.6 = 5 mm */
    TEST_ASSERT_EQUAL_STRING("step_width_slope_s", saddle_config_check(&config));
    config.step_width_fast_speed_m_s = 1.5f; /* 26 mm */
    TEST_ASSERT_NULL(saddle_config_check(&config));
}

static void test_recovery_widths_in_the_wrong_order_are_named(void)
{
    config.recovery_width_min_m = 0.21f;
    config.recovery_width_max_m = 0.2f;
    TEST_ASSERT_EQUAL_STRING("recovery_width_min_m", saddle_config_check(&config));
    config.recovery_width_min_m = 0.2f;
    TEST_ASSERT_NULL(saddle_config_check(&config));
}

static void test_half_step_out_of_reach_is_named(void)
{
    config.half_step_intercept_m = 0.47f; /* x 1.05 > 0.4838, the default body's reach */
    TEST_ASSERT_EQUAL_STRING("half_step_intercept_m", saddle_config_check(&config));
    config.half_step_intercept_m = 0.45f;
    TEST_ASSERT_NULL(saddle_config_check(&config));
}

/* A reach of 36.58 mm: 1.05 x the intercept fits, 1.05 x the half step at 0.02 m/s does not. */
static void test_configuration_without_a_feasible_walk_is_named(void)
{
    config.body_height_m = 0.7f;
    config.pendulum_ratio = 0.3f;
    config.peak_speed_m_s = 0.5f;
    config.step_width_slow_m = 0.1f;
    config.step_width_slope_s = 0.0f;
    config.step_width_intercept_m = 0.1f;
    config.half_step_slope_s = 1.0f;
    config.half_step_intercept_m = 0.0348f;
    TEST_ASSERT_EQUAL_STRING("half_step_intercept_m", saddle_config_check(&config));
    config.half_step_intercept_m = 0.0148f;
    TEST_ASSERT_NULL(saddle_config_check(&config));
}

static void test_reach_that_lays_the_pendulum_flat_is_named(void)
{
    config.peak_speed_m_s = 3.9f; /* reach 0.629 m: with 0.22 m across, 0.444 of 0.833 m^2 */
    TEST_ASSERT_NULL(saddle_config_check(&config));
    config.body_height_m = 1.2f; /* reach 0.515 m, 0.313 of 0.374 m^2 */
    TEST_ASSERT_NULL(saddle_config_check(&config));
    config.step_width_slow_m = 0.4f; /* 0.425 of 0.374 m^2 */
    TEST_ASSERT_EQUAL_STRING("peak_speed_m_s", saddle_config_check(&config));
}

static void test_swing_that_comes_all_but_at_once_is_named(void)
{
    config.swing_skew = 0.29f;
    TEST_ASSERT_EQUAL_STRING("swing_skew", saddle_config_check(&config));
    config.swing_skew = 0.3f;
    TEST_ASSERT_NULL(saddle_config_check(&config));
}

static void test_path_that_lays_the_pendulum_flat_is_named(void)
{
    config.peak_speed_m_s = 3.9f;
    config.body_height_m = 1.2f; /* reach 0.515 m: with 0.22 m across, 0.313 of 0.468 m^2 */
    config.lateral_offset_m = -0.1f;
    TEST_ASSERT_NULL(saddle_config_check(&config)); /* 0.32 m across: 0.368 of 0.421 m^2 */
    config.lateral_delay_rad = 1.5f;                /* 0.65 m across: 0.688 of 0.421 m^2 */
    TEST_ASSERT_EQUAL_STRING("lateral_offset_m", saddle_config_check(&config));
}

static void test_longer_side_that_does_not_reach_its_shortest_step_is_named(void)
{
    config.half_step_intercept_m = 0.35f; /* reach 0.4838 m; the shortest 1.05 times 0.3536 m */
    TEST_ASSERT_NULL(saddle_config_check(&config));
    config.step_length_factor_right = 1.29f; /* 0.479 m */
    TEST_ASSERT_NULL(saddle_config_check(&config));
    config.step_length_factor_right = 0.5f;
    config.step_length_factor_left = 1.31f; /* 0.486 m */
    TEST_ASSERT_EQUAL_STRING("half_step_intercept_m", saddle_config_check(&config));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_default_is_the_papers_and_passes);
    RUN_TEST(test_all_zero_fails);
    RUN_TEST(test_fields_cover_every_float_once);
    RUN_TEST(test_field_names_belong_to_their_offsets);
    RUN_TEST(test_every_field_out_of_range_is_named);
    RUN_TEST(test_ends_of_every_range_belong_to_it);
    RUN_TEST(test_unknown_ankle_is_named);
    RUN_TEST(test_width_thresholds_in_the_wrong_order_are_named);
    RUN_TEST(test_width_that_falls_below_a_centimetre_is_named);
    RUN_TEST(test_recovery_widths_in_the_wrong_order_are_named);
    RUN_TEST(test_half_step_out_of_reach_is_named);
    RUN_TEST(test_configuration_without_a_feasible_walk_is_named);
    RUN_TEST(test_reach_that_lays_the_pendulum_flat_is_named);
    RUN_TEST(test_swing_that_comes_all_but_at_once_is_named);
    RUN_TEST(test_path_that_lays_the_pendulum_flat_is_named);
    RUN_TEST(test_longer_side_that_does_not_reach_its_shortest_step_is_named);
    return UNITY_END();
}
