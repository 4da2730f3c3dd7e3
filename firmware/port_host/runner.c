#include "runner.h"

#include "announce.h"
#include "clock.h"
#include "lcm_commands.h"
#include <arpa/inet.h>
#include <string.h>
#include <sys/random.h>
#include <sys/select.h>

/** Maximum number of messages between two reads of the clock, so that a flood cannot delay a tick.
 *  */
#define FRAMES_AT_ONCE 256
#define COMMANDS_AT_ONCE 16

/** The configuration is published with every so many ticks, about once a second. */
#define CONFIG_TICKS 12

/** Measurements without a time are announced after so many ticks, since the first may come before an
 *  authenticated time can. */
#define UNTIMED_TICKS 12

static uint32_t period_us(const saddle_runner_t *runner)
{
    return saddle_joint_loop_period_us(&runner->joints.config);
}

/** The time of the next pass in lockstep; where no joint is driven, each pass is a tick. */
static uint64_t lockstep_us(const saddle_runner_t *runner)
{
    return runner->passes * period_us(runner);
}

/** The reception time of something that has waited for waited_us. */
static uint64_t arrival_us(const saddle_runner_t *runner, uint32_t waited_us)
{
    if (runner->lockstep) {
        return lockstep_us(runner);
    }
    const uint64_t now_us = saddle_now_us();
    return now_us > waited_us ? now_us - waited_us : 0;
}

/** Announced once; later ones are only counted. */
static void reject_foreign_command(saddle_inbox_t *inbox, struct in_addr source)
{
    char address[INET_ADDRSTRLEN];
    if (inbox->commands_foreign++ == 0 &&
        inet_ntop(AF_INET, &source, address, sizeof address) != NULL) {
        saddle_announce("command by LCM from %s rejected: only this machine may command; "
                        "--lcm-from-network accepts others",
                        address);
    }
}

static void take_lcm_command(saddle_runner_t *runner, const saddle_lcm_arrival_t *arrival,
                             bool usable)
{
    saddle_inbox_take_command(&runner->inbox, SADDLE_SOURCE_LCM, usable ? &arrival->command : NULL,
                              arrival_us(runner, arrival->waited_us));
}

/** Receive the waiting commands by LCM. */
static void take_lcm_commands(saddle_runner_t *runner)
{
    for (int i = 0; i < COMMANDS_AT_ONCE; ++i) {
        saddle_lcm_arrival_t arrival;
        switch (saddle_lcm_commands_receive(runner->lcm_commands_fd, &arrival)) {
        case SADDLE_LCM_COMMAND: take_lcm_command(runner, &arrival, true); break;
        case SADDLE_LCM_JUNK: take_lcm_command(runner, &arrival, false); break;
        case SADDLE_LCM_FOREIGN: reject_foreign_command(&runner->inbox, arrival.source); break;
        default: return;
        }
    }
}

static bool is_lockstep_due(const saddle_runner_t *runner)
{
    return runner->lockstep && saddle_inbox_set_complete(&runner->inbox);
}

/** Announced once; later ones are only counted. */
static void announce_first_bad_version(const saddle_wire_receiver_t *receiver, uint32_t before)
{
    if (before == 0 && receiver->bad_version != 0) {
        saddle_announce("COMMAND of wire version %u rejected: this firmware has version %u",
                        (unsigned)receiver->other_version, (unsigned)SADDLE_WIRE_VERSION);
    }
}

/** Announced once; later ones are only counted. */
static void announce_first_unused(const saddle_inbox_t *inbox, uint32_t before)
{
    if (before == 0 && inbox->frames_unused != 0) {
        saddle_announce(inbox->by_sensors
                            ? "MEASURED_COM, _LEFT or _RIGHT rejected: with --joints the wearer is "
                              "measured by SENSED frames"
                            : "SENSED frames rejected: without --joints the wearer is measured by "
                              "MEASURED_COM, _LEFT and _RIGHT");
    }
}

/** Announced once. */
static void announce_untimed(saddle_runner_t *runner)
{
    const saddle_inbox_t *inbox = &runner->inbox;
    const bool measured =
        (inbox->came & (1u << SADDLE_WIRE_MEASURED_COM | 1u << SADDLE_WIRE_SENSED_GYRO)) != 0u;
    if (measured && !inbox->lockstep && !inbox->sender_clock &&
        ++runner->untimed_ticks == UNTIMED_TICKS) {
        saddle_announce(
            "the measurements come without MEASURED_TIME, as from senders of wire version "
            "%u: their ages count from reception, and a delay is not seen",
            SADDLE_WIRE_OLDEST_VERSION);
    }
}

static void take_frame(saddle_runner_t *runner, const saddle_bus_frame_t *frame)
{
    const uint32_t bad_version_before = runner->inbox.receiver.bad_version;
    const uint32_t unused_before = runner->inbox.frames_unused;
    saddle_inbox_take_frame(&runner->inbox, frame->id, frame->data, frame->length,
                            arrival_us(runner, frame->waited_us));
    announce_first_bad_version(&runner->inbox.receiver, bad_version_before);
    announce_first_unused(&runner->inbox, unused_before);
}

/** Receive the waiting frames; in lockstep, only until a set of measurements is complete. */
static void take_frames(saddle_runner_t *runner)
{
    for (int i = 0; i < FRAMES_AT_ONCE && !is_lockstep_due(runner); ++i) {
        saddle_bus_frame_t frame;
        switch (saddle_bus_receive(runner->bus, &frame)) {
        case SADDLE_BUS_FRAME: take_frame(runner, &frame); break;
        case SADDLE_BUS_JUNK: ++runner->inbox.receiver.malformed; break;
        default: return;
        }
    }
}

static void send_frame(saddle_runner_t *runner, const saddle_frame_t *frame)
{
    saddle_bus_frame_t raw = {.id = frame->id, .length = sizeof frame->data};
    memcpy(raw.data, frame->data, sizeof raw.data);
    saddle_bus_send(runner->bus, &raw);
}

static void send_joints(saddle_runner_t *runner)
{
    saddle_frame_t frames[SADDLE_WIRE_JOINT_FRAMES];
    saddle_wire_encode_joints(&runner->joints.commands, &runner->joints.estimate,
                              (uint8_t)runner->passes, frames);
    for (size_t i = 0; i < SADDLE_WIRE_JOINT_FRAMES; ++i) {
        send_frame(runner, &frames[i]);
    }
}

static void send_session(saddle_runner_t *runner)
{
    const saddle_wire_receiver_t *receiver = &runner->inbox.receiver;
    saddle_frame_t frame;
    if (receiver->guard.opened) {
        saddle_wire_encode_session(receiver, (uint8_t)runner->timing.ticks, &frame);
        send_frame(runner, &frame);
    }
}

static void send_frames(saddle_runner_t *runner, const saddle_output_t *output)
{
    saddle_frame_t frames[SADDLE_WIRE_OUTPUT_FRAMES];
    const saddle_wire_health_t health = saddle_health(&runner->timing, &runner->inbox);
    saddle_wire_encode_output(output, &health, (uint8_t)runner->timing.ticks, frames);
    for (size_t i = 0; i < SADDLE_WIRE_OUTPUT_FRAMES; ++i) {
        send_frame(runner, &frames[i]);
    }
}

/** A configuration that has changed holds from the next tick on. */
static void publish(saddle_runner_t *runner, const saddle_input_t *input,
                    const saddle_output_t *output, bool config_changed)
{
    const saddle_report_t report = saddle_runner_report(runner);
    const saddlewalk_status_t status = saddle_report_status(&report);
    const saddlewalk_health_t health = saddle_report_health(&report, output);
    if (runner->timing.ticks % CONFIG_TICKS == 0 || config_changed) {
        saddle_lcm_publish_config(runner->lcm, &runner->context.model.config, input->time_us,
                                  runner->lockstep);
    }
    saddle_lcm_publish(runner->lcm, input, output, &status, &health);
}

/** Without a random number there is no new session, and the next tick tries again. */
static void open_session(saddle_runner_t *runner)
{
    uint32_t session;
    if (getrandom(&session, sizeof session, GRND_NONBLOCK) == (ssize_t)sizeof session) {
        saddle_wire_open_session(&runner->inbox.receiver, session);
    }
}

/** Commands are stale and the commanded walk has ended. */
static bool is_commandless(const saddle_output_t *output)
{
    return (output->faults & (uint32_t)SADDLE_FAULT_COMMAND_STALE) != 0u &&
           output->plan.mode == (uint8_t)SADDLE_MODE_STANDING;
}

static void tick(saddle_runner_t *runner, uint64_t time_us)
{
    saddle_output_t output;
    const saddle_input_t *input = saddle_inbox_read(&runner->inbox, time_us);
    announce_untimed(runner);
    (void)saddle_tick(&runner->context, input, &output); /* the status is in the output */
    const bool adapted =
        saddle_gait_learner_tick(&runner->learner, &runner->context, input, &output);
    if (saddle_wire_session_expired(&runner->inbox.receiver, &output, runner->timing.ticks)) {
        open_session(runner);
    }
    send_session(runner);
    send_frames(runner, &output);
    publish(runner, input, &output, adapted);
    saddle_bus_maintain(runner->bus);
    if (is_commandless(&output)) {
        saddle_inbox_release(&runner->inbox);
    }
    saddle_joint_loop_tick(&runner->joints, &output);
}

static void sense(saddle_runner_t *runner, uint64_t time_us)
{
    if (runner->inbox.by_sensors) {
        const saddle_sensors_t *sensors = saddle_inbox_sense(&runner->inbox, time_us);
        runner->inbox.input.measurement = *saddle_joint_loop_sense(&runner->joints, sensors);
    }
}

/** What every pass does by CAN is published by LCM once a tick. */
static void drive(saddle_runner_t *runner, uint64_t time_us, bool ticked)
{
    if (!runner->inbox.by_sensors) {
        return;
    }
    saddle_joint_loop_drive(&runner->joints, &runner->context, time_us);
    send_joints(runner);
    if (ticked) {
        saddle_lcm_publish_joints(runner->lcm, &runner->inbox.sensors, &runner->joints.estimate,
                                  &runner->joints.commands);
    }
}

/** Wait for input, or until a time; 0: without a limit. False: the loop must end. */
static bool wait(const saddle_runner_t *runner, uint64_t until_us)
{
    const uint64_t now = saddle_now_us();
    const uint64_t left_us = until_us > now ? until_us - now : 0;
    struct timeval timeout = {.tv_sec = (time_t)(left_us / 1000000u),
                              .tv_usec = (suseconds_t)(left_us % 1000000u)};
    const int fds[] = {runner->stop_fd, runner->bus->receive_fd, runner->lcm_commands_fd};
    fd_set readable;
    int highest = 0;
    FD_ZERO(&readable);
    for (size_t i = 0; i < sizeof fds / sizeof fds[0]; ++i) {
        if (fds[i] >= 0) {
            FD_SET(fds[i], &readable);
            highest = fds[i] > highest ? fds[i] : highest;
        }
    }
    /* Interrupted by a signal, `readable` is not valid: the next round sees stop_fd. */
    return select(highest + 1, &readable, NULL, NULL, until_us != 0 ? &timeout : NULL) < 0 ||
           !FD_ISSET(runner->stop_fd, &readable);
}

/** The newest due time on a grid, from one that was due before. */
static uint64_t newest_place_us(uint64_t due_us, uint64_t now_us, uint32_t step_us)
{
    return now_us > due_us ? due_us + (now_us - due_us) / step_us * step_us : due_us;
}

/** Returns when the next tick is due. */
static uint64_t tick_in_time(saddle_runner_t *runner, uint64_t due_us, uint64_t awake_us)
{
    const uint64_t newest_us = newest_place_us(due_us, awake_us, SADDLE_TICK_US);
    runner->timing.missed_ticks += (uint32_t)((newest_us - due_us) / SADDLE_TICK_US);
    saddle_timing_begin(&runner->timing, newest_us, awake_us);
    tick(runner, newest_us);
    saddle_timing_end(&runner->timing, newest_us + SADDLE_TICK_US, saddle_now_us());
    return newest_us + SADDLE_TICK_US;
}

static void run_realtime(saddle_runner_t *runner)
{
    uint64_t due_us = saddle_now_us() + SADDLE_TICK_US;
    uint64_t tick_us = due_us;
    while (wait(runner, due_us)) {
        const uint64_t awake_us = saddle_now_us();
        take_frames(runner);
        take_lcm_commands(runner);
        if (awake_us < due_us) {
            continue;
        }
        due_us = newest_place_us(due_us, awake_us, period_us(runner));
        sense(runner, due_us);
        const bool ticks = due_us >= tick_us;
        if (ticks) {
            tick_us = tick_in_time(runner, tick_us, awake_us);
        }
        drive(runner, due_us, ticks);
        ++runner->passes;
        due_us += period_us(runner);
    }
}

/** Without a limit of its own, the wait would not notice that a link came back. */
static uint64_t lockstep_deadline_us(const saddle_runner_t *runner)
{
    return runner->bus->link.state == SADDLE_LINK_DOWN ? saddle_now_us() + SADDLE_TICK_US : 0;
}

static void run_lockstep(saddle_runner_t *runner)
{
    while (wait(runner, lockstep_deadline_us(runner))) {
        take_frames(runner);
        if (is_lockstep_due(runner)) {
            const uint64_t due_us = lockstep_us(runner);
            sense(runner, due_us);
            const bool ticks = due_us % SADDLE_TICK_US == 0u;
            if (ticks) {
                saddle_timing_begin(&runner->timing, due_us, due_us);
                tick(runner, due_us);
                saddle_timing_end(&runner->timing, due_us, due_us);
            }
            drive(runner, due_us, ticks);
            ++runner->passes;
        } else {
            saddle_bus_maintain(runner->bus);
        }
    }
}

void saddle_runner_init(saddle_runner_t *runner, const saddle_config_t *config, bool lockstep,
                        saddle_source_t command_from, saddle_bus_t *bus, saddle_lcm_port_t *lcm,
                        int stop_fd)
{
    *runner = (saddle_runner_t){
        .bus = bus, .lcm = lcm, .lcm_commands_fd = -1, .stop_fd = stop_fd, .lockstep = lockstep};
    (void)saddle_init(&runner->context, config);
    saddle_inbox_init(&runner->inbox, command_from);
    runner->inbox.lockstep = lockstep;
}

void saddle_runner_drive_joints(saddle_runner_t *runner, const saddle_joint_loop_config_t *config)
{
    (void)saddle_joint_loop_init(&runner->joints, config);
    runner->inbox.by_sensors = config->passes != 0u;
}

void saddle_runner_require_auth(saddle_runner_t *runner, const uint8_t key[SADDLE_CMAC_LENGTH])
{
    runner->inbox.chosen = SADDLE_SOURCE_CAN;
    runner->inbox.authority = SADDLE_SOURCE_CAN;
    saddle_wire_require_auth(&runner->inbox.receiver, key);
    open_session(runner);
}

void saddle_runner_run(saddle_runner_t *runner)
{
    if (runner->lockstep) {
        run_lockstep(runner);
    } else {
        run_realtime(runner);
    }
}

saddle_report_t saddle_runner_report(const saddle_runner_t *runner)
{
    return (saddle_report_t){.timing = &runner->timing,
                             .inbox = &runner->inbox,
                             .bus = runner->bus,
                             .lcm = runner->lcm,
                             .realtime = &runner->realtime};
}
