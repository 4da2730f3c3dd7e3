#include "timing.h"

static uint32_t span_us(uint64_t from_us, uint64_t to_us)
{
    const uint64_t span = to_us > from_us ? to_us - from_us : 0;
    return span < UINT32_MAX ? (uint32_t)span : UINT32_MAX;
}

static uint32_t larger(uint32_t a, uint32_t b)
{
    return a > b ? a : b;
}

static unsigned bin_of(uint32_t latency_us)
{
    unsigned bin = 0;
    while (latency_us >= 2u && bin < SADDLE_LATENCY_BINS - 1u) {
        latency_us /= 2u;
        ++bin;
    }
    return bin;
}

void saddle_timing_begin(saddle_timing_t *timing, uint64_t due_us, uint64_t now_us)
{
    timing->period_us = timing->ticks > 0u ? span_us(timing->began_us, now_us) : 0u;
    timing->latency_us = span_us(due_us, now_us);
    timing->latency_max_us = larger(timing->latency_max_us, timing->latency_us);
    timing->began_us = now_us;
    ++timing->latencies[bin_of(timing->latency_us)];
}

void saddle_timing_end(saddle_timing_t *timing, uint64_t next_us, uint64_t now_us)
{
    timing->work_us = span_us(timing->began_us, now_us);
    timing->work_max_us = larger(timing->work_max_us, timing->work_us);
    timing->late_ticks += now_us > next_us;
    ++timing->ticks;
}
