/**
 * Saddlewalk on CAN: bytes to structs and back. Knows no bus, clock, heap or global.
 *
 * saddlewalk.dbc is the only source of identifiers, positions and scales, from which
 * tools/wire_signals.py generates the constants for packing. Its VERSION is SADDLE_WIRE_VERSION and
 * increases with every change of the bits or of their meaning: a COMMAND older than
 * SADDLE_WIRE_OLDEST_VERSION or newer than this is rejected. This layer adds what a DBC cannot express:
 *
 *     byte 0      CRC-8 SAE J1850 over the identifier, low byte first, then bytes 1 to 7
 *     byte 1      low 4 bits: alive counter, one more (modulo 16) each time the message is sent
 *     bytes 1..7  signals, little endian
 *
 * Every physical number is a signed 16-bit signal. A number beyond its range is sent as the end
 * of the range, never wrapped. A number that is not finite, or whose result is not valid, is sent
 * as -32768, not available, and received as NaN, which saddle_tick() reports as a fault.
 *
 * No pointer is kept. Every function is re-entrant and takes a bounded time; where codes are
 * required, a COMMAND or a MEASURED_TIME takes one block of AES more. Stack under 300 bytes. Of the C library it needs
 * nothing, unless the compiler makes memcpy() of a copy.
 *
 *     on a frame:  switch (saddle_wire_accept(&receiver, id, data, length)) {
 *                  case SADDLE_WIRE_NONE: break;
 *                  case SADDLE_WIRE_COMMAND: saddle_wire_decode_command(data, &command); break;
 *                  case SADDLE_WIRE_MEASURED_TIME: time_us = saddle_wire_decode_time(data); break;
 *                  default: saddle_wire_decode_measured(message, data, &measurement); }
 *     every tick:  saddle_wire_encode_output(&output, &health, counter++, frames);
 */
#ifndef SADDLEWALK_WIRE_H
#define SADDLEWALK_WIRE_H

#include <saddlewalk/saddlewalk.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#include <saddlewalk/cmac.h>

/** Of a COMMAND that is accepted. Version 6 has no MEASURED_TIME and no ROUND, and 7 as well no TURN_RATE
 *  and no GROUND, whose bytes are 0; both are the same else. */
#define SADDLE_WIRE_OLDEST_VERSION 6u

/** Every frame is a classic CAN data frame of this many bytes with an 11-bit identifier. */
#define SADDLE_WIRE_LENGTH 8u

/** Frames of one output: the plan (16), the scores (5), the verdict (2), the margin and the learned
 *  walk (4), the process (3), and HEALTH as the last. SESSION is separate: it is sent only while codes
 *  are required. */
#define SADDLE_WIRE_OUTPUT_FRAMES 31u

/** Frames of one measurement: CoM, left foot, right foot; MEASURED_TIME is sent before them. */
#define SADDLE_WIRE_MEASURED_FRAMES 3u

/** Sets are numbered from 0 to here, then from 0: by COUNTER, and ROUND above it. */
#define SADDLE_WIRE_SET_MAX 127u

typedef struct {
    uint16_t id;
    uint8_t data[SADDLE_WIRE_LENGTH];
} saddle_frame_t;

/** The messages that the firmware receives. */
typedef enum {
    SADDLE_WIRE_NONE = -1, /**< the frame was rejected and counted */
    SADDLE_WIRE_COMMAND = 0,
    SADDLE_WIRE_MEASURED_COM = 1,
    SADDLE_WIRE_MEASURED_LEFT = 2,
    SADDLE_WIRE_MEASURED_RIGHT = 3,
    SADDLE_WIRE_COMMAND_CODE = 4, /**< kept for the COMMAND that follows; nothing to decode */
    SADDLE_WIRE_MEASURED_TIME = 5,
    SADDLE_WIRE_SENSED_GYRO = 6, /**< from here on raw sensors, see wire_joints.h */
    SADDLE_WIRE_SENSED_ACCELEROMETER = 7,
    SADDLE_WIRE_SENSED_LOADS = 8,
    SADDLE_WIRE_SENSED_LEFT_HIP = 9,
    SADDLE_WIRE_SENSED_LEFT_LEG = 10,
    SADDLE_WIRE_SENSED_RIGHT_HIP = 11,
    SADDLE_WIRE_SENSED_RIGHT_LEG = 12,
    SADDLE_WIRE_MESSAGE_COUNT
} saddle_wire_message_t;

/** Health of the process around the core: TIMING, RECEIVED, INPUTS and HEALTH. Numbers too large
 *  for their signal are sent as the end of the range. */
typedef struct {
    uint32_t late_ticks;
    uint32_t rejected_frames; /**< and commands */
    uint32_t period_us;       /**< between the last two ticks */
    uint32_t latency_us;      /**< of this tick, behind its time */
    uint32_t latency_max_us;  /**< of all */
    uint8_t command_source;   /**< has authority: 0 none, 1 CAN, 2 LCM */
    bool sender_clock; /**< the measurements' ages count from when they were sampled, not from
                            when they were received */
    bool by_sensors;   /**< raw sensors are used, and MEASURED_COM, _LEFT and _RIGHT are not */
    uint32_t input_age_us[SADDLE_WIRE_MEASURED_RIGHT + 1];           /**< by message */
    uint32_t accepted, malformed, bad_crc, bad_version, bad_counter; /**< the receiver's */
} saddle_wire_health_t;

/** Alive counter of one received message. */
typedef struct {
    uint8_t last;      /**< of the last frame accepted */
    uint8_t candidate; /**< of the last frame out of step: the next may follow this one instead */
    bool seen;
} saddle_wire_alive_t;

/** Authentication of COMMAND and MEASURED_TIME, docs/authentication.md. */
typedef struct {
    bool required;
    bool opened; /**< a session; before the first no code is valid */
    saddle_cmac_key_t key;
    uint32_t session;                  /**< a code is valid in its session only */
    uint16_t freshness;                /**< of the last valid code; the next must be higher */
    bool waits;                        /**< a code was received and its COMMAND not yet */
    uint8_t frame[SADDLE_WIRE_LENGTH]; /**< that code's */
    bool timed;                        /**< a MEASURED_TIME of this session was accepted */
    bool timed_before;                 /**< and one of the session before */
    uint32_t session_before;           /**< whose times are good until this one's come */
    uint32_t time_us;                  /**< the newest; the next must be later */
} saddle_wire_guard_t;

/** Caller-owned; start from all zeros. The counts may be read at any time and wrap at 2^32. */
typedef struct {
    saddle_wire_alive_t alive[SADDLE_WIRE_MESSAGE_COUNT];
    uint32_t accepted;
    uint32_t malformed; /**< wrong length, or an identifier that the firmware does not receive */
    uint32_t bad_crc;
    uint32_t bad_version; /**< COMMAND of a wire version that is not accepted */
    uint32_t bad_counter; /**< repeated, or out of step */
    uint8_t
        other_version; /**< of the last COMMAND with another version, accepted or not; 0: none */
    uint32_t
        bad_code; /**< COMMAND or MEASURED_TIME without a code, or one that is wrong or not fresh */
    saddle_wire_guard_t guard;
} saddle_wire_receiver_t;

/** CRC-8 SAE J1850: polynomial 0x1D, start 0xFF, final inversion. "123456789" gives 0x4B. */
uint8_t saddle_wire_crc(const uint8_t *bytes, size_t length);

/** Alive counter of a frame, 0 to 15. */
uint8_t saddle_wire_counter(const uint8_t data[SADDLE_WIRE_LENGTH]);

/** Number of a MEASURED_xxx or SENSED_xxx frame's set, 0 to SADDLE_WIRE_SET_MAX. */
uint8_t saddle_wire_set_number(const uint8_t data[SADDLE_WIRE_LENGTH]);

/**
 * Check one received frame: returns its message, or SADDLE_WIRE_NONE. Exactly one count of the
 * receiver increases. data is read only if length is SADDLE_WIRE_LENGTH; any bytes are safe.
 * Counter rule, per message: the first frame is accepted, then one that is 1 to 4 ahead of the
 * last accepted. A repeat is rejected. Any other is rejected too, but the next frame may be 1 to 4
 * ahead of it instead: a sender that restarted loses one frame. A rejected frame never changes the
 * last accepted counter.
 */
saddle_wire_message_t saddle_wire_accept(saddle_wire_receiver_t *receiver, uint32_t id,
                                         const uint8_t *data, size_t length);

/** From now on accept a COMMAND only after a COMMAND_CODE that authenticates it, and a MEASURED_TIME
 *  with a CODE of the session and a later time than the last: none before there is a session. */
void saddle_wire_require_auth(saddle_wire_receiver_t *receiver,
                              const uint8_t key[SADDLE_CMAC_LENGTH]);

/** Begin a session with an unpredictable number; freshness restarts. Codes of the previous
 *  session are rejected. When: saddle_wire_session_expired(). */
void saddle_wire_open_session(saddle_wire_receiver_t *receiver, uint32_t session);

/** Whether a tick is to open a new session: there is none, the freshness nears its end, or there are no
 *  commands. output: the tick's; ticks: how many came before it. Never while no codes are
 *  required. */
bool saddle_wire_session_expired(const saddle_wire_receiver_t *receiver,
                                 const saddle_output_t *output, uint32_t ticks);

/** SESSION, for those who command; with every tick while there is a session. */
void saddle_wire_encode_session(const saddle_wire_receiver_t *receiver, uint8_t counter,
                                saddle_frame_t *frame);

/** Data of an accepted SADDLE_WIRE_COMMAND. The mode is 0 to 15: the core checks it. */
void saddle_wire_decode_command(const uint8_t data[SADDLE_WIRE_LENGTH], saddle_command_t *command);

/** Data of an accepted SADDLE_WIRE_MEASURED_TIME: when its set was sampled, by the sender's clock. */
uint32_t saddle_wire_decode_time(const uint8_t data[SADDLE_WIRE_LENGTH]);

/** Data of an accepted MEASURED_COM, _LEFT or _RIGHT: writes that part of the measurement, without its
 *  age, and leaves the rest. Other messages write nothing. */
void saddle_wire_decode_measured(saddle_wire_message_t message,
                                 const uint8_t data[SADDLE_WIRE_LENGTH],
                                 saddle_measurement_t *measurement);

/** One tick's output by identifier. Of the counter the low 4 bits count, here and below. */
void saddle_wire_encode_output(const saddle_output_t *output, const saddle_wire_health_t *health,
                               uint8_t counter, saddle_frame_t frames[SADDLE_WIRE_OUTPUT_FRAMES]);

/** The other direction, for the node that measures and commands, and for tests.
 *  A mode above 15 is sent as 15, which all firmware rejects. */
void saddle_wire_encode_command(const saddle_command_t *command, uint8_t counter,
                                saddle_frame_t *frame);

/** The COMMAND_CODE to send just before a COMMAND, with its alive counter. freshness: from 1, higher
 *  for each in a session. */
void saddle_wire_encode_code(const saddle_cmac_key_t *key, uint32_t session, uint16_t freshness,
                             const saddle_frame_t *command, saddle_frame_t *frame);

/** When the set of this number was sampled; to send before the set. CODE is 0. */
void saddle_wire_encode_time(uint32_t sampled_us, uint8_t number, saddle_frame_t *frame);

/** Fill in the CODE of a MEASURED_TIME. In a session times must rise. */
void saddle_wire_authenticate_time(const saddle_cmac_key_t *key, uint32_t session,
                                   saddle_frame_t *frame);

/** number: of the set; the low 7 bits count. The ages are not sent: the receiver counts them. */
void saddle_wire_encode_measurement(const saddle_measurement_t *measurement, uint8_t number,
                                    saddle_frame_t frames[SADDLE_WIRE_MEASURED_FRAMES]);

#ifdef __cplusplus
}
#endif

#endif
