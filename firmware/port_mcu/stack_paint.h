/** How much of a stack was ever used: it is painted at the start, and what has lost its paint was.
 *  Stacks grow towards the lower address. */
#ifndef SADDLEWALK_MCU_STACK_PAINT_H
#define SADDLEWALK_MCU_STACK_PAINT_H

#include <stdint.h>

/** Paint from the lowest word to before `end`, below which nothing is in use yet. */
void saddle_stack_paint(uint32_t *lowest, const uint32_t *end);

/** Bytes from the deepest word that lost its paint to before `top`, the stack's end. */
uint32_t saddle_stack_used(const uint32_t *lowest, const uint32_t *top);

#endif
