/**
 * Elementary functions from + - * / and sqrtf alone, single precision.
 *
 * Built with -ffp-contract=off, an argument gives the same bits on every compiler and target. No
 * function of one argument but saddle_magnitude() returns NaN or infinity. sin, asin and erf are odd
 * and cos is even, bit for bit except for the sign of zero. A stated error is the largest over
 * every float of the range (the relative one where the result is not subnormal), measured in
 * 2026-11 and held by tests/unit/test_elementary.c, which walks them all.
 */
#ifndef SADDLEWALK_ELEMENTARY_H
#define SADDLEWALK_ELEMENTARY_H

#include <stdbool.h>

#define SADDLE_PI 3.14159265f
#define SADDLE_HALF_PI 1.57079633f
#define SADDLE_TWO_PI 6.28318531f

/**
 * Sine of an angle in [-SADDLE_TWO_PI, SADDLE_TWO_PI]; one outside counts as 0, as NaN does.
 * Error at most 7.9e-8, relative 1.3e-7.
 */
float saddle_sin(float x_rad);

/**
 * Cosine of an angle in [-SADDLE_TWO_PI, SADDLE_TWO_PI]; one outside counts as 0, as NaN does.
 * Error at most 8.7e-8, relative 1.4e-6.
 */
float saddle_cos(float x_rad);

typedef struct {
    float sin, cos;
} saddle_sin_cos_t;

/** Both of one angle at less cost, with the bits of saddle_sin() and saddle_cos(). */
saddle_sin_cos_t saddle_sin_cos(float x_rad);

/**
 * Arcsine in radians, within [-SADDLE_HALF_PI, SADDLE_HALF_PI], of x limited to [-1, 1]; NaN counts
 * as 0. Error at most 1.5e-7, relative 2.8e-7.
 */
float saddle_asin(float x);

/**
 * Error function of any x, exactly -1 or 1 from |x| = 4 on; NaN counts as 0.
 * Error at most 9.3e-8, relative 2.3e-7.
 */
float saddle_erf(float x);

/**
 * Exponential function of x in [-87, 88]; 0 below and for NaN, exp(88) above, exactly 1 at 0.
 * Relative error at most 8.3e-8.
 */
float saddle_exp(float x);

/** saddle_exp(-x) of x limited to [0, 40], which is never 0; NaN counts as 0. */
float saddle_decay(float x);

/**
 * Natural logarithm of a normal x > 0; 0 for any other, as NaN. Exactly 0 at 1. Error at most 5.0e-6,
 * relative 2.0e-7.
 */
float saddle_log(float x);

/**
 * Minimum-jerk profile 10 s^3 - 15 s^4 + 6 s^5 of s limited to [0, 1]; NaN counts as 0.
 * Exactly 0, 1/2 and 1 at s = 0, 1/2 and 1. Error at most 1.4e-7.
 */
float saddle_min_jerk(float s);

/** A value of saddle_min_jerk() and of its derivative. */
typedef struct {
    float value, slope;
} saddle_jerk_t;

/**
 * saddle_min_jerk(), bit for bit, and its derivative, 30 s^2 (1 - s)^2; that is 0 outside [0, 1] and
 * for NaN. Its error is at most 4.6e-7, relative 3.0e-7.
 */
saddle_jerk_t saddle_min_jerk_both(float s);

#ifndef SADDLE_DECLARATIONS_ONLY /* for those who read the headers and are no compiler */

/** |x|; NaN for NaN. */
static inline float saddle_magnitude(float x)
{
#if defined(__GNUC__)
    return __builtin_fabsf(x); /* an instruction, or the sign's bit cleared: never a call */
#else
    return x < 0.0f ? -x : x;
#endif
}

/** The larger of two; b if either is NaN. */
static inline float saddle_larger(float a, float b)
{
    return a > b ? a : b;
}

/** The smaller of two; b if either is NaN. */
static inline float saddle_smaller(float a, float b)
{
    return a < b ? a : b;
}

/** x limited to [lo, hi], where lo <= hi; lo for NaN. */
#if defined(__OPTIMIZE_SIZE__) /* a call is shorter: 1.2 kB of the core */
static __attribute__((noinline, unused)) float saddle_clamp(float x, float lo, float hi)
#else
static inline float saddle_clamp(float x, float lo, float hi)
#endif
{
    if (!(x >= lo)) {
        return lo;
    }
    return x > hi ? hi : x;
}

/** Whether x lies in [lo, hi], ends included; false for NaN. */
static inline bool saddle_in_range(float x, float lo, float hi)
{
    return x >= lo && x <= hi;
}

#endif

#endif
