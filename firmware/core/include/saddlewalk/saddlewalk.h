/** Saddlewalk: one walking-planner and stability-supervisor update per call, without a heap.
 *
 *      saddle_context_t context;                        // yours, static, one per walker
 *      saddle_config_t config = saddle_config_default(1.79f, 63.3f);
 *      saddle_init(&context, &config);
 *      every 80 ms:  saddle_tick(&context, &input, &output);
 *
 *  Nothing is kept of the pointers; nothing is shared between contexts, so each may run in a thread
 *  of its own; the same inputs give the same bits on every compiler and target that honours
 *  -ffp-contract=off. What does not is refused by saddle_init(). */
#ifndef SADDLEWALK_SADDLEWALK_H
#define SADDLEWALK_SADDLEWALK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#include <saddlewalk/config.h>
#include <saddlewalk/gait_model.h>
#include <saddlewalk/measurement.h>
#include <saddlewalk/model.h>
#include <saddlewalk/planner.h>
#include <saddlewalk/safe_state.h>
#include <saddlewalk/saddle_space.h>
#include <saddlewalk/supervisor.h>
#include <saddlewalk/version.h>

/** Did the call work? What the answer is worth is told by plan.valid and scores.valid. */
typedef enum {
    SADDLE_OK = 0,
    SADDLE_ERROR_NULL = 1,          /**< an argument is NULL */
    SADDLE_ERROR_CONFIG = 2,        /**< saddle_config_check() names the field */
    SADDLE_ERROR_UNINITIALISED = 3, /**< saddle_init() has not succeeded on this context */
    SADDLE_ERROR_TIME = 4,          /**< time_us went backwards: no plan, no scores, state kept,
                                         until it has caught up or saddle_init() starts over */
    SADDLE_ERROR_COMMAND = 5,       /**< saddle_join() needs a walk with a speed > 0 */
    SADDLE_ERROR_BUILD = 6          /**< the core's flags, or the processor's rounding mode, break
                                         its bits; docs/porting.md names those to use */
} saddle_status_t;

typedef struct {
    uint64_t time_us; /**< the caller's monotonic clock, any origin */
    saddle_command_t command;
    uint32_t command_age_us; /**< since the command was last confirmed */
    saddle_measurement_t measurement;
} saddle_input_t;

/** status: did the call work; limits: what clamped the plan; faults: which inputs were not used. */
typedef struct {
    saddle_status_t status;
    uint32_t limits; /**< saddle_limit_t bits */
    uint32_t faults; /**< saddle_fault_t bits */
    saddle_plan_t plan;
    saddle_scores_t scores;   /**< of the measured posture, in the frame of the CoM */
    saddle_verdict_t verdict; /**< the measured posture against the plan */
} saddle_output_t;

/** Caller-owned state; treat the fields as private. */
typedef struct {
    uint64_t last_time_us;
    uint32_t initialised;
    saddle_model_t model;
    saddle_planner_t planner;
    saddle_supervisor_t supervisor;
    saddle_safe_state_t safe_state;
    saddle_command_t command; /**< the last usable one */
    uint32_t command_age_us;
    bool ticked;
} saddle_context_t;

/** Copy and check the configuration and reset the context. On an error the context stays
 *  uninitialised and every tick on it says so. May be called again at any time. */
saddle_status_t saddle_init(saddle_context_t *context, const saddle_config_t *config);

/** One update. Writes all of *output on every path, unless output is NULL; on an error (its return
 *  value, also in output->status) nothing in it is valid. For the first tick after saddle_init() no
 *  time has passed. No loops over data; docs/costs.md has the cost. The three must not overlap. */
saddle_status_t saddle_tick(saddle_context_t *context, const saddle_input_t *input,
                            saddle_output_t *output);

/** Plan as if a steady walk at the commanded speed were under way, at the left foot via point
 *  (theta = 0): what the paper plans. The next tick goes on from there; give it the same command.
 *  Without this call a walk begins from standing. */
saddle_status_t saddle_join(saddle_context_t *context, const saddle_command_t *command);

/** The plan at time_us, from the last tick's time to the end of the next step (0.5 s while
 *  standing), under the command of the last tick; for a faster joint controller. Does not
 *  touch the context. SADDLE_ERROR_TIME, and a plan that is not valid, outside that span. */
saddle_status_t saddle_plan_at(const saddle_context_t *context, uint64_t time_us,
                               saddle_plan_t *plan);

/** The scores of a planned posture, in the frame of the plan: what the paper tabulates, and what a
 *  measured score is read against. Of a plan that is not valid nothing is scored. */
saddle_status_t saddle_score_plan(const saddle_context_t *context, const saddle_plan_t *plan,
                                  saddle_scores_t *scores);

#ifdef __cplusplus
}
#endif

#endif
