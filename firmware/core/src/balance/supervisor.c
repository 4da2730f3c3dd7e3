#include "balance/supervisor.h"

#include "balance/level.h"
#include "balance/scores.h"
#include "sense/step_tracker.h"

void saddle_supervisor_gap(saddle_supervisor_t *supervisor, float gap_s)
{
    saddle_track_gap(&supervisor->steps, gap_s);
    saddle_level_reset(&supervisor->level);
}

uint32_t saddle_supervisor_update(saddle_supervisor_t *supervisor, const saddle_model_t *model,
                                  const saddle_measurement_t *measurement, uint32_t faults,
                                  float dt_s, const saddle_intent_t *intent,
                                  saddle_scores_t *scores, saddle_verdict_t *verdict)
{
    saddle_step_tracker_t *steps = &supervisor->steps;
    saddle_track_steps(steps, model, measurement, faults, dt_s);
    const bool feet_known = (faults & SADDLE_FAULTS_FEET) == 0u;
    const bool com_known = (faults & SADDLE_FAULTS_COM) == 0u;
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
    saddle_score_posture(model, &posture, scores);
    const uint32_t all_faults = faults | saddle_score_faults(posture.known, scores);
    saddle_compare_nothing(verdict);
    if (com_known && feet_known && scores->bos.defined) {
        const saddle_wearer_t wearer = {steps, measurement, &posture, scores};
        saddle_compare(model, &wearer, intent, verdict);
    }
    saddle_level_update(&supervisor->level, model, all_faults, scores, verdict);
    return all_faults;
}
