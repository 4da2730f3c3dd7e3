/**
 * The core's structs as the messages of `lcm_types`, encoded. Knows no transport. What the host
 * publishes and what `saddlewalk rerun` computes again both come from here, and so can be compared
 * byte by byte.
 */
#ifndef SADDLEWALK_HOST_LCM_MESSAGES_H
#define SADDLEWALK_HOST_LCM_MESSAGES_H

#include <saddlewalk/joint_command.h>
#include <saddlewalk/saddlewalk.h>
#include <stdbool.h>
#include <stdint.h>

/** Enough for the longest message, config_t. */
enum { SADDLE_LCM_MESSAGE_MAX = 4096 };

/** The messages of a tick's output. */
typedef enum {
    SADDLE_LCM_PLAN = 0,
    SADDLE_LCM_SCORES = 1,
    SADDLE_LCM_VERDICT = 2,
    SADDLE_LCM_BALANCE = 3,
    SADDLE_LCM_BOS = 4,
    SADDLE_LCM_WAY = 5,
    SADDLE_LCM_OUTPUTS
} saddle_lcm_output_t;

/** The channel of a message of the output, such as SADDLEWALK_PLAN. */
const char *saddle_lcm_channel(saddle_lcm_output_t part);

/** plan_t, scores_t, verdict_t, balance_t, bos_t or way_t. Returns the size in bytes. */
int saddle_lcm_encode_output(saddle_lcm_output_t part, const saddle_output_t *output,
                             int64_t utime_us, uint8_t bytes[SADDLE_LCM_MESSAGE_MAX]);

/** input_t. Returns the size in bytes. */
int saddle_lcm_encode_input(const saddle_input_t *input, int32_t tick,
                            uint8_t bytes[SADDLE_LCM_MESSAGE_MAX]);

/** Decode an input_t, bit for bit. False, and nothing is written, unless the bytes are exactly one.
 *  */
bool saddle_lcm_decode_input(const uint8_t *bytes, int size, saddle_input_t *input, int32_t *tick);

/** turn_t, what input_t lacks. Returns the size in bytes. */
int saddle_lcm_encode_turn(const saddle_input_t *input, uint8_t bytes[SADDLE_LCM_MESSAGE_MAX]);

/** Add a turn_t to the decoded input_t of its tick. False, and nothing is written, unless the bytes are
 *  exactly one. */
bool saddle_lcm_decode_turn(const uint8_t *bytes, int size, saddle_input_t *input);

/** feet_t, what input_t lacks as well; the same as for turn_t. */
int saddle_lcm_encode_feet(const saddle_input_t *input, uint8_t bytes[SADDLE_LCM_MESSAGE_MAX]);
bool saddle_lcm_decode_feet(const uint8_t *bytes, int size, saddle_input_t *input);

/** sensors_t. Returns the size in bytes. */
int saddle_lcm_encode_sensors(const saddle_sensors_t *sensors, const saddle_estimate_t *estimate,
                              uint8_t bytes[SADDLE_LCM_MESSAGE_MAX]);

/** joints_t. Returns the size in bytes. */
int saddle_lcm_encode_joints(const saddle_joint_commands_t *commands, int64_t utime_us,
                             uint8_t bytes[SADDLE_LCM_MESSAGE_MAX]);

/** config_t. Returns the size in bytes. */
int saddle_lcm_encode_config(const saddle_config_t *config, uint64_t time_us, bool lockstep,
                             uint8_t bytes[SADDLE_LCM_MESSAGE_MAX]);

#endif
