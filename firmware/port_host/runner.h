/**
 * The loop of the host process: receives, ticks the core every 80 ms, sends.
 *
 * Realtime: ticks lie on an absolute grid of CLOCK_MONOTONIC; the time of a tick is its place on
 * the grid. The loop waits for frames and the next place at once, and the kernel notes when each
 * came, so its age is correct even if it had to wait. A tick that ends after the next place counts as
 * late, and a place that passed without a tick as missed: there is one tick at the newest place,
 * not one for each.
 * Lockstep: a set of the three MEASURED_xxx frames with one counter triggers one tick. The time of
 * tick n is n * 80 ms, a frame's that of the next tick, and a tick takes no time: measurements are
 * of age 0, and the same frames give the same bits.
 *
 * Where joints are driven there are several passes in a tick, by sensors and with commands of their
 * own. A tick is made in the first pass at or after its time. In lockstep a set of the SENSED_xxx frames
 * triggers a pass, of which the first and every so many more tick.
 */
#ifndef SADDLEWALK_HOST_RUNNER_H
#define SADDLEWALK_HOST_RUNNER_H

#include "gait_learner.h"
#include "joint_loop.h"
#include "report.h"

typedef struct {
    saddle_bus_t *bus;
    saddle_lcm_port_t *lcm;
    int lcm_commands_fd; /**< -1: LCM cannot command */
    int stop_fd;         /**< readable when the loop must end */
    bool lockstep;
    uint32_t untimed_ticks; /**< with measurements of a sender without a clock */
    saddle_context_t context;
    saddle_gait_learner_t learner; /**< off, unless it was initialised otherwise */
    saddle_joint_loop_t joints;    /**< off, unless saddle_runner_drive_joints() was called */
    uint64_t passes;               /**< so far */
    saddle_inbox_t inbox;
    saddle_timing_t timing;
    saddle_realtime_t realtime;
} saddle_runner_t;

/** Initialise the runner. config has passed saddle_config_check(); the pointers bus and lcm are
 *  kept. Commands by LCM: set lcm_commands_fd afterwards, but not in lockstep, where commands come
 *  by CAN, in order with the measurements. */
void saddle_runner_init(saddle_runner_t *runner, const saddle_config_t *config, bool lockstep,
                        saddle_source_t command_from, saddle_bus_t *bus, saddle_lcm_port_t *lcm,
                        int stop_fd);

/** Measure by sensors and drive joints. config has passed saddle_joint_loop_check(). */
void saddle_runner_drive_joints(saddle_runner_t *runner, const saddle_joint_loop_config_t *config);

/** Require authenticated commands, docs/authentication.md; commands by LCM have no codes. */
void saddle_runner_require_auth(saddle_runner_t *runner, const uint8_t key[SADDLE_CMAC_LENGTH]);

/** Run until stop_fd is readable; a tick that has begun is finished. */
void saddle_runner_run(saddle_runner_t *runner);

/** The present state, for the report. */
saddle_report_t saddle_runner_report(const saddle_runner_t *runner);

#endif
