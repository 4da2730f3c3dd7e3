/* saddlewalk-bench-calls: each call of a transcendental function or square root in each update, a
 * line each: walk, update, function, argument. Linked with --wrap of those functions. */
#include "floor.h"
#include "walks.h"

#include "math/elementary.h"
#include <stdio.h>

static bool telling;
static int walk_number;
static uint32_t update_number;

static void tell(int function, float argument)
{
    if (telling) {
        printf("%d %u %d %.9g\n", walk_number, (unsigned)update_number, function, (double)argument);
    }
}

#define TOLD(name, function)                 \
    float __real_##name(float x);            \
    float __wrap_##name(float x);            \
    float __wrap_##name(float x)             \
    {                                        \
        tell(function, x);                   \
        const bool outer = telling;          \
        telling = false;                     \
        const float y = __real_##name(x);    \
        telling = outer;                     \
        return y;                            \
    }

TOLD(saddle_sin, SADDLE_BENCH_SIN)
TOLD(saddle_cos, SADDLE_BENCH_COS)
TOLD(saddle_asin, SADDLE_BENCH_ASIN)
TOLD(saddle_erf, SADDLE_BENCH_ERF)
TOLD(saddle_exp, SADDLE_BENCH_EXP)
TOLD(sqrtf, SADDLE_BENCH_SQRT)

saddle_sin_cos_t __real_saddle_sin_cos(float x_rad);
saddle_sin_cos_t __wrap_saddle_sin_cos(float x_rad);
saddle_sin_cos_t __wrap_saddle_sin_cos(float x_rad)
{
    tell(SADDLE_BENCH_SIN_COS, x_rad);
    return __real_saddle_sin_cos(x_rad);
}

int main(void)
{
    static saddle_bench_walk_t walk;
    static saddle_output_t output;
    static saddle_scores_t scores;
    for (walk_number = 0; walk_number < SADDLE_BENCH_WALKS; walk_number++) {
        saddle_bench_walk(&walk, walk_number);
        for (update_number = 0; update_number < SADDLE_BENCH_UPDATES; update_number++) {
            telling = true;
            saddle_bench_update(&walk, update_number, &output, &scores);
            telling = false;
        }
    }
    return 0;
}
