/**
 * The loop of the host process: receives, ticks the core every 80 ms, sends.
 *
 * Realtime: ticks lie on an absolute grid of CLOCK_MONOTONIC; the time of a tick is its place on
 * the grid. The loop waits for frames and the next place at once, so each measurement gets the
 * time at which it came and none waits in a buffer. A tick that ends after the next place is
 * counted as late, and the places that it missed are left out.
 * Lockstep: a set of the three MEASURED_xxx frames with one counter triggers one tick. The time of
 * tick n is n * 80 ms and every age is 0, so the same frames give the same bits.
 */
#ifndef SADDLEWALK_HOST_RUNNER_H
#define SADDLEWALK_HOST_RUNNER_H

#include "bus.h"
#include "lcm_port.h"
#include <saddlewalk/saddlewalk.h>
#include <saddlewalk/wire.h>

#define SADDLE_TICK_US 80000

typedef struct {
    saddle_bus_t *bus;
    saddle_lcm_port_t *lcm;
    int stop_fd; /**< readable when the loop must end */
    bool lockstep;
    saddle_context_t context;
    saddle_input_t input;
    saddle_wire_receiver_t receiver;
    uint64_t received_us[SADDLE_WIRE_MESSAGE_COUNT]; /**< 0: never */
    uint32_t set;          /**< lockstep: bits of the messages that have come since the last tick */
    uint8_t set_counter;   /**< their counter */
    uint32_t ticks;
    uint32_t late_ticks;
    uint32_t frames_not_sent;
    uint32_t commands_rejected; /**< unknown mode, number not finite, or no LCM command at all */
} saddle_runner_t;

/** Ready the runner. config has passed saddle_config_check(); bus and lcm are kept. */
void saddle_runner_init(saddle_runner_t *runner, const saddle_config_t *config, bool lockstep,
                        saddle_bus_t *bus, saddle_lcm_port_t *lcm, int stop_fd);

/** Run until stop_fd is readable; a tick that has begun is finished. */
void saddle_runner_run(saddle_runner_t *runner);

#endif
