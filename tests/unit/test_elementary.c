/**
 * Exhaustive test of math/elementary: `test_elementary FUNCTION` walks every float of the function's
 * range against the double-precision C library and fails if an error exceeds the bound that
 * math/elementary.h states. Exit status 0 if all held, 1 if something failed, 2 for a wrong argument.
 */

#include "math/elementary.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

typedef enum { NO_SYMMETRY, ODD, EVEN } symmetry_t;

/** exp(88) rounded to single precision. */
#define EXP_GREATEST 1.65163627e38f
#define ERF_SATURATION 4.0f
#define NOT_STATED HUGE_VAL

/** A function of one float, and what math/elementary.h promises of it. */
typedef struct {
    float (*function)(float);
    double (*reference)(double);
    float lowest;
    float highest;
    symmetry_t symmetry;
    float least_result;
    float greatest_result;
    double absolute_bound;
    double relative_bound;
} promise_t;

typedef struct {
    double error;
    float at;
} worst_t;

typedef struct {
    worst_t absolute;
    worst_t relative;
} worst_errors_t;

static int failures;

static void expect(bool holds, const char *what, float x)
{
    if (!holds && ++failures <= 10) {
        printf("FAIL at %.9g: %s\n", (double)x, what);
    }
}

static uint32_t bits_of(float x)
{
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static float float_of(uint32_t bits)
{
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

static double min_jerk_reference(double s)
{
    return s * s * s * (10.0 + s * (6.0 * s - 15.0));
}

static float min_jerk_slope(float s)
{
    return saddle_min_jerk_both(s).slope;
}

static double min_jerk_slope_reference(double s)
{
    return 30.0 * s * s * (1.0 - s) * (1.0 - s);
}

/** erf, by its series where that is exact to double precision and much faster than the library. */
static double erf_reference(double x)
{
    if (fabs(x) < 0x1p-10) {
        const double two_over_root_pi = 1.1283791670955126;
        return two_over_root_pi * x * (1.0 - x * x * (1.0 / 3.0 - x * x / 10.0));
    }
    return erf(x);
}

/** 0 where there is none, as saddle_log() says. */
static double log_reference(double x)
{
    return x < (double)FLT_MIN ? 0.0 : log(x);
}

/** Keeps the largest error / unit and where it was; divides only when there is a larger one. */
static void note_error(worst_t *worst, double error, double unit, float x)
{
    if (!(error <= worst->error * unit)) {
        *worst = (worst_t){error / unit, x};
    }
}

static void check_point(const promise_t *promise, worst_errors_t *worst, float x)
{
    const float y = promise->function(x);
    const double exact = promise->reference((double)x);
    const double error = fabs((double)y - exact);
    note_error(&worst->absolute, error, 1.0, x);
    if (fabs(exact) >= (double)FLT_MIN) {
        note_error(&worst->relative, error, fabs(exact), x);
    }
    expect(y >= promise->least_result && y <= promise->greatest_result, "result range", x);
    if (promise->symmetry != NO_SYMMETRY) {
        expect(promise->function(-x) == (promise->symmetry == ODD ? -y : y), "symmetry", x);
    }
}

static void check_bound(const char *kind, worst_t worst, double bound)
{
    const double at = (double)worst.at;
    printf("largest %s error %.3e at %.9g, bound %.1e\n", kind, worst.error, at, bound);
    expect(worst.error <= bound, kind, worst.at);
}

/** Every float from 0 to highest; from -0 to lowest too where symmetry does not settle it. */
static void walk(const promise_t *promise)
{
    worst_errors_t worst = {0};
    for (uint32_t bits = 0; bits <= bits_of(promise->highest); bits++) {
        check_point(promise, &worst, float_of(bits));
    }
    if (promise->symmetry == NO_SYMMETRY && promise->lowest < 0.0f) {
        for (uint32_t bits = bits_of(-0.0f); bits <= bits_of(promise->lowest); bits++) {
            check_point(promise, &worst, float_of(bits));
        }
    }
    check_bound("absolute", worst.absolute, promise->absolute_bound);
    check_bound("relative", worst.relative, promise->relative_bound);
}

static void expect_result(float (*function)(float), float x, float result)
{
    expect(function(x) == result, "stated result", x);
}

/** Arguments just outside [-limit, limit], far outside, infinite and NaN. */
static void expect_outside(float (*function)(float), float limit, float below, float above,
                           float for_nan)
{
    const float outside[] = {nextafterf(limit, INFINITY), 1.0e3f, FLT_MAX, INFINITY};
    for (size_t i = 0; i < sizeof outside / sizeof outside[0]; i++) {
        expect_result(function, -outside[i], below);
        expect_result(function, outside[i], above);
    }
    expect_result(function, NAN, for_nan);
    expect_result(function, -NAN, for_nan);
}

static const promise_t SIN = {
    .function = saddle_sin,
    .reference = sin,
    .lowest = -SADDLE_TWO_PI,
    .highest = SADDLE_TWO_PI,
    .symmetry = ODD,
    .least_result = -1.0f,
    .greatest_result = 1.0f,
    .absolute_bound = 7.9e-8,
    .relative_bound = 1.3e-7,
};

static const promise_t COS = {
    .function = saddle_cos,
    .reference = cos,
    .lowest = -SADDLE_TWO_PI,
    .highest = SADDLE_TWO_PI,
    .symmetry = EVEN,
    .least_result = -1.0f,
    .greatest_result = 1.0f,
    .absolute_bound = 8.7e-8,
    .relative_bound = 1.4e-6,
};

static const promise_t ASIN = {
    .function = saddle_asin,
    .reference = asin,
    .lowest = -1.0f,
    .highest = 1.0f,
    .symmetry = ODD,
    .least_result = -SADDLE_HALF_PI,
    .greatest_result = SADDLE_HALF_PI,
    .absolute_bound = 1.5e-7,
    .relative_bound = 2.8e-7,
};

static const promise_t ERF = {
    .function = saddle_erf,
    .reference = erf_reference,
    .lowest = -ERF_SATURATION,
    .highest = ERF_SATURATION,
    .symmetry = ODD,
    .least_result = -1.0f,
    .greatest_result = 1.0f,
    .absolute_bound = 9.3e-8,
    .relative_bound = 2.3e-7,
};

static const promise_t EXP = {
    .function = saddle_exp,
    .reference = exp,
    .lowest = -87.0f,
    .highest = 88.0f,
    .symmetry = NO_SYMMETRY,
    .least_result = FLT_MIN,
    .greatest_result = EXP_GREATEST,
    .absolute_bound = NOT_STATED,
    .relative_bound = 8.3e-8,
};

static const promise_t LOG = {
    .function = saddle_log,
    .reference = log_reference,
    .lowest = 0.0f,
    .highest = FLT_MAX,
    .symmetry = NO_SYMMETRY,
    .least_result = -87.4f,
    .greatest_result = 88.8f,
    .absolute_bound = 5.0e-6,
    .relative_bound = 2.0e-7,
};

static const promise_t MIN_JERK = {
    .function = saddle_min_jerk,
    .reference = min_jerk_reference,
    .lowest = 0.0f,
    .highest = 1.0f,
    .symmetry = NO_SYMMETRY,
    .least_result = 0.0f,
    .greatest_result = 1.0f,
    .absolute_bound = 1.4e-7,
    .relative_bound = NOT_STATED,
};

static const promise_t MIN_JERK_SLOPE = {
    .function = min_jerk_slope,
    .reference = min_jerk_slope_reference,
    .lowest = 0.0f,
    .highest = 1.0f,
    .symmetry = NO_SYMMETRY,
    .least_result = 0.0f,
    .greatest_result = 1.875f,
    .absolute_bound = 4.6e-7,
    .relative_bound = 3.0e-7,
};

static void test_sin(void)
{
    walk(&SIN);
    expect_result(saddle_sin, 0.0f, 0.0f);
    expect_outside(saddle_sin, SADDLE_TWO_PI, 0.0f, 0.0f, 0.0f);
}

static void test_cos(void)
{
    walk(&COS);
    expect_result(saddle_cos, 0.0f, 1.0f);
    expect_outside(saddle_cos, SADDLE_TWO_PI, 1.0f, 1.0f, 1.0f);
}

/** Every 997th float within the range and beyond it. */
static void test_sin_cos(void)
{
    for (uint32_t bits = 0; bits < bits_of(INFINITY); bits += 997u) {
        for (int negative = 0; negative < 2; negative++) {
            const float x = negative != 0 ? -float_of(bits) : float_of(bits);
            const saddle_sin_cos_t both = saddle_sin_cos(x);
            expect(bits_of(both.sin) == bits_of(saddle_sin(x)), "sine", x);
            expect(bits_of(both.cos) == bits_of(saddle_cos(x)), "cosine", x);
        }
    }
    const saddle_sin_cos_t none = saddle_sin_cos(NAN);
    expect(none.sin == 0.0f && none.cos == 1.0f, "not a number", NAN);
}

static void test_asin(void)
{
    walk(&ASIN);
    expect_result(saddle_asin, 0.0f, 0.0f);
    expect_result(saddle_asin, 1.0f, SADDLE_HALF_PI);
    expect_outside(saddle_asin, 1.0f, -SADDLE_HALF_PI, SADDLE_HALF_PI, 0.0f);
}

static void test_erf(void)
{
    walk(&ERF);
    expect_result(saddle_erf, 0.0f, 0.0f);
    expect_result(saddle_erf, NAN, 0.0f);
}

/** The floats from 4 to infinity, of both signs; a test of its own to run beside the walk. */
static void test_erf_saturation(void)
{
    for (uint32_t bits = bits_of(ERF_SATURATION); bits <= bits_of(INFINITY); bits++) {
        const float x = float_of(bits);
        expect(saddle_erf(x) == 1.0f && saddle_erf(-x) == -1.0f, "saturation", x);
    }
}

static void test_exp(void)
{
    walk(&EXP);
    expect_result(saddle_exp, 0.0f, 1.0f);
    expect_result(saddle_exp, 88.0f, EXP_GREATEST);
    expect_result(saddle_exp, nextafterf(-87.0f, -INFINITY), 0.0f);
    expect_outside(saddle_exp, 88.0f, 0.0f, EXP_GREATEST, 0.0f);
}

/** Every 997th float within the range and beyond it. */
static void test_decay(void)
{
    for (uint32_t bits = 0; bits < bits_of(INFINITY); bits += 997u) {
        const float x = float_of(bits);
        const float wanted = saddle_exp(x < 40.0f ? -x : -40.0f);
        expect(bits_of(saddle_decay(x)) == bits_of(wanted), "decay", x);
    }
    expect_outside(saddle_decay, 40.0f, 1.0f, saddle_exp(-40.0f), 1.0f);
}

static void test_log(void)
{
    walk(&LOG);
    expect_result(saddle_log, 1.0f, 0.0f);
    expect_result(saddle_log, -1.0f, 0.0f);
    expect_result(saddle_log, INFINITY, 0.0f);
    expect_result(saddle_log, NAN, 0.0f);
}

static void test_min_jerk(void)
{
    walk(&MIN_JERK);
    expect_result(saddle_min_jerk, 0.0f, 0.0f);
    expect_result(saddle_min_jerk, 0.5f, 0.5f);
    expect_result(saddle_min_jerk, 1.0f, 1.0f);
    expect_outside(saddle_min_jerk, 1.0f, 0.0f, 1.0f, 0.0f);
}

static void test_min_jerk_slope(void)
{
    walk(&MIN_JERK_SLOPE);
    expect_result(min_jerk_slope, 0.0f, 0.0f);
    expect_result(min_jerk_slope, 0.5f, 1.875f);
    expect_result(min_jerk_slope, 1.0f, 0.0f);
    expect_outside(min_jerk_slope, 1.0f, 0.0f, 0.0f, 0.0f);
}

static void test_clamp(void)
{
    expect(saddle_clamp(-2.0f, -1.0f, 3.0f) == -1.0f, "below", -2.0f);
    expect(saddle_clamp(-1.0f, -1.0f, 3.0f) == -1.0f, "low end", -1.0f);
    expect(saddle_clamp(0.5f, -1.0f, 3.0f) == 0.5f, "inside", 0.5f);
    expect(saddle_clamp(3.0f, -1.0f, 3.0f) == 3.0f, "high end", 3.0f);
    expect(saddle_clamp(INFINITY, -1.0f, 3.0f) == 3.0f, "above", INFINITY);
    expect(saddle_clamp(-INFINITY, -1.0f, 3.0f) == -1.0f, "below", -INFINITY);
    expect(saddle_clamp(NAN, -1.0f, 3.0f) == -1.0f, "not a number", NAN);
}

static void test_in_range(void)
{
    expect(saddle_in_range(-1.0f, -1.0f, 3.0f), "low end", -1.0f);
    expect(saddle_in_range(3.0f, -1.0f, 3.0f), "high end", 3.0f);
    expect(!saddle_in_range(nextafterf(-1.0f, -2.0f), -1.0f, 3.0f), "below", -1.0f);
    expect(!saddle_in_range(nextafterf(3.0f, 4.0f), -1.0f, 3.0f), "above", 3.0f);
    expect(!saddle_in_range(INFINITY, -1.0f, 3.0f), "infinite", INFINITY);
    expect(!saddle_in_range(NAN, -1.0f, 3.0f), "not a number", NAN);
}

/** What takes no time of the walks over every float. */
static void test_ends(void)
{
    expect_outside(saddle_sin, SADDLE_TWO_PI, 0.0f, 0.0f, 0.0f);
    expect_outside(saddle_cos, SADDLE_TWO_PI, 1.0f, 1.0f, 1.0f);
    expect_outside(saddle_asin, 1.0f, -SADDLE_HALF_PI, SADDLE_HALF_PI, 0.0f);
    expect_outside(saddle_exp, 88.0f, 0.0f, EXP_GREATEST, 0.0f);
    expect_result(saddle_log, -1.0f, 0.0f);
    expect_result(saddle_log, NAN, 0.0f);
    expect_outside(saddle_erf, ERF_SATURATION, -1.0f, 1.0f, 0.0f);
    expect_outside(saddle_min_jerk, 1.0f, 0.0f, 1.0f, 0.0f);
}

static const struct {
    const char *name;
    void (*run)(void);
} TESTS[] = {
    {"sin", test_sin},         {"cos", test_cos},
    {"sin_cos", test_sin_cos}, {"asin", test_asin},
    {"erf", test_erf},         {"erf_saturation", test_erf_saturation},
    {"exp", test_exp},         {"decay", test_decay},
    {"log", test_log},         {"min_jerk", test_min_jerk},
    {"clamp", test_clamp},     {"min_jerk_slope", test_min_jerk_slope},
    {"ends", test_ends},       {"in_range", test_in_range},
};

int main(int argc, char **argv)
{
    const size_t count = sizeof TESTS / sizeof TESTS[0];
    for (size_t i = 0; argc == 2 && i < count; i++) {
        if (strcmp(argv[1], TESTS[i].name) == 0) {
            TESTS[i].run();
            printf("%s: %d failures\n", argv[1], failures);
            return failures == 0 ? 0 : 1;
        }
    }
    fprintf(stderr, "test_elementary: expected one of");
    for (size_t i = 0; i < count; i++) {
        fprintf(stderr, " %s", TESTS[i].name);
    }
    fprintf(stderr, "\n");
    return 2;
}
