#include "balance/scores.h"

#include "balance/stability_scores.h"
#include "model/gait_model.h"

bool saddle_scores_hold(const saddle_scores_t *scores, uint32_t results)
{
    return (scores->valid & results) == results;
}

static void score_steps(const saddle_model_t *model, const saddle_posture_t *posture,
                        saddle_scores_t *scores)
{
    const saddle_step_bounds_t bounds = saddle_step_bounds(model, posture->v_comp_m_s);
    if (!bounds.feasible) {
        return;
    }
    scores->s_pend = saddle_step_score(posture->half_step_m, bounds.reference_m, bounds.min_m);
    scores->s_jump = saddle_step_score(posture->half_step_m, bounds.reference_m, bounds.max_m);
    scores->valid |= (uint32_t)SADDLE_VALID_STEP;
}

/* [E27] */
static void score_energy(const saddle_model_t *model, const saddle_posture_t *posture,
                         const saddle_support_t *support, saddle_scores_t *scores)
{
    if (saddle_excess_stop_j(model, support, &posture->com, &scores->excess_stop_j)) {
        scores->can_stop = model->body.ankle_work_j >= scores->excess_stop_j;
        scores->valid |= (uint32_t)SADDLE_VALID_STOP;
    }
}

static void score_space(const saddle_model_t *model, const saddle_posture_t *posture,
                        const saddle_support_t *support, saddle_scores_t *scores)
{
    scores->bos = saddle_bos(posture->cop_m, model->config.cop_range_m, model->config.bos_factor);
    if (!scores->bos.defined) {
        return;
    }
    scores->mos_com_m = saddle_bos_margin_m(&scores->bos, posture->com.com_m);
    scores->valid |= (uint32_t)SADDLE_VALID_MOS_COM;
    if ((posture->known & (uint32_t)SADDLE_KNOWN_VELOCITY) != 0u) {
        scores->mos_xcom_m = saddle_bos_margin_m(&scores->bos, scores->xcom_m);
        scores->valid |= (uint32_t)SADDLE_VALID_MOS_XCOM;
        score_energy(model, posture, support, scores);
    }
    if (support->at_com.reached) {
        scores->gravity_n = saddle_gravity_n(&support->at_com, model->config.body_mass_kg);
        scores->valid |= (uint32_t)SADDLE_VALID_GRAVITY;
    }
}

static bool stable_step(const saddle_scores_t *scores)
{
    return saddle_scores_hold(scores, (uint32_t)SADDLE_VALID_STEP | (uint32_t)SADDLE_VALID_S_SW) &&
           scores->s_pend > 0.0f && scores->s_jump > 0.0f && scores->s_sw > 0.0f;
}

static void score_walk(const saddle_model_t *model, const saddle_posture_t *posture,
                       saddle_scores_t *scores)
{
    const uint32_t known = posture->known;
    scores->v_comp_m_s = posture->v_comp_m_s;
    scores->valid |= (uint32_t)SADDLE_VALID_V_COMP;
    if ((known & (uint32_t)SADDLE_KNOWN_HALF_STEP) != 0u) {
        score_steps(model, posture, scores);
    }
    if ((known & (uint32_t)SADDLE_KNOWN_FEET) != 0u) {
        const float midline_m =
            0.5f * (posture->cop_m[SADDLE_LEFT].y + posture->cop_m[SADDLE_RIGHT].y);
        scores->s_sw = saddle_width_score(posture->com.com_m.y - midline_m,
                                          saddle_step_width_m(model, posture->v_comp_m_s));
        scores->valid |= (uint32_t)SADDLE_VALID_S_SW;
    }
}

static void score_nothing(saddle_scores_t *scores)
{
    scores->valid = 0;
    scores->v_comp_m_s = 0.0f;
    scores->s_pend = 0.0f;
    scores->s_jump = 0.0f;
    scores->s_sw = 0.0f;
    scores->mos_com_m = 0.0f;
    scores->mos_xcom_m = 0.0f;
    scores->gravity_n.x = 0.0f;
    scores->gravity_n.y = 0.0f;
    scores->excess_stop_j = 0.0f;
    scores->can_stop = false;
    scores->xcom_m.x = 0.0f;
    scores->xcom_m.y = 0.0f;
    scores->bos = saddle_bos_undefined();
}

void saddle_score_posture(const saddle_model_t *model, const saddle_posture_t *posture,
                          saddle_scores_t *scores, saddle_support_t *support)
{
    support->cop_m = posture->cop_m;
    support->bos = &scores->bos;
    support->at_com.reached = false;
    score_nothing(scores);
    if ((posture->known & (uint32_t)SADDLE_KNOWN_VELOCITY) != 0u) {
        scores->xcom_m = saddle_xcom_m(posture->com.com_m, posture->com.velocity_m_s,
                                       model->body.natural_frequency_rad_s);
    }
    if ((posture->known & (uint32_t)SADDLE_KNOWN_SPEED) != 0u) {
        score_walk(model, posture, scores);
    }
    if ((posture->known & (uint32_t)SADDLE_KNOWN_FEET) != 0u) {
        support->at_com =
            saddle_surface(posture->cop_m, posture->com.com_m, model->body.pendulum_m);
        score_space(model, posture, support, scores);
    }
    scores->paper_stable = scores->can_stop || stable_step(scores);
}

uint32_t saddle_score_faults(uint32_t known, const saddle_scores_t *scores)
{
    const uint32_t for_steps = (uint32_t)SADDLE_KNOWN_SPEED | (uint32_t)SADDLE_KNOWN_HALF_STEP;
    uint32_t faults = 0;
    if ((known & (uint32_t)SADDLE_KNOWN_FEET) != 0u && !scores->bos.defined) {
        faults |= (uint32_t)SADDLE_FAULT_FEET_TOGETHER;
    }
    if ((known & for_steps) == for_steps &&
        !saddle_scores_hold(scores, (uint32_t)SADDLE_VALID_STEP)) {
        faults |= (uint32_t)SADDLE_FAULT_SPEED_INFEASIBLE;
    }
    return faults;
}
