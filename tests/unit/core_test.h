/** What the tests of the core share: exact comparison, the paper's body, repeatable random numbers.
 *
 *  Comparisons are TEST_ASSERT_DOUBLE_WITHIN with a finite literal tolerance, which NaN fails
 *  (test_harness.c holds that), or ASSERT_SAME_FLOAT; Unity's EQUAL_FLOAT allows 1e-5. */
#ifndef SADDLEWALK_CORE_TEST_H
#define SADDLEWALK_CORE_TEST_H

#include "model/model.h"

#include <math.h>
#include <saddlewalk/saddlewalk.h>
#include <string.h>
#include <unity.h>

#define PI 3.14159265358979323846
#define GRAVITY 9.80665

/** One rounding of a number below 1, some of them in a row: 8 x 2^-24. */
#define FLOAT_TOLERANCE 5e-7

/** MANY: so many repetitions of a random test, and so many findings in them; a twentieth where the
 *  processor is emulated. EVERY: the step through a table; 1 where it is not. */
#ifdef SADDLE_EMULATED
#define MANY(count) ((count) / 20)
#define EVERY(count) (count)
#else
#define MANY(count) (count)
#define EVERY(count) 1
#endif

#define COUNT_OF(array) (sizeof(array) / sizeof((array)[0]))

/** Equal bits: -0 and 0 differ, a NaN equals itself. */
#define ASSERT_SAME_FLOAT(expected, actual) \
    TEST_ASSERT_EQUAL_HEX32(float_bits(expected), float_bits(actual))

static inline uint32_t float_bits(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static inline float float_of_bits(uint32_t bits)
{
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/** The paper's mean body. */
static inline saddle_config_t paper_config(void)
{
    return saddle_config_default(1.79f, 63.3f);
}

/** The model of a configuration as it is now: a test may change it between calls. */
static inline const saddle_model_t *model_of(const saddle_config_t *config)
{
    static saddle_model_t model;
    saddle_model_init(&model, config);
    return &model;
}

/** xorshift32: state must not be 0. */
static inline uint32_t random_bits(uint32_t *state)
{
    *state ^= *state << 13;
    *state ^= *state >> 17;
    *state ^= *state << 5;
    return *state;
}

static inline float random_in(uint32_t *state, float min, float max)
{
    return min + (max - min) * ((float)(random_bits(state) >> 8) / 16777216.0f);
}

/** The accepted float field of a configuration at an index. */
static inline float *config_field(saddle_config_t *config, size_t index)
{
    return (float *)(void *)((char *)config + saddle_config_field(index)->offset);
}

#endif
