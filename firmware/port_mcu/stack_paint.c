#include "stack_paint.h"

/** More than what the compiler has of this function below its frame's address. */
#define GAP_BYTES 256u

/** Must not be inlined: then the frame would be the caller's. */
__attribute__((noinline)) void saddle_stack_paint(uint32_t *lowest)
{
    const uintptr_t end = (uintptr_t)__builtin_frame_address(0) - GAP_BYTES;
    for (volatile uint32_t *word = lowest; (uintptr_t)word < end; ++word) {
        *word = SADDLE_STACK_PAINT;
    }
}

uint32_t saddle_stack_used(const uint32_t *lowest, const uint32_t *top)
{
    const volatile uint32_t *word = lowest;
    while (word < top && *word == SADDLE_STACK_PAINT) {
        ++word;
    }
    return (uint32_t)((uintptr_t)top - (uintptr_t)word);
}
