#include "balance/supervisor.h"

#include "balance/learned_walk.h"
#include "balance/level.h"
#include "balance/margin.h"
#include "balance/saddle_space.h"
#include "balance/scores.h"
#include "sense/step_tracker.h"

void saddle_supervisor_init(saddle_supervisor_t *supervisor, const saddle_model_t *model)
{
    saddle_learning_init(&supervisor->learning, model);
}

/* Crossed feet, no foot on the ground and a CoM below the knees contradict the sensors of a wearer who
 * was not seen before. From then on they are what happens to somebody who falls. */
static uint32_t missing(const saddle_supervisor_t *supervisor, uint32_t faults)
{
    const uint32_t evidence = (uint32_t)SADDLE_FAULT_AIRBORNE |
                              (uint32_t)SADDLE_FAULT_FEET_CROSSED | (uint32_t)SADDLE_FAULT_COM_LOW;
    return supervisor->learning.begun ? faults & ~evidence : faults;
}

static void no_margin(saddle_verdict_t *verdict)
{
    verdict->margin_known = false;
    verdict->margin = 0.0f;
    verdict->caution_below = 0.0f;
    verdict->driver = (uint8_t)SADDLE_REASON_NONE;
}

static void bound_margin(saddle_verdict_t *verdict, float most)
{
    if (verdict->margin > most) {
        verdict->margin = most;
        verdict->driver = (uint8_t)SADDLE_REASON_SINKING;
    }
}

/* Returns the margin before the plan has a say. on_plan: the wearer makes the planned step. */
static float measure_margin(const saddle_model_t *model, saddle_learning_t *learning,
                            const saddle_measurement_t *measurement, bool on_plan,
                            saddle_verdict_t *verdict)
{
    saddle_learning_begin(learning);
    const saddle_departure_t departure = saddle_departure(model, learning, measurement);
    const float own = saddle_own_margin(model, learning, &departure);
    const float plan = on_plan ? saddle_plan_margin(model, learning, verdict) : 0.0f;
    verdict->margin_known = true;
    verdict->margin = own + plan;
    verdict->caution_below = saddle_caution_below(model, learning, plan);
    verdict->driver = (uint8_t)saddle_driver(&departure, plan);
    bound_margin(verdict, saddle_sinking_margin(&departure));
    return own;
}

static void learn(saddle_supervisor_t *supervisor, const saddle_model_t *model, float own_margin,
                  float dt_s)
{
    saddle_step_tracker_t *steps = &supervisor->steps;
    saddle_learning_update(&supervisor->learning, model, own_margin, dt_s);
    saddle_learning_step(&supervisor->learning, steps, own_margin);
    steps->disturbed = steps->disturbed || own_margin <= model->config.learn_margin;
}

void saddle_supervisor_gap(saddle_supervisor_t *supervisor, float gap_s)
{
    saddle_track_gap(&supervisor->steps, gap_s);
    saddle_learning_gap(&supervisor->learning);
    saddle_level_reset(&supervisor->level);
}

uint32_t saddle_supervisor_update(saddle_supervisor_t *supervisor, const saddle_model_t *model,
                                  const saddle_sensed_t *sensed, const saddle_intent_t *intent,
                                  saddle_output_t *output)
{
    const saddle_measurement_t *measurement = sensed->measurement;
    const uint32_t faults = sensed->faults;
    const float dt_s = sensed->dt_s;
    saddle_scores_t *scores = &output->scores;
    saddle_verdict_t *verdict = &output->verdict;
    saddle_step_tracker_t *steps = &supervisor->steps;
    saddle_track_steps(steps, model, measurement, faults, dt_s);
    const uint32_t missing_inputs = missing(supervisor, faults);
    const bool feet_known = (missing_inputs & SADDLE_FAULTS_FEET) == 0u;
    const bool com_known = (missing_inputs & SADDLE_FAULTS_COM) == 0u;
    const bool is_to_stand = intent->leads && !intent->walking;
    const bool speed_known = !is_to_stand && (steps->v_comp_known || intent->step.speed_m_s > 0.0f);
    const bool half_step_known = !is_to_stand && feet_known && com_known && steps->half_step_known;
    saddle_posture_t posture;
    posture.com_m.x = 0.0f;
    posture.com_m.y = 0.0f;
    posture.com_velocity_m_s = measurement->com.velocity_m_s;
    posture.cop_m[SADDLE_LEFT] = measurement->foot[SADDLE_LEFT].cop_m;
    posture.cop_m[SADDLE_RIGHT] = measurement->foot[SADDLE_RIGHT].cop_m;
    posture.v_comp_m_s = steps->v_comp_known ? steps->v_comp_m_s : intent->step.speed_m_s;
    posture.half_step_m = steps->half_step_m;
    posture.known = (feet_known ? (uint32_t)SADDLE_KNOWN_FEET : 0u) |
                    (com_known ? (uint32_t)SADDLE_KNOWN_VELOCITY : 0u) |
                    (speed_known ? (uint32_t)SADDLE_KNOWN_SPEED : 0u) |
                    (half_step_known ? (uint32_t)SADDLE_KNOWN_HALF_STEP : 0u);
    const saddle_surface_t at_com = saddle_score_posture(model, &posture, scores);
    const uint32_t all_faults = faults | saddle_score_faults(posture.known, scores);
    saddle_compare_nothing(verdict);
    bool on_plan = false;
    if (com_known && feet_known && scores->bos.defined) {
        const saddle_wearer_t wearer = {steps, measurement, &posture, scores, at_com};
        on_plan = saddle_compare(model, &wearer, intent, verdict);
    }
    no_margin(verdict);
    if (com_known) {
        saddle_learning_watch(&supervisor->learning, measurement, dt_s);
    } else {
        saddle_learning_gap(&supervisor->learning);
    }
    if (com_known && feet_known) {
        const float own =
            measure_margin(model, &supervisor->learning, measurement, on_plan, verdict);
        if ((faults & (uint32_t)SADDLE_FAULT_COM_LOW) == 0u) {
            learn(supervisor, model, own, dt_s);
        } else {
            bound_margin(verdict, 0.0f);
        }
    }
    saddle_level_update(&supervisor->level, model, all_faults, scores, verdict);
    return all_faults;
}
