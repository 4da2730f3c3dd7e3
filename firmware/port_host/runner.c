#include "runner.h"

#include <string.h>
#include <sys/select.h>
#include <time.h>

/** Taken at most between two looks at the clock, so that a flood cannot hold up a tick. */
#define FRAMES_AT_ONCE 256
#define COMMANDS_AT_ONCE 16

/** The configuration is published with every so many ticks, about once a second. */
#define CONFIG_TICKS 12

#define MEASURED_SET                                                        \
    (1u << SADDLE_WIRE_MEASURED_COM | 1u << SADDLE_WIRE_MEASURED_LEFT | \
     1u << SADDLE_WIRE_MEASURED_RIGHT)

static uint64_t now_us(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000u + (uint64_t)now.tv_nsec / 1000u;
}

/** The newest usable command wins, wherever it came from. Judged here, not only by the core: one
 *  that cannot be used must not take the place of a good one that still waits for its tick. */
static void take_command(void *user, const saddle_command_t *command)
{
    saddle_runner_t *runner = user;
    if (command != NULL && saddle_command_usable(command)) {
        runner->input.command = *command;
    } else {
        ++runner->commands_rejected;
    }
}

static void take_measured(saddle_runner_t *runner, saddle_wire_message_t message,
                          const uint8_t *data)
{
    const uint8_t counter = saddle_wire_counter(data);
    saddle_wire_decode_measured(message, data, &runner->input.measurement);
    runner->received_us[message] = now_us();
    if (counter != runner->set_counter) {
        runner->set = 0;
        runner->set_counter = counter;
    }
    runner->set |= 1u << message;
}

static void take_frame(saddle_runner_t *runner, const saddle_bus_frame_t *frame)
{
    const saddle_wire_message_t message =
        saddle_wire_accept(&runner->receiver, frame->id, frame->data, frame->length);
    if (message == SADDLE_WIRE_COMMAND) {
        saddle_command_t command;
        saddle_wire_decode_command(frame->data, &command);
        take_command(runner, &command);
    } else if (message != SADDLE_WIRE_NONE) {
        take_measured(runner, message, frame->data);
    }
}

static bool is_lockstep_due(const saddle_runner_t *runner)
{
    return runner->lockstep && runner->set == MEASURED_SET;
}

/** Take what waits on the bus; in lockstep, no more once a set of measurements is complete. */
static void take_frames(saddle_runner_t *runner)
{
    for (int i = 0; i < FRAMES_AT_ONCE && !is_lockstep_due(runner); ++i) {
        saddle_bus_frame_t frame;
        switch (saddle_bus_receive(runner->bus, &frame)) {
        case SADDLE_BUS_EMPTY: return;
        case SADDLE_BUS_JUNK: ++runner->receiver.malformed; break;
        case SADDLE_BUS_FRAME: take_frame(runner, &frame); break;
        }
    }
}

static uint32_t age_us(const saddle_runner_t *runner, saddle_wire_message_t message,
                       uint64_t time_us)
{
    const uint64_t received_us = runner->received_us[message];
    if (received_us == 0 || runner->lockstep) {
        return received_us == 0 ? SADDLE_AGE_NEVER_US : 0;
    }
    const uint64_t age = time_us > received_us ? time_us - received_us : 0;
    return age < SADDLE_AGE_NEVER_US ? (uint32_t)age : SADDLE_AGE_NEVER_US;
}

/** Age of the oldest part; -1: a part never came. */
static int32_t oldest_age_us(const saddle_measurement_t *measurement)
{
    uint32_t oldest = measurement->com.age_us;
    for (size_t side = 0; side < 2; ++side) {
        if (measurement->foot[side].age_us > oldest) {
            oldest = measurement->foot[side].age_us;
        }
    }
    if (oldest == SADDLE_AGE_NEVER_US) {
        return -1;
    }
    return oldest < INT32_MAX ? (int32_t)oldest : INT32_MAX;
}

static uint32_t rejected(const saddle_runner_t *runner)
{
    const saddle_wire_receiver_t *receiver = &runner->receiver;
    return receiver->malformed + receiver->bad_crc + receiver->bad_version +
           receiver->bad_counter + runner->commands_rejected;
}

static void send_frames(saddle_runner_t *runner, const saddle_output_t *output)
{
    saddle_frame_t frames[SADDLE_WIRE_OUTPUT_FRAMES];
    const saddle_wire_health_t health = {.late_ticks = runner->late_ticks,
                                         .rejected_frames = rejected(runner)};
    saddle_wire_encode_output(output, &health, (uint8_t)runner->ticks, frames);
    for (size_t i = 0; i < SADDLE_WIRE_OUTPUT_FRAMES; ++i) {
        saddle_bus_frame_t frame = {.id = frames[i].id, .length = sizeof frames[i].data};
        memcpy(frame.data, frames[i].data, sizeof frame.data);
        if (!saddle_bus_send(runner->bus, &frame)) {
            ++runner->frames_not_sent;
        }
    }
}

static saddlewalk_health_t health_of(const saddle_runner_t *runner, const saddle_output_t *output,
                                     uint32_t latency_us)
{
    const saddle_wire_receiver_t *receiver = &runner->receiver;
    return (saddlewalk_health_t){
        .utime_us = (int64_t)runner->input.time_us,
        .tick = (int32_t)runner->ticks,
        .status = (int8_t)output->status,
        .can_transport = (int8_t)runner->bus->kind,
        .limits = (int32_t)output->limits,
        .faults = (int32_t)output->faults,
        .latency_us = (int32_t)latency_us,
        .late_ticks = (int32_t)runner->late_ticks,
        .measurement_age_us = oldest_age_us(&runner->input.measurement),
        .frames_accepted = receiver->accepted,
        .frames_bad_crc = receiver->bad_crc,
        .frames_bad_counter = receiver->bad_counter,
        .frames_malformed = receiver->malformed,
        .frames_not_sent = runner->frames_not_sent,
        .commands_rejected = (int64_t)runner->commands_rejected + receiver->bad_version,
    };
}

static void tick(saddle_runner_t *runner, uint64_t time_us, uint32_t latency_us)
{
    saddle_input_t *input = &runner->input;
    saddle_output_t output;
    input->time_us = time_us;
    input->measurement.com.age_us = age_us(runner, SADDLE_WIRE_MEASURED_COM, time_us);
    input->measurement.foot[SADDLE_LEFT].age_us =
        age_us(runner, SADDLE_WIRE_MEASURED_LEFT, time_us);
    input->measurement.foot[SADDLE_RIGHT].age_us =
        age_us(runner, SADDLE_WIRE_MEASURED_RIGHT, time_us);
    (void)saddle_tick(&runner->context, input, &output); /* the status is part of the output */
    send_frames(runner, &output);
    const saddlewalk_health_t health = health_of(runner, &output, latency_us);
    if (runner->ticks % CONFIG_TICKS == 0) {
        saddle_lcm_publish_config(runner->lcm, &runner->context.config, time_us, runner->lockstep);
    }
    saddle_lcm_publish(runner->lcm, input, &output, &health);
    ++runner->ticks;
    runner->set = 0;
}

/** Wait for something to receive, or until a time; 0: however long. False: the loop must end. */
static bool wait(const saddle_runner_t *runner, uint64_t until_us)
{
    const uint64_t now = now_us();
    const uint64_t left_us = until_us > now ? until_us - now : 0;
    struct timeval timeout = {.tv_sec = (time_t)(left_us / 1000000u),
                              .tv_usec = (suseconds_t)(left_us % 1000000u)};
    const int fds[] = {runner->stop_fd, runner->bus->receive_fd, saddle_lcm_fd(runner->lcm)};
    fd_set readable;
    int highest = 0;
    FD_ZERO(&readable);
    for (size_t i = 0; i < sizeof fds / sizeof fds[0]; ++i) {
        if (fds[i] >= 0) {
            FD_SET(fds[i], &readable);
            highest = fds[i] > highest ? fds[i] : highest;
        }
    }
    /* Interrupted by a signal, `readable` says nothing: the next round sees stop_fd. */
    return select(highest + 1, &readable, NULL, NULL, until_us != 0 ? &timeout : NULL) < 0 ||
           !FD_ISSET(runner->stop_fd, &readable);
}

static void run_realtime(saddle_runner_t *runner)
{
    uint64_t due_us = now_us() + SADDLE_TICK_US;
    while (wait(runner, due_us)) {
        const uint64_t awake_us = now_us();
        take_frames(runner);
        saddle_lcm_receive(runner->lcm, COMMANDS_AT_ONCE);
        if (awake_us < due_us) {
            continue;
        }
        tick(runner, due_us, (uint32_t)(awake_us - due_us));
        due_us += SADDLE_TICK_US;
        if (now_us() > due_us) {
            ++runner->late_ticks;
            due_us += (now_us() - due_us) / SADDLE_TICK_US * SADDLE_TICK_US;
        }
    }
}

static void run_lockstep(saddle_runner_t *runner)
{
    while (wait(runner, 0)) {
        take_frames(runner);
        if (is_lockstep_due(runner)) {
            tick(runner, (uint64_t)runner->ticks * SADDLE_TICK_US, 0);
        }
    }
}

void saddle_runner_init(saddle_runner_t *runner, const saddle_config_t *config, bool lockstep,
                        saddle_bus_t *bus, saddle_lcm_port_t *lcm, int stop_fd)
{
    *runner = (saddle_runner_t){
        .bus = bus, .lcm = lcm, .stop_fd = stop_fd, .lockstep = lockstep};
    (void)saddle_init(&runner->context, config);
    if (!lockstep) { /* in lockstep commands come by CAN, in order with the measurements */
        saddle_lcm_subscribe(lcm, take_command, runner);
    }
}

void saddle_runner_run(saddle_runner_t *runner)
{
    if (runner->lockstep) {
        run_lockstep(runner);
    } else {
        run_realtime(runner);
    }
}
