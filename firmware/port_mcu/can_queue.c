#include "can_queue.h"

bool saddle_can_queue_put(saddle_can_queue_t *queue, const saddle_can_frame_t *frame)
{
    const uint32_t put = queue->put;
    if (put - queue->taken == SADDLE_CAN_QUEUE) {
        queue->lost = queue->lost + 1u;
        return false;
    }
    queue->frames[put % SADDLE_CAN_QUEUE] = *frame;
    queue->put = put + 1u;
    return true;
}

bool saddle_can_queue_take(saddle_can_queue_t *queue, saddle_can_frame_t *frame)
{
    const uint32_t taken = queue->taken;
    if (taken == queue->put) {
        return false;
    }
    *frame = queue->frames[taken % SADDLE_CAN_QUEUE];
    queue->taken = taken + 1u;
    return true;
}
