/**
 * The loop of a controller: takes frames, ticks the core every 80 ms, sends. Portable C without a
 * heap; what it needs from the board is in board.h.
 *
 *     static saddle_controller_t controller;
 *     if (saddle_controller_init(&controller, &config, false) == SADDLE_OK)
 *         for (;;) { saddle_controller_step(&controller); sleep until an interrupt has come }
 *
 * Lockstep, for emulators: as the host process's (port_host/runner.h), a set of measurements makes
 * a tick due, tick n has the time n * 80 ms, and what came before it is of age 0.
 *
 * Where joints are driven there are several passes in a tick, one for each period of the board's timer
 * or, in lockstep, for each set of SENSED frames.
 */
#ifndef SADDLEWALK_MCU_CONTROLLER_H
#define SADDLEWALK_MCU_CONTROLLER_H

#include "health.h"
#include "joint_loop.h"

typedef struct {
    saddle_context_t context;
    saddle_inbox_t inbox;
    saddle_timing_t timing;
    saddle_joint_loop_t joints;
    bool lockstep;
    uint64_t rounds;    /**< the board's timer count at the last pass; in lockstep, passes */
    uint64_t ticks_due; /**< whole ticks in them at the last tick */
    uint32_t not_sent;  /**< frames for which the board had no room */
} saddle_controller_t;

/** What saddle_init() returns. If it is not SADDLE_OK do not run it: every tick would
 *  be rejected, and the watchdog never fed. */
saddle_status_t saddle_controller_init(saddle_controller_t *controller,
                                       const saddle_config_t *config, bool lockstep);

/** From now on require codes by this secret key of commands and times (docs/authentication.md). Call it
 *  after saddle_controller_init(). The key is not kept, but what it becomes is. */
void saddle_controller_require_codes(saddle_controller_t *controller,
                                     const uint8_t key[SADDLE_CMAC_LENGTH]);

/** Measure by sensors and drive joints, config->passes times in a tick. Call it after
 *  saddle_controller_init() with what saddle_joint_loop_check() accepts; the board's timer has the period
 *  saddle_joint_loop_period_us(). Returns what saddle_joint_loop_init() returns. */
saddle_status_t saddle_controller_drive_joints(saddle_controller_t *controller,
                                               const saddle_joint_loop_config_t *config);

/** Process received frames, and make the pass and the tick that are due. Never waits. */
void saddle_controller_step(saddle_controller_t *controller);

#endif
