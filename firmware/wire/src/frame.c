#include "frame.h"

#include <float.h>
#include <math.h>

#define NOT_AVAILABLE INT16_MIN

/** Half steps at the end of a number's range. */
#define HALVES_MAX (2.0f * INT16_MAX)

static bool is_finite(float value)
{
    return value >= -FLT_MAX && value <= FLT_MAX;
}

/** Neither NaN nor what is beyond the range becomes an integer. */
uint32_t saddle_frame_raw(bool valid, float value, float half_step)
{
    const float halves = value / half_step;
    if (valid && __builtin_fabsf(halves) <= HALVES_MAX) {
        const uint32_t whole = (uint32_t)(int32_t)halves;
        const uint32_t negative = whole >> 31; /* whose half alone is away from 0 */
        return (whole + 1u - negative) / 2u & UINT16_MAX;
    }
    if (!valid || !is_finite(value)) {
        return (uint16_t)NOT_AVAILABLE;
    }
    return (uint16_t)(value < 0.0f ? -INT16_MAX : INT16_MAX);
}

uint8_t saddle_frame_short_raw(float value, float half_step)
{
    const int16_t raw = (int16_t)(uint16_t)saddle_frame_raw(true, value, half_step);
    if (raw == NOT_AVAILABLE) {
        return (uint8_t)INT8_MIN;
    }
    return (uint8_t)(raw > INT8_MAX ? INT8_MAX : raw < -INT8_MAX ? -INT8_MAX : raw);
}

float saddle_frame_number(uint16_t raw, float scale)
{
    const int16_t whole = (int16_t)raw;
    return whole == NOT_AVAILABLE ? NAN : (float)whole * scale;
}

float saddle_frame_short_number(uint8_t raw, float scale)
{
    const int8_t whole = (int8_t)raw;
    return whole == INT8_MIN ? NAN : (float)whole * scale;
}

uint32_t saddle_frame_crc(uint32_t id_crc, uint64_t bits)
{
    const uint32_t low = (uint32_t)bits, high = (uint32_t)(bits >> 32);
    uint32_t crc = crc_after(crc_after(crc_after(id_crc, low >> 8), low >> 16), low >> 24);
    crc = crc_after(crc_after(crc, high), high >> 8);
    return crc_after(crc_after(crc, high >> 16), high >> 24) ^ 0xFFu;
}

static uint32_t word_at(const uint8_t *bytes)
{
    return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 |
           (uint32_t)bytes[3] << 24;
}

uint64_t saddle_frame_bits(const uint8_t *data)
{
    return (uint64_t)word_at(data + 4) << 32 | word_at(data);
}

static void put_word(uint8_t *bytes, uint32_t word)
{
    bytes[0] = (uint8_t)word;
    bytes[1] = (uint8_t)(word >> 8);
    bytes[2] = (uint8_t)(word >> 16);
    bytes[3] = (uint8_t)(word >> 24);
}

void saddle_frame_seal(uint8_t *data, uint32_t id_crc, uint64_t bits)
{
    put_word(data, (uint32_t)bits | saddle_frame_crc(id_crc, bits));
    put_word(data + 4, (uint32_t)(bits >> 32));
}
