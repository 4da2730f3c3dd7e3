/** Values that nothing is known of: each reading gives any of the type, of a float any bits. */
#ifndef SADDLEWALK_PROOF_ANY_H
#define SADDLEWALK_PROOF_ANY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

static volatile uint8_t any_uint8;
static volatile uint16_t any_uint16;
static volatile uint32_t any_uint32;
static volatile uint64_t any_uint64;
static volatile size_t any_size;
static volatile float any_float;

static inline bool any_bool(void)
{
    return (any_uint8 & 1u) != 0u;
}

#endif
