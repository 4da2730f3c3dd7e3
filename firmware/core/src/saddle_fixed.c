#include <saddlewalk/saddle_fixed.h>

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
    return to_integer(value_m, TWO_POW_28, TWO_POW_12) * POSITION_PER_2_POW_MINUS_40_M;
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
    return to_integer(value_m_s, TWO_POW_27, TWO_POW_15);
}

float saddle_speed_to_m_s(saddle_fixed_t speed)
{
    return (float)(int32_t)(speed / ((int64_t)1 << 13)) * (1.0f / 536870912.0f);
}

saddle_fixed_t saddle_speed_change(float rate_m_s2, uint32_t dt_us)
{
    const int64_t product = (int64_t)(int32_t)(rate_m_s2 * TWO_POW_27) * (int64_t)dt_us;
    const int64_t upper = product / ((int64_t)1 << 27);
    const int64_t lower = product - upper * ((int64_t)1 << 27);
    return upper * SPEED_PER_2_POW_MINUS_27_UM_S / ((int64_t)1 << 9) +
           lower * SPEED_PER_2_POW_MINUS_27_UM_S / ((int64_t)1 << 36);
}

saddle_fixed_t saddle_speed_times_s(saddle_fixed_t speed, float time_s)
{
    const int64_t time_q31 = (int64_t)(uint32_t)(time_s * TWO_POW_31);
    const int64_t upper = speed / ((int64_t)1 << 21);
    const int64_t lower = speed - upper * ((int64_t)1 << 21);
    const int64_t way_q42_m =
        time_q31 * upper / ((int64_t)1 << 10) + time_q31 * lower / ((int64_t)1 << 31);
    return way_q42_m * 1000000;
}
