#include "sense/safe_state.h"

static const uint32_t UNUSABLE = SADDLE_FAULTS_COM | SADDLE_FAULTS_FEET;

static const uint32_t STALE = (uint32_t)SADDLE_FAULT_COM_STALE | (uint32_t)SADDLE_FAULT_LEFT_STALE |
                              (uint32_t)SADDLE_FAULT_RIGHT_STALE;

static const uint32_t LOST =
    (uint32_t)SADDLE_FAULT_COM_STALE | (uint32_t)SADDLE_FAULT_COM_FROZEN |
    (uint32_t)SADDLE_FAULT_LEFT_STALE | (uint32_t)SADDLE_FAULT_LEFT_FROZEN |
    (uint32_t)SADDLE_FAULT_RIGHT_STALE | (uint32_t)SADDLE_FAULT_RIGHT_FROZEN;

/* After a stop a walk that is to wait for a new command waits for a stand first. */
static bool may_resume(const saddle_safe_state_t *state, const saddle_model_t *model)
{
    return state->good_s >= model->config.resume_time_s &&
           (state->stand_commanded || model->config.resume_by_command < 0.5f);
}

bool saddle_safe_state_update(saddle_safe_state_t *state, const saddle_model_t *model,
                              const saddle_safe_inputs_t *inputs, float dt_s)
{
    const bool commanded = (inputs->faults & (uint32_t)SADDLE_FAULT_COMMAND_STALE) == 0u;
    const bool measured = (inputs->faults & UNUSABLE) == 0u;
    state->armed = state->armed || (inputs->faults & STALE) != STALE;
    state->lost_s = measured ? 0.0f : state->lost_s + dt_s;
    const bool lost = (inputs->faults & LOST) != 0u || state->lost_s > model->config.com_max_age_s;
    const bool good = commanded && !inputs->unstable && (measured || !state->armed);
    state->good_s = good ? state->good_s + dt_s : 0.0f;
    state->stand_commanded =
        state->stopped && commanded && (state->stand_commanded || inputs->stands);
    if (!commanded || (state->armed && lost)) {
        state->stopped = true;
    } else if (good && may_resume(state, model)) {
        state->stopped = false;
    }
    return state->stopped && model->config.lost_inputs_stop > 0.5f;
}

void saddle_safe_state_gap(saddle_safe_state_t *state, const saddle_model_t *model, float gap_s)
{
    if (state->armed && gap_s > model->config.step_time_max_s) {
        state->stopped = true;
        state->good_s = 0.0f;
    }
}
