#include <saddlewalk/wire.h>

#include "saddle_can.h"
#include <float.h>
#include <math.h>

#define NOT_AVAILABLE INT16_MIN
#define COUNTER_MASK 0x0Fu
#define COUNTER_STEP_MAX 4u
#define AGE_MAX_MS 4095u

/** A session ends in good time before its freshness does: this leaves some minutes. */
#define FRESHNESS_END 60000u

/** While nobody commands there is a new one every so many ticks, 2 s: a code that was held back is
 *  of no use for longer. */
#define IDLE_SESSION_TICKS 25u

/** Raw value of a number: the scale is the generated codec's, and the ends of the range follow. */
#define RAW(signal, valid, value)                                                                \
    ((valid) && is_finite(value)                                                                 \
         ? saddle_can_##signal##_encode(limited(value, saddle_can_##signal##_decode(INT16_MAX))) \
         : (int16_t)NOT_AVAILABLE)

#define NUMBER(signal, raw) ((raw) == NOT_AVAILABLE ? NAN : saddle_can_##signal##_decode(raw))

static bool is_finite(float value)
{
    return value >= -FLT_MAX && value <= FLT_MAX;
}

static float limited(float value, float limit)
{
    return value > limit ? limit : (value < -limit ? -limit : value);
}

static uint16_t limited_u16(uint32_t value)
{
    return value > UINT16_MAX ? (uint16_t)UINT16_MAX : (uint16_t)value;
}

static uint8_t limited_u8(uint32_t value)
{
    return value > UINT8_MAX ? (uint8_t)UINT8_MAX : (uint8_t)value;
}

static float seconds(uint32_t us)
{
    return (float)us * 1.0e-6f;
}

/** 12 bits of milliseconds; the largest: as old, older, or never. */
static uint16_t age_ms(uint32_t us)
{
    return us / 1000u < AGE_MAX_MS ? (uint16_t)(us / 1000u) : (uint16_t)AGE_MAX_MS;
}

/** What the polynomial 0x1D makes of each upper half byte. */
static const uint8_t CRC_OF_NIBBLE[16] = {0x00, 0x1D, 0x3A, 0x27, 0x74, 0x69, 0x4E, 0x53,
                                          0xE8, 0xF5, 0xD2, 0xCF, 0x9C, 0x81, 0xA6, 0xBB};

static uint32_t crc_of_nibble(uint32_t crc)
{
    return (crc << 4 & 0xFFu) ^ CRC_OF_NIBBLE[crc >> 4];
}

uint8_t saddle_wire_crc(const uint8_t *bytes, size_t length)
{
    uint32_t crc = 0xFFu;
    for (size_t i = 0; i < length; ++i) {
        crc = crc_of_nibble(crc_of_nibble(crc ^ bytes[i]));
    }
    return (uint8_t)(crc ^ 0xFFu);
}

static uint8_t frame_crc(uint32_t id, const uint8_t *data)
{
    uint8_t bytes[1u + SADDLE_WIRE_LENGTH] = {(uint8_t)id, (uint8_t)(id >> 8)};
    for (size_t i = 1; i < SADDLE_WIRE_LENGTH; ++i) {
        bytes[i + 1u] = data[i];
    }
    return saddle_wire_crc(bytes, sizeof bytes);
}

static void seal(saddle_frame_t *frame, uint16_t id)
{
    frame->id = id;
    frame->data[0] = frame_crc(id, frame->data);
}

uint8_t saddle_wire_counter(const uint8_t data[SADDLE_WIRE_LENGTH])
{
    return data[1] & COUNTER_MASK;
}

static bool follows(uint8_t counter, uint8_t before)
{
    const uint8_t step = (uint8_t)(counter - before) & COUNTER_MASK;
    return step >= 1u && step <= COUNTER_STEP_MAX;
}

/** After an accepted frame the candidate is that frame itself, so it adds nothing to the rule. */
static bool in_step(saddle_wire_alive_t *alive, uint8_t counter)
{
    if (alive->seen && counter == alive->last) {
        return false;
    }
    const bool accepted =
        !alive->seen || follows(counter, alive->last) || follows(counter, alive->candidate);
    alive->candidate = counter;
    if (accepted) {
        alive->last = counter;
        alive->seen = true;
    }
    return accepted;
}

static saddle_wire_message_t message_of(uint32_t id)
{
    switch (id) {
    case SADDLE_CAN_COMMAND_FRAME_ID: return SADDLE_WIRE_COMMAND;
    case SADDLE_CAN_COMMAND_CODE_FRAME_ID: return SADDLE_WIRE_COMMAND_CODE;
    case SADDLE_CAN_MEASURED_COM_FRAME_ID: return SADDLE_WIRE_MEASURED_COM;
    case SADDLE_CAN_MEASURED_LEFT_FRAME_ID: return SADDLE_WIRE_MEASURED_LEFT;
    case SADDLE_CAN_MEASURED_RIGHT_FRAME_ID: return SADDLE_WIRE_MEASURED_RIGHT;
    default: return SADDLE_WIRE_NONE;
    }
}

static bool speaks_our_version(saddle_wire_receiver_t *receiver, saddle_wire_message_t message,
                               const uint8_t *data)
{
    if (message != SADDLE_WIRE_COMMAND) {
        return true;
    }
    struct saddle_can_command_t command;
    (void)saddle_can_command_unpack(&command, data, SADDLE_WIRE_LENGTH);
    if (command.wire_version != SADDLE_WIRE_VERSION) {
        receiver->other_version = command.wire_version;
        return false;
    }
    return true;
}

/** One block for the cipher: the session, its freshness, and the frame with its identifier. */
static uint32_t code_of(const saddle_cmac_key_t *key, uint32_t session, uint16_t freshness,
                        const uint8_t *command)
{
    uint8_t bytes[SADDLE_CMAC_LENGTH] = {
        (uint8_t)session,          (uint8_t)(session >> 8),        (uint8_t)(session >> 16),
        (uint8_t)(session >> 24),  (uint8_t)freshness,             (uint8_t)(freshness >> 8),
        (uint8_t)SADDLE_CAN_COMMAND_FRAME_ID, (uint8_t)(SADDLE_CAN_COMMAND_FRAME_ID >> 8)};
    uint8_t code[SADDLE_CMAC_LENGTH];
    for (size_t i = 0; i < SADDLE_WIRE_LENGTH; ++i) {
        bytes[8u + i] = command[i];
    }
    saddle_cmac(key, bytes, sizeof bytes, code);
    return (uint32_t)code[0] << 24 | (uint32_t)code[1] << 16 | (uint32_t)code[2] << 8 | code[3];
}

/** A code is tried once. */
static bool is_authentic(saddle_wire_guard_t *guard, const uint8_t *command)
{
    struct saddle_can_command_code_t told;
    if (!guard->demanded || !guard->waits) {
        return !guard->demanded;
    }
    guard->waits = false;
    (void)saddle_can_command_code_unpack(&told, guard->frame, SADDLE_WIRE_LENGTH);
    if (!guard->opened || told.freshness <= guard->freshness ||
        told.code != code_of(&guard->key, guard->session, told.freshness, command)) {
        return false;
    }
    guard->freshness = told.freshness;
    return true;
}

static void keep_code(saddle_wire_guard_t *guard, const uint8_t *data)
{
    guard->waits = true;
    for (size_t i = 0; i < SADDLE_WIRE_LENGTH; ++i) {
        guard->frame[i] = data[i];
    }
}

saddle_wire_message_t saddle_wire_accept(saddle_wire_receiver_t *receiver, uint32_t id,
                                         const uint8_t *data, size_t length)
{
    const saddle_wire_message_t message = message_of(id);
    uint32_t *count = &receiver->accepted;
    if (length != SADDLE_WIRE_LENGTH || message == SADDLE_WIRE_NONE) {
        count = &receiver->malformed;
    } else if (data[0] != frame_crc(id, data)) {
        count = &receiver->bad_crc;
    } else if (!speaks_our_version(receiver, message, data)) {
        count = &receiver->bad_version;
    } else if (message == SADDLE_WIRE_COMMAND && !is_authentic(&receiver->guard, data)) {
        count = &receiver->bad_code;
    } else if (!in_step(&receiver->alive[message], saddle_wire_counter(data))) {
        count = &receiver->bad_counter;
    } else if (message == SADDLE_WIRE_COMMAND_CODE) {
        keep_code(&receiver->guard, data);
    }
    ++*count;
    return count == &receiver->accepted ? message : SADDLE_WIRE_NONE;
}

void saddle_wire_decode_command(const uint8_t data[SADDLE_WIRE_LENGTH], saddle_command_t *command)
{
    struct saddle_can_command_t raw;
    (void)saddle_can_command_unpack(&raw, data, SADDLE_WIRE_LENGTH);
    command->mode = raw.mode;
    command->speed_m_s = NUMBER(command_speed, raw.speed);
    command->heel_strike_rad = NUMBER(command_heel_strike, raw.heel_strike);
}

static void decode_com(const uint8_t *data, saddle_measurement_t *measurement)
{
    struct saddle_can_measured_com_t raw;
    (void)saddle_can_measured_com_unpack(&raw, data, SADDLE_WIRE_LENGTH);
    measurement->com.height_m = NUMBER(measured_com_height, raw.height);
    measurement->com.velocity_m_s.x = NUMBER(measured_com_vx, raw.vx);
    measurement->com.velocity_m_s.y = NUMBER(measured_com_vy, raw.vy);
}

static void decode_left(const uint8_t *data, saddle_measurement_t *measurement)
{
    struct saddle_can_measured_left_t raw;
    (void)saddle_can_measured_left_unpack(&raw, data, SADDLE_WIRE_LENGTH);
    measurement->foot[SADDLE_LEFT].cop_m.x = NUMBER(measured_left_x, raw.x);
    measurement->foot[SADDLE_LEFT].cop_m.y = NUMBER(measured_left_y, raw.y);
    measurement->foot[SADDLE_LEFT].contact = raw.contact != 0u;
}

static void decode_right(const uint8_t *data, saddle_measurement_t *measurement)
{
    struct saddle_can_measured_right_t raw;
    (void)saddle_can_measured_right_unpack(&raw, data, SADDLE_WIRE_LENGTH);
    measurement->foot[SADDLE_RIGHT].cop_m.x = NUMBER(measured_right_x, raw.x);
    measurement->foot[SADDLE_RIGHT].cop_m.y = NUMBER(measured_right_y, raw.y);
    measurement->foot[SADDLE_RIGHT].contact = raw.contact != 0u;
}

void saddle_wire_decode_measured(saddle_wire_message_t message,
                                 const uint8_t data[SADDLE_WIRE_LENGTH],
                                 saddle_measurement_t *measurement)
{
    if (message == SADDLE_WIRE_MEASURED_COM) {
        decode_com(data, measurement);
    } else if (message == SADDLE_WIRE_MEASURED_LEFT) {
        decode_left(data, measurement);
    } else if (message == SADDLE_WIRE_MEASURED_RIGHT) {
        decode_right(data, measurement);
    }
}

/** Fill a message, pack it and seal the frame. The generated packers refuse only a short buffer. */
#define ENCODE(frame, message, id, ...)                                             \
    do {                                                                            \
        const struct saddle_can_##message##_t raw = {__VA_ARGS__};                  \
        (void)saddle_can_##message##_pack((frame)->data, &raw, SADDLE_WIRE_LENGTH); \
        seal((frame), SADDLE_CAN_##id##_FRAME_ID);                                  \
    } while (0)

static void encode_com_plan(const saddle_plan_t *plan, uint8_t counter, saddle_frame_t *frames)
{
    const bool valid = plan->valid;
    ENCODE(&frames[0], plan_com, PLAN_COM, .counter = counter,
           .x = RAW(plan_com_x, valid, plan->com_m.x),
           .y = RAW(plan_com_y, valid, plan->com_m.y),
           .z = RAW(plan_com_z, valid, plan->com_m.z));
    ENCODE(&frames[1], plan_com_velocity, PLAN_COM_VELOCITY, .counter = counter,
           .vx = RAW(plan_com_velocity_vx, valid, plan->com_velocity_m_s.x),
           .vy = RAW(plan_com_velocity_vy, valid, plan->com_velocity_m_s.y),
           .vz = RAW(plan_com_velocity_vz, valid, plan->com_velocity_m_s.z));
}

static void encode_feet_plan(const saddle_plan_t *plan, uint8_t counter, saddle_frame_t *frames)
{
    const bool valid = plan->valid;
    const saddle_vec3_t left_m = plan->foot_m[SADDLE_LEFT];
    const saddle_vec3_t right_m = plan->foot_m[SADDLE_RIGHT];
    ENCODE(&frames[0], plan_left, PLAN_LEFT, .counter = counter,
           .x = RAW(plan_left_x, valid, left_m.x), .y = RAW(plan_left_y, valid, left_m.y),
           .z = RAW(plan_left_z, valid, left_m.z));
    ENCODE(&frames[1], plan_right, PLAN_RIGHT, .counter = counter,
           .x = RAW(plan_right_x, valid, right_m.x), .y = RAW(plan_right_y, valid, right_m.y),
           .z = RAW(plan_right_z, valid, right_m.z));
    ENCODE(&frames[2], plan_swing, PLAN_SWING, .counter = counter,
           .vx = RAW(plan_swing_vx, valid, plan->swing_velocity_m_s.x),
           .vy = RAW(plan_swing_vy, valid, plan->swing_velocity_m_s.y),
           .vz = RAW(plan_swing_vz, valid, plan->swing_velocity_m_s.z));
}

static void encode_step_plan(const saddle_plan_t *plan, uint8_t counter, saddle_frame_t *frames)
{
    const bool valid = plan->valid;
    ENCODE(&frames[0], plan_landing, PLAN_LANDING, .counter = counter,
           .x = RAW(plan_landing_x, valid, plan->landing_m.x),
           .y = RAW(plan_landing_y, valid, plan->landing_m.y),
           .leg_length = RAW(plan_landing_leg_length, valid, plan->leg_length_m));
    ENCODE(&frames[1], plan_ankle, PLAN_ANKLE, .counter = counter,
           .toe_off = RAW(plan_ankle_toe_off, valid, plan->toe_off_rad),
           .heel_strike = RAW(plan_ankle_heel_strike, valid, plan->heel_strike_rad),
           .speed = RAW(plan_ankle_speed, valid, plan->speed_m_s));
    ENCODE(&frames[2], plan_step, PLAN_STEP, .counter = counter, .valid = valid,
           .support = plan->support, .phase = plan->phase,
           .theta = RAW(plan_step_theta, valid, plan->theta_rad),
           .step_length = RAW(plan_step_step_length, valid, plan->step_length_m),
           .step_count = (uint16_t)plan->step_count);
}

static void encode_events_plan(const saddle_plan_t *plan, uint8_t counter, saddle_frame_t *frames)
{
    const bool valid = plan->valid;
    ENCODE(&frames[0], plan_events, PLAN_EVENTS, .counter = counter, .mode = plan->mode,
           .time_to_via_point =
               RAW(plan_events_time_to_via_point, valid, plan->time_to_via_point_s),
           .time_to_heel_strike =
               RAW(plan_events_time_to_heel_strike, valid, plan->time_to_heel_strike_s),
           .time_to_toe_off = RAW(plan_events_time_to_toe_off, valid, plan->time_to_toe_off_s));
    ENCODE(&frames[1], plan_pitch, PLAN_PITCH, .counter = counter,
           .left = RAW(plan_pitch_left, valid, plan->foot_pitch_rad[SADDLE_LEFT]),
           .right = RAW(plan_pitch_right, valid, plan->foot_pitch_rad[SADDLE_RIGHT]),
           .knee_flexion = RAW(plan_pitch_knee_flexion, valid, plan->knee_flexion_m));
}

static bool holds(const saddle_scores_t *scores, saddle_valid_t result)
{
    return (scores->valid & (uint32_t)result) != 0u;
}

static void encode_scores(const saddle_scores_t *scores, uint32_t faults, uint8_t counter,
                          saddle_frame_t *frames)
{
    const bool step = holds(scores, SADDLE_VALID_STEP);
    const bool gravity = holds(scores, SADDLE_VALID_GRAVITY);
    ENCODE(&frames[0], scores_step, SCORES_STEP, .counter = counter,
           .s_pend = RAW(scores_step_s_pend, step, scores->s_pend),
           .s_jump = RAW(scores_step_s_jump, step, scores->s_jump),
           .s_sw = RAW(scores_step_s_sw, holds(scores, SADDLE_VALID_S_SW), scores->s_sw));
    ENCODE(&frames[1], scores_margin, SCORES_MARGIN, .counter = counter,
           .mos_com = RAW(scores_margin_mos_com, holds(scores, SADDLE_VALID_MOS_COM),
                          scores->mos_com_m),
           .mos_xcom = RAW(scores_margin_mos_xcom, holds(scores, SADDLE_VALID_MOS_XCOM),
                           scores->mos_xcom_m),
           .v_comp = RAW(scores_margin_v_comp, holds(scores, SADDLE_VALID_V_COMP),
                         scores->v_comp_m_s));
    ENCODE(&frames[2], scores_force, SCORES_FORCE, .counter = counter,
           .gravity_x = RAW(scores_force_gravity_x, gravity, scores->gravity_n.x),
           .gravity_y = RAW(scores_force_gravity_y, gravity, scores->gravity_n.y),
           .faults = (uint16_t)faults);
}

static void encode_foresight(const saddle_scores_t *scores, const saddle_verdict_t *verdict,
                             uint8_t counter, saddle_frame_t *frames)
{
    const bool stop = holds(scores, SADDLE_VALID_STOP);
    const bool compared = verdict->compared;
    ENCODE(&frames[0], scores_energy, SCORES_ENERGY, .counter = counter,
           .can_stop = scores->can_stop, .on_track = verdict->on_track,
           .paper_stable = scores->paper_stable,
           .excess_stop = RAW(scores_energy_excess_stop, stop, scores->excess_stop_j),
           .excess_track =
               RAW(scores_energy_excess_track, stop && compared, verdict->excess_track_j));
    ENCODE(&frames[1], scores_expected, SCORES_EXPECTED, .counter = counter,
           .ebos_com = RAW(scores_expected_ebos_com, compared, verdict->ebos_com_m),
           .ebos_xcom = RAW(scores_expected_ebos_xcom, compared, verdict->ebos_xcom_m));
}

static void encode_verdict(const saddle_verdict_t *verdict, uint8_t counter,
                           saddle_frame_t *frames)
{
    const bool compared = verdict->compared;
    const saddle_vec2_t deviation_m = verdict->xcom_deviation_m;
    const saddle_recovery_t *recovery = &verdict->recovery;
    const bool landing = compared && recovery->found;
    ENCODE(&frames[0], verdict, VERDICT, .counter = counter, .compared = compared,
           .level = verdict->level, .reason = verdict->reason,
           .xcom_deviation_x = RAW(verdict_xcom_deviation_x, compared, deviation_m.x),
           .xcom_deviation_y = RAW(verdict_xcom_deviation_y, compared, deviation_m.y));
    ENCODE(&frames[1], recovery, RECOVERY, .counter = counter, .found = recovery->found,
           .stops = recovery->stops, .foot = recovery->foot,
           .x = RAW(recovery_x, landing, recovery->landing_m.x),
           .y = RAW(recovery_y, landing, recovery->landing_m.y),
           .margin = RAW(recovery_margin, compared, recovery->margin_m));
}

static void encode_balance(const saddle_verdict_t *verdict, uint8_t counter,
                           saddle_frame_t *frame)
{
    const bool known = verdict->margin_known;
    ENCODE(frame, balance, BALANCE, .counter = counter, .driver = verdict->driver,
           .balance_margin = RAW(balance_balance_margin, known, verdict->margin),
           .caution_below = RAW(balance_caution_below, known, verdict->caution_below));
}

static void encode_learned_walk(const saddle_learned_walk_t *walk, uint8_t counter,
                                saddle_frame_t *frames)
{
    const bool measured = walk->height_m > 0.0f;
    const bool stepped = walk->step_time_s > 0.0f;
    ENCODE(&frames[0], learned_mean, LEARNED_MEAN, .counter = counter,
           .vx = RAW(learned_mean_vx, measured, walk->velocity_m_s.x),
           .vy = RAW(learned_mean_vy, measured, walk->velocity_m_s.y),
           .height = RAW(learned_mean_height, measured, walk->height_m));
    ENCODE(&frames[1], learned_step, LEARNED_STEP, .counter = counter,
           .time = RAW(learned_step_time, stepped, walk->step_time_s),
           .length = RAW(learned_step_length, stepped, walk->step_length_m),
           .width = RAW(learned_step_width, stepped, walk->step_width_m));
    ENCODE(&frames[2], learned_steadiness, LEARNED_STEADINESS, .counter = counter,
           .ripple = RAW(learned_steadiness_ripple, walk->ripple > 0.0f, walk->ripple),
           .step_margin = RAW(learned_steadiness_step_margin, stepped, walk->step_margin));
}

static void encode_process(const saddle_wire_health_t *health, uint8_t counter,
                           saddle_frame_t *frames)
{
    const uint32_t *const age_us = health->input_age_us;
    ENCODE(&frames[0], timing, TIMING, .counter = counter,
           .period = RAW(timing_period, true, seconds(health->period_us)),
           .latency = RAW(timing_latency, true, seconds(health->latency_us)),
           .latency_max = RAW(timing_latency_max, true, seconds(health->latency_max_us)));
    ENCODE(&frames[1], received, RECEIVED, .counter = counter,
           .malformed = limited_u8(health->malformed), .bad_crc = limited_u8(health->bad_crc),
           .bad_version = limited_u8(health->bad_version),
           .bad_counter = limited_u8(health->bad_counter), .accepted = (uint16_t)health->accepted);
    ENCODE(&frames[2], inputs, INPUTS, .counter = counter,
           .command_source = health->command_source & 3u,
           .command_age = age_ms(age_us[SADDLE_WIRE_COMMAND]),
           .com_age = age_ms(age_us[SADDLE_WIRE_MEASURED_COM]),
           .left_age = age_ms(age_us[SADDLE_WIRE_MEASURED_LEFT]),
           .right_age = age_ms(age_us[SADDLE_WIRE_MEASURED_RIGHT]));
}

static void encode_health(const saddle_output_t *output, const saddle_wire_health_t *health,
                          uint8_t counter, saddle_frame_t *frame)
{
    ENCODE(frame, health, HEALTH, .counter = counter, .status = (uint8_t)output->status,
           .limits = (uint8_t)output->limits, .wire_version = SADDLE_WIRE_VERSION,
           .late_ticks = limited_u16(health->late_ticks),
           .rejected_frames = limited_u16(health->rejected_frames));
}

void saddle_wire_encode_output(const saddle_output_t *output, const saddle_wire_health_t *health,
                               uint8_t counter, saddle_frame_t frames[SADDLE_WIRE_OUTPUT_FRAMES])
{
    counter &= COUNTER_MASK;
    encode_com_plan(&output->plan, counter, &frames[0]);
    encode_feet_plan(&output->plan, counter, &frames[2]);
    encode_step_plan(&output->plan, counter, &frames[5]);
    encode_events_plan(&output->plan, counter, &frames[8]);
    encode_scores(&output->scores, output->faults, counter, &frames[10]);
    encode_foresight(&output->scores, &output->verdict, counter, &frames[13]);
    encode_verdict(&output->verdict, counter, &frames[15]);
    encode_balance(&output->verdict, counter, &frames[17]);
    encode_learned_walk(&output->walk, counter, &frames[18]);
    encode_process(health, counter, &frames[21]);
    encode_health(output, health, counter, &frames[24]);
}

void saddle_wire_encode_command(const saddle_command_t *command, uint8_t counter,
                                saddle_frame_t *frame)
{
    ENCODE(frame, command, COMMAND, .counter = counter & COUNTER_MASK,
           .mode = command->mode < 15u ? command->mode : 15u,
           .speed = RAW(command_speed, true, command->speed_m_s),
           .heel_strike = RAW(command_heel_strike, true, command->heel_strike_rad),
           .wire_version = SADDLE_WIRE_VERSION);
}

void saddle_wire_encode_measurement(const saddle_measurement_t *measurement, uint8_t counter,
                                    saddle_frame_t frames[SADDLE_WIRE_MEASURED_FRAMES])
{
    const saddle_vec2_t left_m = measurement->foot[SADDLE_LEFT].cop_m;
    const saddle_vec2_t right_m = measurement->foot[SADDLE_RIGHT].cop_m;
    counter &= COUNTER_MASK;
    ENCODE(&frames[0], measured_com, MEASURED_COM, .counter = counter,
           .height = RAW(measured_com_height, true, measurement->com.height_m),
           .vx = RAW(measured_com_vx, true, measurement->com.velocity_m_s.x),
           .vy = RAW(measured_com_vy, true, measurement->com.velocity_m_s.y));
    ENCODE(&frames[1], measured_left, MEASURED_LEFT, .counter = counter,
           .contact = measurement->foot[SADDLE_LEFT].contact,
           .x = RAW(measured_left_x, true, left_m.x), .y = RAW(measured_left_y, true, left_m.y));
    ENCODE(&frames[2], measured_right, MEASURED_RIGHT, .counter = counter,
           .contact = measurement->foot[SADDLE_RIGHT].contact,
           .x = RAW(measured_right_x, true, right_m.x),
           .y = RAW(measured_right_y, true, right_m.y));
}

void saddle_wire_demand_codes(saddle_wire_receiver_t *receiver,
                              const uint8_t key[SADDLE_CMAC_LENGTH])
{
    receiver->guard.demanded = true;
    saddle_cmac_prepare(&receiver->guard.key, key);
}

void saddle_wire_open_session(saddle_wire_receiver_t *receiver, uint32_t session)
{
    receiver->guard.opened = true;
    receiver->guard.session = session;
    receiver->guard.freshness = 0;
    receiver->guard.waits = false;
}

/** Whoever commands next may be new, and counts from 1. */
bool saddle_wire_session_is_over(const saddle_wire_receiver_t *receiver,
                                 const saddle_output_t *output, uint32_t ticks)
{
    const saddle_wire_guard_t *guard = &receiver->guard;
    const bool stale = (output->faults & (uint32_t)SADDLE_FAULT_COMMAND_STALE) != 0u;
    const bool renewed = ticks % IDLE_SESSION_TICKS == IDLE_SESSION_TICKS - 1u;
    return guard->demanded && (!guard->opened || guard->freshness >= FRESHNESS_END ||
                               (stale && (guard->freshness > 0u || renewed)));
}

void saddle_wire_encode_session(const saddle_wire_receiver_t *receiver, uint8_t counter,
                                saddle_frame_t *frame)
{
    ENCODE(frame, session, SESSION, .counter = counter & COUNTER_MASK,
           .session = receiver->guard.session, .freshness = receiver->guard.freshness);
}

void saddle_wire_encode_code(const saddle_cmac_key_t *key, uint32_t session, uint16_t freshness,
                             const saddle_frame_t *command, saddle_frame_t *frame)
{
    ENCODE(frame, command_code, COMMAND_CODE, .counter = saddle_wire_counter(command->data),
           .freshness = freshness, .code = code_of(key, session, freshness, command->data));
}
