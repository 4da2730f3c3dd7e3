/** The walks of the benchmark, tick by tick. */
#ifndef SADDLE_BENCH_WALKS_H
#define SADDLE_BENCH_WALKS_H

#include <saddlewalk/saddlewalk.h>

#define SADDLE_BENCH_PERIOD_US 80000u

/** In the order of saddle_bench_walk(). */
enum {
    SADDLE_BENCH_PLAN, /**< a steady walk without a wearer, with scores of the plan, as in the paper */
    SADDLE_BENCH_SLOW, /**< 0.7 m/s: standing, starting, walking, stopping, by a wearer who follows
                            the plan */
    SADDLE_BENCH_MIDDLE, /**< 1.2 m/s, likewise */
    SADDLE_BENCH_FAST,   /**< 1.6 m/s, likewise */
    SADDLE_BENCH_PUSHED, /**< 1.2 m/s, then faster than planned, then beyond what a step can recover */
    SADDLE_BENCH_INVALID, /**< 1.2 m/s, with a different unusable input in each tick */
    SADDLE_BENCH_WALKS
};

#define SADDLE_BENCH_UPDATES 160u

typedef struct {
    saddle_context_t context;
    bool scores_plan;
    saddle_input_t inputs[SADDLE_BENCH_UPDATES];
} saddle_bench_walk_t;

/** A walk by its number, before its first update. */
void saddle_bench_walk(saddle_bench_walk_t *walk, int number);

/** One update: a tick, and in SADDLE_BENCH_PLAN the scores of its plan. */
void saddle_bench_update(saddle_bench_walk_t *walk, uint32_t update, saddle_output_t *output,
                         saddle_scores_t *scores);

#endif
