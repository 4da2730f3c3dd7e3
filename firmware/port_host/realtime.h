/** Real-time scheduling and locked memory. */
#ifndef SADDLEWALK_HOST_REALTIME_H
#define SADDLEWALK_HOST_REALTIME_H

#include <stdbool.h>

typedef struct {
    int fifo_priority; /**< 0: the ordinary scheduler */
    bool memory_locked;
} saddle_realtime_t;

/** Schedule the calling thread by SCHED_FIFO with that priority and keep all memory in place; 0:
 *  neither. What is not permitted is announced with the reason, and the process goes on without it.
 *  */
saddle_realtime_t saddle_realtime_enter(int fifo_priority);

#endif
