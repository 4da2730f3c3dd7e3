#include "balance/comparison.h"
#include "balance/present.h"
#include "balance/scores.h"
#include "balance/supervisor.h"
#include "math/bytes.h"
#include "math/finite.h"
#include "math/rounding.h"
#include "math/vec2.h"
#include "model/model.h"
#include "motion/gait_cycle.h"
#include "motion/plan_output.h"
#include "motion/planner.h"
#include "motion/reference.h"
#include "motion/standing.h"
#include "sense/plausibility.h"
#include "sense/safe_state.h"

#include <saddlewalk/saddlewalk.h>

/* Nothing of such a measurement is brought forward. */
#define UNMEASURED (SADDLE_FAULTS_COM | SADDLE_FAULTS_LEFT | SADDLE_FAULTS_RIGHT)

/* Marks a context that saddle_init() has filled. */
#define INITIALISED 0x5ADD1E00u

/* The largest tick_max_s that is accepted. */
#define TICK_LIMIT_US 250000u

/* Within this a plan is followed by the step after it at most. */
#define REFERENCE_AHEAD_MAX_S 0.5f

saddle_status_t saddle_init(saddle_context_t *context, const saddle_config_t *config)
{
    if (context == NULL) {
        return SADDLE_ERROR_NULL;
    }
    saddle_clear(context, sizeof *context);
    if (!saddle_rounds_as_written()) {
        return SADDLE_ERROR_BUILD;
    }
    if (config == NULL) {
        return SADDLE_ERROR_NULL;
    }
    if (saddle_config_check(config) != NULL) {
        return SADDLE_ERROR_CONFIG;
    }
    saddle_model_init(&context->model, config);
    saddle_planner_reset(&context->planner, &context->model);
    saddle_supervisor_init(&context->supervisor, &context->model);
    context->initialised = INITIALISED;
    return SADDLE_OK;
}

static saddle_status_t check_call(const saddle_context_t *context, const saddle_input_t *input)
{
    if (context == NULL || input == NULL) {
        return SADDLE_ERROR_NULL;
    }
    if (context->initialised != INITIALISED) {
        return SADDLE_ERROR_UNINITIALISED;
    }
    if (context->ticked && input->time_us < context->last_time_us) {
        return SADDLE_ERROR_TIME;
    }
    return SADDLE_OK;
}

static uint32_t sum_us(uint32_t a_us, uint32_t b_us)
{
    return b_us < UINT32_MAX - a_us ? a_us + b_us : UINT32_MAX;
}

/* Time since the last tick, as far as the plan may advance; what it holds has aged by all of it. */
static uint32_t elapsed_us(saddle_context_t *context, uint64_t time_us, uint32_t *limits)
{
    const uint64_t since_us = context->ticked ? time_us - context->last_time_us : 0u;
    const uint32_t aged_us = since_us < UINT32_MAX ? (uint32_t)since_us : UINT32_MAX;
    const uint32_t limit_us = context->model.body.tick_max_us;
    context->last_time_us = time_us;
    context->ticked = true;
    context->command_age_us = sum_us(context->command_age_us, aged_us);
    if (aged_us > limit_us) {
        *limits |= (uint32_t)SADDLE_LIMIT_TICK_GAP;
        const float gap_s = (float)aged_us * 1.0e-6f;
        saddle_supervisor_gap(&context->supervisor, gap_s);
        saddle_safe_state_gap(&context->safe_state, &context->model, gap_s);
        return limit_us;
    }
    return aged_us;
}

/* The last usable command holds. */
static uint32_t take_command(saddle_context_t *context, const saddle_input_t *input)
{
    uint32_t faults = 0;
    if (saddle_command_usable(&input->command)) {
        context->command = input->command;
        context->command_age_us = input->command_age_us;
    } else {
        faults |= (uint32_t)SADDLE_FAULT_COMMAND;
    }
    if ((float)context->command_age_us > context->model.body.command_max_age_us) {
        faults |= (uint32_t)SADDLE_FAULT_COMMAND_STALE;
    }
    return faults;
}

/* Of the ground that carries the wearer: under the one foot that stands, else the mean. */
static float ground_speed_m_s(const saddle_measurement_t *measured)
{
    float speed_m_s[2];
    for (int side = 0; side < 2; side++) {
        const saddle_measured_foot_t *foot = &measured->foot[side];
        speed_m_s[side] = foot->age_us != SADDLE_AGE_NEVER_US ? foot->ground_m_s : 0.0f;
    }
    const bool left = measured->foot[SADDLE_LEFT].contact;
    if (left != measured->foot[SADDLE_RIGHT].contact) {
        return speed_m_s[left ? SADDLE_LEFT : SADDLE_RIGHT];
    }
    return 0.5f * (speed_m_s[SADDLE_LEFT] + speed_m_s[SADDLE_RIGHT]);
}

/* By what its sensors are late a measurement is older than its age says, and from here on the CoM's
 * velocity is that over the ground. */
static void take_measurement(const saddle_model_t *model, const saddle_measurement_t *measured,
                             saddle_measurement_t *sampled)
{
    const uint32_t latency_us = model->body.latency_us;
    saddle_copy(sampled, measured, sizeof *sampled);
    sampled->com.velocity_m_s.x -= ground_speed_m_s(measured);
    sampled->com.age_us = sum_us(measured->com.age_us, latency_us);
    for (int side = 0; side < 2; side++) {
        sampled->foot[side].age_us = sum_us(measured->foot[side].age_us, latency_us);
    }
}

/* Where the wearer is to be. */
static void read_intent(const saddle_planner_t *planner, const saddle_model_t *model,
                        const saddle_plan_t *plan, saddle_intent_t *intent)
{
    const saddle_side_t stance = (saddle_side_t)plan->support;
    const saddle_vec3_t *stance_m = &plan->foot_m[stance];
    const saddle_vec3_t *other_m = &plan->foot_m[saddle_other_side(stance)];
    intent->leads = plan->mode != (uint8_t)SADDLE_MODE_STANDING || plan->step_count > 0u;
    intent->walking = plan->speed_m_s > 0.0f;
    intent->step.speed_m_s = plan->speed_m_s;
    intent->stance_then = stance;
    if (!intent->walking) {
        intent->com.com_m.x = plan->com_m.x - (stance_m->x + 0.5f * (other_m->x - stance_m->x));
        intent->com.com_m.y = plan->com_m.y - (stance_m->y + 0.5f * (other_m->y - stance_m->y));
        intent->com.velocity_m_s.x = plan->com_velocity_m_s.x;
        intent->com.velocity_m_s.y = plan->com_velocity_m_s.y;
        intent->step.stance = stance;
        intent->step.half_behind_m = intent->step.width_behind_m = 0.0f;
        intent->step.landing_m.x = intent->step.landing_m.y = 0.0f;
        intent->place.x_m = 0.0f;
        intent->place.phase = (saddle_sin_cos_t){0.0f, 1.0f};
        intent->may_place = false;
        intent->reference_xcom_m.x = intent->reference_xcom_m.y = 0.0f;
        return;
    }
    intent->com.com_m.x = intent->com.com_m.y = 0.0f;
    intent->com.velocity_m_s.x = intent->com.velocity_m_s.y = 0.0f;
    const saddle_vec2_t landing_m = saddle_unmoved_landing_m(plan);
    intent->step.stance = stance;
    intent->step.half_behind_m = 0.5f * plan->step_length_m;
    intent->step.width_behind_m = plan->step_width_m;
    intent->step.landing_m.x = landing_m.x;
    intent->step.landing_m.y = landing_m.y - stance_m->y;
    intent->place.x_m = plan->com_m.x;
    intent->place.phase = saddle_planner_phase(planner);
    intent->may_place = model->config.placement_gain > 0.0f && plan->phase % 2u == 0u;
    intent->reference_xcom_m.x = plan->reference.xcom_m.x;
    intent->reference_xcom_m.y = plan->reference.xcom_m.y - stance_m->y;
}

/* The plan under the command, or under a stand where the inputs are lost. Its feet are measured as far
 * as the supervisor would use them. */
static SADDLE_NOINLINE void plan_walk(saddle_context_t *context, const saddle_sensed_t *sensed,
                                      bool stop, uint32_t dt_us, saddle_output_t *output)
{
    static const saddle_command_t stand = {(uint8_t)SADDLE_COMMAND_STAND, 0.0f, 0.0f, 0.0f};
    const bool feet_known = (sensed->faults & SADDLE_FAULTS_FEET) == 0u;
    output->limits |= stop ? (uint32_t)SADDLE_LIMIT_SAFE_STOP : 0u;
    output->limits |=
        saddle_planner_update(&context->planner, &context->model, stop ? &stand : &context->command,
                              feet_known ? sensed->sampled : NULL, dt_us);
    output->limits |= saddle_plan_write(&context->planner, &context->model, &output->plan);
    saddle_remember_plan(&context->past, &output->plan, context->planner.cycle.way.walked_nm,
                         dt_us);
}

static bool is_old(const saddle_measurement_t *sampled)
{
    return (sampled->com.age_us | sampled->foot[SADDLE_LEFT].age_us |
            sampled->foot[SADDLE_RIGHT].age_us) != 0u;
}

/* The measured posture, as of now, against the plan. [E46] */
static SADDLE_NOINLINE void compare(saddle_context_t *context, const saddle_sensed_t *sensed,
                                    saddle_output_t *output)
{
    saddle_supervisor_t *supervisor = &context->supervisor;
    const saddle_model_t *model = &context->model;
    saddle_intent_t intent;
    read_intent(&context->planner, model, &output->plan, &intent);
    if (is_old(sensed->sampled) && intent.leads && (sensed->faults & UNMEASURED) == 0u) {
        saddle_measurement_t present;
        intent.stance_then = saddle_bring_forward(&context->past, model, sensed->sampled, &present);
        const saddle_sensed_t now = {&present, sensed->sampled, sensed->faults, sensed->dt_s};
        output->faults |= saddle_supervisor_update(supervisor, model, &now, &intent, output);
    } else {
        output->faults |= saddle_supervisor_update(supervisor, model, sensed, &intent, output);
    }
    output->walk = supervisor->learning.walk;
}

/* Along the way, as the plan is there. [E47] */
static SADDLE_NOINLINE void supervise(saddle_context_t *context, const saddle_sensed_t *sensed,
                                      saddle_output_t *output)
{
    if (context->planner.cycle.way.bent) {
        saddle_measurement_t along;
        saddle_planner_along(&context->planner, &context->model, sensed->sampled, &along);
        const saddle_sensed_t unbent = {&along, &along, sensed->faults, sensed->dt_s};
        compare(context, &unbent, output);
    } else {
        compare(context, sensed, output);
    }
}

/* [E45] From this tick on the plan leads to where the wearer is to land. Neither the swing foot's place
 * nor its velocity jumps. */
static void move_landing(saddle_context_t *context, saddle_plan_t *plan)
{
    const saddle_placement_t *placement = &context->supervisor.placement;
    saddle_cycle_t *cycle = &context->planner.cycle;
    if (placement->known) {
        saddle_cycle_place(cycle, &context->model, placement->landing_m);
        plan->landing_m = saddle_vec2_add(saddle_unmoved_landing_m(plan), cycle->swing.moved_m);
    }
}

/* The output of a tick that failed: nothing in it is valid. */
static saddle_status_t refuse(saddle_output_t *output, saddle_status_t status)
{
    saddle_clear(output, sizeof *output);
    output->status = status;
    return status;
}

saddle_status_t saddle_tick(saddle_context_t *context, const saddle_input_t *input,
                            saddle_output_t *output)
{
    if (output == NULL) {
        return SADDLE_ERROR_NULL;
    }
    const saddle_status_t status = check_call(context, input);
    if (status != SADDLE_OK) {
        return refuse(output, status);
    }
    output->status = SADDLE_OK;
    output->limits = 0;
    const uint32_t dt_us = elapsed_us(context, input->time_us, &output->limits);
    saddle_measurement_t sampled;
    take_measurement(&context->model, &input->measurement, &sampled);
    saddle_sensed_t sensed = {&sampled, &sampled, 0, (float)dt_us * 1.0e-6f};
    sensed.faults =
        saddle_measurement_check(&context->plausibility, &context->model, &sampled,
                                 saddle_planner_speed_m_s(&context->planner), sensed.dt_s);
    output->faults = take_command(context, input);
    const saddle_command_t *command = &context->command;
    const saddle_safe_inputs_t inputs = {
        .faults = sensed.faults | output->faults,
        .unstable = context->supervisor.level.level == (uint8_t)SADDLE_LEVEL_UNSTABLE,
        .stands = command->mode == (uint8_t)SADDLE_COMMAND_STAND || !(command->speed_m_s > 0.0f),
    };
    const bool stop =
        saddle_safe_state_update(&context->safe_state, &context->model, &inputs, sensed.dt_s);
    plan_walk(context, &sensed, stop, dt_us, output);
    supervise(context, &sensed, output);
    move_landing(context, &output->plan);
    saddle_plan_bend(&context->planner.cycle.way, &context->model, &output->plan);
    return saddle_output_finite(output) ? SADDLE_OK : refuse(output, SADDLE_ERROR_NUMBER);
}

saddle_status_t saddle_join(saddle_context_t *context, const saddle_command_t *command)
{
    if (context == NULL || command == NULL) {
        return SADDLE_ERROR_NULL;
    }
    if (context->initialised != INITIALISED) {
        return SADDLE_ERROR_UNINITIALISED;
    }
    if (command->mode != (uint8_t)SADDLE_COMMAND_WALK || !saddle_command_usable(command) ||
        !(command->speed_m_s > 0.0f)) {
        return SADDLE_ERROR_COMMAND;
    }
    context->command = *command;
    saddle_clear(&context->past, sizeof context->past);
    (void)saddle_planner_join(&context->planner, &context->model, command);
    return SADDLE_OK;
}

/* What of a configuration is a person's shape. */
static void take_shape(saddle_config_t *config, const saddle_config_t *from)
{
    config->lateral_factor = from->lateral_factor;
    config->lateral_offset_m = from->lateral_offset_m;
    config->lateral_delay_rad = from->lateral_delay_rad;
    config->vertical_offset_m = from->vertical_offset_m;
    config->vertical_delay_rad = from->vertical_delay_rad;
    config->strike_share = from->strike_share;
    config->swing_begin = from->swing_begin;
    config->swing_end = from->swing_end;
    config->swing_skew = from->swing_skew;
}

saddle_status_t saddle_adapt(saddle_context_t *context, const saddle_config_t *config)
{
    if (context == NULL || config == NULL) {
        return SADDLE_ERROR_NULL;
    }
    if (context->initialised != INITIALISED) {
        return SADDLE_ERROR_UNINITIALISED;
    }
    saddle_config_t adapted;
    saddle_copy(&adapted, &context->model.config, sizeof adapted);
    take_shape(&adapted, config);
    if (saddle_config_check(&adapted) != NULL) {
        return SADDLE_ERROR_CONFIG;
    }
    saddle_model_t reshaped;
    saddle_model_init(&reshaped, &adapted);
    if (!saddle_stands(&context->planner) &&
        !saddle_cycle_reshape(&context->planner.cycle, &context->model, &reshaped)) {
        return SADDLE_ERROR_TIME;
    }
    saddle_copy(&context->model, &reshaped, sizeof reshaped);
    return SADDLE_OK;
}

/* Beyond a tick, tick by tick: within the range of fixed point. */
static void advance_far(saddle_planner_t *planner, const saddle_context_t *context, uint32_t dt_us)
{
    uint32_t rest_us = dt_us;
    while (rest_us > TICK_LIMIT_US) {
        saddle_planner_advance(planner, &context->model, TICK_LIMIT_US);
        rest_us -= TICK_LIMIT_US;
    }
    saddle_planner_advance(planner, &context->model, rest_us);
}

static saddle_status_t check_plan_at(const saddle_context_t *context, uint64_t time_us)
{
    if (context == NULL) {
        return SADDLE_ERROR_NULL;
    }
    if (context->initialised != INITIALISED) {
        return SADDLE_ERROR_UNINITIALISED;
    }
    if (!context->ticked || time_us < context->last_time_us ||
        time_us - context->last_time_us > saddle_plan_horizon_us(&context->planner)) {
        return SADDLE_ERROR_TIME;
    }
    return SADDLE_OK;
}

static saddle_status_t refuse_plan(saddle_plan_t *plan, saddle_status_t status)
{
    saddle_clear(plan, sizeof *plan);
    return status;
}

saddle_status_t saddle_plan_at(const saddle_context_t *context, uint64_t time_us,
                               saddle_plan_t *plan)
{
    if (plan == NULL) {
        return SADDLE_ERROR_NULL;
    }
    const saddle_status_t status = check_plan_at(context, time_us);
    if (status != SADDLE_OK) {
        return refuse_plan(plan, status);
    }
    saddle_planner_t planner;
    saddle_copy(&planner, &context->planner, sizeof planner);
    advance_far(&planner, context, (uint32_t)(time_us - context->last_time_us));
    (void)saddle_plan_write(&planner, &context->model, plan);
    saddle_plan_bend(&planner.cycle.way, &context->model, plan);
    return saddle_plan_finite(plan) ? SADDLE_OK : refuse_plan(plan, SADDLE_ERROR_NUMBER);
}

saddle_status_t saddle_reference_after(const saddle_context_t *context, const saddle_plan_t *plan,
                                       float after_s, saddle_reference_t *reference)
{
    if (reference == NULL) {
        return SADDLE_ERROR_NULL;
    }
    saddle_clear(reference, sizeof *reference);
    if (context == NULL || plan == NULL) {
        return SADDLE_ERROR_NULL;
    }
    if (context->initialised != INITIALISED) {
        return SADDLE_ERROR_UNINITIALISED;
    }
    if (!plan->valid || plan->support > (uint8_t)SADDLE_RIGHT ||
        !(after_s >= 0.0f && after_s <= REFERENCE_AHEAD_MAX_S)) {
        return SADDLE_ERROR_TIME;
    }
    saddle_reference_after_plan(&context->model, plan, after_s, reference);
    return SADDLE_OK;
}

saddle_status_t saddle_score_plan(const saddle_context_t *context, const saddle_plan_t *plan,
                                  saddle_scores_t *scores)
{
    if (scores == NULL) {
        return SADDLE_ERROR_NULL;
    }
    saddle_clear(scores, sizeof *scores);
    if (context == NULL || plan == NULL) {
        return SADDLE_ERROR_NULL;
    }
    if (context->initialised != INITIALISED) {
        return SADDLE_ERROR_UNINITIALISED;
    }
    saddle_posture_t posture;
    posture.com.com_m.x = plan->com_m.x;
    posture.com.com_m.y = plan->com_m.y;
    posture.com.velocity_m_s.x = plan->com_velocity_m_s.x;
    posture.com.velocity_m_s.y = plan->com_velocity_m_s.y;
    for (int side = 0; side < 2; side++) {
        posture.cop_m[side].x = plan->foot_m[side].x;
        posture.cop_m[side].y = plan->foot_m[side].y;
    }
    posture.v_comp_m_s = plan->speed_m_s;
    posture.half_step_m = 0.5f * plan->step_length_m;
    posture.known = plan->valid ? (uint32_t)SADDLE_KNOWN_ALL : 0u;
    saddle_support_t support;
    saddle_score_posture(&context->model, &posture, scores, &support);
    return SADDLE_OK;
}
