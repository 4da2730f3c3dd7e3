/** The fast loop between the ticks, and its configuration. */
#include <joint_loop.h>

#include <math.h>
#include <string.h>
#include <unity.h>

static saddle_joint_loop_t loop;
static saddle_joint_loop_config_t config;
static saddle_context_t context;
static saddle_sensors_t sensors;

/** A person who stands on bent knees, by the library's own legs. */
void setUp(void)
{
    saddle_config_t body = saddle_config_default(1.79f, 63.3f);
    body.double_support_share = 0.2f;
    TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_init(&context, &body));
    config = saddle_joint_loop_default(&body);
    config.passes = 40;
    TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_joint_loop_init(&loop, &config));
    memset(&sensors, 0, sizeof sensors);
    sensors.accelerometer_m_s2.z = SADDLE_GRAVITY_M_S2;
    for (size_t side = 0; side < 2u; ++side) {
        sensors.load_n[side] = 310.0f;
        sensors.angle_rad[side][SADDLE_HIP_PITCH] = -0.3f;
        sensors.angle_rad[side][SADDLE_KNEE] = 0.6f;
        sensors.angle_rad[side][SADDLE_ANKLE_PITCH] = -0.3f;
    }
}

void tearDown(void) {}

/** So many passes of 2 ms from a time on; what came is so old. Returns the last time. */
static uint64_t stand(uint64_t time_us, uint32_t passes, uint32_t age_us)
{
    for (uint32_t i = 0; i < passes; ++i, time_us += 2000u) {
        sensors.time_us = time_us;
        sensors.imu_age_us = age_us;
        const saddle_measurement_t *measurement = saddle_joint_loop_sense(&loop, &sensors);
        if (time_us % SADDLE_TICK_US == 0u) {
            saddle_output_t output;
            const saddle_input_t input = {
                .time_us = time_us, .command_age_us = 0, .measurement = *measurement};
            TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_tick(&context, &input, &output));
            saddle_joint_loop_tick(&loop, &output);
        }
        saddle_joint_loop_drive(&loop, &context, time_us);
    }
    return time_us;
}

static void test_who_stands_is_measured_and_held(void)
{
    (void)stand(0, 400, 0);
    TEST_ASSERT_EQUAL_HEX32(0, loop.estimate.faults);
    TEST_ASSERT_FLOAT_WITHIN(0.05f, 0.97f, loop.estimate.measurement.com.height_m);
    TEST_ASSERT_EQUAL_UINT32(0, loop.estimate.measurement.com.age_us);
    TEST_ASSERT_FALSE(loop.commands.fallback);
    const saddle_joint_command_t *knee = &loop.commands.joint[SADDLE_LEFT][SADDLE_KNEE];
    TEST_ASSERT_FLOAT_WITHIN(0.1f, 0.6f, knee->angle_rad);
    TEST_ASSERT_GREATER_THAN_FLOAT(100.0f, knee->stiffness);
}

static void test_lost_sensors_give_the_fallback_after_the_age_of_the_drives(void)
{
    const uint64_t lost_us = stand(0, 400, 0);
    const uint32_t before = loop.fallbacks;
    const uint32_t passes = (uint32_t)(config.drive.max_age_s * 500.0f);
    (void)stand(lost_us, passes - 1u, 30000);
    TEST_ASSERT_EQUAL_UINT32(before, loop.fallbacks);
    (void)stand(loop.estimator.time_us + 2000u, 3, 30000);
    TEST_ASSERT_TRUE(loop.commands.fallback);
    TEST_ASSERT_GREATER_THAN_UINT32(before, loop.fallbacks);
    TEST_ASSERT_BITS_HIGH(SADDLE_SENSOR_IMU_STALE, loop.estimate.faults);
}

static void test_the_verdict_of_the_last_tick_is_kept(void)
{
    const saddle_output_t output = {.verdict = {.recovery = {.found = true, .margin_m = 0.25f}}};
    saddle_joint_loop_tick(&loop, &output);
    TEST_ASSERT_TRUE(loop.verdict.recovery.found);
    TEST_ASSERT_EQUAL_FLOAT(0.25f, loop.verdict.recovery.margin_m);
}

static void test_the_default_is_of_the_body_and_off(void)
{
    const saddle_config_t body = saddle_config_default(1.60f, 50.0f);
    config = saddle_joint_loop_default(&body);
    TEST_ASSERT_EQUAL_UINT32(0, config.passes);
    TEST_ASSERT_EQUAL_UINT32(SADDLE_TICK_US, saddle_joint_loop_period_us(&config));
    TEST_ASSERT_FLOAT_WITHIN(1.0e-6f, 0.245f * 1.60f, config.legs.thigh_m);
    TEST_ASSERT_EQUAL_FLOAT(body.double_support_share, config.walk.double_support_share);
    TEST_ASSERT_NULL(saddle_joint_loop_check(&config));
}

static void test_passes_are_a_whole_number_in_a_tick(void)
{
    static const uint32_t good[] = {0, 8, 10, 16, 20, 25, 32, 40, 50, 64, 80};
    for (uint32_t passes = 0, next = 0; passes < 100u; ++passes) {
        const bool is_good = next < sizeof good / sizeof good[0] && passes == good[next];
        next += is_good;
        config.passes = passes;
        const char *bad_field = saddle_joint_loop_check(&config);
        if (is_good) {
            TEST_ASSERT_NULL(bad_field);
        } else {
            TEST_ASSERT_EQUAL_STRING("passes", bad_field);
        }
    }
    config.passes = 80;
    TEST_ASSERT_EQUAL_UINT32(1000, saddle_joint_loop_period_us(&config));
}

static void test_a_bad_field_of_each_part_is_named_and_found_by_its_name(void)
{
    static const char *const names[] = {"thigh_m", "imu_x_m", "fade_s", "xcom_gain"};
    static const char *const parts[] = {"legs", "estimator", "walk", "drive"};
    for (size_t index = 0; index < SADDLE_JOINT_PARTS; ++index) {
        const saddle_joint_part_t part = saddle_joint_part(index);
        const saddle_joint_loop_config_t before = config;
        size_t place = 0;
        while (strcmp(part.field(place)->name, names[index]) != 0) {
            ++place;
        }
        const float wrong = NAN;
        memcpy((char *)&config + part.offset + part.field(place)->offset, &wrong, sizeof wrong);
        TEST_ASSERT_EQUAL_STRING(parts[index], part.name);
        TEST_ASSERT_EQUAL_STRING(names[index], saddle_joint_loop_check(&config));
        config = before;
    }
}

static void test_legs_that_are_wrong_move_no_joint(void)
{
    config.legs.thigh_m = -1.0f;
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_CONFIG, saddle_joint_loop_init(&loop, &config));
    (void)stand(0, 1, 0);
    TEST_ASSERT_TRUE(loop.commands.fallback);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_who_stands_is_measured_and_held);
    RUN_TEST(test_lost_sensors_give_the_fallback_after_the_age_of_the_drives);
    RUN_TEST(test_the_verdict_of_the_last_tick_is_kept);
    RUN_TEST(test_the_default_is_of_the_body_and_off);
    RUN_TEST(test_passes_are_a_whole_number_in_a_tick);
    RUN_TEST(test_a_bad_field_of_each_part_is_named_and_found_by_its_name);
    RUN_TEST(test_legs_that_are_wrong_move_no_joint);
    return UNITY_END();
}
