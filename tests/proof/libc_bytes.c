/** math/bytes.c by libc's functions, which Eva has exact models of. */
#include "math/bytes.h"

#include <string.h>

void saddle_clear(void *object, size_t size)
{
    memset(object, 0, size);
}

void saddle_copy(void *to, const void *from, size_t size)
{
    memcpy(to, from, size);
}
