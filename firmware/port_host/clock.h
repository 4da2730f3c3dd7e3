/** The clocks of the host process. */
#ifndef SADDLEWALK_HOST_CLOCK_H
#define SADDLEWALK_HOST_CLOCK_H

#include <stdint.h>

/** CLOCK_MONOTONIC, which nobody sets. */
uint64_t saddle_now_us(void);

/** Time since a recent instant of CLOCK_REALTIME; 0 if the clock was set back since. */
uint32_t saddle_since_us(int64_t realtime_us);

#endif
