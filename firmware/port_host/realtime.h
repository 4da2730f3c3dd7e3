/** A place of its own on the processor. */
#ifndef SADDLEWALK_HOST_REALTIME_H
#define SADDLEWALK_HOST_REALTIME_H

#include <stdbool.h>

typedef struct {
    int fifo_priority; /**< 0: the ordinary scheduler */
    bool memory_locked;
} saddle_realtime_t;

/** Schedule the calling thread by SCHED_FIFO with that priority and keep all memory in place; 0:
 *  neither. What is refused is announced, with the reason, and done without. */
saddle_realtime_t saddle_realtime_enter(int fifo_priority);

#endif
