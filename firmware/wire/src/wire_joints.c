#include <saddlewalk/wire_joints.h>

#include "frame.h"

#define JOINTS ((size_t)2u * SADDLE_LEG_JOINTS)

/* The signals of a left and a right frame lie alike, as do those of all joints:
 * tools/wire_signals.py checks it. */

static void decode_hip(uint64_t bits, float angle_rad[SADDLE_LEG_JOINTS])
{
    angle_rad[SADDLE_HIP_YAW] = NUMBER_IN(SENSED_LEFT_HIP_YAW, bits);
    angle_rad[SADDLE_HIP_ROLL] = NUMBER_IN(SENSED_LEFT_HIP_ROLL, bits);
    angle_rad[SADDLE_HIP_PITCH] = NUMBER_IN(SENSED_LEFT_HIP_PITCH, bits);
}

static void decode_leg(uint64_t bits, float angle_rad[SADDLE_LEG_JOINTS])
{
    angle_rad[SADDLE_KNEE] = NUMBER_IN(SENSED_LEFT_LEG_KNEE, bits);
    angle_rad[SADDLE_ANKLE_PITCH] = NUMBER_IN(SENSED_LEFT_LEG_ANKLE_PITCH, bits);
    angle_rad[SADDLE_ANKLE_ROLL] = NUMBER_IN(SENSED_LEFT_LEG_ANKLE_ROLL, bits);
}

void saddle_wire_decode_sensors(saddle_wire_message_t message,
                                const uint8_t data[SADDLE_WIRE_LENGTH], saddle_sensors_t *sensors)
{
    const uint64_t bits = saddle_frame_bits(data);
    switch (message) {
    case SADDLE_WIRE_SENSED_GYRO:
        sensors->gyro_rad_s =
            (saddle_vec3_t){NUMBER_IN(SENSED_GYRO_X, bits), NUMBER_IN(SENSED_GYRO_Y, bits),
                            NUMBER_IN(SENSED_GYRO_Z, bits)};
        break;
    case SADDLE_WIRE_SENSED_ACCELEROMETER:
        sensors->accelerometer_m_s2 = (saddle_vec3_t){NUMBER_IN(SENSED_ACCELEROMETER_X, bits),
                                                      NUMBER_IN(SENSED_ACCELEROMETER_Y, bits),
                                                      NUMBER_IN(SENSED_ACCELEROMETER_Z, bits)};
        break;
    case SADDLE_WIRE_SENSED_LOADS:
        sensors->load_n[SADDLE_LEFT] = NUMBER_IN(SENSED_LOADS_LEFT, bits);
        sensors->load_n[SADDLE_RIGHT] = NUMBER_IN(SENSED_LOADS_RIGHT, bits);
        break;
    case SADDLE_WIRE_SENSED_LEFT_HIP: decode_hip(bits, sensors->angle_rad[SADDLE_LEFT]); break;
    case SADDLE_WIRE_SENSED_LEFT_LEG: decode_leg(bits, sensors->angle_rad[SADDLE_LEFT]); break;
    case SADDLE_WIRE_SENSED_RIGHT_HIP: decode_hip(bits, sensors->angle_rad[SADDLE_RIGHT]); break;
    case SADDLE_WIRE_SENSED_RIGHT_LEG: decode_leg(bits, sensors->angle_rad[SADDLE_RIGHT]); break;
    default: break;
    }
}

static void encode_hip(uint16_t id, const float angle_rad[SADDLE_LEG_JOINTS], uint64_t begin,
                       saddle_frame_t *frame)
{
    frame->id = id;
    saddle_frame_seal(frame->data, crc_of_id(id),
                      begin | NUMBER(SENSED_LEFT_HIP_YAW, true, angle_rad[SADDLE_HIP_YAW]) |
                          NUMBER(SENSED_LEFT_HIP_ROLL, true, angle_rad[SADDLE_HIP_ROLL]) |
                          NUMBER(SENSED_LEFT_HIP_PITCH, true, angle_rad[SADDLE_HIP_PITCH]));
}

static void encode_leg(uint16_t id, const float angle_rad[SADDLE_LEG_JOINTS], uint64_t begin,
                       saddle_frame_t *frame)
{
    frame->id = id;
    saddle_frame_seal(frame->data, crc_of_id(id),
                      begin | NUMBER(SENSED_LEFT_LEG_KNEE, true, angle_rad[SADDLE_KNEE]) |
                          NUMBER(SENSED_LEFT_LEG_ANKLE_PITCH, true, angle_rad[SADDLE_ANKLE_PITCH]) |
                          NUMBER(SENSED_LEFT_LEG_ANKLE_ROLL, true, angle_rad[SADDLE_ANKLE_ROLL]));
}

void saddle_wire_encode_sensors(const saddle_sensors_t *sensors, uint8_t number,
                                saddle_frame_t frames[SADDLE_WIRE_SENSED_FRAMES])
{
    const uint64_t begin =
        CODE(SENSED_GYRO_COUNTER, number) | CODE(SENSED_GYRO_ROUND, round_of(number));
    const saddle_vec3_t gyro_rad_s = sensors->gyro_rad_s;
    const saddle_vec3_t accelerometer_m_s2 = sensors->accelerometer_m_s2;
    const float (*angle_rad)[SADDLE_LEG_JOINTS] = sensors->angle_rad;
    ENCODE(&frames[0], SENSED_GYRO, number,
           begin | NUMBER(SENSED_GYRO_X, true, gyro_rad_s.x) |
               NUMBER(SENSED_GYRO_Y, true, gyro_rad_s.y) |
               NUMBER(SENSED_GYRO_Z, true, gyro_rad_s.z));
    ENCODE(&frames[1], SENSED_ACCELEROMETER, number,
           begin | NUMBER(SENSED_ACCELEROMETER_X, true, accelerometer_m_s2.x) |
               NUMBER(SENSED_ACCELEROMETER_Y, true, accelerometer_m_s2.y) |
               NUMBER(SENSED_ACCELEROMETER_Z, true, accelerometer_m_s2.z));
    ENCODE(&frames[2], SENSED_LOADS, number,
           begin | NUMBER(SENSED_LOADS_LEFT, true, sensors->load_n[SADDLE_LEFT]) |
               NUMBER(SENSED_LOADS_RIGHT, true, sensors->load_n[SADDLE_RIGHT]));
    encode_hip(MESSAGE_SENSED_LEFT_HIP, angle_rad[SADDLE_LEFT], begin, &frames[3]);
    encode_leg(MESSAGE_SENSED_LEFT_LEG, angle_rad[SADDLE_LEFT], begin, &frames[4]);
    encode_hip(MESSAGE_SENSED_RIGHT_HIP, angle_rad[SADDLE_RIGHT], begin, &frames[5]);
    encode_leg(MESSAGE_SENSED_RIGHT_LEG, angle_rad[SADDLE_RIGHT], begin, &frames[6]);
}

static void encode_joint(uint16_t id, const saddle_joint_command_t *command, uint8_t counter,
                         saddle_frame_t *frame)
{
    frame->id = id;
    saddle_frame_seal(frame->data, crc_of_id(id),
                      CODE(JOINT_LEFT_HIP_YAW_COUNTER, counter) |
                          NUMBER(JOINT_LEFT_HIP_YAW_ANGLE, true, command->angle_rad) |
                          NUMBER(JOINT_LEFT_HIP_YAW_RATE, true, command->rate_rad_s) |
                          NUMBER(JOINT_LEFT_HIP_YAW_TORQUE, true, command->torque_nm));
}

static void encode_gains(uint16_t id, const saddle_joint_command_t *command, uint8_t counter,
                         saddle_frame_t *frame)
{
    frame->id = id;
    saddle_frame_seal(frame->data, crc_of_id(id),
                      CODE(GAINS_LEFT_HIP_YAW_COUNTER, counter) |
                          NUMBER(GAINS_LEFT_HIP_YAW_STIFFNESS, true, command->stiffness) |
                          NUMBER(GAINS_LEFT_HIP_YAW_DAMPING, true, command->damping) |
                          SHORT_NUMBER(GAINS_LEFT_HIP_YAW_TORQUE_MIN, command->torque_min_nm) |
                          SHORT_NUMBER(GAINS_LEFT_HIP_YAW_TORQUE_MAX, command->torque_max_nm));
}

void saddle_wire_encode_joints(const saddle_joint_commands_t *commands,
                               const saddle_estimate_t *estimate, uint8_t counter,
                               saddle_frame_t frames[SADDLE_WIRE_JOINT_FRAMES])
{
    for (uint32_t place = 0; place < JOINTS; ++place) {
        const saddle_joint_command_t *command =
            &commands->joint[place / SADDLE_LEG_JOINTS][place % SADDLE_LEG_JOINTS];
        encode_joint((uint16_t)(MESSAGE_JOINT_LEFT_HIP_YAW + place), command, counter,
                     &frames[place]);
        encode_gains((uint16_t)(MESSAGE_GAINS_LEFT_HIP_YAW + place), command, counter,
                     &frames[JOINTS + place]);
    }
    ENCODE(&frames[2u * JOINTS], JOINTS_STATE, counter,
           CODE(JOINTS_STATE_FALLBACK, commands->fallback) |
               CODE(JOINTS_STATE_FAULTS, estimate->faults) |
               CODE(JOINTS_STATE_LOST_JOINTS, estimate->lost_joints));
}
