#include "mps2.h"

#include "timing.h"

typedef struct {
    volatile uint32_t control, value, reload, interrupt;
} timer_t;

#define TIMER ((timer_t *)0x40000000u)
#define TIMER_ENABLE 1u
#define TIMER_INTERRUPT 8u
#define COUNTS_US (MPS2_CLOCK_HZ / 1000000u)

static volatile uint64_t rounds;
static uint32_t period_us = SADDLE_TICK_US;

static uint32_t counts_of_period(void)
{
    return period_us * COUNTS_US;
}

/** Both at once: between them, an interrupt of higher priority would read a time
 *  that is one round too early. */
void mps2_timer_came_round(void)
{
    const uint32_t held = mps2_interrupts_hold();
    TIMER->interrupt = 1u;
    rounds = rounds + 1u;
    mps2_interrupts_restore(held);
}

void mps2_clock_start(uint32_t timer_period_us)
{
    period_us = timer_period_us;
    TIMER->reload = counts_of_period() - 1u;
    TIMER->value = counts_of_period() - 1u;
    TIMER->control = TIMER_ENABLE | TIMER_INTERRUPT;
    mps2_interrupt_enable(MPS2_TIMER);
}

uint64_t saddle_clock_rounds(void)
{
    const uint32_t held = mps2_interrupts_hold();
    const uint64_t so_far = rounds;
    mps2_interrupts_restore(held);
    return so_far;
}

/** Where the timer has come round and its interrupt is held back, that round counts already. */
uint64_t saddle_clock_now_us(void)
{
    const uint32_t held = mps2_interrupts_hold();
    uint64_t so_far = rounds;
    uint32_t left = TIMER->value;
    if (TIMER->interrupt != 0u) {
        left = TIMER->value;
        ++so_far;
    }
    mps2_interrupts_restore(held);
    return so_far * period_us + (counts_of_period() - 1u - left) / COUNTS_US;
}
