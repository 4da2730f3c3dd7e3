#include <saddlewalk/wire.h>

#include "frame.h"

#define COUNTER_MASK 0x0Fu
#define ROUND_SHIFT 5u /* in byte 1 */
#define COUNTER_STEP_MAX 4u
#define AGE_MAX_MS 4095u

/** A session ends some minutes before its freshness is used up. */
#define FRESHNESS_END 60000u

/** Without commands there is a new session every so many ticks, 2 s, so that a delayed code expires. */
#define IDLE_SESSION_TICKS 25u

static uint32_t limited(uint32_t value, uint32_t largest)
{
    return value < largest ? value : largest;
}

static float seconds(uint32_t us)
{
    return (float)us * 1.0e-6f;
}

/** 12 bits of milliseconds; the largest: as old, older, or never. */
static uint32_t age_ms(uint32_t us)
{
    return limited(us / 1000u, AGE_MAX_MS);
}

uint8_t saddle_wire_crc(const uint8_t *bytes, size_t length)
{
    uint32_t crc = 0xFFu;
    for (size_t i = 0; i < length; ++i) {
        crc = crc_after(crc, bytes[i]);
    }
    return (uint8_t)(crc ^ 0xFFu);
}

uint8_t saddle_wire_counter(const uint8_t data[SADDLE_WIRE_LENGTH])
{
    return data[1] & COUNTER_MASK;
}

uint8_t saddle_wire_set_number(const uint8_t data[SADDLE_WIRE_LENGTH])
{
    return (uint8_t)((uint32_t)data[1] >> ROUND_SHIFT << COUNTER_BITS) | (data[1] & COUNTER_MASK);
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
    case MESSAGE_COMMAND: return SADDLE_WIRE_COMMAND;
    case MESSAGE_COMMAND_CODE: return SADDLE_WIRE_COMMAND_CODE;
    case MESSAGE_MEASURED_TIME: return SADDLE_WIRE_MEASURED_TIME;
    case MESSAGE_MEASURED_COM: return SADDLE_WIRE_MEASURED_COM;
    case MESSAGE_MEASURED_LEFT: return SADDLE_WIRE_MEASURED_LEFT;
    case MESSAGE_MEASURED_RIGHT: return SADDLE_WIRE_MEASURED_RIGHT;
    case MESSAGE_SENSED_GYRO: return SADDLE_WIRE_SENSED_GYRO;
    case MESSAGE_SENSED_ACCELEROMETER: return SADDLE_WIRE_SENSED_ACCELEROMETER;
    case MESSAGE_SENSED_LOADS: return SADDLE_WIRE_SENSED_LOADS;
    case MESSAGE_SENSED_LEFT_HIP: return SADDLE_WIRE_SENSED_LEFT_HIP;
    case MESSAGE_SENSED_LEFT_LEG: return SADDLE_WIRE_SENSED_LEFT_LEG;
    case MESSAGE_SENSED_RIGHT_HIP: return SADDLE_WIRE_SENSED_RIGHT_HIP;
    case MESSAGE_SENSED_RIGHT_LEG: return SADDLE_WIRE_SENSED_RIGHT_LEG;
    default: return SADDLE_WIRE_NONE;
    }
}

static bool speaks_our_version(saddle_wire_receiver_t *receiver, uint64_t command)
{
    const uint32_t version = CODE_IN(COMMAND_WIRE_VERSION, command);
    if (version != SADDLE_WIRE_VERSION) {
        receiver->other_version = (uint8_t)version;
    }
    return version >= SADDLE_WIRE_OLDEST_VERSION && version <= SADDLE_WIRE_VERSION;
}

/** One block for the cipher: the session, its freshness, and the frame with its identifier. */
static uint32_t code_of(const saddle_cmac_key_t *key, uint32_t session, uint16_t freshness,
                        uint32_t id, const uint8_t *data)
{
    uint8_t bytes[SADDLE_CMAC_LENGTH] = {(uint8_t)session,
                                         (uint8_t)(session >> 8),
                                         (uint8_t)(session >> 16),
                                         (uint8_t)(session >> 24),
                                         (uint8_t)freshness,
                                         (uint8_t)(freshness >> 8),
                                         (uint8_t)id,
                                         (uint8_t)(id >> 8)};
    uint8_t code[SADDLE_CMAC_LENGTH];
    for (size_t i = 0; i < SADDLE_WIRE_LENGTH; ++i) {
        bytes[8u + i] = data[i];
    }
    saddle_cmac(key, bytes, sizeof bytes, code);
    return (uint32_t)code[0] << 24 | (uint32_t)code[1] << 16 | (uint32_t)code[2] << 8 | code[3];
}

/** A code is checked once. */
static bool is_authentic(saddle_wire_guard_t *guard, const uint8_t *command)
{
    if (!guard->required || !guard->waits) {
        return !guard->required;
    }
    guard->waits = false;
    const uint64_t code = saddle_frame_bits(guard->frame);
    const uint16_t freshness = (uint16_t)CODE_IN(COMMAND_CODE_FRESHNESS, code);
    if (!guard->opened || freshness <= guard->freshness ||
        CODE_IN(COMMAND_CODE_CODE, code) !=
            code_of(&guard->key, guard->session, freshness, MESSAGE_COMMAND, command)) {
        return false;
    }
    guard->freshness = freshness;
    return true;
}

/** The code of a MEASURED_TIME: over all of the frame but its CRC and the code itself. */
static uint32_t code_of_time(const saddle_cmac_key_t *key, uint32_t session, const uint8_t *data)
{
    const uint8_t covered[SADDLE_WIRE_LENGTH] = {0,       data[1], data[2], data[3],
                                                 data[4], data[5], 0,       0};
    return code_of(key, session, 0, MESSAGE_MEASURED_TIME, covered) >> 16;
}

/** Its time is its freshness: within a session it rises. Until the sender has heard of a new session
 *  its times are those of the session before. */
static bool is_authentic_time(saddle_wire_guard_t *guard, const uint8_t *data)
{
    if (!guard->required || !guard->opened) {
        return !guard->required;
    }
    const uint32_t time_us = saddle_wire_decode_time(data);
    const uint32_t code = CODE_IN(MEASURED_TIME_CODE, saddle_frame_bits(data));
    const bool later = (int32_t)(time_us - guard->time_us) > 0;
    if (code == code_of_time(&guard->key, guard->session, data)) {
        if (guard->timed && !later) {
            return false;
        }
        guard->timed = true;
    } else if (guard->timed || !guard->timed_before || !later ||
               code != code_of_time(&guard->key, guard->session_before, data)) {
        return false;
    }
    guard->time_us = time_us;
    return true;
}

static void keep_code(saddle_wire_guard_t *guard, const uint8_t *data)
{
    guard->waits = true;
    for (size_t i = 0; i < SADDLE_WIRE_LENGTH; ++i) {
        guard->frame[i] = data[i];
    }
}

/** The count that a frame of this message moves. */
static uint32_t *count_of(saddle_wire_receiver_t *receiver, saddle_wire_message_t message,
                          uint32_t id, const uint8_t *data)
{
    const uint64_t bits = saddle_frame_bits(data);
    const bool commands = message == SADDLE_WIRE_COMMAND;
    if ((bits & 0xFFu) != saddle_frame_crc(crc_of_id(id), bits)) {
        return &receiver->bad_crc;
    }
    if (commands && !speaks_our_version(receiver, bits)) {
        return &receiver->bad_version;
    }
    if ((commands && !is_authentic(&receiver->guard, data)) ||
        (message == SADDLE_WIRE_MEASURED_TIME && !is_authentic_time(&receiver->guard, data))) {
        return &receiver->bad_code;
    }
    if (!in_step(&receiver->alive[message], saddle_wire_counter(data))) {
        return &receiver->bad_counter;
    }
    return &receiver->accepted;
}

saddle_wire_message_t saddle_wire_accept(saddle_wire_receiver_t *receiver, uint32_t id,
                                         const uint8_t *data, size_t length)
{
    const saddle_wire_message_t message = message_of(id);
    if (length != SADDLE_WIRE_LENGTH || message == SADDLE_WIRE_NONE) {
        ++receiver->malformed;
        return SADDLE_WIRE_NONE;
    }
    uint32_t *count = count_of(receiver, message, id, data);
    ++*count;
    if (count != &receiver->accepted) {
        return SADDLE_WIRE_NONE;
    }
    if (message == SADDLE_WIRE_COMMAND_CODE) {
        keep_code(&receiver->guard, data);
    }
    return message;
}

void saddle_wire_decode_command(const uint8_t data[SADDLE_WIRE_LENGTH], saddle_command_t *command)
{
    const uint64_t bits = saddle_frame_bits(data);
    command->mode = (uint8_t)CODE_IN(COMMAND_MODE, bits);
    command->speed_m_s = NUMBER_IN(COMMAND_SPEED, bits);
    command->heel_strike_rad = NUMBER_IN(COMMAND_HEEL_STRIKE, bits);
    command->turn_rate_rad_s = SHORT_NUMBER_IN(COMMAND_TURN_RATE, bits);
}

uint32_t saddle_wire_decode_time(const uint8_t data[SADDLE_WIRE_LENGTH])
{
    return CODE_IN(MEASURED_TIME_TIME, saddle_frame_bits(data));
}

static void decode_com(uint64_t bits, saddle_measurement_t *measurement)
{
    measurement->com.height_m = NUMBER_IN(MEASURED_COM_HEIGHT, bits);
    measurement->com.velocity_m_s.x = NUMBER_IN(MEASURED_COM_VX, bits);
    measurement->com.velocity_m_s.y = NUMBER_IN(MEASURED_COM_VY, bits);
}

static void decode_left(uint64_t bits, saddle_measurement_t *measurement)
{
    measurement->foot[SADDLE_LEFT].cop_m.x = NUMBER_IN(MEASURED_LEFT_X, bits);
    measurement->foot[SADDLE_LEFT].cop_m.y = NUMBER_IN(MEASURED_LEFT_Y, bits);
    measurement->foot[SADDLE_LEFT].ground_m_s = NUMBER_IN(MEASURED_LEFT_GROUND, bits);
    measurement->foot[SADDLE_LEFT].contact = CODE_IN(MEASURED_LEFT_CONTACT, bits) != 0u;
}

static void decode_right(uint64_t bits, saddle_measurement_t *measurement)
{
    measurement->foot[SADDLE_RIGHT].cop_m.x = NUMBER_IN(MEASURED_RIGHT_X, bits);
    measurement->foot[SADDLE_RIGHT].cop_m.y = NUMBER_IN(MEASURED_RIGHT_Y, bits);
    measurement->foot[SADDLE_RIGHT].ground_m_s = NUMBER_IN(MEASURED_RIGHT_GROUND, bits);
    measurement->foot[SADDLE_RIGHT].contact = CODE_IN(MEASURED_RIGHT_CONTACT, bits) != 0u;
}

void saddle_wire_decode_measured(saddle_wire_message_t message,
                                 const uint8_t data[SADDLE_WIRE_LENGTH],
                                 saddle_measurement_t *measurement)
{
    if (message == SADDLE_WIRE_MEASURED_COM) {
        decode_com(saddle_frame_bits(data), measurement);
    } else if (message == SADDLE_WIRE_MEASURED_LEFT) {
        decode_left(saddle_frame_bits(data), measurement);
    } else if (message == SADDLE_WIRE_MEASURED_RIGHT) {
        decode_right(saddle_frame_bits(data), measurement);
    }
}

static void encode_com_plan(const saddle_plan_t *plan, uint8_t counter, saddle_frame_t *frames)
{
    const bool valid = plan->valid;
    ENCODE(&frames[0], PLAN_COM, counter,
           NUMBER(PLAN_COM_X, valid, plan->com_m.x) | NUMBER(PLAN_COM_Y, valid, plan->com_m.y) |
               NUMBER(PLAN_COM_Z, valid, plan->com_m.z));
    ENCODE(&frames[1], PLAN_COM_VELOCITY, counter,
           NUMBER(PLAN_COM_VELOCITY_VX, valid, plan->com_velocity_m_s.x) |
               NUMBER(PLAN_COM_VELOCITY_VY, valid, plan->com_velocity_m_s.y) |
               NUMBER(PLAN_COM_VELOCITY_VZ, valid, plan->com_velocity_m_s.z));
}

static void encode_feet_plan(const saddle_plan_t *plan, uint8_t counter, saddle_frame_t *frames)
{
    const bool valid = plan->valid;
    const saddle_vec3_t left_m = plan->foot_m[SADDLE_LEFT];
    const saddle_vec3_t right_m = plan->foot_m[SADDLE_RIGHT];
    ENCODE(&frames[0], PLAN_LEFT, counter,
           NUMBER(PLAN_LEFT_X, valid, left_m.x) | NUMBER(PLAN_LEFT_Y, valid, left_m.y) |
               NUMBER(PLAN_LEFT_Z, valid, left_m.z));
    ENCODE(&frames[1], PLAN_RIGHT, counter,
           NUMBER(PLAN_RIGHT_X, valid, right_m.x) | NUMBER(PLAN_RIGHT_Y, valid, right_m.y) |
               NUMBER(PLAN_RIGHT_Z, valid, right_m.z));
    ENCODE(&frames[2], PLAN_SWING, counter,
           NUMBER(PLAN_SWING_VX, valid, plan->swing_velocity_m_s.x) |
               NUMBER(PLAN_SWING_VY, valid, plan->swing_velocity_m_s.y) |
               NUMBER(PLAN_SWING_VZ, valid, plan->swing_velocity_m_s.z));
}

static void encode_step_plan(const saddle_plan_t *plan, uint8_t counter, saddle_frame_t *frames)
{
    const bool valid = plan->valid;
    ENCODE(&frames[0], PLAN_LANDING, counter,
           NUMBER(PLAN_LANDING_X, valid, plan->landing_m.x) |
               NUMBER(PLAN_LANDING_Y, valid, plan->landing_m.y) |
               NUMBER(PLAN_LANDING_LEG_LENGTH, valid, plan->leg_length_m));
    ENCODE(&frames[1], PLAN_ANKLE, counter,
           NUMBER(PLAN_ANKLE_TOE_OFF, valid, plan->toe_off_rad) |
               NUMBER(PLAN_ANKLE_HEEL_STRIKE, valid, plan->heel_strike_rad) |
               NUMBER(PLAN_ANKLE_SPEED, valid, plan->speed_m_s));
    ENCODE(&frames[2], PLAN_STEP, counter,
           CODE(PLAN_STEP_VALID, valid) | CODE(PLAN_STEP_SUPPORT, plan->support) |
               CODE(PLAN_STEP_PHASE, plan->phase) |
               NUMBER(PLAN_STEP_THETA, valid, plan->theta_rad) |
               NUMBER(PLAN_STEP_STEP_LENGTH, valid, plan->step_length_m) |
               CODE(PLAN_STEP_STEP_COUNT, plan->step_count));
}

static void encode_events_plan(const saddle_plan_t *plan, uint8_t counter, saddle_frame_t *frames)
{
    const bool valid = plan->valid;
    ENCODE(&frames[0], PLAN_EVENTS, counter,
           CODE(PLAN_EVENTS_MODE, plan->mode) |
               NUMBER(PLAN_EVENTS_TIME_TO_VIA_POINT, valid, plan->time_to_via_point_s) |
               NUMBER(PLAN_EVENTS_TIME_TO_HEEL_STRIKE, valid, plan->time_to_heel_strike_s) |
               NUMBER(PLAN_EVENTS_TIME_TO_TOE_OFF, valid, plan->time_to_toe_off_s));
    ENCODE(&frames[1], PLAN_PITCH, counter,
           NUMBER(PLAN_PITCH_LEFT, valid, plan->foot_pitch_rad[SADDLE_LEFT]) |
               NUMBER(PLAN_PITCH_RIGHT, valid, plan->foot_pitch_rad[SADDLE_RIGHT]) |
               NUMBER(PLAN_PITCH_KNEE_FLEXION, valid, plan->knee_flexion_m));
}

static void encode_reference(const saddle_plan_t *plan, uint8_t counter, saddle_frame_t *frames)
{
    const bool valid = plan->valid;
    const saddle_reference_t *reference = &plan->reference;
    ENCODE(&frames[0], PLAN_REFERENCE_XCOM, counter,
           NUMBER(PLAN_REFERENCE_XCOM_X, valid, reference->xcom_m.x) |
               NUMBER(PLAN_REFERENCE_XCOM_Y, valid, reference->xcom_m.y) |
               NUMBER(PLAN_REFERENCE_XCOM_LOAD_LEFT, valid, reference->load[SADDLE_LEFT]));
    ENCODE(&frames[1], PLAN_REFERENCE_COP, counter,
           NUMBER(PLAN_REFERENCE_COP_X, valid, reference->cop_m.x) |
               NUMBER(PLAN_REFERENCE_COP_Y, valid, reference->cop_m.y) |
               NUMBER(PLAN_REFERENCE_COP_LOAD_RIGHT, valid, reference->load[SADDLE_RIGHT]));
    ENCODE(&frames[2], PLAN_REFERENCE_COM, counter,
           NUMBER(PLAN_REFERENCE_COM_X, valid, reference->com_m.x) |
               NUMBER(PLAN_REFERENCE_COM_Y, valid, reference->com_m.y) |
               NUMBER(PLAN_REFERENCE_COM_RATE, valid, plan->acceleration_m_s2));
    ENCODE(&frames[3], PLAN_LAST_STEP, counter,
           NUMBER(PLAN_LAST_STEP_X, valid, plan->last_step_m.x) |
               NUMBER(PLAN_LAST_STEP_Y, valid, plan->last_step_m.y) |
               NUMBER(PLAN_LAST_STEP_WIDTH, valid, plan->step_width_m));
}

static void encode_way(const saddle_plan_t *plan, uint8_t counter, saddle_frame_t *frames)
{
    const bool valid = plan->valid;
    ENCODE(&frames[0], PLAN_WAY, counter,
           NUMBER(PLAN_WAY_HEADING, valid, plan->heading_rad) |
               NUMBER(PLAN_WAY_CURVATURE_BEHIND, valid, plan->curvature_1_m[0]) |
               NUMBER(PLAN_WAY_CURVATURE_AHEAD, valid, plan->curvature_1_m[1]));
    ENCODE(&frames[1], PLAN_YAW, counter,
           NUMBER(PLAN_YAW_LEFT, valid, plan->foot_yaw_rad[SADDLE_LEFT]) |
               NUMBER(PLAN_YAW_RIGHT, valid, plan->foot_yaw_rad[SADDLE_RIGHT]) |
               NUMBER(PLAN_YAW_PELVIS, valid, plan->pelvis_yaw_rad));
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
    ENCODE(&frames[0], SCORES_STEP, counter,
           NUMBER(SCORES_STEP_S_PEND, step, scores->s_pend) |
               NUMBER(SCORES_STEP_S_JUMP, step, scores->s_jump) |
               NUMBER(SCORES_STEP_S_SW, holds(scores, SADDLE_VALID_S_SW), scores->s_sw));
    ENCODE(
        &frames[1], SCORES_MARGIN, counter,
        NUMBER(SCORES_MARGIN_MOS_COM, holds(scores, SADDLE_VALID_MOS_COM), scores->mos_com_m) |
            NUMBER(SCORES_MARGIN_MOS_XCOM, holds(scores, SADDLE_VALID_MOS_XCOM),
                   scores->mos_xcom_m) |
            NUMBER(SCORES_MARGIN_V_COMP, holds(scores, SADDLE_VALID_V_COMP), scores->v_comp_m_s));
    ENCODE(&frames[2], SCORES_FORCE, counter,
           NUMBER(SCORES_FORCE_GRAVITY_X, gravity, scores->gravity_n.x) |
               NUMBER(SCORES_FORCE_GRAVITY_Y, gravity, scores->gravity_n.y) |
               CODE(SCORES_FORCE_FAULTS, faults));
}

static void encode_foresight(const saddle_scores_t *scores, const saddle_verdict_t *verdict,
                             uint8_t counter, saddle_frame_t *frames)
{
    const bool stop = holds(scores, SADDLE_VALID_STOP);
    const bool compared = verdict->compared;
    const bool track = stop && compared;
    ENCODE(&frames[0], SCORES_ENERGY, counter,
           CODE(SCORES_ENERGY_CAN_STOP, scores->can_stop) |
               CODE(SCORES_ENERGY_ON_TRACK, verdict->on_track) |
               CODE(SCORES_ENERGY_PAPER_STABLE, scores->paper_stable) |
               NUMBER(SCORES_ENERGY_EXCESS_STOP, stop, scores->excess_stop_j) |
               NUMBER(SCORES_ENERGY_EXCESS_TRACK, track, verdict->excess_track_j));
    ENCODE(&frames[1], SCORES_EXPECTED, counter,
           NUMBER(SCORES_EXPECTED_EBOS_COM, compared, verdict->ebos_com_m) |
               NUMBER(SCORES_EXPECTED_EBOS_XCOM, compared, verdict->ebos_xcom_m));
}

static void encode_verdict(const saddle_verdict_t *verdict, uint8_t counter, saddle_frame_t *frames)
{
    const bool compared = verdict->compared;
    const saddle_vec2_t deviation_m = verdict->xcom_deviation_m;
    const saddle_recovery_t *recovery = &verdict->recovery;
    const bool landing = compared && recovery->found;
    ENCODE(&frames[0], VERDICT, counter,
           CODE(VERDICT_COMPARED, compared) | CODE(VERDICT_LEVEL, verdict->level) |
               CODE(VERDICT_REASON, verdict->reason) |
               NUMBER(VERDICT_XCOM_DEVIATION_X, compared, deviation_m.x) |
               NUMBER(VERDICT_XCOM_DEVIATION_Y, compared, deviation_m.y));
    ENCODE(&frames[1], RECOVERY, counter,
           CODE(RECOVERY_FOUND, recovery->found) | CODE(RECOVERY_STOPS, recovery->stops) |
               CODE(RECOVERY_FOOT, recovery->foot) |
               NUMBER(RECOVERY_X, landing, recovery->landing_m.x) |
               NUMBER(RECOVERY_Y, landing, recovery->landing_m.y) |
               NUMBER(RECOVERY_MARGIN, compared, recovery->margin_m));
}

static void encode_balance(const saddle_verdict_t *verdict, uint8_t counter, saddle_frame_t *frame)
{
    const bool known = verdict->margin_known;
    ENCODE(frame, BALANCE, counter,
           CODE(BALANCE_DRIVER, verdict->driver) |
               NUMBER(BALANCE_BALANCE_MARGIN, known, verdict->margin) |
               NUMBER(BALANCE_CAUTION_BELOW, known, verdict->caution_below));
}

static void encode_learned_walk(const saddle_learned_walk_t *walk, uint8_t counter,
                                saddle_frame_t *frames)
{
    const bool measured = walk->height_m > 0.0f;
    const bool stepped = walk->step_time_s > 0.0f;
    ENCODE(&frames[0], LEARNED_MEAN, counter,
           NUMBER(LEARNED_MEAN_VX, measured, walk->velocity_m_s.x) |
               NUMBER(LEARNED_MEAN_VY, measured, walk->velocity_m_s.y) |
               NUMBER(LEARNED_MEAN_HEIGHT, measured, walk->height_m));
    ENCODE(&frames[1], LEARNED_STEP, counter,
           NUMBER(LEARNED_STEP_TIME, stepped, walk->step_time_s) |
               NUMBER(LEARNED_STEP_LENGTH, stepped, walk->step_length_m) |
               NUMBER(LEARNED_STEP_WIDTH, stepped, walk->step_width_m));
    ENCODE(&frames[2], LEARNED_STEADINESS, counter,
           NUMBER(LEARNED_STEADINESS_RIPPLE, walk->ripple > 0.0f, walk->ripple) |
               NUMBER(LEARNED_STEADINESS_STEP_MARGIN, stepped, walk->step_margin));
}

static void encode_process(const saddle_wire_health_t *health, uint8_t counter,
                           saddle_frame_t *frames)
{
    const uint32_t *const age_us = health->input_age_us;
    ENCODE(&frames[0], TIMING, counter,
           NUMBER(TIMING_PERIOD, true, seconds(health->period_us)) |
               NUMBER(TIMING_LATENCY, true, seconds(health->latency_us)) |
               NUMBER(TIMING_LATENCY_MAX, true, seconds(health->latency_max_us)));
    ENCODE(&frames[1], RECEIVED, counter,
           CODE(RECEIVED_MALFORMED, limited(health->malformed, UINT8_MAX)) |
               CODE(RECEIVED_BAD_CRC, limited(health->bad_crc, UINT8_MAX)) |
               CODE(RECEIVED_BAD_VERSION, limited(health->bad_version, UINT8_MAX)) |
               CODE(RECEIVED_BAD_COUNTER, limited(health->bad_counter, UINT8_MAX)) |
               CODE(RECEIVED_ACCEPTED, health->accepted));
    ENCODE(&frames[2], INPUTS, counter,
           CODE(INPUTS_COMMAND_SOURCE, health->command_source) |
               CODE(INPUTS_SENDER_CLOCK, health->sender_clock) |
               CODE(INPUTS_MEASURED_BY, health->by_sensors) |
               CODE(INPUTS_COMMAND_AGE, age_ms(age_us[SADDLE_WIRE_COMMAND])) |
               CODE(INPUTS_COM_AGE, age_ms(age_us[SADDLE_WIRE_MEASURED_COM])) |
               CODE(INPUTS_LEFT_AGE, age_ms(age_us[SADDLE_WIRE_MEASURED_LEFT])) |
               CODE(INPUTS_RIGHT_AGE, age_ms(age_us[SADDLE_WIRE_MEASURED_RIGHT])));
}

static void encode_health(const saddle_output_t *output, const saddle_wire_health_t *health,
                          uint8_t counter, saddle_frame_t *frame)
{
    ENCODE(frame, HEALTH, counter,
           CODE(HEALTH_STATUS, (uint8_t)output->status) |
               CODE(HEALTH_LIMITS, (uint8_t)output->limits) |
               CODE(HEALTH_WIRE_VERSION, SADDLE_WIRE_VERSION) |
               CODE(HEALTH_LATE_TICKS, limited(health->late_ticks, UINT16_MAX)) |
               CODE(HEALTH_REJECTED_FRAMES, limited(health->rejected_frames, UINT16_MAX)));
}

void saddle_wire_encode_output(const saddle_output_t *output, const saddle_wire_health_t *health,
                               uint8_t counter, saddle_frame_t frames[SADDLE_WIRE_OUTPUT_FRAMES])
{
    encode_com_plan(&output->plan, counter, &frames[0]);
    encode_feet_plan(&output->plan, counter, &frames[2]);
    encode_step_plan(&output->plan, counter, &frames[5]);
    encode_events_plan(&output->plan, counter, &frames[8]);
    encode_reference(&output->plan, counter, &frames[10]);
    encode_way(&output->plan, counter, &frames[14]);
    encode_scores(&output->scores, output->faults, counter, &frames[16]);
    encode_foresight(&output->scores, &output->verdict, counter, &frames[19]);
    encode_verdict(&output->verdict, counter, &frames[21]);
    encode_balance(&output->verdict, counter, &frames[23]);
    encode_learned_walk(&output->walk, counter, &frames[24]);
    encode_process(health, counter, &frames[27]);
    encode_health(output, health, counter, &frames[30]);
}

void saddle_wire_encode_command(const saddle_command_t *command, uint8_t counter,
                                saddle_frame_t *frame)
{
    ENCODE(frame, COMMAND, counter,
           CODE(COMMAND_MODE, limited(command->mode, 15u)) |
               NUMBER(COMMAND_SPEED, true, command->speed_m_s) |
               NUMBER(COMMAND_HEEL_STRIKE, true, command->heel_strike_rad) |
               CODE(COMMAND_WIRE_VERSION, SADDLE_WIRE_VERSION) |
               SHORT_NUMBER(COMMAND_TURN_RATE, command->turn_rate_rad_s));
}

void saddle_wire_encode_time(uint32_t sampled_us, uint8_t number, saddle_frame_t *frame)
{
    ENCODE(frame, MEASURED_TIME, number,
           CODE(MEASURED_TIME_ROUND, round_of(number)) | CODE(MEASURED_TIME_TIME, sampled_us));
}

void saddle_wire_authenticate_time(const saddle_cmac_key_t *key, uint32_t session,
                                   saddle_frame_t *frame)
{
    const uint64_t bits = saddle_frame_bits(frame->data) & UINT64_C(0x0000FFFFFFFFFF00);
    saddle_frame_seal(frame->data, crc_of_id(MESSAGE_MEASURED_TIME),
                      bits | CODE(MEASURED_TIME_CODE, code_of_time(key, session, frame->data)));
}

void saddle_wire_encode_measurement(const saddle_measurement_t *measurement, uint8_t number,
                                    saddle_frame_t frames[SADDLE_WIRE_MEASURED_FRAMES])
{
    const uint32_t round = round_of(number);
    const saddle_vec2_t left_m = measurement->foot[SADDLE_LEFT].cop_m;
    const saddle_vec2_t right_m = measurement->foot[SADDLE_RIGHT].cop_m;
    ENCODE(&frames[0], MEASURED_COM, number,
           CODE(MEASURED_COM_ROUND, round) |
               NUMBER(MEASURED_COM_HEIGHT, true, measurement->com.height_m) |
               NUMBER(MEASURED_COM_VX, true, measurement->com.velocity_m_s.x) |
               NUMBER(MEASURED_COM_VY, true, measurement->com.velocity_m_s.y));
    ENCODE(&frames[1], MEASURED_LEFT, number,
           CODE(MEASURED_LEFT_ROUND, round) |
               CODE(MEASURED_LEFT_CONTACT, measurement->foot[SADDLE_LEFT].contact) |
               NUMBER(MEASURED_LEFT_X, true, left_m.x) | NUMBER(MEASURED_LEFT_Y, true, left_m.y) |
               NUMBER(MEASURED_LEFT_GROUND, true, measurement->foot[SADDLE_LEFT].ground_m_s));
    ENCODE(&frames[2], MEASURED_RIGHT, number,
           CODE(MEASURED_RIGHT_ROUND, round) |
               CODE(MEASURED_RIGHT_CONTACT, measurement->foot[SADDLE_RIGHT].contact) |
               NUMBER(MEASURED_RIGHT_X, true, right_m.x) |
               NUMBER(MEASURED_RIGHT_Y, true, right_m.y) |
               NUMBER(MEASURED_RIGHT_GROUND, true, measurement->foot[SADDLE_RIGHT].ground_m_s));
}

void saddle_wire_require_auth(saddle_wire_receiver_t *receiver,
                              const uint8_t key[SADDLE_CMAC_LENGTH])
{
    receiver->guard.required = true;
    saddle_cmac_prepare(&receiver->guard.key, key);
}

void saddle_wire_open_session(saddle_wire_receiver_t *receiver, uint32_t session)
{
    receiver->guard.opened = true;
    receiver->guard.session_before = receiver->guard.session;
    receiver->guard.timed_before = receiver->guard.timed;
    receiver->guard.session = session;
    receiver->guard.freshness = 0;
    receiver->guard.waits = false;
    receiver->guard.timed = false;
}

/** The next commander may be new, and counts from 1. */
bool saddle_wire_session_expired(const saddle_wire_receiver_t *receiver,
                                 const saddle_output_t *output, uint32_t ticks)
{
    const saddle_wire_guard_t *guard = &receiver->guard;
    const bool stale = (output->faults & (uint32_t)SADDLE_FAULT_COMMAND_STALE) != 0u;
    const bool renewed = ticks % IDLE_SESSION_TICKS == IDLE_SESSION_TICKS - 1u;
    return guard->required && (!guard->opened || guard->freshness >= FRESHNESS_END ||
                               (stale && (guard->freshness > 0u || renewed)));
}

void saddle_wire_encode_session(const saddle_wire_receiver_t *receiver, uint8_t counter,
                                saddle_frame_t *frame)
{
    ENCODE(frame, SESSION, counter,
           CODE(SESSION_SESSION, receiver->guard.session) |
               CODE(SESSION_FRESHNESS, receiver->guard.freshness));
}

void saddle_wire_encode_code(const saddle_cmac_key_t *key, uint32_t session, uint16_t freshness,
                             const saddle_frame_t *command, saddle_frame_t *frame)
{
    ENCODE(frame, COMMAND_CODE, saddle_wire_counter(command->data),
           CODE(COMMAND_CODE_FRESHNESS, freshness) |
               CODE(COMMAND_CODE_CODE,
                    code_of(key, session, freshness, MESSAGE_COMMAND, command->data)));
}
