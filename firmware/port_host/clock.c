#include "clock.h"

#include <time.h>

static int64_t read_us(clockid_t clock)
{
    struct timespec now;
    clock_gettime(clock, &now);
    return (int64_t)now.tv_sec * 1000000 + now.tv_nsec / 1000;
}

uint64_t saddle_now_us(void)
{
    return (uint64_t)read_us(CLOCK_MONOTONIC);
}

uint32_t saddle_since_us(int64_t realtime_us)
{
    const int64_t since_us = read_us(CLOCK_REALTIME) - realtime_us;
    if (since_us < 0) {
        return 0;
    }
    return since_us < UINT32_MAX ? (uint32_t)since_us : UINT32_MAX;
}
