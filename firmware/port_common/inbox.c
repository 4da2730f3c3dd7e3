#include "inbox.h"

#include "timing.h"

#define MEASURED_SET                                                    \
    (1u << SADDLE_WIRE_MEASURED_COM | 1u << SADDLE_WIRE_MEASURED_LEFT | \
     1u << SADDLE_WIRE_MEASURED_RIGHT)
#define SENSED_SET                                                            \
    (1u << SADDLE_WIRE_SENSED_GYRO | 1u << SADDLE_WIRE_SENSED_ACCELEROMETER | \
     1u << SADDLE_WIRE_SENSED_LOADS | 1u << SADDLE_WIRE_SENSED_LEFT_HIP |     \
     1u << SADDLE_WIRE_SENSED_LEFT_LEG | 1u << SADDLE_WIRE_SENSED_RIGHT_HIP | \
     1u << SADDLE_WIRE_SENSED_RIGHT_LEG)

/** Ticks and times of sets do not come so far apart. */
#define GAP_US (SADDLE_TICK_US * 3u / 2u)

void saddle_inbox_init(saddle_inbox_t *inbox, saddle_source_t chosen)
{
    *inbox = (saddle_inbox_t){.chosen = chosen, .authority = chosen};
}

static void note_age(saddle_inbox_t *inbox, saddle_wire_message_t message, uint64_t time_us)
{
    inbox->age_from_us[message] = time_us;
    inbox->came |= 1u << message;
}

void saddle_inbox_take_command(saddle_inbox_t *inbox, saddle_source_t source,
                               const saddle_command_t *command, uint64_t time_us)
{
    if (inbox->authority != SADDLE_SOURCE_NONE && inbox->authority != source) {
        ++inbox->commands_ignored;
    } else if (command == NULL || !saddle_command_usable(command)) {
        ++inbox->commands_unusable;
    } else {
        inbox->authority = source;
        inbox->input.command = *command;
        ++inbox->commands_applied;
        note_age(inbox, SADDLE_WIRE_COMMAND, time_us);
    }
}

static bool is_gap(uint64_t from_us, uint64_t to_us)
{
    return to_us > from_us && to_us - from_us > GAP_US;
}

/** Without a tick and without a time our own clock jumped: the frames of a process that stood wait for
 *  it, with the times of their reception. */
static void take_time(saddle_inbox_t *inbox, const uint8_t *data, uint64_t time_us)
{
    if (is_gap(inbox->input.time_us, time_us) && is_gap(inbox->clock.heard_us, time_us)) {
        saddle_sender_clock_forget(&inbox->clock);
    }
    saddle_sender_clock_take(&inbox->clock, saddle_wire_set_number(data),
                             saddle_wire_decode_time(data), time_us);
}

/** From when the age of what came at time_us counts. False: it is of no use. */
static bool is_newer(saddle_inbox_t *inbox, saddle_wire_message_t message, const uint8_t *data,
                     uint64_t time_us, uint64_t *age_from_us)
{
    *age_from_us = time_us;
    inbox->sender_clock = !inbox->lockstep && saddle_sender_clock_runs(&inbox->clock, time_us);
    if (!inbox->sender_clock) {
        return true;
    }
    const bool known = saddle_sender_clock_sampled(&inbox->clock, saddle_wire_set_number(data),
                                                   time_us, age_from_us);
    const uint64_t held_us = inbox->age_from_us[message];
    return known && (*age_from_us >= held_us || held_us > time_us);
}

/** The set that the port uses. */
static uint32_t set_of(const saddle_inbox_t *inbox)
{
    return inbox->by_sensors ? SENSED_SET : MEASURED_SET;
}

/** When each foot came down or left the ground, to the time between two sets. */
static void follow_contact(saddle_inbox_t *inbox, saddle_side_t side, bool was_in_contact,
                           uint64_t sampled_us)
{
    saddle_measured_foot_t *foot = &inbox->input.measurement.foot[side];
    uint64_t *from_us = &inbox->contact_from_us[side];
    if (foot->contact != was_in_contact || *from_us == 0u || *from_us > sampled_us) {
        *from_us = sampled_us;
    }
    const uint64_t since_us = sampled_us - *from_us;
    foot->since_us = since_us < UINT32_MAX ? (uint32_t)since_us : UINT32_MAX;
}

static void take_measured(saddle_inbox_t *inbox, saddle_wire_message_t message, const uint8_t *data,
                          uint64_t time_us)
{
    const uint8_t counter = saddle_wire_counter(data);
    uint64_t age_from_us;
    if ((set_of(inbox) & 1u << message) == 0u) {
        ++inbox->frames_unused;
        return;
    }
    if (!is_newer(inbox, message, data, time_us, &age_from_us)) {
        ++inbox->frames_late;
        return;
    }
    const saddle_side_t side = message == SADDLE_WIRE_MEASURED_LEFT ? SADDLE_LEFT : SADDLE_RIGHT;
    const bool was_in_contact = inbox->input.measurement.foot[side].contact;
    saddle_wire_decode_measured(message, data, &inbox->input.measurement);
    saddle_wire_decode_sensors(message, data, &inbox->sensors);
    if (message == SADDLE_WIRE_MEASURED_LEFT || message == SADDLE_WIRE_MEASURED_RIGHT) {
        follow_contact(inbox, side, was_in_contact, age_from_us);
    }
    note_age(inbox, message, age_from_us);
    if (counter != inbox->set_counter) {
        inbox->set = 0;
        inbox->set_counter = counter;
    }
    inbox->set |= 1u << message;
}

void saddle_inbox_take_frame(saddle_inbox_t *inbox, uint32_t id, const uint8_t *data, size_t length,
                             uint64_t time_us)
{
    const saddle_wire_message_t message = saddle_wire_accept(&inbox->receiver, id, data, length);
    if (message == SADDLE_WIRE_COMMAND) {
        saddle_command_t command;
        saddle_wire_decode_command(data, &command);
        saddle_inbox_take_command(inbox, SADDLE_SOURCE_CAN, &command, time_us);
    } else if (message == SADDLE_WIRE_MEASURED_TIME) {
        take_time(inbox, data, time_us);
    } else if (message != SADDLE_WIRE_NONE && message != SADDLE_WIRE_COMMAND_CODE) {
        take_measured(inbox, message, data, time_us);
    }
}

bool saddle_inbox_set_complete(const saddle_inbox_t *inbox)
{
    return inbox->set == set_of(inbox);
}

static uint32_t age_us(const saddle_inbox_t *inbox, saddle_wire_message_t message, uint64_t time_us)
{
    if ((inbox->came & 1u << message) == 0u) {
        return SADDLE_AGE_NEVER_US;
    }
    const uint64_t age_from_us = inbox->age_from_us[message];
    const uint64_t age = time_us > age_from_us ? time_us - age_from_us : 0;
    return age < SADDLE_AGE_NEVER_US ? (uint32_t)age : SADDLE_AGE_NEVER_US - 1u;
}

const saddle_input_t *saddle_inbox_read(saddle_inbox_t *inbox, uint64_t time_us)
{
    saddle_input_t *input = &inbox->input;
    saddle_measurement_t *measurement = &input->measurement;
    input->time_us = time_us;
    input->command_age_us = age_us(inbox, SADDLE_WIRE_COMMAND, time_us);
    if (inbox->by_sensors) {
        return input;
    }
    measurement->com.age_us = age_us(inbox, SADDLE_WIRE_MEASURED_COM, time_us);
    measurement->foot[SADDLE_LEFT].age_us = age_us(inbox, SADDLE_WIRE_MEASURED_LEFT, time_us);
    measurement->foot[SADDLE_RIGHT].age_us = age_us(inbox, SADDLE_WIRE_MEASURED_RIGHT, time_us);
    inbox->set = 0;
    return input;
}

/** Of two frames the older. */
static uint32_t age_of_both_us(const saddle_inbox_t *inbox, saddle_wire_message_t one,
                               saddle_wire_message_t other, uint64_t time_us)
{
    const uint32_t one_us = age_us(inbox, one, time_us);
    const uint32_t other_us = age_us(inbox, other, time_us);
    return one_us > other_us ? one_us : other_us;
}

const saddle_sensors_t *saddle_inbox_sense(saddle_inbox_t *inbox, uint64_t time_us)
{
    saddle_sensors_t *sensors = &inbox->sensors;
    sensors->time_us = time_us;
    sensors->imu_age_us =
        age_of_both_us(inbox, SADDLE_WIRE_SENSED_GYRO, SADDLE_WIRE_SENSED_ACCELEROMETER, time_us);
    sensors->joints_age_us[SADDLE_LEFT] =
        age_of_both_us(inbox, SADDLE_WIRE_SENSED_LEFT_HIP, SADDLE_WIRE_SENSED_LEFT_LEG, time_us);
    sensors->joints_age_us[SADDLE_RIGHT] =
        age_of_both_us(inbox, SADDLE_WIRE_SENSED_RIGHT_HIP, SADDLE_WIRE_SENSED_RIGHT_LEG, time_us);
    sensors->load_age_us[SADDLE_LEFT] = age_us(inbox, SADDLE_WIRE_SENSED_LOADS, time_us);
    sensors->load_age_us[SADDLE_RIGHT] = sensors->load_age_us[SADDLE_LEFT];
    inbox->set = 0;
    return sensors;
}

void saddle_inbox_release(saddle_inbox_t *inbox)
{
    inbox->authority = inbox->chosen;
}

uint32_t saddle_inbox_rejected(const saddle_inbox_t *inbox)
{
    const saddle_wire_receiver_t *receiver = &inbox->receiver;
    return inbox->frames_late + inbox->frames_unused + receiver->malformed + receiver->bad_crc +
           receiver->bad_version + receiver->bad_counter + receiver->bad_code +
           inbox->commands_unusable + inbox->commands_ignored + inbox->commands_foreign;
}
