#include "stack_paint.h"

#define PAINT 0x5ADD1E57u

void saddle_stack_paint(uint32_t *lowest, const uint32_t *end)
{
    for (volatile uint32_t *word = lowest; word < end; ++word) {
        *word = PAINT;
    }
}

uint32_t saddle_stack_used(const uint32_t *lowest, const uint32_t *top)
{
    const volatile uint32_t *word = lowest;
    while (word < top && *word == PAINT) {
        ++word;
    }
    return (uint32_t)((uintptr_t)top - (uintptr_t)word);
}
