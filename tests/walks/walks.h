/** Long walks and many walks: what the checks share. Every check prints what it measured. */
#ifndef SADDLEWALK_TESTS_WALKS_H
#define SADDLEWALK_TESTS_WALKS_H

#include <math.h>
#include <saddlewalk/saddlewalk.h>
#include <stdint.h>
#include <stdio.h>

#define PI 3.14159265358979323846
#define TICK_US 80000u

/** Each takes the number of its optional argument (0: none was given) and returns the failures. */
int check_schedules(uint64_t first_seed, uint64_t count);
int check_day(void);
int check_constant(void);
int check_followers(void);
int check_turns(uint64_t first_seed, uint64_t count);

/** A body that passes the check; its ankles; some asymmetric, some with a shape of their own. */
saddle_config_t random_config(uint64_t *random);

/** xorshift64*: state must not be 0. */
static inline uint64_t random_bits(uint64_t *state)
{
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    return *state * 0x2545F4914F6CDD1Du;
}

static inline double random_in(uint64_t *state, double min, double max)
{
    return min + (max - min) * ((double)(random_bits(state) >> 11) * 0x1p-53);
}

static inline double min_jerk(double s)
{
    const double clamped = fmin(fmax(s, 0.0), 1.0);
    return clamped * clamped * clamped * (10.0 + clamped * (6.0 * clamped - 15.0));
}

static inline void keep_larger(double *largest, double value)
{
    if (!(fabs(value) <= *largest)) { /* NaN is kept */
        *largest = fabs(value);
    }
}

/** The difference of two angles, in [-pi, pi]. */
static inline double turn_between(double a_rad, double b_rad)
{
    return remainder(a_rad - b_rad, 2.0 * PI);
}

#endif
