/** Sensors and joint commands on CAN: each number in its own place, written out from the DBC. */
#include <saddlewalk/wire_joints.h>

#include <string.h>
#include <unity.h>

#define JOINTS (2u * SADDLE_LEG_JOINTS)

void setUp(void) {}

void tearDown(void) {}

static int32_t raw(const saddle_frame_t *frame, unsigned first_byte)
{
    const uint32_t bits = frame->data[first_byte] | (uint32_t)frame->data[first_byte + 1u] << 8;
    return (int16_t)(uint16_t)bits;
}

static void assert_sealed(const saddle_frame_t *frame, uint16_t id, uint8_t second_byte)
{
    uint8_t covered[9] = {(uint8_t)id, (uint8_t)(id >> 8)};
    memcpy(&covered[2], &frame->data[1], 7);
    TEST_ASSERT_EQUAL_HEX16(id, frame->id);
    TEST_ASSERT_EQUAL_HEX8(second_byte, frame->data[1]);
    TEST_ASSERT_EQUAL_HEX8(saddle_wire_crc(covered, sizeof covered), frame->data[0]);
}

static void assert_numbers(const saddle_frame_t *frame, int32_t a, int32_t b, int32_t c)
{
    TEST_ASSERT_EQUAL_INT32(a, raw(frame, 2));
    TEST_ASSERT_EQUAL_INT32(b, raw(frame, 4));
    TEST_ASSERT_EQUAL_INT32(c, raw(frame, 6));
}

/* No two numbers are the same, in steps of their signals. */
static saddle_sensors_t some_sensors(void)
{
    saddle_sensors_t sensors = {.gyro_rad_s = {0.101f, -0.102f, 0.103f},
                                .accelerometer_m_s2 = {1.005f, -1.01f, 1.015f},
                                .load_n = {200.1f, -200.2f}};
    for (unsigned side = 0; side < 2; side++) {
        for (unsigned joint = 0; joint < SADDLE_LEG_JOINTS; joint++) {
            sensors.angle_rad[side][joint] = 1.0e-4f * (float)(1000 * (side + 1u) + joint);
        }
    }
    return sensors;
}

static void test_every_sensor_has_its_place(void)
{
    const saddle_sensors_t sensors = some_sensors();
    saddle_frame_t frames[SADDLE_WIRE_SENSED_FRAMES];
    saddle_wire_encode_sensors(&sensors, 0x35, frames);
    for (uint16_t i = 0; i < SADDLE_WIRE_SENSED_FRAMES; i++) {
        assert_sealed(&frames[i], (uint16_t)(128u + i), 0x65); /* counter 5, round 3 */
    }
    assert_numbers(&frames[0], 101, -102, 103);
    assert_numbers(&frames[1], 201, -202, 203);
    assert_numbers(&frames[2], 2001, -2002, 0);
    assert_numbers(&frames[3], 1000, 1001, 1002);
    assert_numbers(&frames[4], 1003, 1004, 1005);
    assert_numbers(&frames[5], 2000, 2001, 2002);
    assert_numbers(&frames[6], 2003, 2004, 2005);
}

static void assert_same_sensors(const saddle_sensors_t *sent, const saddle_sensors_t *received)
{
    const float tolerance = 1.0e-5f; /* of a product and its quotient in single precision */
    TEST_ASSERT_FLOAT_WITHIN(tolerance, sent->gyro_rad_s.x, received->gyro_rad_s.x);
    TEST_ASSERT_FLOAT_WITHIN(tolerance, sent->gyro_rad_s.y, received->gyro_rad_s.y);
    TEST_ASSERT_FLOAT_WITHIN(tolerance, sent->gyro_rad_s.z, received->gyro_rad_s.z);
    TEST_ASSERT_FLOAT_WITHIN(tolerance, sent->accelerometer_m_s2.x, received->accelerometer_m_s2.x);
    TEST_ASSERT_FLOAT_WITHIN(tolerance, sent->accelerometer_m_s2.y, received->accelerometer_m_s2.y);
    TEST_ASSERT_FLOAT_WITHIN(tolerance, sent->accelerometer_m_s2.z, received->accelerometer_m_s2.z);
    for (unsigned side = 0; side < 2; side++) {
        TEST_ASSERT_FLOAT_WITHIN(1.0e-3f, sent->load_n[side], received->load_n[side]);
        TEST_ASSERT_FLOAT_ARRAY_WITHIN(tolerance, sent->angle_rad[side], received->angle_rad[side],
                                       SADDLE_LEG_JOINTS);
    }
}

static void test_sensors_come_back(void)
{
    const saddle_sensors_t sensors = some_sensors();
    saddle_sensors_t received = {.time_us = 7, .load_age_us = {8, 9}};
    saddle_frame_t frames[SADDLE_WIRE_SENSED_FRAMES];
    saddle_wire_receiver_t receiver = {0};
    saddle_wire_encode_sensors(&sensors, 0, frames);
    for (unsigned i = 0; i < SADDLE_WIRE_SENSED_FRAMES; i++) {
        const saddle_wire_message_t message =
            saddle_wire_accept(&receiver, frames[i].id, frames[i].data, SADDLE_WIRE_LENGTH);
        TEST_ASSERT_NOT_EQUAL(SADDLE_WIRE_NONE, message);
        saddle_wire_decode_sensors(message, frames[i].data, &received);
    }
    saddle_wire_decode_sensors(SADDLE_WIRE_COMMAND, frames[0].data, &received);
    assert_same_sensors(&sensors, &received);
    TEST_ASSERT_EQUAL_UINT64(7, received.time_us);
    TEST_ASSERT_EQUAL_UINT32(9, received.load_age_us[1]);
}

static void test_every_joint_command_has_its_place(void)
{
    static saddle_joint_commands_t commands;
    static saddle_estimate_t estimate;
    saddle_frame_t frames[SADDLE_WIRE_JOINT_FRAMES];
    for (uint16_t place = 0; place < JOINTS; place++) {
        saddle_joint_command_t *command =
            &commands.joint[place / SADDLE_LEG_JOINTS][place % SADDLE_LEG_JOINTS];
        *command = (saddle_joint_command_t){.angle_rad = 1.0e-4f * (float)(100 + place),
                                            .rate_rad_s = 1.0e-3f * (float)(200 + place),
                                            .torque_nm = -0.02f * (float)(300 + place),
                                            .stiffness = 0.5f * (float)(400 + place),
                                            .damping = 0.05f * (float)(500 + place),
                                            .torque_min_nm = -2.0f * (float)(30 + place),
                                            .torque_max_nm = 2.0f * (float)(60 + place)};
    }
    commands.fallback = true;
    estimate.faults = 0x1234u;
    estimate.lost_joints = 0x0ABCu;
    saddle_wire_encode_joints(&commands, &estimate, 9, frames);
    for (uint16_t place = 0; place < JOINTS; place++) {
        const saddle_frame_t *gains = &frames[JOINTS + place];
        assert_sealed(&frames[place], (uint16_t)(144u + place), 9);
        assert_numbers(&frames[place], 100 + place, 200 + place, -300 - place);
        assert_sealed(gains, (uint16_t)(160u + place), 9);
        TEST_ASSERT_EQUAL_INT32(400 + place, raw(gains, 2));
        TEST_ASSERT_EQUAL_INT32(500 + place, raw(gains, 4));
        TEST_ASSERT_EQUAL_INT8(-30 - place, gains->data[6]);
        TEST_ASSERT_EQUAL_INT8(60 + place, gains->data[7]);
    }
    assert_sealed(&frames[2u * JOINTS], 176, 0x19);
    assert_numbers(&frames[2u * JOINTS], 0x1234, 0x0ABC, 0);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_every_sensor_has_its_place);
    RUN_TEST(test_sensors_come_back);
    RUN_TEST(test_every_joint_command_has_its_place);
    return UNITY_END();
}
