/** Numbers and codes in the 64 bits of a frame, and its CRC: what all messages share. */
#ifndef SADDLEWALK_WIRE_FRAME_H
#define SADDLEWALK_WIRE_FRAME_H

#include "wire_signals.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define COUNTER_BITS 4u

/** A frame's bytes 0 to 7 are one number of 64 bits, byte 0 the lowest. These are a signal's part of
 *  it: of a number of 16 or 8 bits, or of a count or code, whose higher bits are dropped. */
#define NUMBER(signal, valid, value)                                                     \
    ((uint64_t)saddle_frame_raw((valid), (value), 0.5f * SIGNALS[SIGNAL_##signal].scale) \
     << SIGNALS[SIGNAL_##signal].start)
#define SHORT_NUMBER(signal, value)                                                   \
    ((uint64_t)saddle_frame_short_raw((value), 0.5f * SIGNALS[SIGNAL_##signal].scale) \
     << SIGNALS[SIGNAL_##signal].start)
#define CODE(signal, value) \
    ((uint64_t)((value) & mask_of(SIGNAL_##signal)) << SIGNALS[SIGNAL_##signal].start)

/** And back. */
#define NUMBER_IN(signal, bits)                                               \
    saddle_frame_number((uint16_t)((bits) >> SIGNALS[SIGNAL_##signal].start), \
                        SIGNALS[SIGNAL_##signal].scale)
#define SHORT_NUMBER_IN(signal, bits)                                              \
    saddle_frame_short_number((uint8_t)((bits) >> SIGNALS[SIGNAL_##signal].start), \
                              SIGNALS[SIGNAL_##signal].scale)
#define CODE_IN(signal, bits) \
    ((uint32_t)((bits) >> SIGNALS[SIGNAL_##signal].start) & mask_of(SIGNAL_##signal))

/** Write a frame: its identifier, and the CRC of it and of the signals. */
#define ENCODE(frame, message, counter, signals)                           \
    do {                                                                   \
        (frame)->id = MESSAGE_##message;                                   \
        saddle_frame_seal((frame)->data, crc_of_id(MESSAGE_##message),     \
                          CODE(message##_COUNTER, (counter)) | (signals)); \
    } while (0)

/** All bits of a count or code. */
static inline uint32_t mask_of(size_t signal)
{
    return UINT32_MAX >> (32u - SIGNALS[signal].length);
}

/** ROUND of a set: the low bits of its number are the COUNTER. */
static inline uint32_t round_of(uint8_t number)
{
    return (uint32_t)number >> COUNTER_BITS;
}

static inline uint32_t crc_after(uint32_t crc, uint32_t byte)
{
    return CRC_OF_BYTE[crc ^ (byte & 0xFFu)];
}

/** A frame's CRC begins with its identifier. */
static inline uint32_t crc_of_id(uint32_t id)
{
    return crc_after(crc_after(0xFFu, id), id >> 8);
}

/** The nearest whole number of steps, ties away from 0, in 16 bits; the end of the range for what is
 *  beyond it, and not available for what is not valid or not finite. */
uint32_t saddle_frame_raw(bool valid, float value, float half_step);

/** The same in 8 bits. */
uint8_t saddle_frame_short_raw(float value, float half_step);

/** NaN: not available. */
float saddle_frame_number(uint16_t raw, float scale);
float saddle_frame_short_number(uint8_t raw, float scale);

/** A frame's bytes as one number. */
uint64_t saddle_frame_bits(const uint8_t *data);

/** CRC of a frame: of its identifier, crc_of_id(), then of the seven bytes above byte 0. */
uint32_t saddle_frame_crc(uint32_t id_crc, uint64_t bits);

/** The bits of a frame, which have no CRC yet, as its bytes. */
void saddle_frame_seal(uint8_t *data, uint32_t id_crc, uint64_t bits);

#endif
