/** The floor of an update: only its transcendental functions and square roots, with their
 *  arguments. */
#ifndef SADDLE_BENCH_FLOOR_H
#define SADDLE_BENCH_FLOOR_H

#include <stdint.h>

/** In the order of the arguments. A square root inside another function belongs to that function.
 *  */
enum {
    SADDLE_BENCH_SIN,
    SADDLE_BENCH_COS,
    SADDLE_BENCH_SIN_COS,
    SADDLE_BENCH_ASIN,
    SADDLE_BENCH_ERF,
    SADDLE_BENCH_EXP,
    SADDLE_BENCH_SQRT,
    SADDLE_BENCH_FUNCTIONS
};

/** How often an update calls each function. */
typedef struct {
    uint32_t count[7];
} saddle_bench_calls_t;

/** Repeat the calls. arguments: for one function after the other. Returns the
 *  sum of the results; *used: number of arguments that were used. */
float saddle_bench_floor(const saddle_bench_calls_t *calls, const float *arguments, uint32_t *used);

#endif
