/** The loop of a controller on a board that does as the test says. */
#include <board.h>
#include <controller.h>

#include <string.h>
#include <unity.h>

static saddle_controller_t controller;
static saddle_config_t config;

static saddle_can_queue_t coming;
static saddle_can_frame_t sent[4 * SADDLE_WIRE_OUTPUT_FRAMES];
static uint32_t frames_sent, room, lost;
static uint64_t now_us;
static uint32_t sending_us; /* what each frame takes */
static uint64_t rounds;
static uint32_t period_us;
static uint32_t feeds;
static bool flood;
static uint32_t random_bits; /* 0: none */

bool saddle_can_receive(saddle_can_frame_t *frame)
{
    static const saddle_can_frame_t stray = {.id = 0x7FF};
    *frame = stray;
    return flood || saddle_can_queue_take(&coming, frame);
}

uint32_t saddle_can_lost(void)
{
    return lost;
}

bool saddle_can_send(const saddle_can_frame_t *frame)
{
    now_us += sending_us;
    if (frames_sent == room) {
        return false;
    }
    sent[frames_sent] = *frame;
    ++frames_sent;
    return true;
}

uint64_t saddle_clock_now_us(void)
{
    return now_us;
}

uint64_t saddle_clock_rounds(void)
{
    return rounds;
}

void saddle_watchdog_feed(void)
{
    ++feeds;
}

bool saddle_random(uint32_t *bits)
{
    *bits = random_bits;
    return random_bits != 0u;
}

void setUp(void)
{
    memset(&coming, 0, sizeof coming);
    room = sizeof sent / sizeof sent[0];
    frames_sent = lost = sending_us = feeds = 0;
    now_us = rounds = 0;
    period_us = SADDLE_TICK_US;
    flood = false;
    random_bits = 0;
    config = saddle_config_default(1.79f, 63.3f);
    TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_controller_init(&controller, &config, false));
}

void tearDown(void) {}

/** The timer comes round; the loop sees it late by as much. */
static void timer(uint32_t late_us)
{
    ++rounds;
    now_us = rounds * period_us + late_us;
    saddle_controller_step(&controller);
}

static void bring(const saddle_frame_t *from, uint64_t received_us)
{
    saddle_can_frame_t frame = {
        .received_us = received_us, .id = from->id, .length = sizeof from->data};
    memcpy(frame.data, from->data, sizeof frame.data);
    TEST_ASSERT_TRUE(saddle_can_queue_put(&coming, &frame));
}

static void bring_set(uint8_t counter, uint64_t received_us)
{
    const saddle_measurement_t measurement = {.com.height_m = 1.0f};
    saddle_frame_t frames[SADDLE_WIRE_MEASURED_FRAMES];
    saddle_wire_encode_measurement(&measurement, counter, frames);
    for (size_t i = 0; i < SADDLE_WIRE_MEASURED_FRAMES; ++i) {
        bring(&frames[i], received_us);
    }
}

static uint16_t rejected_frames(const saddle_can_frame_t *health)
{
    return (uint16_t)(health->data[6] | health->data[7] << 8);
}

static void test_the_timer_makes_a_tick_due_once(void)
{
    saddle_controller_step(&controller);
    TEST_ASSERT_EQUAL_UINT32(0, frames_sent);
    timer(120);
    saddle_controller_step(&controller);
    TEST_ASSERT_EQUAL_UINT32(SADDLE_WIRE_OUTPUT_FRAMES, frames_sent);
    TEST_ASSERT_EQUAL_HEX16(0x140, sent[frames_sent - 1u].id);
    TEST_ASSERT_EQUAL_UINT64(SADDLE_TICK_US, controller.inbox.input.time_us);
    TEST_ASSERT_EQUAL_UINT32(120, controller.timing.latency_us);
    TEST_ASSERT_EQUAL_UINT32(1, feeds);
    timer(0);
    TEST_ASSERT_EQUAL_UINT32(2 * SADDLE_WIRE_OUTPUT_FRAMES, frames_sent);
    TEST_ASSERT_EQUAL_UINT8(1, sent[frames_sent - 1u].data[1] & 15u);
    TEST_ASSERT_EQUAL_UINT32(2, feeds);
}

static void test_a_late_tick_does_not_feed_the_watchdog(void)
{
    sending_us = 1000;
    const uint32_t latest_us = SADDLE_TICK_US - SADDLE_WIRE_OUTPUT_FRAMES * sending_us;
    timer(latest_us);
    TEST_ASSERT_EQUAL_UINT32(1, feeds);
    timer(latest_us + 1u);
    TEST_ASSERT_EQUAL_UINT32(1, feeds);
    TEST_ASSERT_EQUAL_UINT32(1, controller.timing.late_ticks);
    sending_us = 0;
    timer(0);
    TEST_ASSERT_EQUAL_UINT32(2, feeds);
}

static void test_a_rejected_tick_does_not_feed_the_watchdog(void)
{
    timer(0);
    controller.context.last_time_us = UINT64_C(1) << 40;
    timer(0);
    TEST_ASSERT_EQUAL_UINT32(1, feeds);
    TEST_ASSERT_EQUAL_UINT8(SADDLE_ERROR_TIME, sent[frames_sent - 1u].data[1] >> 4);
}

static void test_result_of_saddle_init_is_returned(void)
{
    config.body_mass_kg = -1.0f;
    TEST_ASSERT_EQUAL_INT(SADDLE_ERROR_CONFIG, saddle_controller_init(&controller, &config, false));
    timer(0);
    TEST_ASSERT_EQUAL_UINT32(0, feeds);
}

static void test_missed_ticks_are_counted_not_made_up_for(void)
{
    timer(0);
    rounds += 3;
    timer(0);
    TEST_ASSERT_EQUAL_UINT32(2, controller.timing.ticks);
    TEST_ASSERT_EQUAL_UINT32(3, controller.timing.missed_ticks);
    TEST_ASSERT_EQUAL_UINT64(5 * SADDLE_TICK_US, controller.inbox.input.time_us);
}

static void test_missing_measurements_age(void)
{
    bring_set(0, SADDLE_TICK_US - 5000u);
    timer(0);
    const saddle_measurement_t *measurement = &controller.inbox.input.measurement;
    TEST_ASSERT_EQUAL_UINT32(5000, measurement->com.age_us);
    TEST_ASSERT_EQUAL_UINT32(SADDLE_AGE_NEVER_US, controller.inbox.input.command_age_us);
    timer(0);
    TEST_ASSERT_EQUAL_UINT32(SADDLE_TICK_US + 5000u, measurement->foot[SADDLE_LEFT].age_us);
}

static void test_the_newest_waiting_frame_is_used(void)
{
    bring_set(0, 10000);
    bring_set(1, 20000);
    bring_set(2, 30000);
    timer(0);
    TEST_ASSERT_EQUAL_UINT32(SADDLE_TICK_US - 30000u,
                             controller.inbox.input.measurement.com.age_us);
}

static void test_frames_without_room_are_counted(void)
{
    room = 20;
    timer(0);
    TEST_ASSERT_EQUAL_UINT32(SADDLE_WIRE_OUTPUT_FRAMES - 20u, controller.not_sent);
    TEST_ASSERT_EQUAL_UINT32(1, feeds);
}

static void test_frames_lost_by_the_board_are_reported(void)
{
    lost = 3;
    timer(0);
    TEST_ASSERT_EQUAL_UINT16(3, rejected_frames(&sent[frames_sent - 1u]));
}

static void test_a_flood_does_not_delay_a_tick(void)
{
    flood = true;
    timer(0);
    TEST_ASSERT_EQUAL_UINT32(1, feeds);
}

static void test_in_lockstep_a_set_makes_a_tick_due(void)
{
    (void)saddle_controller_init(&controller, &config, true);
    timer(0);
    TEST_ASSERT_EQUAL_UINT32(0, frames_sent);
    now_us = 5000000; /* of a clock that does not matter */
    bring_set(0, 1);
    bring_set(1, 2);
    saddle_controller_step(&controller);
    TEST_ASSERT_EQUAL_UINT32(SADDLE_WIRE_OUTPUT_FRAMES, frames_sent);
    TEST_ASSERT_EQUAL_UINT64(0, controller.inbox.input.time_us);
    saddle_controller_step(&controller);
    TEST_ASSERT_EQUAL_UINT32(2 * SADDLE_WIRE_OUTPUT_FRAMES, frames_sent);
    TEST_ASSERT_EQUAL_UINT64(SADDLE_TICK_US, controller.inbox.input.time_us);
    TEST_ASSERT_EQUAL_UINT32(0, controller.inbox.input.measurement.com.age_us);
    TEST_ASSERT_EQUAL_UINT32(0, controller.timing.latency_us);
    TEST_ASSERT_EQUAL_UINT32(0, controller.timing.late_ticks);
    saddle_controller_step(&controller);
    TEST_ASSERT_EQUAL_UINT32(2, controller.timing.ticks);
}

static const uint8_t KEY[SADDLE_CMAC_LENGTH] = {7, 1, 9};

/** With a code of that session and freshness. */
static void bring_command(uint32_t session, uint16_t freshness)
{
    const saddle_command_t wanted = {.mode = SADDLE_COMMAND_WALK, .speed_m_s = 1.0f};
    saddle_cmac_key_t key;
    saddle_frame_t command, code;
    saddle_cmac_prepare(&key, KEY);
    saddle_wire_encode_command(&wanted, (uint8_t)freshness, &command);
    saddle_wire_encode_code(&key, session, freshness, &command, &code);
    bring(&code, now_us);
    bring(&command, now_us);
}

static void test_commands_need_a_code_of_the_session_that_was_sent(void)
{
    saddle_controller_require_codes(&controller, KEY);
    random_bits = 0x5EED1234u;
    timer(0);
    TEST_ASSERT_EQUAL_UINT32(SADDLE_WIRE_OUTPUT_FRAMES + 1u, frames_sent);
    TEST_ASSERT_EQUAL_HEX16(0x13C, sent[0].id);
    TEST_ASSERT_EQUAL_HEX32(0x5EED1234u, controller.inbox.receiver.guard.session);
    bring_command(0x5EED1234u, 1);
    timer(0);
    TEST_ASSERT_EQUAL_UINT8(SADDLE_COMMAND_WALK, controller.context.command.mode);
    TEST_ASSERT_EQUAL_HEX32(0x5EED1234u, controller.inbox.receiver.guard.session);
}

static void test_commands_with_codes_of_another_session_are_rejected(void)
{
    saddle_controller_require_codes(&controller, KEY);
    random_bits = 1;
    timer(0);
    bring_command(2, 1);
    timer(0);
    TEST_ASSERT_EQUAL_UINT8(SADDLE_COMMAND_STAND, controller.context.command.mode);
    TEST_ASSERT_EQUAL_UINT32(1, controller.inbox.receiver.bad_code);
}

static void test_without_random_bits_there_is_no_session_until_there_are(void)
{
    saddle_controller_require_codes(&controller, KEY);
    timer(0);
    bring_command(0, 1);
    timer(0);
    TEST_ASSERT_EQUAL_UINT32(2u * SADDLE_WIRE_OUTPUT_FRAMES, frames_sent);
    TEST_ASSERT_EQUAL_UINT8(SADDLE_COMMAND_STAND, controller.context.command.mode);
    random_bits = 3;
    timer(0);
    TEST_ASSERT_EQUAL_UINT32(3u * SADDLE_WIRE_OUTPUT_FRAMES + 1u, frames_sent);
}

static void test_where_no_codes_are_required_there_is_no_session(void)
{
    random_bits = 4;
    timer(0);
    TEST_ASSERT_EQUAL_UINT32(SADDLE_WIRE_OUTPUT_FRAMES, frames_sent);
}

/** 40 passes in a tick, of 2 ms. */
static void drive_joints(void)
{
    saddle_joint_loop_config_t joints = saddle_joint_loop_default(&config);
    joints.passes = 40;
    TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_controller_drive_joints(&controller, &joints));
    period_us = saddle_joint_loop_period_us(&joints);
}

static void bring_sensors(uint8_t number, uint64_t received_us)
{
    const saddle_sensors_t sensors = {.load_n = {310.0f, 310.0f},
                                      .accelerometer_m_s2 = {.z = 9.8f}};
    saddle_frame_t frames[SADDLE_WIRE_SENSED_FRAMES];
    saddle_wire_encode_sensors(&sensors, number, frames);
    for (size_t i = 0; i < SADDLE_WIRE_SENSED_FRAMES; ++i) {
        bring(&frames[i], received_us);
    }
}

static void test_joints_are_driven_many_times_in_a_tick(void)
{
    drive_joints();
    for (uint32_t pass = 1; pass < 40u; ++pass) {
        bring_sensors((uint8_t)pass, rounds * period_us + 1400u);
        timer(100);
        TEST_ASSERT_EQUAL_UINT32(SADDLE_WIRE_JOINT_FRAMES, frames_sent);
        TEST_ASSERT_EQUAL_HEX16(0xB0, sent[frames_sent - 1u].id);
        TEST_ASSERT_EQUAL_UINT8(pass & 15u, sent[0].data[1] & 15u);
        TEST_ASSERT_EQUAL_UINT32(600, controller.inbox.sensors.imu_age_us);
        frames_sent = 0;
    }
    TEST_ASSERT_EQUAL_UINT32(0, controller.timing.ticks);
    timer(100);
    TEST_ASSERT_EQUAL_UINT32(SADDLE_WIRE_OUTPUT_FRAMES + SADDLE_WIRE_JOINT_FRAMES, frames_sent);
    TEST_ASSERT_EQUAL_HEX16(0x90, sent[SADDLE_WIRE_OUTPUT_FRAMES].id);
    TEST_ASSERT_EQUAL_UINT32(1, controller.timing.ticks);
    TEST_ASSERT_EQUAL_UINT64(SADDLE_TICK_US, controller.inbox.input.time_us);
    TEST_ASSERT_EQUAL_UINT64(SADDLE_TICK_US, controller.joints.estimator.time_us);
    TEST_ASSERT_EQUAL_UINT32(1, feeds);
}

static void test_a_tick_whose_pass_was_missed_is_made_in_the_next(void)
{
    drive_joints();
    rounds = 42;
    timer(0);
    TEST_ASSERT_EQUAL_UINT32(1, controller.timing.ticks);
    TEST_ASSERT_EQUAL_UINT32(0, controller.timing.missed_ticks);
    TEST_ASSERT_EQUAL_UINT64(43u * 2000u, controller.inbox.input.time_us);
    timer(0);
    TEST_ASSERT_EQUAL_UINT32(1, controller.timing.ticks);
    rounds = 160;
    timer(0);
    TEST_ASSERT_EQUAL_UINT32(2, controller.timing.ticks);
    TEST_ASSERT_EQUAL_UINT32(2, controller.timing.missed_ticks);
}

static void test_in_lockstep_a_set_of_sensors_makes_a_pass_due(void)
{
    (void)saddle_controller_init(&controller, &config, true);
    drive_joints();
    saddle_controller_step(&controller);
    TEST_ASSERT_EQUAL_UINT32(0, frames_sent);
    for (uint32_t pass = 0; pass < 41u; ++pass) {
        frames_sent = 0;
        bring_sensors((uint8_t)pass, 1);
        saddle_controller_step(&controller);
        const uint32_t ticked = pass % 40u == 0u ? SADDLE_WIRE_OUTPUT_FRAMES : 0u;
        TEST_ASSERT_EQUAL_UINT32(ticked + SADDLE_WIRE_JOINT_FRAMES, frames_sent);
        TEST_ASSERT_EQUAL_UINT64(2000u * pass, controller.joints.estimator.time_us);
    }
    TEST_ASSERT_EQUAL_UINT64(SADDLE_TICK_US, controller.inbox.input.time_us);
    TEST_ASSERT_EQUAL_UINT32(2, controller.timing.ticks);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_timer_makes_a_tick_due_once);
    RUN_TEST(test_a_late_tick_does_not_feed_the_watchdog);
    RUN_TEST(test_a_rejected_tick_does_not_feed_the_watchdog);
    RUN_TEST(test_result_of_saddle_init_is_returned);
    RUN_TEST(test_missed_ticks_are_counted_not_made_up_for);
    RUN_TEST(test_missing_measurements_age);
    RUN_TEST(test_the_newest_waiting_frame_is_used);
    RUN_TEST(test_frames_without_room_are_counted);
    RUN_TEST(test_frames_lost_by_the_board_are_reported);
    RUN_TEST(test_a_flood_does_not_delay_a_tick);
    RUN_TEST(test_in_lockstep_a_set_makes_a_tick_due);
    RUN_TEST(test_commands_need_a_code_of_the_session_that_was_sent);
    RUN_TEST(test_commands_with_codes_of_another_session_are_rejected);
    RUN_TEST(test_without_random_bits_there_is_no_session_until_there_are);
    RUN_TEST(test_where_no_codes_are_required_there_is_no_session);
    RUN_TEST(test_joints_are_driven_many_times_in_a_tick);
    RUN_TEST(test_a_tick_whose_pass_was_missed_is_made_in_the_next);
    RUN_TEST(test_in_lockstep_a_set_of_sensors_makes_a_pass_due);
    return UNITY_END();
}
