/* Stand-ins for what examples/zephyr calls: time passes only in k_sleep(). */
#ifndef ZEPHYR_KERNEL_H
#define ZEPHYR_KERNEL_H

#include <stdint.h>
#include <stdio.h>

typedef struct {
    int64_t until_ms;
} k_timeout_t;

static int64_t stand_in_ms;

#define ARG_UNUSED(name) (void)(name)
#define K_TIMEOUT_ABS_MS(ms) ((k_timeout_t){ms})
#define printk printf

static inline int32_t k_sleep(k_timeout_t timeout)
{
    stand_in_ms = timeout.until_ms;
    return 0;
}

static inline int64_t k_uptime_ticks(void)
{
    return stand_in_ms;
}

static inline uint64_t k_ticks_to_us_floor64(uint64_t ticks)
{
    return 1000u * ticks;
}

#endif
