#include "health.h"

saddle_wire_health_t saddle_health(const saddle_timing_t *timing, const saddle_inbox_t *inbox)
{
    const saddle_input_t *input = &inbox->input;
    const saddle_wire_receiver_t *receiver = &inbox->receiver;
    return (saddle_wire_health_t){
        .late_ticks = timing->late_ticks,
        .rejected_frames = saddle_inbox_rejected(inbox),
        .period_us = timing->period_us,
        .latency_us = timing->latency_us,
        .latency_max_us = timing->latency_max_us,
        .command_source = (uint8_t)inbox->authority,
        .sender_clock = inbox->sender_clock,
        .by_sensors = inbox->by_sensors,
        .input_age_us = {[SADDLE_WIRE_COMMAND] = input->command_age_us,
                         [SADDLE_WIRE_MEASURED_COM] = input->measurement.com.age_us,
                         [SADDLE_WIRE_MEASURED_LEFT] = input->measurement.foot[SADDLE_LEFT].age_us,
                         [SADDLE_WIRE_MEASURED_RIGHT] =
                             input->measurement.foot[SADDLE_RIGHT].age_us},
        .accepted = receiver->accepted,
        .malformed = receiver->malformed,
        .bad_crc = receiver->bad_crc,
        .bad_version = receiver->bad_version,
        .bad_counter = receiver->bad_counter,
    };
}
