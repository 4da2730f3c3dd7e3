/** What the loop of a controller needs of its board: CAN, a clock, a watchdog. All of it is called
 *  from the loop alone; interrupts are the board's own matter. */
#ifndef SADDLEWALK_MCU_BOARD_H
#define SADDLEWALK_MCU_BOARD_H

#include "can_queue.h"

/** The oldest frame that has come and was not taken yet, stamped with saddle_clock_now_us() by the
 *  interrupt that brought it. False: there is none. */
bool saddle_can_receive(saddle_can_frame_t *frame);

/** Frames that came and could not be kept. Wraps at 2^32. */
uint32_t saddle_can_lost(void);

/** Hand a frame over to be sent; never waits. False: there is no room. */
bool saddle_can_send(const saddle_can_frame_t *frame);

/** Monotonic, in microseconds. */
uint64_t saddle_clock_now_us(void);

/** How often the timer has come round: tick n is due at n * SADDLE_TICK_US of the clock. Wraps
 *  after ten years. */
uint32_t saddle_clock_ticks_due(void);

/** All is well: unless this comes again in time, the watchdog resets the controller. */
void saddle_watchdog_kick(void);

#endif
