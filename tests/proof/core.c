/** The core, with whatever comes: from any configuration that it accepts, for ever, any order of
 *  calls with any values. Read by Eva (`make prove`). */
#include "any.h"

#include <saddlewalk/saddlewalk.h>

static volatile saddle_config_t any_config;
static volatile saddle_input_t any_input;
static volatile saddle_plan_t any_plan;
static volatile saddle_output_t any_output;

static saddle_input_t some_input(void)
{
    saddle_input_t input = any_input;
    input.measurement.foot[SADDLE_LEFT].contact = any_bool();
    input.measurement.foot[SADDLE_RIGHT].contact = any_bool();
    return input;
}

static saddle_plan_t some_plan(void)
{
    saddle_plan_t plan = any_plan;
    plan.valid = any_bool();
    return plan;
}

/** One that saddle_config_check() accepts: tests/unit/test_config.c shows that it accepts no other. */
static saddle_config_t some_accepted_config(void)
{
    const saddle_config_field_t *field;
    saddle_config_t config = any_config;
    /*@ loop unroll 256; */
    for (size_t i = 0; (field = saddle_config_field(i)) != NULL; ++i) {
        float value = any_float;
        if (value != value || value < field->min || value > field->max) {
            value = field->min;
        }
        *(float *)(void *)((char *)&config + field->offset) = value;
    }
    return config;
}

static void walk(saddle_context_t *context)
{
    saddle_output_t output = any_output;
    saddle_plan_t plan = some_plan();
    saddle_reference_t reference;
    saddle_scores_t scores;
    while (any_bool()) {
        const saddle_input_t input = some_input();
        const saddle_plan_t other = some_plan();
        const saddle_config_t shape = any_config;
        (void)saddle_tick(context, &input, &output);
        (void)saddle_plan_at(context, any_uint64, &plan);
        (void)saddle_reference_after(context, &plan, any_float, &reference);
        (void)saddle_reference_after(context, &other, any_float, &reference);
        (void)saddle_score_plan(context, &plan, &scores);
        (void)saddle_score_plan(context, &other, &scores);
        (void)saddle_join(context, &input.command);
        (void)saddle_adapt(context, &shape);
    }
}

int main(void)
{
    static saddle_context_t context;
    const saddle_config_t any = any_config;
    const saddle_config_t accepted = some_accepted_config();
    (void)saddle_config_check(&any);
    if (saddle_init(&context, &accepted) == SADDLE_OK) {
        walk(&context);
    }
    return 0;
}
