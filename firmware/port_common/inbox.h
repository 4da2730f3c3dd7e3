/**
 * The firmware's inputs: the newest command and measurement, how old each part is, and what was
 * rejected and why. Knows no bus and reads no clock.
 *
 * A command's age counts from its reception, a measurement's from when it was sampled, if the sender
 * gives that time in MEASURED_TIME; else from its reception too.
 *
 * Measured is a CoM and two feet, or by raw sensors: the port says which of the two is used. The frames
 * of the other are counted, not used.
 *
 * One source of commands has authority at a time. The commands of the other are counted, not
 * applied, even when the first goes silent: the plan then stops the walk.
 */
#ifndef SADDLEWALK_PORT_INBOX_H
#define SADDLEWALK_PORT_INBOX_H

#include "sender_clock.h"
#include <saddlewalk/saddlewalk.h>
#include <saddlewalk/wire_joints.h>

/** Same numbers as in status_t. */
typedef enum {
    SADDLE_SOURCE_NONE = 0, /**< when chosen: the first source that commands */
    SADDLE_SOURCE_CAN = 1,
    SADDLE_SOURCE_LCM = 2
} saddle_source_t;

typedef struct {
    saddle_source_t chosen; /**< the only one that may command; NONE: see saddle_inbox_release() */
    saddle_source_t authority; /**< the source that commands now */
    saddle_input_t input;      /**< ages as of the last saddle_inbox_read() */
    bool by_sensors;           /**< set by the port: measured by SENSED frames, which an estimator
                                    makes input.measurement of; else by MEASURED ones */
    saddle_sensors_t sensors;  /**< ages as of the last saddle_inbox_sense() */
    saddle_wire_receiver_t receiver;
    saddle_sender_clock_t clock;
    bool lockstep;        /**< set by the port: what came is of age 0, whatever its time is */
    bool sender_clock;    /**< the last measurement's age counts from when it was sampled */
    uint32_t frames_late; /**< measured before what is held, or too long ago to know when */
    uint64_t age_from_us[SADDLE_WIRE_MESSAGE_COUNT]; /**< from when its age counts */
    uint64_t contact_from_us[2]; /**< of each foot: when its contact was first what it is */
    uint32_t frames_unused;      /**< of the kind that by_sensors excludes */
    uint32_t came;               /**< bits of the messages received so far */
    uint32_t set;                /**< bits of the messages with set_counter since the last read */
    uint8_t set_counter;
    uint32_t commands_applied;
    uint32_t commands_unusable; /**< unknown mode, non-finite number, or not a command_t */
    uint32_t commands_ignored;  /**< from the source without authority */
    uint32_t commands_foreign;  /**< by LCM from another machine, if that is not accepted */
} saddle_inbox_t;

/** Initialise it empty. chosen: see saddle_inbox_t. */
void saddle_inbox_init(saddle_inbox_t *inbox, saddle_source_t chosen);

/** Process a frame received from CAN at time_us. */
void saddle_inbox_take_frame(saddle_inbox_t *inbox, uint32_t id, const uint8_t *data, size_t length,
                             uint64_t time_us);

/** Process a command; NULL: an invalid message. An unusable command does not gain authority. */
void saddle_inbox_take_command(saddle_inbox_t *inbox, saddle_source_t source,
                               const saddle_command_t *command, uint64_t time_us);

/** All measurements of one instant were received since the last read, or sense where they are by
 *  sensors. */
bool saddle_inbox_set_complete(const saddle_inbox_t *inbox);

/** The input of a tick at time_us, with the age of each part at that time. By sensors: with the
 *  measurement as it is. */
const saddle_input_t *saddle_inbox_read(saddle_inbox_t *inbox, uint64_t time_us);

/** The sensors at time_us, with the age of each part at that time. */
const saddle_sensors_t *saddle_inbox_sense(saddle_inbox_t *inbox, uint64_t time_us);

/** If the first source that commands has authority: release it for the next one that commands.
 *  For use when the walk has ended and commands are stale. */
void saddle_inbox_release(saddle_inbox_t *inbox);

/** Rejected frames and commands. */
uint32_t saddle_inbox_rejected(const saddle_inbox_t *inbox);

#endif
