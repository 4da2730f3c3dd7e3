/** Functions in a form that Eva sees through, with the same result for every argument
 *  (tests/unit/test_proof_models.c): to it `x >= lo` does not say that x is a number, `x == x` does,
 *  and what a function returns says nothing of its arguments. */
#ifndef SADDLEWALK_PROOF_MODELS_H
#define SADDLEWALK_PROOF_MODELS_H

#include "math/elementary.h"

static inline float model_larger(float a, float b)
{
    return a == a && a > b ? a : b;
}

static inline float model_smaller(float a, float b)
{
    return a == a && a < b ? a : b;
}

static inline float model_clamp(float x, float lo, float hi)
{
    if (x != x || x < lo) {
        return lo;
    }
    return x > hi ? hi : x;
}

#define MODEL_IN_RANGE(x, lo, hi) ((x) == (x) && (x) >= (lo) && (x) <= (hi))

#endif
