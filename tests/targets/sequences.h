/** Random inputs that are the same on every target: own random numbers, no libm, no printf.
 *
 *  A wearer who follows the plan, is pushed now and then and speaks CAN; and the same with numbers
 *  that no body has, or that are none. */
#ifndef SADDLEWALK_SEQUENCES_H
#define SADDLEWALK_SEQUENCES_H

#include <saddlewalk/saddlewalk.h>
#include <saddlewalk/wire.h>

typedef enum {
    SEQUENCE_VALID = 0,
    SEQUENCE_ABSURD = 1,     /**< finite numbers of any size, any configuration, time that leaps */
    SEQUENCE_NOT_FINITE = 2, /**< and any bits for a float */
    SEQUENCE_TURNING = 3,    /**< valid, and each command turns */
    SEQUENCE_COUNT
} sequence_kind_t;

typedef struct {
    sequence_kind_t kind;
    uint32_t random;
    uint32_t ticks;
    float push_m_s;
    saddle_config_t config;
    saddle_context_t context;
    saddle_input_t input;
    saddle_output_t output;
    saddle_wire_receiver_t receiver;
    saddle_frame_t frames[SADDLE_WIRE_OUTPUT_FRAMES]; /**< the output, encoded */
} sequence_t;

void sequence_begin(sequence_t *sequence, sequence_kind_t kind);

/** The next input, its tick and its frames. */
void sequence_tick(sequence_t *sequence);

#endif
