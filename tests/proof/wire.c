/** The wire, with whatever comes: any frames, any results, any keys. Read by Eva (`make prove`). */
#include "any.h"

#include <saddlewalk/wire_joints.h>

static volatile saddle_output_t any_output;
static volatile saddle_wire_health_t any_health;
static volatile saddle_command_t any_command;
static volatile saddle_measurement_t any_measurement;
static volatile saddle_sensors_t any_sensors;
static volatile saddle_joint_commands_t any_commands;
static volatile saddle_estimate_t any_estimate;

/** The flags, of which C knows two values only. */
static saddle_output_t some_output(void)
{
    saddle_output_t output = any_output;
    output.plan.valid = any_bool();
    output.scores.can_stop = any_bool();
    output.scores.paper_stable = any_bool();
    output.scores.bos.defined = any_bool();
    output.verdict.margin_known = any_bool();
    output.verdict.compared = any_bool();
    output.verdict.on_track = any_bool();
    output.verdict.recovery.found = any_bool();
    output.verdict.recovery.stops = any_bool();
    return output;
}

static saddle_measurement_t some_measurement(void)
{
    saddle_measurement_t measurement = any_measurement;
    measurement.foot[SADDLE_LEFT].contact = any_bool();
    measurement.foot[SADDLE_RIGHT].contact = any_bool();
    return measurement;
}

static void receive(saddle_wire_receiver_t *receiver, saddle_measurement_t *measurement,
                    saddle_sensors_t *sensors)
{
    saddle_command_t command;
    uint8_t data[SADDLE_WIRE_LENGTH];
    for (size_t i = 0; i < sizeof data; ++i) {
        data[i] = any_uint8;
    }
    const size_t length = any_size;
    const saddle_wire_message_t message = saddle_wire_accept(receiver, any_uint32, data, length);
    if (message == SADDLE_WIRE_COMMAND) {
        saddle_wire_decode_command(data, &command);
    } else if (message == SADDLE_WIRE_MEASURED_TIME) {
        (void)saddle_wire_decode_time(data);
        (void)saddle_wire_set_number(data);
    } else if (message != SADDLE_WIRE_NONE) {
        saddle_wire_decode_measured(message, data, measurement);
        saddle_wire_decode_sensors(message, data, sensors);
    }
}

static void send(const saddle_wire_receiver_t *receiver, const saddle_cmac_key_t *key)
{
    saddle_frame_t frames[SADDLE_WIRE_OUTPUT_FRAMES];
    saddle_frame_t code;
    const saddle_output_t output = some_output();
    saddle_wire_health_t health = any_health;
    health.sender_clock = any_bool();
    health.by_sensors = any_bool();
    const saddle_command_t command = any_command;
    const saddle_measurement_t measurement = some_measurement();
    saddle_wire_encode_output(&output, &health, any_uint8, frames);
    saddle_wire_encode_command(&command, any_uint8, &frames[0]);
    saddle_wire_encode_code(key, any_uint32, any_uint16, &frames[0], &code);
    saddle_wire_encode_measurement(&measurement, any_uint8, frames);
    saddle_wire_encode_time(any_uint32, any_uint8, frames);
    saddle_wire_authenticate_time(key, any_uint32, frames);
    saddle_wire_encode_session(receiver, any_uint8, frames);
    (void)saddle_wire_session_expired(receiver, &output, any_uint32);
}

static void send_joints(void)
{
    saddle_frame_t frames[SADDLE_WIRE_JOINT_FRAMES];
    const saddle_sensors_t sensors = any_sensors;
    const saddle_estimate_t estimate = any_estimate;
    saddle_joint_commands_t commands = any_commands;
    commands.fallback = any_bool();
    saddle_wire_encode_sensors(&sensors, any_uint8, frames);
    saddle_wire_encode_joints(&commands, &estimate, any_uint8, frames);
}

int main(void)
{
    static saddle_wire_receiver_t receiver;
    saddle_measurement_t measurement = some_measurement();
    saddle_sensors_t sensors = any_sensors;
    uint8_t secret[SADDLE_CMAC_LENGTH];
    saddle_cmac_key_t key;
    for (size_t i = 0; i < sizeof secret; ++i) {
        secret[i] = any_uint8;
    }
    saddle_cmac_prepare(&key, secret);
    (void)saddle_wire_crc(secret, sizeof secret);
    while (any_bool()) {
        if (any_bool()) {
            saddle_wire_require_auth(&receiver, secret);
        }
        if (any_bool()) {
            saddle_wire_open_session(&receiver, any_uint32);
        }
        receive(&receiver, &measurement, &sensors);
        send(&receiver, &key);
        send_joints();
    }
    return 0;
}
