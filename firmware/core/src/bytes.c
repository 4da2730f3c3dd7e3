#include <saddlewalk/bytes.h>

/* Volatile: a compiler that knows these loops would turn them into calls of libc. */

void saddle_clear(void *object, size_t size)
{
    volatile unsigned char *byte = object;
    for (size_t i = 0; i < size; i++) {
        byte[i] = 0;
    }
}

void saddle_copy(void *to, const void *from, size_t size)
{
    volatile unsigned char *target = to;
    const unsigned char *source = from;
    for (size_t i = 0; i < size; i++) {
        target[i] = source[i];
    }
}
