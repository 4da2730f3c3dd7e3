#include "sequences.h"

#include <string.h>

#define TICK_US 80000u
#define TICKS_PER_COMMAND 40u
#define TICKS_PER_BODY 500u

/* xorshift32 */
static uint32_t random_bits(sequence_t *sequence)
{
    sequence->random ^= sequence->random << 13;
    sequence->random ^= sequence->random >> 17;
    sequence->random ^= sequence->random << 5;
    return sequence->random;
}

static float random_in(sequence_t *sequence, float min, float max)
{
    return min + (max - min) * ((float)(random_bits(sequence) >> 8) / 16777216.0f);
}

static bool one_in(sequence_t *sequence, uint32_t count)
{
    return random_bits(sequence) % count == 0u;
}

/* Small and large ones alike. */
static uint32_t random_size(sequence_t *sequence)
{
    const uint32_t bits = random_bits(sequence);
    return bits >> (random_bits(sequence) % 32u);
}

static bool hostile(const sequence_t *sequence)
{
    return sequence->kind != SEQUENCE_VALID && sequence->kind != SEQUENCE_TURNING;
}

/* ---- numbers that no body has -------------------------------------------------------------- */

#define EXPONENT 0x7F800000u

static void spoil(sequence_t *sequence, float *value)
{
    if (!one_in(sequence, 16)) {
        return;
    }
    uint32_t bits = random_bits(sequence);
    if (sequence->kind == SEQUENCE_NOT_FINITE && one_in(sequence, 2)) {
        bits |= EXPONENT;
    } else if ((bits & EXPONENT) == EXPONENT) {
        bits ^= 0x40000000u;
    }
    memcpy(value, &bits, sizeof bits);
}

static void spoil_age(sequence_t *sequence, uint32_t *age_us)
{
    if (one_in(sequence, 16)) {
        *age_us = random_size(sequence);
    }
}

static void spoil_input(sequence_t *sequence)
{
    saddle_input_t *input = &sequence->input;
    spoil(sequence, &input->command.speed_m_s);
    spoil(sequence, &input->command.heel_strike_rad);
    spoil(sequence, &input->command.turn_rate_rad_s);
    spoil(sequence, &input->measurement.com.height_m);
    spoil(sequence, &input->measurement.com.velocity_m_s.x);
    spoil(sequence, &input->measurement.com.velocity_m_s.y);
    spoil_age(sequence, &input->command_age_us);
    spoil_age(sequence, &input->measurement.com.age_us);
    for (int side = 0; side < 2; side++) {
        spoil(sequence, &input->measurement.foot[side].cop_m.x);
        spoil(sequence, &input->measurement.foot[side].cop_m.y);
        spoil(sequence, &input->measurement.foot[side].ground_m_s);
        spoil_age(sequence, &input->measurement.foot[side].age_us);
        spoil_age(sequence, &input->measurement.foot[side].since_us);
        input->measurement.foot[side].contact ^= one_in(sequence, 16);
    }
    if (one_in(sequence, 16)) {
        input->command.mode = (uint8_t)random_bits(sequence);
    }
    if (one_in(sequence, 16)) {
        input->time_us += random_size(sequence);
    } else if (one_in(sequence, 64)) {
        input->time_us -= random_bits(sequence) % 200000u;
    }
}

static void spoil_config(sequence_t *sequence)
{
    const saddle_config_field_t *field;
    for (size_t i = 0; (field = saddle_config_field(i)) != NULL; i++) {
        if (one_in(sequence, 16)) {
            const float value = random_in(sequence, field->min, field->max);
            memcpy((char *)&sequence->config + field->offset, &value, sizeof value);
        }
    }
}

/* ---- a wearer ------------------------------------------------------------------------------ */

static void new_body(sequence_t *sequence)
{
    const float height_m = random_in(sequence, 1.5f, 1.95f);
    sequence->config = saddle_config_default(height_m, random_in(sequence, 45.0f, 110.0f));
    sequence->config.ankle = (saddle_ankle_t)(random_bits(sequence) % (uint32_t)SADDLE_ANKLE_COUNT);
    if (hostile(sequence)) {
        spoil_config(sequence);
    }
    if (saddle_init(&sequence->context, &sequence->config) != SADDLE_OK) {
        sequence->config = saddle_config_default(height_m, 70.0f);
        (void)saddle_init(&sequence->context, &sequence->config);
    }
    sequence->input = (saddle_input_t){.time_us = random_bits(sequence)};
}

static void new_command(sequence_t *sequence)
{
    saddle_command_t *command = &sequence->input.command;
    command->mode = (uint8_t)(one_in(sequence, 3) ? SADDLE_COMMAND_STAND : SADDLE_COMMAND_WALK);
    command->speed_m_s = random_in(sequence, 0.1f, 1.9f);
    command->heel_strike_rad = random_in(sequence, 0.0f, 0.3f);
    command->turn_rate_rad_s =
        sequence->kind == SEQUENCE_TURNING ? random_in(sequence, -0.6f, 0.6f) : 0.0f;
}

/* Where the plan is, but for noise and what is left of the last push. */
static void measure(sequence_t *sequence, const saddle_plan_t *plan)
{
    saddle_measurement_t *measured = &sequence->input.measurement;
    sequence->push_m_s *= 0.75f;
    if (one_in(sequence, 50)) {
        sequence->push_m_s = random_in(sequence, -1.0f, 1.0f);
    }
    measured->com.height_m = plan->com_m.z + random_in(sequence, -0.005f, 0.005f);
    measured->com.velocity_m_s.x = plan->com_velocity_m_s.x + sequence->push_m_s;
    measured->com.velocity_m_s.y = plan->com_velocity_m_s.y + 0.4f * sequence->push_m_s;
    measured->com.age_us = 0;
    for (int side = 0; side < 2; side++) {
        measured->foot[side].cop_m.x =
            plan->foot_m[side].x - plan->com_m.x + random_in(sequence, -0.005f, 0.005f);
        measured->foot[side].cop_m.y =
            plan->foot_m[side].y - plan->com_m.y + random_in(sequence, -0.005f, 0.005f);
        measured->foot[side].contact = !(plan->foot_m[side].z > 0.0f);
        measured->foot[side].age_us = 0;
    }
}

/* The input as it comes from the bus, where a bit may be wrong. */
static void receive(sequence_t *sequence, saddle_frame_t *frame)
{
    if (hostile(sequence) && one_in(sequence, 16)) {
        const uint32_t place = random_bits(sequence) % SADDLE_WIRE_LENGTH;
        frame->data[place] ^= (uint8_t)(1u << (random_bits(sequence) % 8u));
    }
    const saddle_wire_message_t message =
        saddle_wire_accept(&sequence->receiver, frame->id, frame->data, SADDLE_WIRE_LENGTH);
    if (message == SADDLE_WIRE_COMMAND) {
        saddle_wire_decode_command(frame->data, &sequence->input.command);
    } else {
        saddle_wire_decode_measured(message, frame->data, &sequence->input.measurement);
    }
}

static void pass_through_the_wire(sequence_t *sequence)
{
    const uint8_t counter = (uint8_t)sequence->ticks;
    saddle_frame_t frames[1u + SADDLE_WIRE_MEASURED_FRAMES];
    saddle_wire_encode_command(&sequence->input.command, counter, &frames[0]);
    saddle_wire_encode_measurement(&sequence->input.measurement, counter, &frames[1]);
    for (size_t i = 0; i < 1u + SADDLE_WIRE_MEASURED_FRAMES; i++) {
        receive(sequence, &frames[i]);
    }
}

static void encode(sequence_t *sequence)
{
    const saddle_wire_receiver_t *receiver = &sequence->receiver;
    const saddle_wire_health_t health = {.latency_us = random_bits(sequence),
                                         .accepted = receiver->accepted,
                                         .bad_crc = receiver->bad_crc,
                                         .bad_counter = receiver->bad_counter};
    saddle_wire_encode_output(&sequence->output, &health, (uint8_t)sequence->ticks,
                              sequence->frames);
}

void sequence_begin(sequence_t *sequence, sequence_kind_t kind)
{
    memset(sequence, 0, sizeof *sequence);
    sequence->kind = kind;
    sequence->random = 2026u + (uint32_t)kind;
}

void sequence_tick(sequence_t *sequence)
{
    saddle_plan_t plan;
    if (sequence->ticks % TICKS_PER_BODY == 0u) {
        new_body(sequence);
    }
    if (sequence->ticks % TICKS_PER_COMMAND == 0u) {
        new_command(sequence);
    }
    sequence->input.time_us += TICK_US - 2000u + random_bits(sequence) % 4000u;
    if (saddle_plan_at(&sequence->context, sequence->input.time_us, &plan) != SADDLE_OK) {
        plan = sequence->output.plan;
    }
    measure(sequence, &plan);
    pass_through_the_wire(sequence);
    if (hostile(sequence)) {
        spoil_input(sequence);
    }
    (void)saddle_tick(&sequence->context, &sequence->input, &sequence->output);
    encode(sequence);
    sequence->ticks++;
}
