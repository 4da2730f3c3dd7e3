#include "report.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

/** A count for LCM, which has no unsigned numbers. */
static int32_t limited(uint32_t count)
{
    return count < INT32_MAX ? (int32_t)count : INT32_MAX;
}

static int32_t age_message(uint32_t age_us)
{
    return age_us != SADDLE_AGE_NEVER_US ? limited(age_us) : SADDLEWALK_STATUS_T_NEVER;
}

static uint32_t larger(uint32_t a, uint32_t b)
{
    return a > b ? a : b;
}

saddlewalk_health_t saddle_report_health(const saddle_report_t *report,
                                         const saddle_output_t *output)
{
    const saddle_inbox_t *inbox = report->inbox;
    const saddle_wire_receiver_t *receiver = &inbox->receiver;
    const saddle_measurement_t *measured = &inbox->input.measurement;
    const uint32_t feet_age_us =
        larger(measured->foot[SADDLE_LEFT].age_us, measured->foot[SADDLE_RIGHT].age_us);
    return (saddlewalk_health_t){
        .utime_us = (int64_t)inbox->input.time_us,
        .tick = (int32_t)report->timing->ticks,
        .status = (int8_t)output->status,
        .can_transport = (int8_t)report->bus->kind,
        .limits = (int32_t)output->limits,
        .faults = (int32_t)output->faults,
        .latency_us = limited(report->timing->latency_us),
        .late_ticks = (int32_t)report->timing->late_ticks,
        .measurement_age_us = age_message(larger(measured->com.age_us, feet_age_us)),
        .frames_accepted = receiver->accepted,
        .frames_bad_crc = receiver->bad_crc,
        .frames_bad_counter = receiver->bad_counter,
        .frames_malformed = receiver->malformed,
        .frames_not_sent = (int64_t)report->bus->no_room + report->bus->no_link,
        .commands_rejected = (int64_t)inbox->commands_unusable + inbox->commands_ignored +
                             inbox->commands_foreign + receiver->bad_version,
    };
}

static void tell_timing(saddlewalk_status_t *message, const saddle_timing_t *timing)
{
    message->tick = (int32_t)timing->ticks;
    message->period_us = limited(timing->period_us);
    message->latency_us = limited(timing->latency_us);
    message->latency_max_us = limited(timing->latency_max_us);
    message->work_us = limited(timing->work_us);
    message->work_max_us = limited(timing->work_max_us);
    message->late_ticks = (int32_t)timing->late_ticks;
    message->missed_ticks = (int32_t)timing->missed_ticks;
    for (size_t bin = 0; bin < SADDLE_LATENCY_BINS; ++bin) {
        message->latencies[bin] = (int32_t)timing->latencies[bin];
    }
}

static void tell_inputs(saddlewalk_status_t *message, const saddle_inbox_t *inbox)
{
    const saddle_input_t *input = &inbox->input;
    const saddle_wire_receiver_t *receiver = &inbox->receiver;
    message->command_source = (int8_t)inbox->authority;
    message->command_age_us = age_message(input->command_age_us);
    message->com_age_us = age_message(input->measurement.com.age_us);
    message->left_age_us = age_message(input->measurement.foot[SADDLE_LEFT].age_us);
    message->right_age_us = age_message(input->measurement.foot[SADDLE_RIGHT].age_us);
    message->commands_obeyed = inbox->commands_applied;
    message->commands_unusable = inbox->commands_unusable;
    message->commands_ignored = inbox->commands_ignored;
    message->commands_foreign = inbox->commands_foreign;
    message->frames_accepted = receiver->accepted;
    message->frames_malformed = receiver->malformed;
    message->frames_bad_crc = receiver->bad_crc;
    message->frames_bad_counter = receiver->bad_counter;
    message->frames_bad_version = receiver->bad_version;
    message->other_version = receiver->other_version;
    message->codes_demanded = receiver->guard.required;
    message->frames_bad_code = receiver->bad_code;
}

static void tell_transports(saddlewalk_status_t *message, const saddle_bus_t *bus,
                            const saddle_lcm_port_t *lcm)
{
    message->can_transport = (int8_t)bus->kind;
    message->can_link = (int8_t)bus->link.state;
    message->can_losses = (int32_t)bus->link.losses;
    message->frames_sent = bus->sent;
    message->frames_no_room = bus->no_room;
    message->frames_no_link = bus->no_link;
    message->lcm_link = (int8_t)lcm->link.state;
    message->lcm_losses = (int32_t)lcm->link.losses;
    message->messages_not_sent = (int64_t)lcm->not_sent;
}

saddlewalk_status_t saddle_report_status(const saddle_report_t *report)
{
    static char library_version[] = SADDLE_VERSION;
    saddlewalk_status_t message = {
        .utime_us = (int64_t)report->inbox->input.time_us,
        .fifo_priority = (int8_t)report->realtime->fifo_priority,
        .memory_locked = report->realtime->memory_locked,
        .wire_version = SADDLE_WIRE_VERSION,
        .library_version = library_version,
    };
    tell_timing(&message, report->timing);
    tell_inputs(&message, report->inbox);
    tell_transports(&message, report->bus, report->lcm);
    return message;
}

void saddle_report_print(const saddle_report_t *report)
{
    const saddle_timing_t *timing = report->timing;
    const saddle_inbox_t *inbox = report->inbox;
    const saddle_wire_receiver_t *receiver = &inbox->receiver;
    printf("%" PRIu32 " ticks, %" PRIu32 " late, %" PRIu32 " missed; frames: %" PRIu32
           " accepted, rejected %" PRIu32 " bad CRC, %" PRIu32 " bad counter, %" PRIu32
           " bad version, %" PRIu32 " bad code, %" PRIu32 " malformed; commands: %" PRIu32
           " applied, %" PRIu32 " unusable, %" PRIu32 " ignored, %" PRIu32
           " from other machines; not sent: %" PRIu32 " frames without room, %" PRIu32
           " without link, %" PRIu64 " LCM messages\n",
           timing->ticks, timing->late_ticks, timing->missed_ticks, receiver->accepted,
           receiver->bad_crc, receiver->bad_counter, receiver->bad_version, receiver->bad_code,
           receiver->malformed, inbox->commands_applied, inbox->commands_unusable,
           inbox->commands_ignored, inbox->commands_foreign, report->bus->no_room,
           report->bus->no_link, report->lcm->not_sent);
}
