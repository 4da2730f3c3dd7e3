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

/* CoM and feet. */
static bool is_measured(uint32_t known)
{
    const uint32_t all = (uint32_t)SADDLE_KNOWN_FEET | (uint32_t)SADDLE_KNOWN_VELOCITY;
    return (known & all) == all;
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

/* What is known of a wearer with these faults. */
static uint32_t known_of(const saddle_supervisor_t *supervisor, const saddle_intent_t *intent,
                         uint32_t faults)
{
    const saddle_step_tracker_t *steps = &supervisor->steps;
    const uint32_t missing_inputs = missing(supervisor, faults);
    const bool is_to_stand = intent->leads && !intent->walking;
    uint32_t known = 0;
    if ((missing_inputs & SADDLE_FAULTS_FEET) == 0u) {
        known |= (uint32_t)SADDLE_KNOWN_FEET;
    }
    if ((missing_inputs & SADDLE_FAULTS_COM) == 0u) {
        known |= (uint32_t)SADDLE_KNOWN_VELOCITY;
    }
    if (!is_to_stand && (steps->v_comp_known || intent->step.speed_m_s > 0.0f)) {
        known |= (uint32_t)SADDLE_KNOWN_SPEED;
    }
    if (!is_to_stand && is_measured(known) && steps->half_step_known) {
        known |= (uint32_t)SADDLE_KNOWN_HALF_STEP;
    }
    return known;
}

/* The measured posture, in the frame of the CoM. */
static void read_posture(const saddle_step_tracker_t *steps,
                         const saddle_measurement_t *measurement, const saddle_intent_t *intent,
                         saddle_posture_t *posture)
{
    posture->com.com_m.x = 0.0f;
    posture->com.com_m.y = 0.0f;
    posture->com.velocity_m_s = measurement->com.velocity_m_s;
    posture->cop_m[SADDLE_LEFT] = measurement->foot[SADDLE_LEFT].cop_m;
    posture->cop_m[SADDLE_RIGHT] = measurement->foot[SADDLE_RIGHT].cop_m;
    posture->v_comp_m_s = steps->v_comp_known ? steps->v_comp_m_s : intent->step.speed_m_s;
    posture->half_step_m = steps->half_step_m;
}

/* The margin of what is known, and what it teaches. */
static SADDLE_NOINLINE void follow_margin(saddle_supervisor_t *supervisor,
                                          const saddle_model_t *model,
                                          const saddle_sensed_t *sensed, bool on_plan,
                                          saddle_verdict_t *verdict)
{
    const uint32_t missing_inputs = missing(supervisor, sensed->faults);
    no_margin(verdict);
    if ((missing_inputs & SADDLE_FAULTS_COM) != 0u) {
        saddle_learning_gap(&supervisor->learning);
        return;
    }
    saddle_learning_watch(&supervisor->learning, sensed->measurement, sensed->dt_s);
    if ((missing_inputs & SADDLE_FAULTS_FEET) != 0u) {
        return;
    }
    const float own =
        measure_margin(model, &supervisor->learning, sensed->measurement, on_plan, verdict);
    if ((sensed->faults & (uint32_t)SADDLE_FAULT_COM_LOW) == 0u) {
        learn(supervisor, model, own, sensed->dt_s);
    } else {
        bound_margin(verdict, 0.0f);
    }
}

uint32_t saddle_supervisor_update(saddle_supervisor_t *supervisor, const saddle_model_t *model,
                                  const saddle_sensed_t *sensed, const saddle_intent_t *intent,
                                  saddle_output_t *output)
{
    saddle_scores_t *scores = &output->scores;
    saddle_verdict_t *verdict = &output->verdict;
    saddle_step_tracker_t *steps = &supervisor->steps;
    saddle_track_steps(steps, model, sensed->sampled, sensed->faults, sensed->dt_s);
    const uint32_t known = known_of(supervisor, intent, sensed->faults);
    saddle_posture_t posture = {.known = known};
    read_posture(steps, sensed->measurement, intent, &posture);
    saddle_support_t support;
    saddle_score_posture(model, &posture, scores, &support);
    const uint32_t faults = sensed->faults | saddle_score_faults(known, scores);
    bool on_plan = false;
    verdict->compared = verdict->on_track = false; /* whatever the output held before */
    verdict->recovery.found = verdict->recovery.stops = false;
    supervisor->placement.known = false;
    if (is_measured(known) && scores->bos.defined) {
        const saddle_wearer_t wearer = {steps, sensed->measurement, &posture, scores, &support};
        on_plan = saddle_compare(model, &wearer, intent, verdict, &supervisor->placement);
    }
    if (!verdict->compared) {
        saddle_compare_nothing(verdict);
    }
    follow_margin(supervisor, model, sensed, on_plan, verdict);
    saddle_level_update(&supervisor->level, model, faults, scores, verdict);
    return faults;
}
