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

#include <saddlewalk/private/context.h>
#include <saddlewalk/types.h>
#include <saddlewalk/version.h>

/** The paper's parameters for a body. saddle_config_check() checks the arguments. */
saddle_config_t saddle_config_default(float body_height_m, float body_mass_kg);

/** Name of the first field that is not finite, out of range or at odds with the others;
 *  NULL when the configuration can be used. The text is constant and never freed.
 *  config must not be NULL. */
const char *saddle_config_check(const saddle_config_t *config);

/** The float field at an index, NULL past the last. For hosts that set fields by name. */
const saddle_config_field_t *saddle_config_field(size_t index);

/** Copy and check the configuration and reset the context. On an error the context stays
 *  uninitialised and every tick on it returns SADDLE_ERROR_UNINITIALISED. May be called again at any time. */
saddle_status_t saddle_init(saddle_context_t *context, const saddle_config_t *config);

/** That nothing was ever measured: for a plan without a wearer. */
saddle_measurement_t saddle_no_measurement(void);

/** True for a stand, whatever its numbers, and for a walk with numbers within +-10^6. */
bool saddle_command_usable(const saddle_command_t *command);

/** One update. Writes all of *output on every path, unless output is NULL; on an error (its return
 *  value, also in output->status) nothing in it is valid. For the first tick after saddle_init() no
 *  time has passed. Every number of an output is finite: were one not, the tick would be a
 *  SADDLE_ERROR_NUMBER. No loops over data; docs/costs.md has the cost. The three must not overlap. */
saddle_status_t saddle_tick(saddle_context_t *context, const saddle_input_t *input,
                            saddle_output_t *output);

/** Plan as if a steady walk at the commanded speed were under way, at the left foot via point
 *  (theta = 0): what the paper plans. The next tick goes on from there; give it the same command.
 *  Without this call a walk begins from standing. */
saddle_status_t saddle_join(saddle_context_t *context, const saddle_command_t *command);

/** Go on in the shape of another configuration: its lateral_factor, lateral_offset_m, lateral_delay_rad,
 *  vertical_offset_m, vertical_delay_rad, strike_share, swing_begin, swing_end and swing_skew are taken
 *  over, and nothing else of it. For a plan that follows its wearer while walking. No position of the plan
 *  jumps: a walk takes it over in the first quarter of a step, and what it changes there fades out within
 *  that step. SADDLE_ERROR_TIME in the rest of a step, and nothing changes: call it again after the next
 *  tick. SADDLE_ERROR_CONFIG where saddle_config_check() would not pass. Costs as much as saddle_init(). */
saddle_status_t saddle_adapt(saddle_context_t *context, const saddle_config_t *config);

/** The plan at time_us, from the last tick's time to the end of the next step (0.5 s while
 *  standing), under the command of the last tick; for a faster joint controller. Does not
 *  touch the context. SADDLE_ERROR_TIME, and a plan that is not valid, outside that span;
 *  SADDLE_ERROR_NUMBER as for a tick. */
saddle_status_t saddle_plan_at(const saddle_context_t *context, uint64_t time_us,
                               saddle_plan_t *plan);

/** The reference after_s in [0, 0.5] after a valid plan, in that plan's frame: for a controller behind a
 *  bus, which has the last tick's plan alone. The plan itself holds the reference of its own time. The
 *  speed is taken to go on changing as it does. SADDLE_ERROR_TIME, and zeros, for another time or a
 *  plan that is not valid. Depends on nothing of the context but its configuration. */
saddle_status_t saddle_reference_after(const saddle_context_t *context, const saddle_plan_t *plan,
                                       float after_s, saddle_reference_t *reference);

/** The scores of a planned posture, in the frame of the plan: what the paper tabulates, and what a
 *  measured score is read against. Of a plan that is not valid nothing is scored. */
saddle_status_t saddle_score_plan(const saddle_context_t *context, const saddle_plan_t *plan,
                                  saddle_scores_t *scores);

/** For display: a convex polygon inscribed in the BoS, counter-clockwise, every vertex on the
 *  border. Zeros if the BoS is undefined. */
void saddle_bos_polygon(const saddle_bos_t *bos, saddle_vec2_t vertices_m[SADDLE_BOS_VERTICES]);

#ifdef __cplusplus
}
#endif

#endif
