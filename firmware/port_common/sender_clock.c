#include "sender_clock.h"

#include <saddlewalk/wire.h>

/** 200 ppm. */
#define RISE_SHARE 5000u

/** A set follows another if it is at most so many later: the rule of the alive counter. */
#define FOLLOWS_MAX 4u

/** So many times in a row before the newest are those of a sender that restarted. */
#define RESTARTED 16u

/** Half of what a difference of the sender's times can tell from a step back. */
#define LONGEST_SILENCE_US (UINT64_C(1) << 30)

/** A sender that has given no time for so long has no clock: ages count from reception again. */
#define CLOCKLESS_US 10000000u

static void begin(saddle_sender_clock_t *clock, uint8_t number, uint32_t sampled_us,
                  uint64_t received_us)
{
    *clock = (saddle_sender_clock_t){
        .heard = true, .newest = number, .newest_us = sampled_us, .local_us = received_us};
}

/** From one time of the sender's clock to another; negative: back. */
static int32_t step_us(uint32_t from_us, uint32_t to_us)
{
    return (int32_t)(to_us - from_us);
}

static bool follows(uint8_t number, uint8_t before)
{
    const uint8_t ahead = (uint8_t)(number - before) & SADDLE_WIRE_SET_MAX;
    return ahead >= 1u && ahead <= FOLLOWS_MAX;
}

static void advance(saddle_sender_clock_t *clock, uint8_t number, uint32_t sampled_us,
                    uint64_t received_us)
{
    const uint32_t passed_us = sampled_us - clock->newest_us;
    const uint64_t expected_us = clock->local_us + passed_us + passed_us / RISE_SHARE;
    clock->local_us = received_us < expected_us ? received_us : expected_us;
    clock->newest = number;
    clock->newest_us = sampled_us;
    clock->behind = 0;
}

/** Whether a time before the newest is of a clock that was set back or started over. */
static bool went_back(saddle_sender_clock_t *clock, uint8_t number, uint32_t sampled_us)
{
    const bool rises = step_us(clock->last_us, sampled_us) > 0;
    clock->behind = rises ? (uint8_t)(clock->behind + 1u) : 1u;
    return follows(number, clock->newest) || clock->behind >= RESTARTED;
}

void saddle_sender_clock_take(saddle_sender_clock_t *clock, uint8_t number, uint32_t sampled_us,
                              uint64_t received_us)
{
    const bool silent =
        received_us > clock->heard_us && received_us - clock->heard_us > LONGEST_SILENCE_US;
    const bool goes_on = clock->heard && !silent;
    if (goes_on && step_us(clock->newest_us, sampled_us) > 0) {
        advance(clock, number, sampled_us, received_us);
    } else if (!goes_on || went_back(clock, number, sampled_us)) {
        begin(clock, number, sampled_us, received_us);
    }
    clock->last_us = sampled_us;
    clock->heard_us = received_us;
    const uint32_t place = number % SADDLE_SENDER_SETS;
    clock->sets[place].sampled_us = sampled_us;
    clock->sets[place].held = (uint8_t)(number + 1u);
}

void saddle_sender_clock_forget(saddle_sender_clock_t *clock)
{
    *clock = (saddle_sender_clock_t){.heard = false};
}

bool saddle_sender_clock_runs(const saddle_sender_clock_t *clock, uint64_t now_us)
{
    return clock->heard && (now_us < clock->heard_us || now_us - clock->heard_us <= CLOCKLESS_US);
}

bool saddle_sender_clock_sampled(const saddle_sender_clock_t *clock, uint8_t number,
                                 uint64_t received_us, uint64_t *sampled_us)
{
    for (uint32_t back = 0; back < SADDLE_SENDER_SETS; ++back) {
        const uint8_t sought = (uint8_t)(number - back) & SADDLE_WIRE_SET_MAX;
        const uint32_t place = sought % SADDLE_SENDER_SETS;
        if (clock->sets[place].held == sought + 1u) {
            const uint32_t before_us = clock->newest_us - clock->sets[place].sampled_us;
            const uint64_t local_us = clock->local_us > before_us ? clock->local_us - before_us : 0;
            *sampled_us = local_us < received_us ? local_us : received_us;
            return true;
        }
    }
    return false;
}
