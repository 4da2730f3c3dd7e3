/** The maximum use of a stack: it is painted at the start, and words that were used have lost the
 *  paint. Stacks grow towards the lower address. */
#ifndef SADDLEWALK_MCU_STACK_PAINT_H
#define SADDLEWALK_MCU_STACK_PAINT_H

#include <stdint.h>

/** A word of paint. */
#define SADDLE_STACK_PAINT 0x5ADD1E57u

/** Paint the stack in use, from its lowest word to 256 bytes below this function's frame: certainly
 *  below all that is live, wherever a compiler puts it. Before there are interrupts. */
void saddle_stack_paint(uint32_t *lowest);

/** Bytes from the deepest word that lost its paint to before `top`, the stack's end. */
uint32_t saddle_stack_used(const uint32_t *lowest, const uint32_t *top);

#endif
