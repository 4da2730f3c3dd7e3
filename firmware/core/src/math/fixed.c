#include "math/fixed.h"

#define TWO_POW_12 4096.0f
#define TWO_POW_15 32768.0f
#define TWO_POW_27 134217728.0f
#define TWO_POW_28 268435456.0f
#define TWO_POW_31 2147483648.0f

/* Positions per metre: 10^6 2^42 = 15625 2^48. */
#define MICROMETRES_ODD_PART 15625
#define POSITION_PER_2_POW_MINUS_40_M ((int64_t)MICROMETRES_ODD_PART * 256)
#define M_PER_2_POW_32 (1.0f / (15625.0f * 65536.0f))

/* 2^-27 um/s in units of speed, times 2^36. */
#define SPEED_PER_2_POW_MINUS_27_UM_S ((int64_t)2251799814)

/* 2 m and 4 m/s. */
#define POSITION_MAX (((int64_t)2 << 40) * POSITION_PER_2_POW_MINUS_40_M)
#define SPEED_MAX ((int64_t)4 << 42)

/* pi and 2 pi, in 2^-42 rad. */
#define HALF_TURN ((int64_t)13816870609431)
#define TURN ((int64_t)27633741218861)

#define WAY_MAX_NM ((int64_t)1999999999)
#define Q31_M_PER_NM 2305843009u /* times 2^30 */
#define HALF ((uint64_t)1 << 29)

#define RATE_MAX_M_S2 15.9999990f /* the largest float below 16 */
#define TIME_MAX_S 1.99999988f    /* the largest float below 2 */
#define DT_MAX_US 10000000u

static float limited(float value, float max)
{
    if (value != value) {
        return 0.0f;
    }
    if (value < -max) {
        return -max;
    }
    return value > max ? max : value;
}

static int64_t limited_integer(int64_t value, int64_t max)
{
    if (value < -max) {
        return -max;
    }
    return value > max ? max : value;
}

/* value * scale * fine as an integer, truncated; |value * scale| < 2^31. Both steps are exact. */
static int64_t to_integer(float value, float scale, float fine)
{
    const float scaled = value * scale;
    const int32_t upper = (int32_t)scaled;
    const int32_t lower = (int32_t)((scaled - (float)upper) * fine);
    return (int64_t)upper * (int32_t)fine + lower;
}

saddle_fixed_t saddle_position_from_m(float value_m)
{
    return to_integer(limited(value_m, 2.0f), TWO_POW_28, TWO_POW_12) *
           POSITION_PER_2_POW_MINUS_40_M;
}

float saddle_position_to_m(saddle_fixed_t position)
{
    return (float)(int32_t)(position / ((int64_t)1 << 32)) * M_PER_2_POW_32;
}

int64_t saddle_position_to_nm(saddle_fixed_t position)
{
    const int64_t half_nm = (int64_t)1 << 21;
    return (position / ((int64_t)1 << 20) * 1000 + half_nm) / ((int64_t)1 << 22);
}

saddle_fixed_t saddle_speed_from_m_s(float value_m_s)
{
    return to_integer(limited(value_m_s, 4.0f), TWO_POW_27, TWO_POW_15);
}

float saddle_speed_to_m_s(saddle_fixed_t speed)
{
    const int64_t in_range = limited_integer(speed, SPEED_MAX - 1);
    return (float)(int32_t)(in_range / ((int64_t)1 << 13)) * (1.0f / 536870912.0f);
}

saddle_fixed_t saddle_speed_sum(saddle_fixed_t a, saddle_fixed_t b)
{
    return limited_integer(a + b, SPEED_MAX);
}

saddle_fixed_t saddle_speed_change(float rate_m_s2, uint32_t dt_us)
{
    const int32_t rate = (int32_t)(limited(rate_m_s2, RATE_MAX_M_S2) * TWO_POW_27);
    const int64_t product = rate * (int64_t)(dt_us < DT_MAX_US ? dt_us : DT_MAX_US);
    const int64_t upper = product / ((int64_t)1 << 27);
    const int64_t lower = product % ((int64_t)1 << 27);
    return upper * SPEED_PER_2_POW_MINUS_27_UM_S / ((int64_t)1 << 9) +
           lower * SPEED_PER_2_POW_MINUS_27_UM_S / ((int64_t)1 << 36);
}

uint32_t saddle_time_from_s(float time_s)
{
    const float in_range_s = time_s > 0.0f ? limited(time_s, TIME_MAX_S) : 0.0f;
    return (uint32_t)(in_range_s * TWO_POW_31);
}

/* In 2^-42, of a value in that and a factor in 2^-31: in two parts, whose products have 64 bits. */
static uint64_t product(saddle_fixed_t value, uint32_t factor_q31)
{
    const uint64_t in_range = value > 0 ? (uint64_t)(value < SPEED_MAX ? value : SPEED_MAX) : 0u;
    const uint32_t upper = (uint32_t)(in_range >> 21);
    const uint32_t lower = (uint32_t)in_range & ((1u << 21) - 1u);
    return ((uint64_t)factor_q31 * upper >> 10) + ((uint64_t)factor_q31 * lower >> 31);
}

saddle_fixed_t saddle_distance(saddle_fixed_t speed, uint32_t time_q31)
{
    const uint64_t distance_q42_m = product(speed, time_q31);
    const uint64_t max_q42_m = (uint64_t)2 << 42;
    return (int64_t)(distance_q42_m < max_q42_m ? distance_q42_m : max_q42_m) * 1000000;
}

saddle_fixed_t saddle_angle(saddle_fixed_t curvature, int64_t way_nm)
{
    const int64_t in_range_nm = way_nm < 0 ? 0 : limited_integer(way_nm, WAY_MAX_NM);
    const uint32_t way_q31 = (uint32_t)(((uint64_t)in_range_nm * Q31_M_PER_NM + HALF) >> 30);
    const int64_t angle = (int64_t)product(curvature < 0 ? -curvature : curvature, way_q31);
    return curvature < 0 ? -angle : angle;
}

saddle_fixed_t saddle_angle_sum(saddle_fixed_t a, saddle_fixed_t b)
{
    const int64_t sum = limited_integer(a, HALF_TURN) + limited_integer(b, HALF_TURN);
    if (sum > HALF_TURN) {
        return sum - TURN;
    }
    return sum < -HALF_TURN ? sum + TURN : sum;
}

int64_t saddle_share_nm(int64_t length_nm, float factor)
{
    const int64_t one = (int64_t)1 << 30;
    const int64_t in_range_nm = limited_integer(length_nm, INT32_MAX);
    return in_range_nm * (int32_t)(limited(factor, 1.0f) * 1073741824.0f) / one;
}

saddle_fixed_t saddle_position_sum(saddle_fixed_t a, saddle_fixed_t b)
{
    const int64_t x = limited_integer(a, POSITION_MAX);
    const int64_t y = limited_integer(b, POSITION_MAX);
    if (y > 0) {
        return x > POSITION_MAX - y ? POSITION_MAX : x + y;
    }
    return x < -POSITION_MAX - y ? -POSITION_MAX : x + y;
}
