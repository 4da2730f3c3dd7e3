/** Planning and its floor, timed in C, without the overhead of calls from another language. */
#ifndef SADDLE_BENCH_PLANNING_H
#define SADDLE_BENCH_PLANNING_H

#include "floor.h"

#include <saddlewalk/saddlewalk.h>

/** Nanoseconds to plan a steady walk as the paper does, instant by instant and scored, on a context
 *  that saddle_init() has filled: 0 if the core rejects it. outputs and scores: one for each
 *  instant. */
uint64_t saddle_bench_plan_ns(saddle_context_t *context, const saddle_command_t *command,
                              uint32_t period_us, uint32_t instants, saddle_output_t *outputs,
                              saddle_scores_t *scores);

/** Nanoseconds of the next update of a walk that saddle_bench_plan_ns() began: 0 if the core
 *  rejects it. */
uint64_t saddle_bench_update_ns(saddle_context_t *context, const saddle_command_t *command,
                                uint32_t period_us, saddle_output_t *output,
                                saddle_scores_t *scores);

/** Nanoseconds of saddle_bench_floor() for a number of updates; *sum: sum of their results. */
uint64_t saddle_bench_floor_ns(const saddle_bench_calls_t *calls, const float *arguments,
                               uint32_t updates, float *sum);

#endif
