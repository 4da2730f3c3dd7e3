#include <saddlewalk/saddlewalk.h>

/* Marks a context that saddle_init() has filled. */
#define INITIALISED 0x5ADD1E00u

saddle_status_t saddle_init(saddle_context_t *context, const saddle_config_t *config)
{
    if (context == NULL) {
        return SADDLE_ERROR_NULL;
    }
    *context = (saddle_context_t){.initialised = 0};
    if (config == NULL) {
        return SADDLE_ERROR_NULL;
    }
    if (saddle_config_check(config) != NULL) {
        return SADDLE_ERROR_CONFIG;
    }
    context->config = *config;
    context->body = saddle_body(config);
    context->initialised = INITIALISED;
    return SADDLE_OK;
}

static saddle_status_t judge_call(const saddle_context_t *context, const saddle_input_t *input)
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

static float elapsed_s(saddle_context_t *context, uint64_t time_us, uint32_t *limits)
{
    const uint64_t elapsed_us = context->ticked ? time_us - context->last_time_us : 0u;
    const float limit_us = context->config.tick_max_s * 1.0e6f;
    context->last_time_us = time_us;
    context->ticked = true;
    if (elapsed_us > UINT32_MAX || (float)(uint32_t)elapsed_us > limit_us) {
        *limits |= (uint32_t)SADDLE_LIMIT_TICK_GAP;
        return context->config.tick_max_s;
    }
    return (float)(uint32_t)elapsed_us * 1.0e-6f;
}

static saddle_scores_t score_plan(const saddle_context_t *context, const saddle_plan_t *plan)
{
    const saddle_posture_t posture = {
        .com_m = {plan->com_m.x, plan->com_m.y},
        .com_velocity_m_s = {plan->com_velocity_m_s.x, plan->com_velocity_m_s.y},
        .cop_m = {{plan->foot_m[SADDLE_LEFT].x, plan->foot_m[SADDLE_LEFT].y},
                  {plan->foot_m[SADDLE_RIGHT].x, plan->foot_m[SADDLE_RIGHT].y}},
        .v_comp_m_s = plan->speed_m_s,
        .half_step_m = 0.5f * plan->step_length_m,
        .known = plan->valid ? (uint32_t)SADDLE_KNOWN_ALL : 0u,
    };
    return saddle_score_posture(&context->config, &context->body, &posture);
}

saddle_status_t saddle_tick(saddle_context_t *context, const saddle_input_t *input,
                            saddle_output_t *output)
{
    if (output == NULL) {
        return SADDLE_ERROR_NULL;
    }
    *output = (saddle_output_t){.status = judge_call(context, input)};
    if (output->status != SADDLE_OK) {
        return output->status;
    }
    if (saddle_command_usable(&input->command)) {
        context->command = input->command;
    } else {
        output->faults |= (uint32_t)SADDLE_FAULT_COMMAND;
    }
    const float dt_s = elapsed_s(context, input->time_us, &output->limits);
    output->limits |= saddle_planner_update(&context->planner, &context->config, &context->body,
                                            &context->command, dt_s, &output->plan);
    output->plan_scores = score_plan(context, &output->plan);
    output->faults |= saddle_supervisor_update(&context->supervisor, &context->config,
                                               &context->body, &input->measurement, dt_s,
                                               output->plan.speed_m_s, &output->scores);
    return SADDLE_OK;
}
