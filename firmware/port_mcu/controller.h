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
 */
#ifndef SADDLEWALK_MCU_CONTROLLER_H
#define SADDLEWALK_MCU_CONTROLLER_H

#include "health.h"

typedef struct {
    saddle_context_t context;
    saddle_inbox_t inbox;
    saddle_timing_t timing;
    bool lockstep;
    uint32_t ticks_due; /**< the board's timer count at the last tick */
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

/** Process received frames, and tick if a tick is due. Never waits. */
void saddle_controller_step(saddle_controller_t *controller);

#endif
