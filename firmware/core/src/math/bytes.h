/** Clearing and copying whole objects, aligned as a uint32_t at least, without a libc. */
#ifndef SADDLEWALK_BYTES_H
#define SADDLEWALK_BYTES_H

#include <stddef.h>

/** Set every byte to 0: the zero of every type that the core has. */
void saddle_clear(void *object, size_t size);

/** Copy every byte; the objects must not overlap. */
void saddle_copy(void *to, const void *from, size_t size);

#endif
