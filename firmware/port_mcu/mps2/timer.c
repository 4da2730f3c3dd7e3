#include "mps2.h"

#include "timing.h"

typedef struct {
    volatile uint32_t control, value, reload, interrupt;
} timer_t;

#define TIMER ((timer_t *)0x40000000u)
#define TIMER_ENABLE 1u
#define TIMER_INTERRUPT 8u
#define COUNTS_US (MPS2_CLOCK_HZ / 1000000u)
#define COUNTS_TICK (SADDLE_TICK_US * COUNTS_US)

static volatile uint32_t ticks_due;

/** Both at once: between them, an interrupt of higher priority would read a time
 *  that is one round too early. */
void mps2_timer_came_round(void)
{
    const uint32_t held = mps2_interrupts_hold();
    TIMER->interrupt = 1u;
    ticks_due = ticks_due + 1u;
    mps2_interrupts_restore(held);
}

void mps2_clock_start(void)
{
    TIMER->reload = COUNTS_TICK - 1u;
    TIMER->value = COUNTS_TICK - 1u;
    TIMER->control = TIMER_ENABLE | TIMER_INTERRUPT;
    mps2_interrupt_enable(MPS2_TIMER);
}

uint32_t saddle_clock_ticks_due(void)
{
    return ticks_due;
}

/** Where the timer has come round and its interrupt is held back, that round counts already. */
uint64_t saddle_clock_now_us(void)
{
    const uint32_t held = mps2_interrupts_hold();
    uint64_t rounds = ticks_due;
    uint32_t left = TIMER->value;
    if (TIMER->interrupt != 0u) {
        left = TIMER->value;
        ++rounds;
    }
    mps2_interrupts_restore(held);
    return rounds * SADDLE_TICK_US + (COUNTS_TICK - 1u - left) / COUNTS_US;
}
