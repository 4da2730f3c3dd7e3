/** What every port shares and the loop of a controller, on a board that does anything: any frames,
 *  lost or sent or not, any clock. Core and joints are not run here (core.c does that for the core):
 *  their calls give any result. Read by Eva (`make prove`). */
#include "any.h"

#include <board.h>
#include <controller.h>
#include <settings.h>
#include <slcan.h>

static volatile saddle_can_frame_t any_frame;
static volatile saddle_config_t any_config;
static volatile saddle_command_t any_command;
static volatile saddle_output_t any_output;
static volatile saddle_joint_loop_config_t any_joints;
static volatile saddle_legs_t any_legs;
static volatile saddle_estimator_config_t any_estimator_config;
static volatile saddle_joint_walk_config_t any_walk_config;
static volatile saddle_drive_config_t any_drive_config;
static volatile saddle_plan_t any_plan;
static volatile saddle_estimate_t any_estimate;
static volatile saddle_intent_t any_intent;
static volatile saddle_joint_commands_t any_commands;

bool saddle_can_receive(saddle_can_frame_t *frame)
{
    *frame = any_frame;
    frame->length = any_uint8 % (SADDLE_WIRE_LENGTH + 1u);
    return any_bool();
}

uint32_t saddle_can_lost(void)
{
    return any_uint32;
}

bool saddle_can_send(const saddle_can_frame_t *frame)
{
    char line[SADDLE_SLCAN_LINE];
    (void)saddle_slcan_write(frame, line);
    return any_bool();
}

uint64_t saddle_clock_now_us(void)
{
    return any_uint64;
}

uint64_t saddle_clock_rounds(void)
{
    return any_uint64;
}

void saddle_watchdog_feed(void) {}

bool saddle_random(uint32_t *bits)
{
    *bits = any_uint32;
    return any_bool();
}

saddle_status_t saddle_init(saddle_context_t *context, const saddle_config_t *config)
{
    (void)context;
    (void)config;
    return any_bool() ? SADDLE_OK : SADDLE_ERROR_CONFIG;
}

bool saddle_command_usable(const saddle_command_t *command)
{
    (void)command;
    return any_bool();
}

saddle_status_t saddle_tick(saddle_context_t *context, const saddle_input_t *input,
                            saddle_output_t *output)
{
    (void)context;
    (void)input;
    *output = any_output;
    output->plan.valid = any_bool();
    output->scores.can_stop = any_bool();
    output->scores.paper_stable = any_bool();
    output->scores.bos.defined = any_bool();
    output->verdict.margin_known = any_bool();
    output->verdict.compared = any_bool();
    output->verdict.on_track = any_bool();
    output->verdict.recovery.found = any_bool();
    output->verdict.recovery.stops = any_bool();
    return any_bool() ? SADDLE_OK : SADDLE_ERROR_TIME;
}

/** A part of the joints' configuration has one field here, the first. */
static const saddle_config_field_t *field_at(size_t index)
{
    static const saddle_config_field_t field = {"first", 0, 0.0f, 1.0f};
    return index == 0u ? &field : NULL;
}

static const char *any_bad_field(void)
{
    return any_bool() ? "first" : NULL;
}

const saddle_config_field_t *saddle_legs_field(size_t index)
{
    return field_at(index);
}

const saddle_config_field_t *saddle_estimator_field(size_t index)
{
    return field_at(index);
}

const saddle_config_field_t *saddle_joint_walk_field(size_t index)
{
    return field_at(index);
}

const saddle_config_field_t *saddle_drive_field(size_t index)
{
    return field_at(index);
}

const char *saddle_legs_check(const saddle_legs_t *legs)
{
    (void)legs;
    return any_bad_field();
}

const char *saddle_estimator_check(const saddle_estimator_config_t *config)
{
    (void)config;
    return any_bad_field();
}

const char *saddle_joint_walk_check(const saddle_joint_walk_config_t *config)
{
    (void)config;
    return any_bad_field();
}

const char *saddle_drive_check(const saddle_drive_config_t *config)
{
    (void)config;
    return any_bad_field();
}

saddle_legs_t saddle_legs_default(float body_height_m, float body_mass_kg)
{
    (void)body_height_m;
    (void)body_mass_kg;
    return any_legs;
}

saddle_estimator_config_t saddle_estimator_default(void)
{
    return any_estimator_config;
}

saddle_joint_walk_config_t saddle_joint_walk_default(void)
{
    return any_walk_config;
}

saddle_drive_config_t saddle_drive_default(void)
{
    return any_drive_config;
}

saddle_status_t saddle_plan_at(const saddle_context_t *context, uint64_t time_us,
                               saddle_plan_t *plan)
{
    (void)context;
    (void)time_us;
    *plan = any_plan;
    plan->valid = any_bool();
    return any_bool() ? SADDLE_OK : SADDLE_ERROR_TIME;
}

saddle_status_t saddle_estimator_init(saddle_estimator_t *estimator, const saddle_legs_t *legs,
                                      const saddle_estimator_config_t *config)
{
    (void)estimator;
    (void)legs;
    (void)config;
    return any_bool() ? SADDLE_OK : SADDLE_ERROR_CONFIG;
}

saddle_status_t saddle_estimator_update(saddle_estimator_t *estimator,
                                        const saddle_sensors_t *sensors,
                                        saddle_estimate_t *estimate)
{
    (void)estimator;
    (void)sensors;
    *estimate = any_estimate;
    estimate->measurement.foot[SADDLE_LEFT].contact = any_bool();
    estimate->measurement.foot[SADDLE_RIGHT].contact = any_bool();
    return any_bool() ? SADDLE_OK : SADDLE_ERROR_UNINITIALISED;
}

saddle_status_t saddle_joint_walk_init(saddle_joint_walk_t *walk, const saddle_legs_t *legs,
                                       const saddle_joint_walk_config_t *config)
{
    (void)walk;
    (void)legs;
    (void)config;
    return any_bool() ? SADDLE_OK : SADDLE_ERROR_CONFIG;
}

saddle_status_t saddle_joint_walk_update(saddle_joint_walk_t *walk,
                                         const saddle_joint_walk_input_t *input,
                                         const saddle_estimate_t *estimate, saddle_intent_t *intent)
{
    (void)walk;
    (void)input;
    (void)estimate;
    *intent = any_intent;
    return any_bool() ? SADDLE_OK : SADDLE_ERROR_UNINITIALISED;
}

void saddle_joint_commands(const saddle_legs_t *legs, const saddle_drive_config_t *config,
                           const saddle_estimate_t *estimate, const saddle_intent_t *intent,
                           saddle_joint_commands_t *commands)
{
    (void)legs;
    (void)config;
    (void)estimate;
    (void)intent;
    *commands = any_commands;
    commands->fallback = any_bool();
}

/** A page of flash with anything in it, and a CRC that fits by chance. */
static void read_settings(saddle_settings_t *settings)
{
    static uint32_t page[128];
    for (size_t i = 0; i < 128u; ++i) {
        page[i] = any_uint32;
    }
    (void)saddle_settings_read(page, settings);
}

static void read_serial_line(void)
{
    static saddle_slcan_reader_t reader;
    saddle_can_frame_t frame = any_frame;
    (void)saddle_slcan_read(&reader, (char)any_uint8, &frame);
}

static void queue(void)
{
    static saddle_can_queue_t queue;
    saddle_can_frame_t frame = any_frame;
    (void)saddle_can_queue_put(&queue, &frame);
    (void)saddle_can_queue_take(&queue, &frame);
}

/** What the host process does to its inbox and a controller does not. */
static void host(void)
{
    static saddle_inbox_t inbox;
    saddle_inbox_init(&inbox, any_bool() ? SADDLE_SOURCE_NONE : SADDLE_SOURCE_LCM);
    while (any_bool()) {
        const saddle_command_t command = any_command;
        saddle_inbox_take_command(&inbox, SADDLE_SOURCE_LCM, any_bool() ? &command : NULL,
                                  any_uint64);
        (void)saddle_inbox_read(&inbox, any_uint64);
        saddle_inbox_release(&inbox);
    }
}

int main(void)
{
    static saddle_controller_t controller;
    static saddle_settings_t settings;
    settings.config = any_config;
    settings.joints = any_bool() ? any_joints : saddle_joint_loop_default(&settings.config);
    read_settings(&settings);
    uint8_t key[SADDLE_CMAC_LENGTH];
    for (size_t i = 0; i < SADDLE_CMAC_LENGTH; ++i) {
        key[i] = any_uint8;
    }
    (void)saddle_controller_init(&controller, &settings.config, any_bool());
    if (any_bool() && saddle_joint_loop_check(&settings.joints) == NULL) {
        (void)saddle_controller_drive_joints(&controller, &settings.joints);
    }
    if (any_bool()) {
        saddle_controller_require_codes(&controller, key);
    }
    while (any_bool()) {
        read_serial_line();
        queue();
        saddle_controller_step(&controller);
    }
    host();
    return 0;
}
