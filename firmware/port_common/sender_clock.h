/**
 * When each measured set was sampled, by the receiver's clock. The two clocks have any origins and
 * differ in rate by up to 100 ppm; what is known is a least delay: no frame is received before it was
 * sent. So a path that is always late by the same time is not seen to be late, and one that becomes late
 * is, for as long as it lasts. Integers only, fixed storage.
 *
 * The least delay is followed at once when it falls. It may rise by 200 ppm of the time that passes,
 * which covers the clocks' rates: after a minute without one undelayed frame an age is too low by 18 ms
 * at most.
 */
#ifndef SADDLEWALK_PORT_SENDER_CLOCK_H
#define SADDLEWALK_PORT_SENDER_CLOCK_H

#include <stdbool.h>
#include <stdint.h>

/** Of the newest sets, so many are remembered. */
#define SADDLE_SENDER_SETS 16u

/** Initialise with zeros. */
typedef struct {
    bool heard;
    uint8_t newest;     /**< number of the newest set */
    uint8_t behind;     /**< times in a row that rose and yet are before the newest */
    uint32_t newest_us; /**< when it was sampled, by the sender's clock */
    uint32_t last_us;   /**< the last time received */
    uint64_t local_us;  /**< when the newest was sampled, by ours, and the least delay after it */
    uint64_t heard_us;  /**< when the last time was received */
    struct {
        uint32_t sampled_us;
        uint8_t held; /**< its number + 1; 0: none */
    } sets[SADDLE_SENDER_SETS];
} saddle_sender_clock_t;

/** The set of this number was sampled at sampled_us by the sender's clock, which wraps; that was
 *  received at received_us. Learned anew: when the sender's clock went back, in a set that follows the
 *  newest or, after a restart, for 16 sets in a row; and after 18 minutes of silence. */
void saddle_sender_clock_take(saddle_sender_clock_t *clock, uint8_t number, uint32_t sampled_us,
                              uint64_t received_us);

/** The receiver's clock jumped, which a delay cannot be told from: learn anew, from the next time. */
void saddle_sender_clock_forget(saddle_sender_clock_t *clock);

/** Whether the sender gave a time within the last 10 s; else it has no clock. */
bool saddle_sender_clock_runs(const saddle_sender_clock_t *clock, uint64_t now_us);

/** When that set was sampled, by our clock, and received_us at the latest. If its own time was lost:
 *  when the nearest set before it was. False: it is older than all that are remembered. */
bool saddle_sender_clock_sampled(const saddle_sender_clock_t *clock, uint8_t number,
                                 uint64_t received_us, uint64_t *sampled_us);

#endif
