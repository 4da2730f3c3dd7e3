/** Which source commands, and the age of each input. */
#include <inbox.h>

#include <unity.h>

static saddle_inbox_t inbox;

static const saddle_command_t walk = {SADDLE_COMMAND_WALK, 1.2f, 0.17f, 0.0f};
static const saddle_command_t stroll = {SADDLE_COMMAND_WALK, 0.5f, 0.17f, 0.0f};
static const saddle_command_t no_mode = {7, 0.0f, 0.0f, 0.0f};

void setUp(void)
{
    saddle_inbox_init(&inbox, SADDLE_SOURCE_NONE);
}

void tearDown(void) {}

static void expect_counts(uint32_t applied, uint32_t unusable, uint32_t ignored)
{
    TEST_ASSERT_EQUAL_UINT32(applied, inbox.commands_applied);
    TEST_ASSERT_EQUAL_UINT32(unusable, inbox.commands_unusable);
    TEST_ASSERT_EQUAL_UINT32(ignored, inbox.commands_ignored);
    TEST_ASSERT_EQUAL_UINT32(unusable + ignored, saddle_inbox_rejected(&inbox));
}

static void test_the_first_that_commands_has_authority_until_released(void)
{
    saddle_inbox_take_command(&inbox, SADDLE_SOURCE_LCM, &walk, 1000);
    saddle_inbox_take_command(&inbox, SADDLE_SOURCE_CAN, &stroll, 9000);
    TEST_ASSERT_EQUAL_FLOAT(1.2f, saddle_inbox_read(&inbox, 10000)->command.speed_m_s);
    TEST_ASSERT_EQUAL_UINT32(9000, inbox.input.command_age_us);
    TEST_ASSERT_EQUAL_INT(SADDLE_SOURCE_LCM, inbox.authority);
    expect_counts(1, 0, 1);
    saddle_inbox_release(&inbox);
    saddle_inbox_take_command(&inbox, SADDLE_SOURCE_CAN, &stroll, 11000);
    TEST_ASSERT_EQUAL_INT(SADDLE_SOURCE_CAN, inbox.authority);
    TEST_ASSERT_EQUAL_FLOAT(0.5f, saddle_inbox_read(&inbox, 11000)->command.speed_m_s);
    expect_counts(2, 0, 1);
}

static void test_only_the_chosen_source_commands(void)
{
    saddle_inbox_init(&inbox, SADDLE_SOURCE_CAN);
    saddle_inbox_take_command(&inbox, SADDLE_SOURCE_LCM, &walk, 0);
    saddle_inbox_release(&inbox);
    saddle_inbox_take_command(&inbox, SADDLE_SOURCE_LCM, &walk, 0);
    expect_counts(0, 0, 2);
    TEST_ASSERT_EQUAL_UINT32(SADDLE_AGE_NEVER_US, saddle_inbox_read(&inbox, 5)->command_age_us);
}

static void test_unusable_inputs_give_no_authority_and_no_age(void)
{
    saddle_inbox_take_command(&inbox, SADDLE_SOURCE_LCM, &no_mode, 0);
    saddle_inbox_take_command(&inbox, SADDLE_SOURCE_LCM, NULL, 0);
    TEST_ASSERT_EQUAL_INT(SADDLE_SOURCE_NONE, inbox.authority);
    saddle_inbox_take_command(&inbox, SADDLE_SOURCE_CAN, &walk, 100);
    saddle_inbox_take_command(&inbox, SADDLE_SOURCE_CAN, &no_mode, 200);
    TEST_ASSERT_EQUAL_UINT32(200, saddle_inbox_read(&inbox, 300)->command_age_us);
    expect_counts(1, 3, 0);
}

static bool left_contact;

static void send_set(uint8_t counter, size_t frames_sent, uint64_t time_us)
{
    const saddle_measurement_t measurement = {.com.height_m = 1.0f,
                                              .foot[SADDLE_LEFT].contact = left_contact};
    saddle_frame_t frames[SADDLE_WIRE_MEASURED_FRAMES];
    saddle_wire_encode_measurement(&measurement, counter, frames);
    for (size_t i = 0; i < frames_sent; ++i) {
        saddle_inbox_take_frame(&inbox, frames[i].id, frames[i].data, sizeof frames[i].data,
                                time_us + i);
    }
}

static void test_a_command_is_received_by_can_and_a_code_changes_no_input(void)
{
    const saddle_cmac_key_t key = {{0}, {0}, {0}};
    saddle_frame_t command, code;
    saddle_wire_encode_command(&stroll, 3, &command);
    saddle_wire_encode_code(&key, 1, 1, &command, &code);
    saddle_inbox_take_frame(&inbox, code.id, code.data, sizeof code.data, 100);
    TEST_ASSERT_EQUAL_UINT32(1, inbox.receiver.accepted);
    TEST_ASSERT_EQUAL_UINT32(0, inbox.came);
    saddle_inbox_take_frame(&inbox, command.id, command.data, sizeof command.data, 200);
    TEST_ASSERT_EQUAL_UINT32(50, saddle_inbox_read(&inbox, 250)->command_age_us);
    TEST_ASSERT_EQUAL_FLOAT(0.5f, inbox.input.command.speed_m_s);
    TEST_ASSERT_EQUAL_INT(SADDLE_SOURCE_CAN, inbox.authority);
}

static void test_each_part_has_its_age(void)
{
    send_set(0, 3, 1000);
    send_set(1, 1, 2000);
    const saddle_measurement_t *measurement = &saddle_inbox_read(&inbox, 3000)->measurement;
    TEST_ASSERT_EQUAL_UINT32(1000, measurement->com.age_us);
    TEST_ASSERT_EQUAL_UINT32(1999, measurement->foot[SADDLE_LEFT].age_us);
    TEST_ASSERT_EQUAL_UINT32(1998, measurement->foot[SADDLE_RIGHT].age_us);
    TEST_ASSERT_EQUAL_UINT32(0, saddle_inbox_read(&inbox, 500)->measurement.com.age_us);
}

static void test_no_age_is_mistaken_for_never(void)
{
    send_set(0, 1, 0);
    const saddle_measurement_t *measurement =
        &saddle_inbox_read(&inbox, UINT64_C(1) << 40)->measurement;
    TEST_ASSERT_EQUAL_UINT32(SADDLE_AGE_NEVER_US - 1u, measurement->com.age_us);
    TEST_ASSERT_EQUAL_UINT32(SADDLE_AGE_NEVER_US, measurement->foot[SADDLE_LEFT].age_us);
}

static void test_a_set_is_of_one_instant_and_read_once(void)
{
    send_set(0, 2, 0);
    TEST_ASSERT_FALSE(saddle_inbox_set_complete(&inbox));
    send_set(1, 3, 0);
    TEST_ASSERT_TRUE(saddle_inbox_set_complete(&inbox));
    (void)saddle_inbox_read(&inbox, 0);
    TEST_ASSERT_FALSE(saddle_inbox_set_complete(&inbox));
}

static void send_timed_set(uint8_t number, uint32_t sampled_us, uint64_t time_us)
{
    saddle_frame_t frame;
    saddle_wire_encode_time(sampled_us, number, &frame);
    saddle_inbox_take_frame(&inbox, frame.id, frame.data, sizeof frame.data, time_us);
    send_set(number, 3, time_us);
}

/** Sets every 10 ms between two ticks say when the foot came down. */
static void test_contact_is_dated_within_the_tick(void)
{
    const uint32_t landed_set = 13;
    for (uint8_t n = 0; n < 32; ++n) {
        left_contact = n >= landed_set;
        send_set(n, 3, 10000u * (n + 1u));
        if (n % 8 == 7) {
            const saddle_measured_foot_t *foot =
                saddle_inbox_read(&inbox, 10000u * (n + 1u))->measurement.foot;
            const uint32_t first = n < landed_set ? 0u : landed_set;
            TEST_ASSERT_EQUAL_UINT32(10000u * (n - first), foot[SADDLE_LEFT].since_us);
            TEST_ASSERT_EQUAL_UINT32(10000u * n, foot[SADDLE_RIGHT].since_us);
        }
    }
    send_set(32, 3, UINT64_C(1) << 33); /* for longer than can be said */
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, inbox.input.measurement.foot[SADDLE_LEFT].since_us);
    left_contact = false;
}

/** Held back for 0.3 s in the numbers' second round, with ticks between. */
static void test_late_data_are_old_data(void)
{
    for (uint8_t n = 0; n < 20; ++n) {
        send_timed_set(n, 500u + n * 80000u, 100000u + n * 80000u);
        (void)saddle_inbox_read(&inbox, 100002u + n * 80000u);
    }
    TEST_ASSERT_TRUE(inbox.sender_clock);
    TEST_ASSERT_LESS_THAN_UINT32(20, inbox.input.measurement.foot[SADDLE_RIGHT].age_us);
    const uint64_t now_us = 100000u + 20u * 80000u;
    (void)saddle_inbox_read(&inbox, now_us + 240000u);
    send_timed_set(20, 500u + 20u * 80000u, now_us + 300000u);
    const saddle_measurement_t *measurement =
        &saddle_inbox_read(&inbox, now_us + 320000u)->measurement;
    TEST_ASSERT_UINT32_WITHIN(100, 320000, measurement->com.age_us);
    TEST_ASSERT_UINT32_WITHIN(100, 320000, measurement->foot[SADDLE_LEFT].age_us);
}

static void test_what_was_measured_before_what_is_held_is_not_taken(void)
{
    send_timed_set(0, 0, 1000);
    send_timed_set(1, 80000, 81000);
    send_timed_set(2, 160000, 161000);
    inbox.receiver.alive[SADDLE_WIRE_MEASURED_COM].seen = false;
    const saddle_measurement_t old = {.com.height_m = 0.5f};
    saddle_frame_t frames[SADDLE_WIRE_MEASURED_FRAMES];
    saddle_wire_encode_measurement(&old, 1, frames);
    saddle_inbox_take_frame(&inbox, frames[0].id, frames[0].data, 8, 162000);
    TEST_ASSERT_EQUAL_FLOAT(1.0f, saddle_inbox_read(&inbox, 170000)->measurement.com.height_m);
    TEST_ASSERT_EQUAL_UINT32(1, inbox.frames_late);
    TEST_ASSERT_EQUAL_UINT32(1, saddle_inbox_rejected(&inbox));
}

/** Not while ticks come, nor while frames do, since a process that stood finds them in its queue. */
static void test_a_jump_of_our_own_clock_is_no_delay(void)
{
    send_timed_set(0, 0, 1000);
    (void)saddle_inbox_read(&inbox, 2000);
    send_timed_set(1, 80000, 581000);
    TEST_ASSERT_EQUAL_UINT32(0, saddle_inbox_read(&inbox, 581000)->measurement.com.age_us);
    send_timed_set(2, 160000, 661000);
    send_timed_set(3, 240000, 741000);
    send_timed_set(4, 320000, 861000);
    TEST_ASSERT_UINT32_WITHIN(100, 40000,
                              saddle_inbox_read(&inbox, 861000)->measurement.com.age_us);
}

static void test_of_a_set_whose_time_never_came_nothing_is_taken(void)
{
    send_timed_set(0, 0, 1000);
    inbox.receiver.alive[SADDLE_WIRE_MEASURED_COM].seen = false;
    send_set(100, 1, 2000);
    TEST_ASSERT_EQUAL_UINT32(1, inbox.frames_late);
    TEST_ASSERT_EQUAL_UINT32(2000, saddle_inbox_read(&inbox, 3000)->measurement.com.age_us);
}

/** What is held seems to be of the future then. */
static void test_our_own_clock_set_back_takes_what_comes(void)
{
    send_timed_set(0, 0, 900000);
    (void)saddle_inbox_read(&inbox, 900000);
    send_timed_set(1, 80000, 500000);
    TEST_ASSERT_EQUAL_UINT32(0, inbox.frames_late);
    TEST_ASSERT_EQUAL_UINT32(0, saddle_inbox_read(&inbox, 500000)->measurement.com.age_us);
}

static void test_in_lockstep_every_age_is_0(void)
{
    inbox.lockstep = true;
    send_timed_set(0, 0, 1000);
    send_timed_set(1, 80000, 900000);
    TEST_ASSERT_EQUAL_UINT32(0, saddle_inbox_read(&inbox, 900000)->measurement.com.age_us);
    TEST_ASSERT_FALSE(inbox.sender_clock);
}

static void sense_set(uint8_t number, size_t left_out, uint64_t time_us)
{
    const saddle_sensors_t sensors = {.accelerometer_m_s2 = {.z = 9.8f},
                                      .load_n = {310.0f, 320.0f},
                                      .angle_rad = {{[SADDLE_KNEE] = 0.5f}}};
    saddle_frame_t frames[SADDLE_WIRE_SENSED_FRAMES];
    saddle_wire_encode_sensors(&sensors, number, frames);
    for (size_t i = 0; i < SADDLE_WIRE_SENSED_FRAMES; ++i) {
        if (i != left_out) {
            saddle_inbox_take_frame(&inbox, frames[i].id, frames[i].data, sizeof frames[i].data,
                                    time_us);
        }
    }
}

#define ALL SADDLE_WIRE_SENSED_FRAMES

static void test_sensors_are_read_with_the_age_of_their_older_frame(void)
{
    inbox.by_sensors = true;
    sense_set(0, ALL, 1000);
    TEST_ASSERT_TRUE(saddle_inbox_set_complete(&inbox));
    const saddle_sensors_t *sensors = saddle_inbox_sense(&inbox, 1500);
    TEST_ASSERT_FALSE(saddle_inbox_set_complete(&inbox));
    TEST_ASSERT_EQUAL_UINT64(1500, sensors->time_us);
    TEST_ASSERT_EQUAL_FLOAT(9.8f, sensors->accelerometer_m_s2.z);
    TEST_ASSERT_EQUAL_FLOAT(320.0f, sensors->load_n[SADDLE_RIGHT]);
    TEST_ASSERT_EQUAL_FLOAT(0.5f, sensors->angle_rad[SADDLE_LEFT][SADDLE_KNEE]);
    static const struct {
        size_t left_out; /* frame of a set */
        uint32_t imu_us, left_us, right_us, loads_us;
    } cases[] = {{0, 2000, 0, 0, 0}, {1, 2000, 0, 0, 0}, {2, 0, 0, 0, 2000}, {3, 0, 2000, 0, 0},
                 {4, 0, 2000, 0, 0}, {5, 0, 0, 2000, 0}, {6, 0, 0, 2000, 0}, {ALL, 0, 0, 0, 0}};
    for (uint8_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        const uint64_t time_us = 10000u * (i + 1u);
        sense_set((uint8_t)(2u * i + 1u), ALL, time_us - 2000u);
        sense_set((uint8_t)(2u * i + 2u), cases[i].left_out, time_us);
        TEST_ASSERT_EQUAL(cases[i].left_out == ALL, saddle_inbox_set_complete(&inbox));
        (void)saddle_inbox_sense(&inbox, time_us);
        TEST_ASSERT_EQUAL_UINT32(cases[i].imu_us, sensors->imu_age_us);
        TEST_ASSERT_EQUAL_UINT32(cases[i].left_us, sensors->joints_age_us[SADDLE_LEFT]);
        TEST_ASSERT_EQUAL_UINT32(cases[i].right_us, sensors->joints_age_us[SADDLE_RIGHT]);
        TEST_ASSERT_EQUAL_UINT32(cases[i].loads_us, sensors->load_age_us[SADDLE_LEFT]);
        TEST_ASSERT_EQUAL_UINT32(cases[i].loads_us, sensors->load_age_us[SADDLE_RIGHT]);
    }
}

static void test_sensors_that_never_came_are_never_old(void)
{
    inbox.by_sensors = true;
    const saddle_sensors_t *sensors = saddle_inbox_sense(&inbox, 1500);
    TEST_ASSERT_EQUAL_UINT32(SADDLE_AGE_NEVER_US, sensors->imu_age_us);
    TEST_ASSERT_EQUAL_UINT32(SADDLE_AGE_NEVER_US, sensors->joints_age_us[SADDLE_RIGHT]);
    TEST_ASSERT_EQUAL_UINT32(SADDLE_AGE_NEVER_US, sensors->load_age_us[SADDLE_LEFT]);
}

static void test_only_the_chosen_kind_of_measurement_is_used(void)
{
    sense_set(0, ALL, 1000);
    TEST_ASSERT_EQUAL_UINT32(ALL, inbox.frames_unused);
    TEST_ASSERT_EQUAL_UINT32(ALL, saddle_inbox_rejected(&inbox));
    TEST_ASSERT_EQUAL_FLOAT(0.0f, inbox.sensors.accelerometer_m_s2.z);
    inbox.by_sensors = true;
    send_set(0, SADDLE_WIRE_MEASURED_FRAMES, 2000);
    TEST_ASSERT_EQUAL_UINT32(ALL + SADDLE_WIRE_MEASURED_FRAMES, inbox.frames_unused);
    TEST_ASSERT_FALSE(saddle_inbox_set_complete(&inbox));
    TEST_ASSERT_EQUAL_FLOAT(0.0f, inbox.input.measurement.com.height_m);
}

/** What the estimator made of them has ages of its own. */
static void test_by_sensors_a_tick_has_the_measurement_as_it_is(void)
{
    inbox.by_sensors = true;
    inbox.input.measurement.com.age_us = 1234;
    sense_set(0, ALL, 1000);
    TEST_ASSERT_EQUAL_UINT32(1234, saddle_inbox_read(&inbox, 5000)->measurement.com.age_us);
    TEST_ASSERT_EQUAL_UINT64(5000, inbox.input.time_us);
    TEST_ASSERT_TRUE(saddle_inbox_set_complete(&inbox));
}

static void test_sensors_age_from_when_they_were_sampled(void)
{
    inbox.by_sensors = true;
    for (uint8_t i = 0; i < 4u; ++i) {
        saddle_frame_t frame;
        const uint64_t time_us = 2000u * i + (i == 3u ? 1500u : 0u);
        saddle_wire_encode_time(2000u * i, i, &frame);
        saddle_inbox_take_frame(&inbox, frame.id, frame.data, sizeof frame.data, time_us);
        sense_set(i, ALL, time_us);
    }
    TEST_ASSERT_TRUE(inbox.sender_clock);
    TEST_ASSERT_UINT32_WITHIN(5, 2000, saddle_inbox_sense(&inbox, 8000)->imu_age_us);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_first_that_commands_has_authority_until_released);
    RUN_TEST(test_only_the_chosen_source_commands);
    RUN_TEST(test_unusable_inputs_give_no_authority_and_no_age);
    RUN_TEST(test_a_command_is_received_by_can_and_a_code_changes_no_input);
    RUN_TEST(test_each_part_has_its_age);
    RUN_TEST(test_no_age_is_mistaken_for_never);
    RUN_TEST(test_a_set_is_of_one_instant_and_read_once);
    RUN_TEST(test_contact_is_dated_within_the_tick);
    RUN_TEST(test_late_data_are_old_data);
    RUN_TEST(test_what_was_measured_before_what_is_held_is_not_taken);
    RUN_TEST(test_a_jump_of_our_own_clock_is_no_delay);
    RUN_TEST(test_of_a_set_whose_time_never_came_nothing_is_taken);
    RUN_TEST(test_our_own_clock_set_back_takes_what_comes);
    RUN_TEST(test_in_lockstep_every_age_is_0);
    RUN_TEST(test_sensors_are_read_with_the_age_of_their_older_frame);
    RUN_TEST(test_sensors_that_never_came_are_never_old);
    RUN_TEST(test_only_the_chosen_kind_of_measurement_is_used);
    RUN_TEST(test_by_sensors_a_tick_has_the_measurement_as_it_is);
    RUN_TEST(test_sensors_age_from_when_they_were_sampled);
    return UNITY_END();
}
