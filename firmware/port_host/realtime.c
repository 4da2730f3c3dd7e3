#include "realtime.h"

#include "announce.h"
#include <errno.h>
#include <sched.h>
#include <string.h>
#include <sys/mman.h>

saddle_realtime_t saddle_realtime_enter(int fifo_priority)
{
    saddle_realtime_t realtime = {.fifo_priority = fifo_priority};
    if (fifo_priority == 0) {
        return realtime;
    }
    const struct sched_param wanted = {.sched_priority = fifo_priority};
    if (sched_setscheduler(0, SCHED_FIFO, &wanted) != 0) {
        saddle_announce("--fifo %d: %s: run it as root, or give the process "
                        "the capability cap_sys_nice; going on with the ordinary scheduler",
                        fifo_priority, strerror(errno));
        realtime.fifo_priority = 0;
    }
    realtime.memory_locked = mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
    if (!realtime.memory_locked) {
        saddle_announce("memory cannot be locked (%s): raise `ulimit -l`, or give the process the "
                        "capability cap_ipc_lock; a page that was swapped out may delay a tick",
                        strerror(errno));
    }
    return realtime;
}
