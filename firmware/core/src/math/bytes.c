#include "math/bytes.h"

/* Volatile: a compiler that knows these loops would turn them into calls of libc. By eights, since
 * the loop itself costs more than what it does. */

void saddle_clear(void *object, size_t size)
{
    volatile unsigned char *byte = object;
    for (; size >= 8u; size -= 8u, byte += 8) {
        byte[0] = 0;
        byte[1] = 0;
        byte[2] = 0;
        byte[3] = 0;
        byte[4] = 0;
        byte[5] = 0;
        byte[6] = 0;
        byte[7] = 0;
    }
    while (size-- > 0u) {
        *byte++ = 0;
    }
}

void saddle_copy(void *to, const void *from, size_t size)
{
    volatile unsigned char *target = to;
    const unsigned char *source = from;
    for (; size >= 8u; size -= 8u, target += 8, source += 8) {
        target[0] = source[0];
        target[1] = source[1];
        target[2] = source[2];
        target[3] = source[3];
        target[4] = source[4];
        target[5] = source[5];
        target[6] = source[6];
        target[7] = source[7];
    }
    while (size-- > 0u) {
        *target++ = *source++;
    }
}
