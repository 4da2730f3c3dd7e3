#include "joint_loop.h"

saddle_joint_loop_config_t saddle_joint_loop_default(const saddle_config_t *config)
{
    saddle_joint_loop_config_t joints = {
        .passes = 0,
        .legs = saddle_legs_default(config->body_height_m, config->body_mass_kg),
        .estimator = saddle_estimator_default(),
        .walk = saddle_joint_walk_default(),
        .drive = saddle_drive_default(),
    };
    joints.walk.double_support_share = config->double_support_share;
    return joints;
}

saddle_joint_part_t saddle_joint_part(size_t index)
{
    static const saddle_joint_part_t parts[SADDLE_JOINT_PARTS] = {
        {"legs", saddle_legs_field, offsetof(saddle_joint_loop_config_t, legs)},
        {"estimator", saddle_estimator_field, offsetof(saddle_joint_loop_config_t, estimator)},
        {"walk", saddle_joint_walk_field, offsetof(saddle_joint_loop_config_t, walk)},
        {"drive", saddle_drive_field, offsetof(saddle_joint_loop_config_t, drive)},
    };
    return parts[index % SADDLE_JOINT_PARTS];
}

static bool are_passes_whole(uint32_t passes)
{
    return passes == 0u || (passes >= SADDLE_PASSES_MIN && passes <= SADDLE_PASSES_MAX &&
                            SADDLE_TICK_US % passes == 0u);
}

const char *saddle_joint_loop_check(const saddle_joint_loop_config_t *config)
{
    const char *bad_field = are_passes_whole(config->passes) ? NULL : "passes";
    bad_field = bad_field != NULL ? bad_field : saddle_legs_check(&config->legs);
    bad_field = bad_field != NULL ? bad_field : saddle_estimator_check(&config->estimator);
    bad_field = bad_field != NULL ? bad_field : saddle_joint_walk_check(&config->walk);
    return bad_field != NULL ? bad_field : saddle_drive_check(&config->drive);
}

uint32_t saddle_joint_loop_period_us(const saddle_joint_loop_config_t *config)
{
    return config->passes == 0u ? SADDLE_TICK_US : SADDLE_TICK_US / config->passes;
}

saddle_status_t saddle_joint_loop_init(saddle_joint_loop_t *loop,
                                       const saddle_joint_loop_config_t *config)
{
    *loop = (saddle_joint_loop_t){.config = *config};
    const saddle_status_t status =
        saddle_estimator_init(&loop->estimator, &config->legs, &config->estimator);
    if (status != SADDLE_OK) {
        return status;
    }
    return saddle_joint_walk_init(&loop->walk, &config->legs, &config->walk);
}

const saddle_measurement_t *saddle_joint_loop_sense(saddle_joint_loop_t *loop,
                                                    const saddle_sensors_t *sensors)
{
    (void)saddle_estimator_update(&loop->estimator, sensors, &loop->estimate); /* faults say it */
    return &loop->estimate.measurement;
}

void saddle_joint_loop_tick(saddle_joint_loop_t *loop, const saddle_output_t *output)
{
    loop->verdict = output->verdict;
}

void saddle_joint_loop_drive(saddle_joint_loop_t *loop, const saddle_context_t *context,
                             uint64_t time_us)
{
    saddle_intent_t intent;
    (void)saddle_plan_at(context, time_us, &loop->plan); /* not valid: both feet stay */
    const saddle_joint_walk_input_t input = {
        .time_us = time_us, .plan = &loop->plan, .verdict = &loop->verdict};
    (void)saddle_joint_walk_update(&loop->walk, &input, &loop->estimate, &intent);
    saddle_joint_commands(&loop->config.legs, &loop->config.drive, &loop->estimate, &intent,
                          &loop->commands);
    loop->fallbacks += loop->commands.fallback;
}
