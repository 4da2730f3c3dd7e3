/** ARM's MPS2 board with the AN386 image (Cortex-M4F), which QEMU emulates as mps2-an386. */
#ifndef SADDLEWALK_MCU_MPS2_H
#define SADDLEWALK_MCU_MPS2_H

#include "board.h"

#define MPS2_CLOCK_HZ 25000000u

/** Interrupts by their number at the NVIC, and what vectors.c has them do. */
enum { MPS2_UART_RECEIVED = 0, MPS2_UART_SENT = 1, MPS2_TIMER = 8, MPS2_INTERRUPTS = 32 };
void mps2_uart_received(void);
void mps2_uart_sent(void);
void mps2_timer_came_round(void);

void mps2_interrupt_enable(uint32_t number);

/** Hold interrupts back; returns what mps2_interrupts_restore() takes. Calls may be nested. */
uint32_t mps2_interrupts_hold(void);
void mps2_interrupts_restore(uint32_t held);

/** Sleep until mps2_wake() has been called, by an interrupt, since the last call. */
void mps2_sleep(void);
void mps2_wake(void);

/** Start the timer, with the period of saddle_clock_rounds(). */
void mps2_clock_start(uint32_t timer_period_us);

/** Start the watchdog: after two and a half ticks without being fed it warns, for which the controller
 *  hangs, and after five it resets. */
void mps2_watchdog_start(void);

/** Start the serial line that stands for a CAN controller: SLCAN, see slcan.h. */
void mps2_can_start(void);

/** The other side of the line has closed the channel. */
bool mps2_can_closed(void);

#endif
