/**
 * The fast loop of a device with sensors and drives at its joints: estimator, walking layer and joint
 * commands, several passes in a tick. Knows no bus and reads no clock. In each pass
 *
 *     saddle_joint_loop_sense(&loop, sensors)         the measurement for the tick, if one is due
 *     saddle_joint_loop_tick(&loop, &output)          after that tick
 *     saddle_joint_loop_drive(&loop, &context, now)   then loop.commands are for the drives
 */
#ifndef SADDLEWALK_PORT_JOINT_LOOP_H
#define SADDLEWALK_PORT_JOINT_LOOP_H

#include "timing.h"
#include <saddlewalk/joint_walk.h>
#include <saddlewalk/saddlewalk.h>

/** Passes in a tick: 8 of 10 ms to 80 of 1 ms. */
#define SADDLE_PASSES_MIN 8u
#define SADDLE_PASSES_MAX 80u

/** Start from saddle_joint_loop_default(), then override. */
typedef struct {
    uint32_t passes; /**< in a tick; 0: the device measures a CoM, and no joint is driven */
    saddle_legs_t legs;
    saddle_estimator_config_t estimator;
    saddle_joint_walk_config_t walk;
    saddle_drive_config_t drive;
} saddle_joint_loop_config_t;

/** One of the four structs in a configuration: its fields, as of saddle_legs_field(), and where it lies. */
typedef struct {
    const char *name; /**< legs, estimator, walk or drive */
    const saddle_config_field_t *(*field)(size_t index);
    size_t offset; /**< in saddle_joint_loop_config_t */
} saddle_joint_part_t;

#define SADDLE_JOINT_PARTS 4u

typedef struct {
    saddle_joint_loop_config_t config;
    saddle_estimator_t estimator;
    saddle_joint_walk_t walk;
    saddle_estimate_t estimate;       /**< of the last pass */
    saddle_joint_commands_t commands; /**< likewise */
    uint32_t fallbacks;               /**< passes whose commands were the fallback */
    saddle_plan_t plan;
    saddle_verdict_t verdict; /**< of the last tick */
} saddle_joint_loop_t;

/** For the body of a configuration that has passed its check; passes is 0. */
saddle_joint_loop_config_t saddle_joint_loop_default(const saddle_config_t *config);

/** The part at an index below SADDLE_JOINT_PARTS: legs, estimator, walk, drive. */
saddle_joint_part_t saddle_joint_part(size_t index);

/** Name of the first field that is out of its range, `passes` included, or NULL. */
const char *saddle_joint_loop_check(const saddle_joint_loop_config_t *config);

/** From one pass to the next: a tick's part, or a whole tick where no joint is driven. */
uint32_t saddle_joint_loop_period_us(const saddle_joint_loop_config_t *config);

/** Copies the configuration. As saddle_estimator_init(); then every command is the fallback. */
saddle_status_t saddle_joint_loop_init(saddle_joint_loop_t *loop,
                                       const saddle_joint_loop_config_t *config);

/** What the core measures the wearer by, at sensors->time_us. */
const saddle_measurement_t *saddle_joint_loop_sense(saddle_joint_loop_t *loop,
                                                    const saddle_sensors_t *sensors);

/** Keep what a tick says for the passes until the next. */
void saddle_joint_loop_tick(saddle_joint_loop_t *loop, const saddle_output_t *output);

/** The commands of the joints at time_us, from the context's plan. */
void saddle_joint_loop_drive(saddle_joint_loop_t *loop, const saddle_context_t *context,
                             uint64_t time_us);

#endif
