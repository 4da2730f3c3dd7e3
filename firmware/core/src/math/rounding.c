#include "math/rounding.h"

/* What a compiler tells of its flags; saddle_rounds_as_written() finds the rest. */
#if defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__)
#error "Saddlewalk: -ffast-math, -Ofast and -funsafe-math-optimizations change its results"
#endif
#if defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__
#error "Saddlewalk: -ffinite-math-only removes its checks for NaN"
#endif
#if defined(__FLT_EVAL_METHOD__) && __FLT_EVAL_METHOD__ != 0 && __FLT_EVAL_METHOD__ != 16
#error \
    "Saddlewalk: float must be evaluated as float; on 32-bit x86 compile with -msse2 -mfpmath=sse"
#endif

/* 1 + 2^-12 and 1 + 3 x 2^-12: with the first as factor, their products lie half-way between
 * floats, one to be rounded down to the even neighbour and one up. */
#define FACTOR 1.00024414f
#define OTHER_FACTOR 1.00073242f
#define PRODUCT_DOWN 1.00048828f
#define PRODUCT_UP 1.00097680f

/* 2^24, to which 1 adds nothing. */
#define LARGE 16777216.0f

/* 5/3 rounded; 5 x (1/3) is the float above. */
#define FIVE_THIRDS 1.66666663f

bool saddle_rounds_as_written(void)
{
    /* Volatile: computed here, on this processor, and not by the compiler. */
    const volatile float factor = FACTOR;
    const volatile float other_factor = OTHER_FACTOR;
    const volatile float large = LARGE;
    const volatile float five = 5.0f;
    const float x = factor;
    const float y = other_factor;
    const float z = large;
    return x * x - PRODUCT_DOWN == 0.0f && x * y - PRODUCT_UP == 0.0f && (z + 1.0f) - z == 0.0f &&
           five / 3.0f == FIVE_THIRDS;
}
