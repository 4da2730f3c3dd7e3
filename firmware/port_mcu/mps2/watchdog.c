#include "mps2.h"

#include "timing.h"

typedef struct {
    volatile uint32_t load, value, control, clear;
} watchdog_t;

#define WATCHDOG ((watchdog_t *)0x40008000u)
#define WATCHDOG_LOCK (*(volatile uint32_t *)0x40008C00u)
#define WATCHDOG_UNLOCK 0x1ACCE551u
#define WATCHDOG_WARN 1u
#define WATCHDOG_RESET 2u

/** Two and a half ticks: one may be late, but not the next too. It warns when its count is over,
 *  and resets when that is so again. */
#define COUNTS (MPS2_CLOCK_HZ / 1000000u * SADDLE_TICK_US * 5u / 2u)

void mps2_watchdog_start(void)
{
    WATCHDOG_LOCK = WATCHDOG_UNLOCK;
    WATCHDOG->load = COUNTS;
    WATCHDOG->control = WATCHDOG_WARN | WATCHDOG_RESET;
    WATCHDOG_LOCK = 0u;
}

void saddle_watchdog_feed(void)
{
    WATCHDOG_LOCK = WATCHDOG_UNLOCK;
    WATCHDOG->clear = 1u;
    WATCHDOG_LOCK = 0u;
}
