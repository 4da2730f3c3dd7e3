#include "mps2.h"

#define NVIC_ENABLE (*(volatile uint32_t *)0xE000E100u)

static volatile bool woken;

void mps2_interrupt_enable(uint32_t number)
{
    NVIC_ENABLE = 1u << number;
}

uint32_t mps2_interrupts_hold(void)
{
    uint32_t held;
    __asm volatile("mrs %0, primask\n cpsid i" : "=r"(held) : : "memory");
    return held;
}

void mps2_interrupts_restore(uint32_t held)
{
    __asm volatile("msr primask, %0" : : "r"(held) : "memory");
}

void mps2_wake(void)
{
    woken = true;
}

/** An interrupt that is held back ends the sleep too, so none is slept through. */
void mps2_sleep(void)
{
    const uint32_t held = mps2_interrupts_hold();
    if (!woken) {
        __asm volatile("wfi" : : : "memory");
    }
    woken = false;
    mps2_interrupts_restore(held);
}
