#include "balance/level.h"

#include "balance/scores.h"
#include "math/elementary.h"

/* The first score of the walk that is too low. */
static saddle_reason_t low_score(const saddle_model_t *model, uint32_t faults,
                                 const saddle_scores_t *scores)
{
    const bool steps = saddle_scores_hold(scores, (uint32_t)SADDLE_VALID_STEP);
    if ((faults & (uint32_t)SADDLE_FAULT_SPEED_INFEASIBLE) != 0u) {
        return SADDLE_REASON_SPEED;
    }
    if (steps && scores->s_pend < model->config.caution_score) {
        return SADDLE_REASON_S_PEND;
    }
    if (steps && scores->s_jump < model->config.caution_score) {
        return SADDLE_REASON_S_JUMP;
    }
    if (saddle_scores_hold(scores, (uint32_t)SADDLE_VALID_S_SW) &&
        scores->s_sw < model->config.caution_score) {
        return SADDLE_REASON_S_SW;
    }
    return SADDLE_REASON_NONE;
}

static saddle_reason_t departure(const saddle_model_t *model, const saddle_verdict_t *verdict)
{
    if (saddle_magnitude(verdict->xcom_deviation_m.x) > model->config.caution_xcom_ap_m) {
        return SADDLE_REASON_XCOM_AP;
    }
    if (saddle_magnitude(verdict->xcom_deviation_m.y) > model->config.caution_xcom_ml_m) {
        return SADDLE_REASON_XCOM_ML;
    }
    return verdict->on_track ? SADDLE_REASON_NONE : SADDLE_REASON_OFF_TRACK;
}

/* [E36] What decided the level before there was a margin. */
static saddle_reason_t previous_reason(const saddle_model_t *model, uint32_t faults,
                                       const saddle_scores_t *scores,
                                       const saddle_verdict_t *verdict)
{
    const uint32_t unusable =
        SADDLE_FAULTS_COM | SADDLE_FAULTS_FEET | (uint32_t)SADDLE_FAULT_FEET_TOGETHER;
    if ((faults & unusable) != 0u) {
        return SADDLE_REASON_INPUT;
    }
    if (!verdict->compared) {
        return SADDLE_REASON_NO_WALK;
    }
    const bool stays = scores->can_stop && scores->mos_xcom_m >= model->config.stop_margin_m;
    if (!stays && !verdict->recovery.found) {
        return SADDLE_REASON_NO_STEP;
    }
    const saddle_reason_t low = low_score(model, faults, scores);
    return low != SADDLE_REASON_NONE ? low : departure(model, verdict);
}

static saddle_level_t previous_level(saddle_reason_t reason)
{
    switch (reason) {
    case SADDLE_REASON_NONE: return SADDLE_LEVEL_STABLE;
    case SADDLE_REASON_INPUT:
    case SADDLE_REASON_NO_WALK: return SADDLE_LEVEL_UNKNOWN;
    case SADDLE_REASON_NO_STEP: return SADDLE_LEVEL_UNSTABLE;
    default: return SADDLE_LEVEL_CAUTION;
    }
}

/* A level of this tick, and what decided it. */
typedef struct {
    saddle_level_t level;
    saddle_reason_t reason;
} decision_t;

/* [E31] */
static decision_t decide(const saddle_verdict_t *verdict)
{
    decision_t decision = {SADDLE_LEVEL_STABLE, SADDLE_REASON_NONE};
    if (!verdict->margin_known) {
        decision.level = SADDLE_LEVEL_UNKNOWN;
        decision.reason = SADDLE_REASON_INPUT;
    } else if (!(verdict->margin > verdict->caution_below)) {
        decision.level = verdict->margin > 0.0f ? SADDLE_LEVEL_CAUTION : SADDLE_LEVEL_UNSTABLE;
        decision.reason = (saddle_reason_t)verdict->driver;
    }
    return decision;
}

static void count_ticks(saddle_level_state_t *state, uint8_t level)
{
    for (int i = 0; i <= (int)SADDLE_LEVEL_UNSTABLE; i++) {
        if (state->ticks_since[i] < UINT8_MAX) {
            state->ticks_since[i]++;
        }
    }
    state->ticks_since[level] = 0;
}

/* Every level was known, and from `best` to `worst`, for long enough. */
static bool held(const saddle_level_state_t *state, const saddle_model_t *model, uint8_t best,
                 uint8_t worst)
{
    for (uint8_t i = 0; i <= (uint8_t)SADDLE_LEVEL_UNSTABLE; i++) {
        if ((i < best || i > worst) &&
            (float)state->ticks_since[i] < model->config.level_hold_ticks) {
            return false;
        }
    }
    return true;
}

/* From the announced level as far towards this tick's as has held for long enough. */
static uint8_t level_held(const saddle_level_state_t *state, const saddle_model_t *model,
                          uint8_t level)
{
    while (level > state->level && !held(state, model, level, (uint8_t)SADDLE_LEVEL_UNSTABLE)) {
        level--;
    }
    while (level < state->level && !held(state, model, (uint8_t)SADDLE_LEVEL_STABLE, level)) {
        level++;
    }
    return level;
}

/* Why the announced level is that, whatever this tick's own reason is. */
static saddle_reason_t announced_reason(const saddle_level_state_t *state, decision_t decision)
{
    switch (state->level) {
    case SADDLE_LEVEL_STABLE: return SADDLE_REASON_NONE;
    case SADDLE_LEVEL_CAUTION: return (saddle_reason_t)state->caution_reason;
    case SADDLE_LEVEL_UNSTABLE: return (saddle_reason_t)state->unstable_reason;
    default:
        return decision.level == SADDLE_LEVEL_UNKNOWN ? decision.reason : SADDLE_REASON_SETTLING;
    }
}

/* A level is announced once it, or a worse one, has held for long enough, a better one likewise;
 * unknown at once. */
static void announce(saddle_level_state_t *state, const saddle_model_t *model, decision_t decision)
{
    count_ticks(state, (uint8_t)decision.level);
    if (decision.level == SADDLE_LEVEL_CAUTION) {
        state->caution_reason = (uint8_t)decision.reason;
    }
    if (decision.level == SADDLE_LEVEL_UNSTABLE) {
        state->unstable_reason = (uint8_t)decision.reason;
    }
    state->level = decision.level == SADDLE_LEVEL_UNKNOWN
                       ? (uint8_t)SADDLE_LEVEL_UNKNOWN
                       : level_held(state, model, (uint8_t)decision.level);
    state->reason = (uint8_t)announced_reason(state, decision);
}

void saddle_level_update(saddle_level_state_t *state, const saddle_model_t *model, uint32_t faults,
                         const saddle_scores_t *scores, saddle_verdict_t *verdict)
{
    decision_t decision = decide(verdict);
    if (model->config.previous_level > 0.5f) {
        decision.reason = previous_reason(model, faults, scores, verdict);
        decision.level = previous_level(decision.reason);
    }
    announce(state, model, decision);
    verdict->level = state->level;
    verdict->reason = state->reason;
}

void saddle_level_reset(saddle_level_state_t *state)
{
    state->level = (uint8_t)SADDLE_LEVEL_UNKNOWN;
    for (int i = 0; i <= (int)SADDLE_LEVEL_UNSTABLE; i++) {
        state->ticks_since[i] = 0;
    }
}
