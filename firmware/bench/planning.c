#include "planning.h"

#include <time.h>

static uint64_t now_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

/* Tick and scores at input->time_us. */
static bool update(saddle_context_t *context, const saddle_input_t *input, saddle_output_t *output,
                   saddle_scores_t *scores)
{
    return saddle_tick(context, input, output) == SADDLE_OK &&
           saddle_score_plan(context, &output->plan, scores) == SADDLE_OK;
}

uint64_t saddle_bench_plan_ns(saddle_context_t *context, const saddle_command_t *command,
                              uint32_t period_us, uint32_t instants, saddle_output_t *outputs,
                              saddle_scores_t *scores)
{
    saddle_input_t input = {.command = *command, .measurement = saddle_no_measurement()};
    input.time_us = context->last_time_us;
    const uint64_t start_ns = now_ns();
    if (saddle_join(context, command) != SADDLE_OK) {
        return 0;
    }
    for (uint32_t k = 0; k < instants; k++) {
        if (!update(context, &input, &outputs[k], &scores[k])) {
            return 0;
        }
        input.time_us += period_us;
    }
    return now_ns() - start_ns;
}

uint64_t saddle_bench_update_ns(saddle_context_t *context, const saddle_command_t *command,
                                uint32_t period_us, saddle_output_t *output,
                                saddle_scores_t *scores)
{
    saddle_input_t input = {.command = *command, .measurement = saddle_no_measurement()};
    input.time_us = context->last_time_us + period_us;
    const uint64_t start_ns = now_ns();
    return update(context, &input, output, scores) ? now_ns() - start_ns : 0;
}

uint64_t saddle_bench_floor_ns(const saddle_bench_calls_t *calls, const float *arguments,
                               uint32_t updates, float *sum)
{
    const uint64_t start_ns = now_ns();
    *sum = 0.0f;
    for (uint32_t k = 0; k < updates; k++) {
        uint32_t used;
        *sum += saddle_bench_floor(&calls[k], arguments, &used);
        arguments += used;
    }
    return now_ns() - start_ns;
}
