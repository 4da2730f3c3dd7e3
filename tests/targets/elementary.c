/* The elementary functions for same_bits.c. In the core of one file they are static, so this file is
 * compiled as a part of it. */
#include "elementary.h"

#ifdef SADDLE_ONE_FILE
#include <saddlewalk.c>
#else
#include "math/elementary.h"
#endif

static float min_jerk_slope(float s)
{
    return saddle_min_jerk_both(s).slope;
}

float (*const ELEMENTARY[ELEMENTARY_COUNT])(float) = {
    saddle_sin, saddle_cos, saddle_asin, saddle_erf, saddle_exp, saddle_min_jerk, min_jerk_slope,
};
