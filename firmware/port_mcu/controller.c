#include "controller.h"

#include "board.h"
#include <string.h>

static uint32_t period_us(const saddle_controller_t *controller)
{
    return saddle_joint_loop_period_us(&controller->joints.config);
}

/** The time of the next pass in lockstep; where no joint is driven, each pass is a tick. */
static uint64_t lockstep_us(const saddle_controller_t *controller)
{
    return controller->rounds * period_us(controller);
}

static uint64_t now_us(const saddle_controller_t *controller)
{
    return controller->lockstep ? lockstep_us(controller) : saddle_clock_now_us();
}

static bool is_lockstep_due(const saddle_controller_t *controller)
{
    return controller->lockstep && saddle_inbox_set_complete(&controller->inbox);
}

/** At most as many frames as the queue holds, so that a flood cannot delay a tick; in lockstep,
 *  none once a set of measurements is complete. */
static void take_frames(saddle_controller_t *controller)
{
    saddle_can_frame_t frame;
    for (uint32_t i = 0;
         i < SADDLE_CAN_QUEUE && !is_lockstep_due(controller) && saddle_can_receive(&frame); ++i) {
        saddle_inbox_take_frame(&controller->inbox, frame.id, frame.data, frame.length,
                                controller->lockstep ? lockstep_us(controller) : frame.received_us);
    }
}

/** Whether a pass is due, and for what time. One whose time has passed is missed, and not made up. */
static bool is_due(saddle_controller_t *controller, uint64_t *due_us)
{
    if (controller->lockstep) {
        *due_us = lockstep_us(controller);
        return is_lockstep_due(controller);
    }
    const uint64_t rounds = saddle_clock_rounds();
    const bool due = rounds != controller->rounds;
    controller->rounds = rounds;
    *due_us = rounds * period_us(controller);
    return due;
}

/** Whether this pass ticks: the first at or after a tick's time. */
static bool is_tick_due(saddle_controller_t *controller, uint64_t due_us)
{
    if (controller->lockstep) {
        return due_us % SADDLE_TICK_US == 0u;
    }
    const uint64_t ticks_due = due_us / SADDLE_TICK_US;
    const uint64_t come = ticks_due - controller->ticks_due;
    if (come == 0u) {
        return false;
    }
    controller->timing.missed_ticks += (uint32_t)come - 1u;
    controller->ticks_due = ticks_due;
    return true;
}

static void send_frame(saddle_controller_t *controller, const saddle_frame_t *from)
{
    saddle_can_frame_t frame = {.id = from->id, .length = SADDLE_WIRE_LENGTH};
    memcpy(frame.data, from->data, sizeof frame.data);
    controller->not_sent += !saddle_can_send(&frame);
}

/** Where codes are required: a new session if it is time for one, and to those who command the
 *  session there is. */
static void keep_session(saddle_controller_t *controller, const saddle_output_t *output)
{
    saddle_wire_receiver_t *receiver = &controller->inbox.receiver;
    uint32_t bits;
    if (saddle_wire_session_expired(receiver, output, controller->timing.ticks) &&
        saddle_random(&bits)) {
        saddle_wire_open_session(receiver, bits);
    }
    if (receiver->guard.opened) {
        saddle_frame_t frame;
        saddle_wire_encode_session(receiver, (uint8_t)controller->timing.ticks, &frame);
        send_frame(controller, &frame);
    }
}

static void send_output(saddle_controller_t *controller, const saddle_output_t *output)
{
    saddle_frame_t frames[SADDLE_WIRE_OUTPUT_FRAMES];
    saddle_wire_health_t health = saddle_health(&controller->timing, &controller->inbox);
    health.rejected_frames += saddle_can_lost();
    saddle_wire_encode_output(output, &health, (uint8_t)controller->timing.ticks, frames);
    for (size_t i = 0; i < SADDLE_WIRE_OUTPUT_FRAMES; ++i) {
        send_frame(controller, &frames[i]);
    }
}

static void send_joints(saddle_controller_t *controller)
{
    saddle_frame_t frames[SADDLE_WIRE_JOINT_FRAMES];
    saddle_wire_encode_joints(&controller->joints.commands, &controller->joints.estimate,
                              (uint8_t)controller->rounds, frames);
    for (size_t i = 0; i < SADDLE_WIRE_JOINT_FRAMES; ++i) {
        send_frame(controller, &frames[i]);
    }
}

/** Feed the watchdog only after a successful tick that ended before the next one is due. */
static void tick(saddle_controller_t *controller, uint64_t due_us)
{
    saddle_output_t output;
    const uint64_t next_us = due_us + SADDLE_TICK_US;
    saddle_timing_begin(&controller->timing, due_us, now_us(controller));
    const saddle_input_t *input = saddle_inbox_read(&controller->inbox, due_us);
    const saddle_status_t status = saddle_tick(&controller->context, input, &output);
    saddle_joint_loop_tick(&controller->joints, &output);
    keep_session(controller, &output);
    send_output(controller, &output);
    const uint64_t done_us = now_us(controller);
    saddle_timing_end(&controller->timing, next_us, done_us);
    if (status == SADDLE_OK && done_us <= next_us) {
        saddle_watchdog_feed();
    }
}

static void sense(saddle_controller_t *controller, uint64_t due_us)
{
    if (controller->inbox.by_sensors) {
        const saddle_sensors_t *sensors = saddle_inbox_sense(&controller->inbox, due_us);
        controller->inbox.input.measurement =
            *saddle_joint_loop_sense(&controller->joints, sensors);
    }
}

static void drive(saddle_controller_t *controller, uint64_t due_us)
{
    if (controller->inbox.by_sensors) {
        saddle_joint_loop_drive(&controller->joints, &controller->context, due_us);
        send_joints(controller);
    }
    controller->rounds += controller->lockstep;
}

saddle_status_t saddle_controller_init(saddle_controller_t *controller,
                                       const saddle_config_t *config, bool lockstep)
{
    *controller = (saddle_controller_t){.lockstep = lockstep};
    saddle_inbox_init(&controller->inbox, SADDLE_SOURCE_CAN);
    controller->inbox.lockstep = lockstep;
    return saddle_init(&controller->context, config);
}

void saddle_controller_require_codes(saddle_controller_t *controller,
                                     const uint8_t key[SADDLE_CMAC_LENGTH])
{
    saddle_wire_require_auth(&controller->inbox.receiver, key);
}

saddle_status_t saddle_controller_drive_joints(saddle_controller_t *controller,
                                               const saddle_joint_loop_config_t *config)
{
    controller->inbox.by_sensors = config->passes != 0u;
    return saddle_joint_loop_init(&controller->joints, config);
}

void saddle_controller_step(saddle_controller_t *controller)
{
    uint64_t due_us = 0;
    take_frames(controller);
    if (!is_due(controller, &due_us)) {
        return;
    }
    sense(controller, due_us);
    if (is_tick_due(controller, due_us)) {
        tick(controller, due_us);
    }
    drive(controller, due_us);
}
