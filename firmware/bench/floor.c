#include "floor.h"

#include "math/elementary.h"
#include <math.h>

static float sin_and_cos(float x_rad)
{
    const saddle_sin_cos_t both = saddle_sin_cos(x_rad);
    return both.sin + both.cos;
}

/* A macro, so that each function is called as the core calls it, and not through a pointer. */
#define SUM_OF(function, count)              \
    for (uint32_t i = 0; i < (count); i++) { \
        sum += function(arguments[next++]);  \
    }

float saddle_bench_floor(const saddle_bench_calls_t *calls, const float *arguments, uint32_t *used)
{
    float sum = 0.0f;
    uint32_t next = 0;
    SUM_OF(saddle_sin, calls->count[SADDLE_BENCH_SIN])
    SUM_OF(saddle_cos, calls->count[SADDLE_BENCH_COS])
    SUM_OF(sin_and_cos, calls->count[SADDLE_BENCH_SIN_COS])
    SUM_OF(saddle_asin, calls->count[SADDLE_BENCH_ASIN])
    SUM_OF(saddle_erf, calls->count[SADDLE_BENCH_ERF])
    SUM_OF(saddle_exp, calls->count[SADDLE_BENCH_EXP])
    SUM_OF(sqrtf, calls->count[SADDLE_BENCH_SQRT])
    *used = next;
    return sum;
}
