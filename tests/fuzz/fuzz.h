/** What the fuzz targets share. A broken property ends the program, which keeps the input. */
#ifndef SADDLEWALK_FUZZ_H
#define SADDLEWALK_FUZZ_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define REQUIRE(holds)                                                          \
    do {                                                                        \
        if (!(holds)) {                                                         \
            fprintf(stderr, "%s:%d: not so: %s\n", __FILE__, __LINE__, #holds); \
            abort();                                                            \
        }                                                                       \
    } while (0)

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

/** What is left of the input. */
typedef struct {
    const uint8_t *at;
    size_t left;
} fuzz_bytes_t;

/** The next bytes, 0 where there are no more. */
static inline void fuzz_take(fuzz_bytes_t *bytes, void *to, size_t size)
{
    const size_t taken = size < bytes->left ? size : bytes->left;
    memset(to, 0, size);
    memcpy(to, bytes->at, taken);
    bytes->at += taken;
    bytes->left -= taken;
}

static inline uint8_t fuzz_byte(fuzz_bytes_t *bytes)
{
    uint8_t byte;
    fuzz_take(bytes, &byte, 1);
    return byte;
}

static inline uint32_t fuzz_word(fuzz_bytes_t *bytes)
{
    uint32_t word;
    fuzz_take(bytes, &word, 4);
    return word;
}

/** In 65536 steps from lo to hi, both included. */
static inline float fuzz_between(fuzz_bytes_t *bytes, float lo, float hi)
{
    uint16_t step;
    fuzz_take(bytes, &step, 2);
    return lo + (hi - lo) * ((float)step / 65535.0f);
}

#endif
