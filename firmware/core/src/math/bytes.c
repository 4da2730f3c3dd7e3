#include "math/bytes.h"

#include <stdint.h>

/* By words, the alignment of every type that the core has, and four at a time, since the loop itself
 * costs more than what it does. Volatile: a compiler that knows these loops would turn them into
 * calls of libc. */
#if defined(__GNUC__)
typedef uint32_t __attribute__((may_alias)) word_t;
#else
typedef unsigned char word_t;
#endif

#define BLOCK (4u * sizeof(word_t))

void saddle_clear(void *object, size_t size)
{
    volatile word_t *word = object;
    for (; size >= BLOCK; size -= BLOCK, word += 4) {
        word[0] = 0;
        word[1] = 0;
        word[2] = 0;
        word[3] = 0;
    }
    volatile unsigned char *byte = (volatile unsigned char *)word;
    while (size-- > 0u) {
        *byte++ = 0;
    }
}

void saddle_copy(void *to, const void *from, size_t size)
{
    volatile word_t *target = to;
    const word_t *source = from;
    for (; size >= BLOCK; size -= BLOCK, target += 4, source += 4) {
        target[0] = source[0];
        target[1] = source[1];
        target[2] = source[2];
        target[3] = source[3];
    }
    volatile unsigned char *byte = (volatile unsigned char *)target;
    const unsigned char *last = (const unsigned char *)source;
    while (size-- > 0u) {
        *byte++ = *last++;
    }
}
