/**
 * Raw sensors and joint commands on CAN, for devices that have encoders, an IMU and foot loads in place
 * of a measured CoM, and drives at their joints.
 *
 * One pass: MEASURED_TIME and the seven SENSED frames of one instant come in, a JOINT and a GAINS frame
 * for each joint and JOINTS_STATE go out. 33 frames of at most 135 bits: 1 Mbit/s carries 200 passes a
 * second. Their identifiers are below all others: what is sent most often comes first.
 */
#ifndef SADDLEWALK_WIRE_JOINTS_H
#define SADDLEWALK_WIRE_JOINTS_H

#include <saddlewalk/joint_command.h>
#include <saddlewalk/wire.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Frames of the sensors at one instant; MEASURED_TIME is sent before them. */
#define SADDLE_WIRE_SENSED_FRAMES 7u

/** Frames of one pass: JOINT and GAINS of every joint, left first, and JOINTS_STATE as the last. */
#define SADDLE_WIRE_JOINT_FRAMES 25u

/** Data of an accepted SENSED_xxx: writes that part of the sensors, without its age, and leaves the rest.
 *  Other messages write nothing. */
void saddle_wire_decode_sensors(saddle_wire_message_t message,
                                const uint8_t data[SADDLE_WIRE_LENGTH], saddle_sensors_t *sensors);

/** The commands of one pass and what they come from, by identifier. A torque's limits are sent in
 *  steps of 2 N m, 254 at most. */
void saddle_wire_encode_joints(const saddle_joint_commands_t *commands,
                               const saddle_estimate_t *estimate, uint8_t counter,
                               saddle_frame_t frames[SADDLE_WIRE_JOINT_FRAMES]);

/** The other direction, for the node that senses, and for tests. number: of the set; the low 7 bits
 *  count. The ages are not sent: the receiver counts them. */
void saddle_wire_encode_sensors(const saddle_sensors_t *sensors, uint8_t number,
                                saddle_frame_t frames[SADDLE_WIRE_SENSED_FRAMES]);

#ifdef __cplusplus
}
#endif

#endif
