/** What the cross test with Python cannot see: check values, the layout of a frame, the receiver. */
#include <saddlewalk/wire.h>

#include <float.h>
#include <math.h>
#include <string.h>
#include <unity.h>

static saddle_wire_receiver_t receiver;

void setUp(void)
{
    memset(&receiver, 0, sizeof receiver);
}

void tearDown(void) {}

static saddle_frame_t command_frame(uint8_t counter)
{
    const saddle_command_t command = {
        .mode = SADDLE_COMMAND_WALK, .speed_m_s = 1.2f, .heel_strike_rad = 0.1745f};
    saddle_frame_t frame;
    saddle_wire_encode_command(&command, counter, &frame);
    return frame;
}

static saddle_wire_message_t accept(const saddle_frame_t *frame)
{
    return saddle_wire_accept(&receiver, frame->id, frame->data, sizeof frame->data);
}

static void test_crc_check_value(void)
{
    TEST_ASSERT_EQUAL_HEX8(0x4B, saddle_wire_crc((const uint8_t *)"123456789", 9));
    TEST_ASSERT_EQUAL_HEX8(0x00, saddle_wire_crc(NULL, 0));
}

/** Written out by hand from the DBC: 12000, 1745, little endian, then the wire version. */
static void test_command_bytes(void)
{
    const saddle_frame_t frame = command_frame(5);
    const uint8_t covered[9] = {0x00, 0x01, 0x15, 0xE0, 0x2E, 0xD1, 0x06, SADDLE_WIRE_VERSION, 0};
    TEST_ASSERT_EQUAL_HEX16(0x100, frame.id);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(&covered[2], &frame.data[1], 7);
    TEST_ASSERT_EQUAL_HEX8(saddle_wire_crc(covered, sizeof covered), frame.data[0]);
    TEST_ASSERT_EQUAL_UINT8(5, saddle_wire_counter(frame.data));
}

/** Raw value of a commanded speed. */
static int16_t raw_speed(float speed_m_s)
{
    const saddle_command_t command = {.speed_m_s = speed_m_s};
    saddle_frame_t frame;
    saddle_wire_encode_command(&command, 0, &frame);
    return (int16_t)(uint16_t)(frame.data[2] | (uint32_t)frame.data[3] << 8);
}

static void test_numbers_round_half_away_from_zero(void)
{
    for (int32_t halves = -65534; halves <= 65534; ++halves) {
        const float tie = (float)halves * 0.5e-4f;
        const float values[] = {nextafterf(tie, -4.0f), tie, nextafterf(tie, 4.0f)};
        for (size_t i = 0; i < 3u; ++i) {
            const float nearest = fminf(fmaxf(roundf(values[i] / 1.0e-4f), -32767.0f), 32767.0f);
            TEST_ASSERT_EQUAL_INT16((int16_t)nearest, raw_speed(values[i]));
        }
    }
}

static void test_numbers_beyond_the_range_saturate(void)
{
    TEST_ASSERT_EQUAL_INT16(INT16_MAX, raw_speed(3.2768f));
    TEST_ASSERT_EQUAL_INT16(INT16_MAX, raw_speed(FLT_MAX));
    TEST_ASSERT_EQUAL_INT16(-INT16_MAX, raw_speed(-3.2768f));
    TEST_ASSERT_EQUAL_INT16(-INT16_MAX, raw_speed(-FLT_MAX));
    TEST_ASSERT_EQUAL_INT16(INT16_MIN, raw_speed(INFINITY));
    TEST_ASSERT_EQUAL_INT16(INT16_MIN, raw_speed(-INFINITY));
    TEST_ASSERT_EQUAL_INT16(INT16_MIN, raw_speed(NAN));
}

static void test_every_single_bit_error_is_rejected(void)
{
    for (size_t bit = 0; bit < 8u * SADDLE_WIRE_LENGTH; ++bit) {
        saddle_frame_t frame = command_frame(0);
        frame.data[bit / 8u] ^= (uint8_t)(1u << (bit % 8u));
        TEST_ASSERT_EQUAL_INT(SADDLE_WIRE_NONE, accept(&frame));
    }
    TEST_ASSERT_EQUAL_UINT32(64, receiver.bad_crc);
}

static void test_frame_under_another_identifier_is_rejected(void)
{
    saddle_frame_t frames[SADDLE_WIRE_MEASURED_FRAMES];
    const saddle_measurement_t measurement = {.com.height_m = 1.0f};
    saddle_wire_encode_measurement(&measurement, 0, frames);
    TEST_ASSERT_EQUAL_INT(SADDLE_WIRE_NONE,
                          saddle_wire_accept(&receiver, frames[2].id, frames[1].data, 8));
    TEST_ASSERT_EQUAL_UINT32(1, receiver.bad_crc);
}

static void test_messages_that_the_firmware_does_not_receive_are_malformed(void)
{
    const saddle_frame_t frame = command_frame(0);
    const uint32_t identifiers[] = {0x101, 0x127, 0x128, 0x140, 0x7FF, 0x80000100u, UINT32_MAX};
    for (size_t i = 0; i < sizeof identifiers / sizeof identifiers[0]; ++i) {
        TEST_ASSERT_EQUAL_INT(SADDLE_WIRE_NONE,
                              saddle_wire_accept(&receiver, identifiers[i], frame.data, 8));
    }
    for (size_t length = 0; length < SADDLE_WIRE_LENGTH; ++length) {
        TEST_ASSERT_EQUAL_INT(SADDLE_WIRE_NONE,
                              saddle_wire_accept(&receiver, frame.id, NULL, length));
    }
    TEST_ASSERT_EQUAL_UINT32(15, receiver.malformed);
    TEST_ASSERT_EQUAL_UINT32(0, receiver.accepted);
}

static void reseal(saddle_frame_t *frame)
{
    uint8_t covered[9] = {(uint8_t)frame->id, (uint8_t)(frame->id >> 8)};
    memcpy(&covered[2], &frame->data[1], 7);
    frame->data[0] = saddle_wire_crc(covered, sizeof covered);
}

static void expect_version(uint8_t version, saddle_wire_message_t message, uint32_t bad)
{
    saddle_frame_t frame = command_frame((uint8_t)(receiver.alive[0].last + 1u));
    frame.data[6] = version;
    reseal(&frame);
    TEST_ASSERT_EQUAL_INT(message, accept(&frame));
    TEST_ASSERT_EQUAL_UINT32(bad, receiver.bad_version);
    TEST_ASSERT_EQUAL_UINT8(version, receiver.other_version);
}

static void test_other_wire_versions_but_the_older_ones_that_fit_are_rejected(void)
{
    expect_version(SADDLE_WIRE_VERSION + 1, SADDLE_WIRE_NONE, 1);
    expect_version(SADDLE_WIRE_OLDEST_VERSION, SADDLE_WIRE_COMMAND, 1);
    expect_version(SADDLE_WIRE_OLDEST_VERSION - 1, SADDLE_WIRE_NONE, 2);
}

/** Counter 5 in round 6 is set 101. */
static void test_a_set_has_one_number_in_all_its_frames(void)
{
    const saddle_measurement_t measurement = {.foot = {{.contact = true}, {.contact = true}}};
    saddle_frame_t frames[1u + SADDLE_WIRE_MEASURED_FRAMES];
    saddle_wire_encode_time(0x12345678, 101, &frames[0]);
    saddle_wire_encode_measurement(&measurement, 101, &frames[1]);
    for (size_t i = 0; i < 1u + SADDLE_WIRE_MEASURED_FRAMES; ++i) {
        TEST_ASSERT_EQUAL_UINT8(101, saddle_wire_set_number(frames[i].data));
        TEST_ASSERT_EQUAL_UINT8(5, saddle_wire_counter(frames[i].data));
    }
    const uint8_t after_crc[7] = {0xC5, 0x78, 0x56, 0x34, 0x12, 0, 0};
    TEST_ASSERT_EQUAL_HEX8_ARRAY(after_crc, &frames[0].data[1], 7);
    TEST_ASSERT_EQUAL_INT(SADDLE_WIRE_MEASURED_TIME, accept(&frames[0]));
    TEST_ASSERT_EQUAL_HEX32(0x12345678, saddle_wire_decode_time(frames[0].data));
}

static void expect_counters(const char *counters, const char *accepted)
{
    for (size_t i = 0; counters[i] != '\0'; ++i) {
        const char digit = counters[i];
        const saddle_frame_t frame =
            command_frame((uint8_t)(digit <= '9' ? digit - '0' : digit - 'a' + 10));
        const char result = accept(&frame) == SADDLE_WIRE_COMMAND ? 'y' : 'n';
        TEST_ASSERT_EQUAL_CHAR_MESSAGE(accepted[i], result, counters);
    }
}

static void test_counter_rule(void)
{
    expect_counters("7", "y");       /* the first, whatever it is */
    expect_counters("8bf3", "yyyy"); /* 1, 3, 4, and 4 over the end */
    expect_counters("334", "nny");   /* repeats */
    expect_counters("9", "n");       /* 5 ahead of 4 */
    expect_counters("ab", "yy");     /* it had restarted there */
    expect_counters("5505", "nnnn"); /* a rejected frame never counts as the last accepted */
    expect_counters("c", "y");
}

static void test_messages_have_separate_counters(void)
{
    saddle_frame_t frames[SADDLE_WIRE_MEASURED_FRAMES];
    const saddle_measurement_t measurement = {.com.height_m = 1.0f};
    saddle_wire_encode_measurement(&measurement, 9, frames);
    expect_counters("0", "y");
    TEST_ASSERT_EQUAL_INT(SADDLE_WIRE_MEASURED_COM, accept(&frames[0]));
    TEST_ASSERT_EQUAL_INT(SADDLE_WIRE_MEASURED_LEFT, accept(&frames[1]));
    TEST_ASSERT_EQUAL_INT(SADDLE_WIRE_MEASURED_RIGHT, accept(&frames[2]));
}

static void test_decoding_leaves_ages_and_other_parts(void)
{
    saddle_frame_t frames[SADDLE_WIRE_MEASURED_FRAMES];
    const saddle_measurement_t sent = {
        .foot = {{.cop_m = {-0.25f, 0.125f}, .ground_m_s = -1.2f, .contact = true},
                 {.cop_m = {0.5f, NAN}, .ground_m_s = NAN}}};
    saddle_measurement_t received = {.com = {.height_m = 0.875f, .age_us = 11},
                                     .foot = {{.age_us = 22}, {.age_us = 33, .contact = true}}};
    saddle_wire_encode_measurement(&sent, 0, frames);
    saddle_wire_decode_measured(SADDLE_WIRE_MEASURED_LEFT, frames[1].data, &received);
    saddle_wire_decode_measured(SADDLE_WIRE_MEASURED_RIGHT, frames[2].data, &received);
    saddle_wire_decode_measured(SADDLE_WIRE_NONE, frames[0].data, &received);
    TEST_ASSERT_EQUAL_FLOAT(-0.25f, received.foot[SADDLE_LEFT].cop_m.x);
    TEST_ASSERT_TRUE(received.foot[SADDLE_LEFT].contact);
    TEST_ASSERT_EQUAL_FLOAT(-1.2f, received.foot[SADDLE_LEFT].ground_m_s);
    TEST_ASSERT_TRUE(isnan(received.foot[SADDLE_RIGHT].ground_m_s));
    TEST_ASSERT_EQUAL_FLOAT(0.5f, received.foot[SADDLE_RIGHT].cop_m.x);
    TEST_ASSERT_TRUE(isnan(received.foot[SADDLE_RIGHT].cop_m.y));
    TEST_ASSERT_FALSE(received.foot[SADDLE_RIGHT].contact);
    TEST_ASSERT_EQUAL_FLOAT(0.875f, received.com.height_m);
    TEST_ASSERT_EQUAL_UINT32(11, received.com.age_us);
    TEST_ASSERT_EQUAL_UINT32(22, received.foot[SADDLE_LEFT].age_us);
    TEST_ASSERT_EQUAL_UINT32(33, received.foot[SADDLE_RIGHT].age_us);
}

/** Written out by hand from the DBC: stopping in bits 4 and 5 of byte 1; 0.25 s, the end of the
 *  range for what never comes, not available for what is no number; -0.1 rad, 0.3 rad, 2 mm. */
/** The three numbers of a frame, and the half byte beside the counter. */
static void expect_frame(const saddle_frame_t *frame, uint16_t id, uint8_t half_byte,
                         const int16_t numbers[3])
{
    TEST_ASSERT_EQUAL_HEX16(id, frame->id);
    TEST_ASSERT_EQUAL_HEX8(half_byte, frame->data[1] >> 4);
    for (size_t i = 0; i < 3u; ++i) {
        const uint32_t raw = frame->data[2u + 2u * i] | (uint32_t)frame->data[3u + 2u * i] << 8;
        TEST_ASSERT_EQUAL_INT16_MESSAGE(numbers[i], (int16_t)(uint16_t)raw, "in units of the DBC");
    }
}

/** Each number of the plan at its place, in units of the DBC: 0.1 mm, 0.2 mm/s, 0.2 mrad. */
static void test_plan_frames(void)
{
    static const int16_t expected[8][3] = {
        {1000, -2000, 10000}, {6000, -500, 750},    {3000, 1100, 0},    {-3000, -1100, 200},
        {10000, -250, 1500},  {7000, -1050, 10203}, {2500, 750, 12000}, {15000, 7000, 513},
    };
    const saddle_wire_health_t health = {.late_ticks = 0};
    saddle_frame_t frames[SADDLE_WIRE_OUTPUT_FRAMES];
    const saddle_output_t output = {
        .plan = {.valid = true,
                 .phase = 2,
                 .support = SADDLE_RIGHT,
                 .step_count = 513,
                 .theta_rad = 3.0f,
                 .speed_m_s = 1.2f,
                 .step_length_m = 0.7f,
                 .com_m = {0.1f, -0.2f, 1.0f},
                 .com_velocity_m_s = {1.2f, -0.1f, 0.15f},
                 .foot_m = {{0.3f, 0.11f, 0.0f}, {-0.3f, -0.11f, 0.02f}},
                 .swing_velocity_m_s = {2.0f, -0.05f, 0.3f},
                 .leg_length_m = 1.0203f,
                 .toe_off_rad = 0.5f,
                 .heel_strike_rad = 0.15f,
                 .landing_m = {0.7f, -0.105f}}};
    saddle_wire_encode_output(&output, &health, 9, frames);
    for (size_t i = 0; i < 7u; ++i) {
        expect_frame(&frames[i], (uint16_t)(0x120u + i), 0, expected[i]);
    }
    expect_frame(&frames[7], 0x127, 0x1u | 0x1u << 1 | 0x2u << 2, expected[7]);
}

static void test_a_command_is_decoded(void)
{
    const saddle_frame_t frame = command_frame(1);
    saddle_command_t command = {.mode = 9};
    saddle_wire_decode_command(frame.data, &command);
    TEST_ASSERT_EQUAL_UINT8(SADDLE_COMMAND_WALK, command.mode);
    TEST_ASSERT_EQUAL_FLOAT(1.2f, command.speed_m_s);
    TEST_ASSERT_EQUAL_FLOAT(0.1745f, command.heel_strike_rad);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, command.turn_rate_rad_s);
}

/** In byte 7: steps of 0.01 rad/s, which saturate, and -128 for what is no number. */
static void test_turning_rate_has_a_byte(void)
{
    static const struct {
        float rate_rad_s, decoded_rad_s;
        uint8_t byte;
    } table[] = {{0.4f, 0.4f, 0x28},   {-0.014f, -0.01f, 0xFF}, {0.005f, 0.01f, 0x01},
                 {-0.3f, -0.3f, 0xE2}, {5.0f, 1.27f, 0x7F},     {-400.0f, -1.27f, 0x81},
                 {1e9f, 1.27f, 0x7F}};
    saddle_command_t command = {.mode = SADDLE_COMMAND_WALK, .speed_m_s = 0.6f};
    saddle_frame_t frame;
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
        saddle_command_t decoded;
        command.turn_rate_rad_s = table[i].rate_rad_s;
        saddle_wire_encode_command(&command, 1, &frame);
        TEST_ASSERT_EQUAL_HEX8(table[i].byte, frame.data[7]);
        saddle_wire_decode_command(frame.data, &decoded);
        TEST_ASSERT_EQUAL_FLOAT(table[i].decoded_rad_s, decoded.turn_rate_rad_s);
    }
    command.turn_rate_rad_s = NAN;
    saddle_wire_encode_command(&command, 1, &frame);
    TEST_ASSERT_EQUAL_HEX8(0x80, frame.data[7]);
    saddle_wire_decode_command(frame.data, &command);
    TEST_ASSERT_TRUE(command.turn_rate_rad_s != command.turn_rate_rad_s);
}

/** Written out by hand from the DBC: 20000 (0.1 mrad), 1000 and -2500 (0.2 mm^-1 of a metre); then 0,
 *  -500 and 2345. */
static void test_way_bytes(void)
{
    const uint8_t way[7] = {0x07, 0x20, 0x4E, 0xE8, 0x03, 0x3C, 0xF6};
    const uint8_t yaw[7] = {0x07, 0x00, 0x00, 0x0C, 0xFE, 0x29, 0x09};
    const saddle_wire_health_t health = {.late_ticks = 0};
    const saddle_output_t output = {.plan = {.valid = true,
                                             .heading_rad = 2.0f,
                                             .curvature_1_m = {0.2f, -0.5f},
                                             .foot_yaw_rad = {0.0f, -0.05f},
                                             .pelvis_yaw_rad = 0.2345f}};
    saddle_frame_t frames[SADDLE_WIRE_OUTPUT_FRAMES];
    saddle_wire_encode_output(&output, &health, 7, frames);
    TEST_ASSERT_EQUAL_HEX16(0x12E, frames[14].id);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(way, &frames[14].data[1], 7);
    TEST_ASSERT_EQUAL_HEX16(0x12F, frames[15].id);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(yaw, &frames[15].data[1], 7);
}

static void test_a_measured_com_is_decoded(void)
{
    saddle_frame_t frames[SADDLE_WIRE_MEASURED_FRAMES];
    const saddle_measurement_t sent = {.com = {.height_m = 1.25f, .velocity_m_s = {1.5f, -0.5f}},
                                       .foot = {{.cop_m = {-0.25f, 0.125f}}}};
    saddle_measurement_t received = {.com.age_us = 11};
    saddle_wire_encode_measurement(&sent, 0, frames);
    saddle_wire_decode_measured(SADDLE_WIRE_MEASURED_COM, frames[0].data, &received);
    saddle_wire_decode_measured(SADDLE_WIRE_MEASURED_LEFT, frames[1].data, &received);
    TEST_ASSERT_EQUAL_FLOAT(1.25f, received.com.height_m);
    TEST_ASSERT_EQUAL_FLOAT(1.5f, received.com.velocity_m_s.x);
    TEST_ASSERT_EQUAL_FLOAT(-0.5f, received.com.velocity_m_s.y);
    TEST_ASSERT_EQUAL_FLOAT(0.125f, received.foot[SADDLE_LEFT].cop_m.y);
    TEST_ASSERT_EQUAL_UINT32(11, received.com.age_us);
}

static void test_events_and_pitch_bytes(void)
{
    const uint8_t events[7] = {0x37, 0xFA, 0x00, 0xFF, 0x7F, 0x00, 0x80};
    const uint8_t pitch[7] = {0x07, 0x0C, 0xFE, 0xDC, 0x05, 0x14, 0x00};
    const saddle_wire_health_t health = {.late_ticks = 0};
    const saddle_output_t output = {.plan = {.valid = true,
                                             .mode = SADDLE_MODE_STOPPING,
                                             .time_to_via_point_s = 0.25f,
                                             .time_to_heel_strike_s = 1000.0f,
                                             .time_to_toe_off_s = NAN,
                                             .foot_pitch_rad = {-0.1f, 0.3f},
                                             .knee_flexion_m = 0.002f}};
    saddle_frame_t frames[SADDLE_WIRE_OUTPUT_FRAMES];
    saddle_wire_encode_output(&output, &health, 7, frames);
    TEST_ASSERT_EQUAL_HEX16(0x128, frames[8].id);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(events, &frames[8].data[1], 7);
    TEST_ASSERT_EQUAL_HEX16(0x129, frames[9].id);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(pitch, &frames[9].data[1], 7);
    TEST_ASSERT_EQUAL_HEX16(0x140, frames[SADDLE_WIRE_OUTPUT_FRAMES - 1u].id);
}

static void test_a_plan_that_is_not_valid_has_no_numbers(void)
{
    const uint8_t nothing[7] = {0x00, 0x00, 0x80, 0x00, 0x80, 0x00, 0x80};
    const saddle_wire_health_t health = {.late_ticks = 0};
    const saddle_output_t output = {.plan = {.valid = false}};
    saddle_frame_t frames[SADDLE_WIRE_OUTPUT_FRAMES];
    saddle_wire_encode_output(&output, &health, 0, frames);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(nothing, &frames[8].data[1], 7);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(nothing, &frames[9].data[1], 7);
}

static saddle_output_t sample_output(void)
{
    return (saddle_output_t){
        .scores = {.valid = SADDLE_VALID_STOP, .excess_stop_j = 31.2f, .paper_stable = true},
        .verdict = {.level = SADDLE_LEVEL_CAUTION,
                    .reason = SADDLE_REASON_OFF_TRACK,
                    .compared = true,
                    .on_track = true,
                    .excess_track_j = -0.5f,
                    .ebos_com_m = 0.25f,
                    .ebos_xcom_m = -0.3f,
                    .xcom_deviation_m = {0.05f, -0.02f},
                    .recovery = {.found = true,
                                 .foot = SADDLE_RIGHT,
                                 .landing_m = {0.7f, -0.15f},
                                 .margin_m = 0.2f}}};
}

static void assert_judgement(const saddle_output_t *output, const uint8_t expected[4][7])
{
    const saddle_wire_health_t health = {.late_ticks = 0};
    saddle_frame_t frames[SADDLE_WIRE_OUTPUT_FRAMES];
    saddle_wire_encode_output(output, &health, 7, frames);
    for (size_t i = 0; i < 4u; ++i) {
        TEST_ASSERT_EQUAL_HEX16(0x133u + i, frames[19u + i].id);
        TEST_ASSERT_EQUAL_HEX8_ARRAY(expected[i], &frames[19u + i].data[1], 7);
    }
}

/** Written out by hand from the DBC. Byte 1 holds the bits above the counter: on track and stable
 *  by the paper; compared; found and the right foot. Then 312 and -5 (0.1 J), 2500 and -3000
 *  (0.1 mm), level 2 and reason 10, 500 and -200, 7000, -1500 and 2000. */
static void test_verdict_bytes(void)
{
    const uint8_t expected[4][7] = {{0x67, 0x38, 0x01, 0xFB, 0xFF, 0x00, 0x00},
                                    {0x07, 0xC4, 0x09, 0x48, 0xF4, 0x00, 0x00},
                                    {0x17, 0x02, 0x0A, 0xF4, 0x01, 0x38, 0xFF},
                                    {0x57, 0x58, 0x1B, 0x24, 0xFA, 0xD0, 0x07}};
    const saddle_output_t output = sample_output();
    assert_judgement(&output, expected);
}

/** The energies hang on a bit of their own; all that the plan is needed for on `compared`. */
static void test_results_that_were_not_compared_have_no_numbers(void)
{
    const uint8_t not_compared[4][7] = {{0x67, 0x38, 0x01, 0x00, 0x80, 0x00, 0x00},
                                        {0x07, 0x00, 0x80, 0x00, 0x80, 0x00, 0x00},
                                        {0x07, 0x02, 0x0A, 0x00, 0x80, 0x00, 0x80},
                                        {0x57, 0x00, 0x80, 0x00, 0x80, 0x00, 0x80}};
    saddle_output_t output = sample_output();
    output.verdict.compared = false;
    assert_judgement(&output, not_compared);

    const uint8_t no_step_no_stop[4][7] = {{0x67, 0x00, 0x80, 0x00, 0x80, 0x00, 0x00},
                                           {0x07, 0xC4, 0x09, 0x48, 0xF4, 0x00, 0x00},
                                           {0x17, 0x02, 0x0A, 0xF4, 0x01, 0x38, 0xFF},
                                           {0x47, 0x00, 0x80, 0x00, 0x80, 0x30, 0xF8}};
    output = sample_output();
    output.scores.valid = SADDLE_VALID_ALL & ~(uint32_t)SADDLE_VALID_STOP;
    output.verdict.recovery.found = false;
    output.verdict.recovery.margin_m = -0.2f;
    assert_judgement(&output, no_step_no_stop);
}

static void assert_balance(const saddle_output_t *output, const uint8_t expected[4][7])
{
    const saddle_wire_health_t health = {.late_ticks = 0};
    saddle_frame_t frames[SADDLE_WIRE_OUTPUT_FRAMES];
    saddle_wire_encode_output(output, &health, 7, frames);
    for (size_t i = 0; i < 4u; ++i) {
        TEST_ASSERT_EQUAL_HEX16(0x137u + i, frames[23u + i].id);
        TEST_ASSERT_EQUAL_HEX8_ARRAY(expected[i], &frames[23u + i].data[1], 7);
    }
}

/** Written out by hand from the DBC: driver 16, then -250 and 1000 (1e-4); 6000, -50 (0.2 mm/s) and
 *  10000 (0.1 mm); 560 ms, 6500 and 1500 (0.1 mm); 350 and 2500 (1e-4). */
static void test_balance_bytes(void)
{
    const uint8_t expected[4][7] = {{0x07, 0x10, 0x00, 0x06, 0xFF, 0xE8, 0x03},
                                    {0x07, 0x70, 0x17, 0xCE, 0xFF, 0x10, 0x27},
                                    {0x07, 0x30, 0x02, 0x64, 0x19, 0xDC, 0x05},
                                    {0x07, 0x5E, 0x01, 0xC4, 0x09, 0x00, 0x00}};
    const saddle_output_t output = {.verdict = {.driver = SADDLE_REASON_SINKING,
                                                .margin_known = true,
                                                .margin = -0.025f,
                                                .caution_below = 0.1f},
                                    .walk = {.velocity_m_s = {1.2f, -0.01f},
                                             .height_m = 1.0f,
                                             .ripple = 0.035f,
                                             .step_time_s = 0.56f,
                                             .step_length_m = 0.65f,
                                             .step_width_m = 0.15f,
                                             .step_margin = 0.25f}};
    assert_balance(&output, expected);
}

/** Each part has a sign of its own that it is known: margin_known, a height, a step time, a ripple. */
static void test_values_that_were_not_learned_have_no_numbers(void)
{
    const uint8_t nothing[4][7] = {{0x07, 0x00, 0x00, 0x00, 0x80, 0x00, 0x80},
                                   {0x07, 0x00, 0x80, 0x00, 0x80, 0x00, 0x80},
                                   {0x07, 0x00, 0x80, 0x00, 0x80, 0x00, 0x80},
                                   {0x07, 0x00, 0x80, 0x00, 0x80, 0x00, 0x00}};
    const uint8_t no_step[4][7] = {{0x07, 0x00, 0x00, 0x00, 0x80, 0x00, 0x80},
                                   {0x07, 0x00, 0x00, 0x00, 0x00, 0x10, 0x27},
                                   {0x07, 0x00, 0x80, 0x00, 0x80, 0x00, 0x80},
                                   {0x07, 0x5E, 0x01, 0x00, 0x80, 0x00, 0x00}};
    saddle_output_t output = {.status = SADDLE_ERROR_TIME};
    assert_balance(&output, nothing);
    output.walk = (saddle_learned_walk_t){.height_m = 1.0f, .ripple = 0.035f};
    assert_balance(&output, no_step);
}

/** Written out by hand from the DBC: 80.25 ms, 0.13 ms and the end of the range; counts that saturate
 *  beside one that wraps; LCM, then 80, 7, 4095 and 0 ms in 12 bits each; status and limits 0. */
static void test_process_bytes(void)
{
    const uint8_t expected[4][7] = {{0x07, 0x59, 0x1F, 0x0D, 0x00, 0xFF, 0x7F},
                                    {0x07, 0x03, 0xFF, 0x00, 0x02, 0x05, 0x00},
                                    {0x27, 0x50, 0x70, 0x00, 0xFF, 0x0F, 0x00},
                                    {0x07, 0x00, SADDLE_WIRE_VERSION, 0x04, 0x00, 0xFF, 0xFF}};
    const saddle_wire_health_t health = {.late_ticks = 4,
                                         .rejected_frames = 70000,
                                         .period_us = 80250,
                                         .latency_us = 130,
                                         .latency_max_us = 400000,
                                         .command_source = 2,
                                         .input_age_us = {80000, 7999, SADDLE_AGE_NEVER_US, 400},
                                         .accepted = 65536 + 5,
                                         .malformed = 3,
                                         .bad_crc = 256,
                                         .bad_counter = 2};
    const saddle_output_t output = {.status = SADDLE_OK};
    saddle_frame_t frames[SADDLE_WIRE_OUTPUT_FRAMES];
    saddle_wire_encode_output(&output, &health, 7, frames);
    for (size_t i = 0; i < 4u; ++i) {
        TEST_ASSERT_EQUAL_HEX16(0x13Du + i, frames[27u + i].id);
        TEST_ASSERT_EQUAL_HEX8_ARRAY(expected[i], &frames[27u + i].data[1], 7);
    }
}

static const uint8_t KEY[SADDLE_CMAC_LENGTH] = {1, 2, 3};

/** A COMMAND under a code; whether it is accepted. */
static bool accepts_frame(uint32_t session, uint16_t freshness, saddle_frame_t command)
{
    saddle_cmac_key_t prepared;
    saddle_frame_t code;
    saddle_cmac_prepare(&prepared, KEY);
    saddle_wire_encode_code(&prepared, session, freshness, &command, &code);
    (void)accept(&code);
    return accept(&command) == SADDLE_WIRE_COMMAND;
}

static bool accepts(uint32_t session, uint16_t freshness)
{
    return accepts_frame(session, freshness, command_frame((uint8_t)freshness));
}

static void test_before_a_session_no_code_is_valid(void)
{
    saddle_wire_require_auth(&receiver, KEY);
    TEST_ASSERT_FALSE(accepts(0, 1));
    TEST_ASSERT_EQUAL_UINT32(1, receiver.bad_code);
    saddle_wire_open_session(&receiver, 0);
    TEST_ASSERT_TRUE(accepts(0, 2));
    TEST_ASSERT_FALSE(accepts(1, 3));
}

/** A code is good for one command, and only with a freshness above the last. */
static void test_a_code_authenticates_one_command_once(void)
{
    saddle_wire_require_auth(&receiver, KEY);
    saddle_wire_open_session(&receiver, 7);
    TEST_ASSERT_TRUE(accepts(7, 18));
    const saddle_frame_t without_code = command_frame(3);
    TEST_ASSERT_EQUAL_INT(SADDLE_WIRE_NONE, accept(&without_code));
    TEST_ASSERT_EQUAL_UINT32(1, receiver.bad_code);
    TEST_ASSERT_FALSE(accepts(7, 3)); /* as counter 3 follows 18, as freshness it does not */
    TEST_ASSERT_EQUAL_UINT32(2, receiver.bad_code);
    TEST_ASSERT_FALSE(accepts(8, 20)); /* of another session */
    TEST_ASSERT_EQUAL_UINT32(3, receiver.bad_code);
    TEST_ASSERT_TRUE(accepts(7, 21));
    TEST_ASSERT_FALSE(accepts_frame(7, 21, command_frame(22))); /* of the same freshness */
    TEST_ASSERT_EQUAL_UINT32(4, receiver.bad_code);
    TEST_ASSERT_EQUAL_UINT32(0, receiver.bad_counter);
}

/** echo efcdab8934120001a1b2c3d4e5f60718 | xxd -r -p | openssl mac -cipher AES-128-CBC -macopt
 *  hexkey:000102030405060708090a0b0c0d0e0f CMAC: 7C65BF73..., a number that the frame has with its
 *  lowest byte first. */
static void test_code_is_the_cmac_of_session_freshness_and_command(void)
{
    static const uint8_t secret[SADDLE_CMAC_LENGTH] = {0, 1, 2,  3,  4,  5,  6,  7,
                                                       8, 9, 10, 11, 12, 13, 14, 15};
    static const uint8_t expected[] = {0x34, 0x12, 0x73, 0xBF, 0x65, 0x7C};
    const saddle_frame_t command = {.id = 0x100,
                                    .data = {0xA1, 0xB2, 0xC3, 0xD4, 0xE5, 0xF6, 0x07, 0x18}};
    saddle_cmac_key_t prepared;
    saddle_frame_t code;
    saddle_cmac_prepare(&prepared, secret);
    saddle_wire_encode_code(&prepared, 0x89ABCDEFu, 0x1234u, &command, &code);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(expected, &code.data[2], sizeof expected);
}

static void test_a_new_session_counts_from_one(void)
{
    saddle_wire_require_auth(&receiver, KEY);
    saddle_wire_open_session(&receiver, 7);
    TEST_ASSERT_TRUE(accepts(7, 30));
    saddle_wire_open_session(&receiver, 8);
    TEST_ASSERT_TRUE(accepts(8, 1));
}

static bool accepts_time(uint32_t session, uint32_t time_us, uint8_t flipped)
{
    saddle_cmac_key_t prepared;
    saddle_frame_t frame;
    saddle_cmac_prepare(&prepared, KEY);
    saddle_wire_encode_time(time_us, (uint8_t)(time_us / 1000u), &frame);
    saddle_wire_authenticate_time(&prepared, session, &frame);
    frame.data[3] ^= flipped;
    reseal(&frame);
    return accept(&frame) == SADDLE_WIRE_MEASURED_TIME;
}

static void test_a_time_is_authenticated_by_its_own_code_and_rises_in_a_session(void)
{
    TEST_ASSERT_TRUE(accepts_time(9, 1000, 4)); /* no codes are required */
    saddle_wire_require_auth(&receiver, KEY);
    TEST_ASSERT_FALSE(accepts_time(0, 2000, 0));
    saddle_wire_open_session(&receiver, 7);
    TEST_ASSERT_FALSE(accepts_time(0, 2000, 0)); /* there was no session before */
    TEST_ASSERT_TRUE(accepts_time(7, 3000, 0));
    TEST_ASSERT_FALSE(accepts_time(7, 3000, 0)); /* a replay */
    TEST_ASSERT_FALSE(accepts_time(7, 2000, 0));
    TEST_ASSERT_FALSE(accepts_time(8, 4000, 0));
    TEST_ASSERT_FALSE(accepts_time(7, 4000, 4));
    TEST_ASSERT_EQUAL_UINT32(6, receiver.bad_code);
    TEST_ASSERT_TRUE(accepts_time(7, 4000, 0));
    saddle_wire_open_session(&receiver, 8);
    TEST_ASSERT_FALSE(accepts_time(9, 5000, 0)); /* neither of this session nor the one before */
    TEST_ASSERT_TRUE(accepts_time(7, 5000, 0));  /* the sender has not heard of the session */
    TEST_ASSERT_FALSE(accepts_time(7, 5000, 0));
    /* Earlier, with a number that follows. */
    TEST_ASSERT_TRUE(accepts_time(8, UINT32_MAX - 290u, 0));
    TEST_ASSERT_FALSE(accepts_time(7, 6000, 0));
}

static void test_when_a_session_is_over(void)
{
    const saddle_output_t commanded = {.status = SADDLE_OK};
    const saddle_output_t idle = {.faults = SADDLE_FAULT_COMMAND_STALE};
    TEST_ASSERT_FALSE(saddle_wire_session_expired(&receiver, &idle, 24));
    saddle_wire_require_auth(&receiver, KEY);
    TEST_ASSERT_TRUE(saddle_wire_session_expired(&receiver, &commanded, 0));
    saddle_wire_open_session(&receiver, 7);
    for (uint32_t tick = 0; tick < 50; ++tick) {
        TEST_ASSERT_FALSE(saddle_wire_session_expired(&receiver, &commanded, tick));
        TEST_ASSERT_EQUAL(tick == 24 || tick == 49,
                          saddle_wire_session_expired(&receiver, &idle, tick));
    }
    TEST_ASSERT_TRUE(accepts(7, 59999));
    TEST_ASSERT_FALSE(saddle_wire_session_expired(&receiver, &commanded, 0));
    TEST_ASSERT_TRUE(saddle_wire_session_expired(&receiver, &idle, 0));
    TEST_ASSERT_TRUE(accepts(7, 60000));
    TEST_ASSERT_TRUE(saddle_wire_session_expired(&receiver, &commanded, 0));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_crc_check_value);
    RUN_TEST(test_command_bytes);
    RUN_TEST(test_numbers_round_half_away_from_zero);
    RUN_TEST(test_numbers_beyond_the_range_saturate);
    RUN_TEST(test_every_single_bit_error_is_rejected);
    RUN_TEST(test_frame_under_another_identifier_is_rejected);
    RUN_TEST(test_messages_that_the_firmware_does_not_receive_are_malformed);
    RUN_TEST(test_other_wire_versions_but_the_older_ones_that_fit_are_rejected);
    RUN_TEST(test_a_set_has_one_number_in_all_its_frames);
    RUN_TEST(test_counter_rule);
    RUN_TEST(test_messages_have_separate_counters);
    RUN_TEST(test_decoding_leaves_ages_and_other_parts);
    RUN_TEST(test_plan_frames);
    RUN_TEST(test_a_command_is_decoded);
    RUN_TEST(test_turning_rate_has_a_byte);
    RUN_TEST(test_way_bytes);
    RUN_TEST(test_a_measured_com_is_decoded);
    RUN_TEST(test_events_and_pitch_bytes);
    RUN_TEST(test_a_plan_that_is_not_valid_has_no_numbers);
    RUN_TEST(test_verdict_bytes);
    RUN_TEST(test_results_that_were_not_compared_have_no_numbers);
    RUN_TEST(test_balance_bytes);
    RUN_TEST(test_values_that_were_not_learned_have_no_numbers);
    RUN_TEST(test_process_bytes);
    RUN_TEST(test_before_a_session_no_code_is_valid);
    RUN_TEST(test_a_code_authenticates_one_command_once);
    RUN_TEST(test_code_is_the_cmac_of_session_freshness_and_command);
    RUN_TEST(test_a_new_session_counts_from_one);
    RUN_TEST(test_a_time_is_authenticated_by_its_own_code_and_rises_in_a_session);
    RUN_TEST(test_when_a_session_is_over);
    return UNITY_END();
}
