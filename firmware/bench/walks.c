#include "walks.h"

#include <math.h>

/* Ticks: from where a walk is commanded, from where a stand is; from where the wearer is off the
 * plan's speed, and from where far off. */
#define WALK_FROM 15u
#define STAND_FROM 100u
#define OFF_FROM 45u
#define FAR_OFF_FROM 70u

static const float SPEEDS_M_S[SADDLE_BENCH_WALKS] = {1.2f, 0.7f, 1.2f, 1.6f, 1.2f, 1.2f};
static const float HEEL_STRIKE_RAD = 0.174532925f;

/* The wearer follows the plan exactly. */
static saddle_measurement_t wearer(const saddle_plan_t *plan)
{
    saddle_measurement_t measured = {.com = {.height_m = plan->com_m.z, .age_us = 5000u}};
    measured.com.velocity_m_s = (saddle_vec2_t){plan->com_velocity_m_s.x, plan->com_velocity_m_s.y};
    for (int side = 0; side < 2; side++) {
        measured.foot[side].cop_m = (saddle_vec2_t){plan->foot_m[side].x - plan->com_m.x,
                                                    plan->foot_m[side].y - plan->com_m.y};
        measured.foot[side].contact =
            side == (int)plan->support || plan->speed_m_s == 0.0f; /* both feet stand */
        measured.foot[side].age_us = 5000u;
    }
    return measured;
}

static void spoil(saddle_input_t *input, uint32_t way)
{
    saddle_measurement_t *measured = &input->measurement;
    switch (way % 10u) {
    case 0: measured->com.height_m = NAN; break;
    case 1: measured->com.velocity_m_s.y = INFINITY; break;
    case 2: measured->com.age_us = SADDLE_AGE_NEVER_US; break;
    case 3: measured->foot[SADDLE_LEFT].age_us = 1000000u; break;
    case 4: measured->foot[SADDLE_RIGHT].cop_m.x = -1.0e30f; break;
    case 5: measured->foot[SADDLE_LEFT].cop_m = measured->foot[SADDLE_RIGHT].cop_m; break;
    case 6: measured->foot[SADDLE_LEFT].contact = measured->foot[SADDLE_RIGHT].contact; break;
    case 7: input->command.speed_m_s = NAN; break;
    case 8: input->command.mode = 200; break;
    default: input->time_us = 0; break;
    }
}

void saddle_bench_walk(saddle_bench_walk_t *walk, int number)
{
    static saddle_output_t planned;
    const saddle_config_t config = saddle_config_default(1.79f, 63.3f);
    const saddle_command_t go = {SADDLE_COMMAND_WALK, SPEEDS_M_S[number], HEEL_STRIKE_RAD, 0.0f};
    saddle_context_t *model = &walk->context; /* used to make the inputs, then initialised again */
    walk->scores_plan = number == SADDLE_BENCH_PLAN;
    (void)saddle_init(model, &config);
    for (uint32_t k = 0; k < SADDLE_BENCH_UPDATES; k++) {
        saddle_input_t *input = &walk->inputs[k];
        *input = (saddle_input_t){.time_us = (uint64_t)k * SADDLE_BENCH_PERIOD_US};
        input->measurement = saddle_no_measurement();
        if (walk->scores_plan || (k >= WALK_FROM && k < STAND_FROM)) {
            input->command = go;
        }
        if (walk->scores_plan) {
            continue;
        }
        (void)saddle_tick(model, input, &planned);
        input->measurement = wearer(&planned.plan);
        if (number == SADDLE_BENCH_PUSHED && k >= OFF_FROM) {
            input->measurement.com.velocity_m_s.x += k < FAR_OFF_FROM ? 0.5f : 1.5f;
            input->measurement.com.velocity_m_s.y += k < FAR_OFF_FROM ? 0.0f : 1.0f;
        }
        if (number == SADDLE_BENCH_INVALID && k > 0u) {
            spoil(input, k);
        }
    }
    (void)saddle_init(&walk->context, &config);
    if (walk->scores_plan) {
        (void)saddle_join(&walk->context, &go);
    }
}

void saddle_bench_update(saddle_bench_walk_t *walk, uint32_t update, saddle_output_t *output,
                         saddle_scores_t *scores)
{
    (void)saddle_tick(&walk->context, &walk->inputs[update], output);
    if (walk->scores_plan) {
        (void)saddle_score_plan(&walk->context, &output->plan, scores);
    }
}
