/* saddlewalk-bench-calls: each call of a transcendental function or square root in each update, a
 * line each: walk, update, function, argument. Linked with --wrap of those functions. */
#include "floor.h"
#include "walks.h"

#include "math/elementary.h"
#include <stdio.h>

static bool recording;
static int walk_number;
static uint32_t update_number;

static void record(int function, float argument)
{
    if (recording) {
        printf("%d %u %d %.9g\n", walk_number, (unsigned)update_number, function, (double)argument);
    }
}

/* The linker gives the names, by --wrap. */
/* NOLINTBEGIN(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp,misc-use-internal-linkage) */
#define RECORDED(name, function)          \
    float __real_##name(float x);         \
    float __wrap_##name(float x);         \
    float __wrap_##name(float x)          \
    {                                     \
        record(function, x);              \
        const bool outer = recording;     \
        recording = false;                \
        const float y = __real_##name(x); \
        recording = outer;                \
        return y;                         \
    }

RECORDED(saddle_sin, SADDLE_BENCH_SIN)
RECORDED(saddle_cos, SADDLE_BENCH_COS)
RECORDED(saddle_asin, SADDLE_BENCH_ASIN)
RECORDED(saddle_erf, SADDLE_BENCH_ERF)
RECORDED(saddle_exp, SADDLE_BENCH_EXP)
RECORDED(sqrtf, SADDLE_BENCH_SQRT)

saddle_sin_cos_t __real_saddle_sin_cos(float x_rad);
saddle_sin_cos_t __wrap_saddle_sin_cos(float x_rad);
saddle_sin_cos_t __wrap_saddle_sin_cos(float x_rad)
{
    record(SADDLE_BENCH_SIN_COS, x_rad);
    return __real_saddle_sin_cos(x_rad);
}
/* NOLINTEND(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp,misc-use-internal-linkage) */

int main(void)
{
    static saddle_bench_walk_t walk;
    static saddle_output_t output;
    static saddle_scores_t scores;
    for (walk_number = 0; walk_number < SADDLE_BENCH_WALKS; walk_number++) {
        saddle_bench_walk(&walk, walk_number);
        for (update_number = 0; update_number < SADDLE_BENCH_UPDATES; update_number++) {
            recording = true;
            saddle_bench_update(&walk, update_number, &output, &scores);
            recording = false;
        }
    }
    return 0;
}
