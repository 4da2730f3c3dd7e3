/** A queue of CAN frames between an interrupt and the loop, in either direction. */
#ifndef SADDLEWALK_MCU_CAN_QUEUE_H
#define SADDLEWALK_MCU_CAN_QUEUE_H

#include <saddlewalk/wire.h>

/** A power of 2. Enough for an output and the commands of all joints, or for 100 ms of measurements at
 *  100 Hz. */
#define SADDLE_CAN_QUEUE 64u

/** A classic data frame with an 11-bit identifier. */
typedef struct {
    uint64_t received_us; /**< of a received frame */
    uint16_t id;
    uint8_t length; /**< 0 to 8 */
    uint8_t data[SADDLE_WIRE_LENGTH];
} saddle_can_frame_t;

/** Initialise with zeros. One side puts, the other takes; either may interrupt the other. The
 *  counts wrap at 2^32. */
typedef struct {
    volatile saddle_can_frame_t frames[SADDLE_CAN_QUEUE];
    volatile uint32_t put, taken; /**< since the start */
    volatile uint32_t lost;       /**< frames that did not fit */
} saddle_can_queue_t;

/** False: there is no room; the frames in the queue are kept. */
bool saddle_can_queue_put(saddle_can_queue_t *queue, const saddle_can_frame_t *frame);

/** Take the oldest frame; false: there is none. */
bool saddle_can_queue_take(saddle_can_queue_t *queue, saddle_can_frame_t *frame);

#endif
