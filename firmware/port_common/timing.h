/** Timing of the ticks. */
#ifndef SADDLEWALK_PORT_TIMING_H
#define SADDLEWALK_PORT_TIMING_H

#include <stdint.h>

/** From one tick to the next. */
#define SADDLE_TICK_US 80000u

/** Bin 0: woken within 2 us of the tick's time on the grid; bin n: from 2^n us, below
 *  2^(n+1) us; the last: anything later. */
#define SADDLE_LATENCY_BINS 17

/** Initialise with zeros. */
typedef struct {
    uint64_t began_us; /**< of the last tick */
    uint32_t ticks;
    uint32_t late_ticks;   /**< ended after the next was due */
    uint32_t missed_ticks; /**< times on the grid without a tick */
    uint32_t period_us;    /**< between the last two ticks */
    uint32_t latency_us;   /**< from the tick's time on the grid to its beginning */
    uint32_t latency_max_us;
    uint32_t work_us; /**< duration of the last but one tick */
    uint32_t work_max_us;
    uint32_t latencies[SADDLE_LATENCY_BINS]; /**< ticks by latency */
} saddle_timing_t;

/** A tick that was due at due_us begins at now_us. */
void saddle_timing_begin(saddle_timing_t *timing, uint64_t due_us, uint64_t now_us);

/** The tick has ended; the next one is due at next_us. */
void saddle_timing_end(saddle_timing_t *timing, uint64_t next_us, uint64_t now_us);

#endif
