/** What the loop of a controller needs from its board: CAN, a clock, a watchdog. All functions are
 *  called from the loop only; interrupts are internal to the board. */
#ifndef SADDLEWALK_MCU_BOARD_H
#define SADDLEWALK_MCU_BOARD_H

#include "can_queue.h"

/** The oldest received frame that was not taken yet, timestamped with saddle_clock_now_us() by the
 *  interrupt that received it. False: there is none. */
bool saddle_can_receive(saddle_can_frame_t *frame);

/** Number of received frames that did not fit. Wraps at 2^32. */
uint32_t saddle_can_lost(void);

/** Queue a frame for sending; never waits. False: there is no room. */
bool saddle_can_send(const saddle_can_frame_t *frame);

/** Monotonic, in microseconds. */
uint64_t saddle_clock_now_us(void);

/** Number of timer periods so far: that of the ticks, SADDLE_TICK_US, or of the passes where joints are
 *  driven, saddle_joint_loop_period_us(). Round n is due at n periods of the clock. */
uint64_t saddle_clock_rounds(void);

/** 32 bits that nobody can predict, from a source of the hardware: for codes, once a session. False:
 *  there are none yet, or no such source; until there are, no command is accepted where codes are
 *  required. */
bool saddle_random(uint32_t *bits);

/** Feed the watchdog. Unless this is called again in time, it resets the controller. */
void saddle_watchdog_feed(void);

#endif
