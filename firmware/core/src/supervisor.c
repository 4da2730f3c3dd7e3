#include <saddlewalk/saddle_math.h>
#include <saddlewalk/stability_scores.h>
#include <saddlewalk/supervisor.h>

/* Beyond these a measurement of a person who stands or walks is absurd. */
#define COM_HEIGHT_MIN_M 0.1f
#define COM_HEIGHT_MAX_M 2.5f
#define COM_SPEED_MAX_M_S 6.0f
#define COP_DISTANCE_MAX_M 2.5f

static bool vec2_within(saddle_vec2_t v, float max)
{
    return saddle_in_range(v.x, -max, max) && saddle_in_range(v.y, -max, max);
}

static bool stale(const saddle_config_t *config, uint32_t age_us)
{
    return (float)age_us > config->measurement_max_age_s * 1.0e6f;
}

static uint32_t judge_com(const saddle_config_t *config, const saddle_measurement_t *measurement)
{
    if (stale(config, measurement->com.age_us)) {
        return (uint32_t)SADDLE_FAULT_COM_STALE;
    }
    if (!saddle_in_range(measurement->com.height_m, COM_HEIGHT_MIN_M, COM_HEIGHT_MAX_M) ||
        !vec2_within(measurement->com.velocity_m_s, COM_SPEED_MAX_M_S)) {
        return (uint32_t)SADDLE_FAULT_COM_RANGE;
    }
    return 0;
}

static uint32_t judge_foot(const saddle_config_t *config, const saddle_measurement_t *measurement,
                           saddle_side_t side)
{
    const bool left = side == SADDLE_LEFT;
    if (stale(config, measurement->foot[side].age_us)) {
        return (uint32_t)(left ? SADDLE_FAULT_LEFT_STALE : SADDLE_FAULT_RIGHT_STALE);
    }
    if (!vec2_within(measurement->foot[side].cop_m, COP_DISTANCE_MAX_M)) {
        return (uint32_t)(left ? SADDLE_FAULT_LEFT_RANGE : SADDLE_FAULT_RIGHT_RANGE);
    }
    return 0;
}

/* A usable foot that was in the air and is on the ground now. */
static bool heel_strike(saddle_supervisor_t *supervisor, const saddle_measurement_t *measurement,
                        saddle_side_t side)
{
    const bool contact = measurement->foot[side].contact;
    const bool strike = contact && supervisor->airborne[side];
    supervisor->airborne[side] = !contact;
    return strike;
}

/* v_CoMp: the velocity integrated by the trapezoidal rule from one heel strike to the next. */
static void follow_speed(saddle_supervisor_t *supervisor, bool velocity_known, float velocity_m_s,
                         float dt_s, bool strike)
{
    supervisor->step_open = supervisor->step_open && velocity_known;
    if (supervisor->step_open) {
        supervisor->step_distance_m += 0.5f * dt_s * (supervisor->last_velocity_m_s + velocity_m_s);
        supervisor->step_duration_s += dt_s;
    }
    if (velocity_known) {
        supervisor->last_velocity_m_s = velocity_m_s;
    }
    if (!strike) {
        return;
    }
    if (supervisor->step_open && supervisor->step_duration_s > 0.0f) {
        supervisor->v_comp_m_s = supervisor->step_distance_m / supervisor->step_duration_s;
        supervisor->v_comp_known = true;
    }
    supervisor->step_open = velocity_known;
    supervisor->step_distance_m = 0.0f;
    supervisor->step_duration_s = 0.0f;
}

static void follow_half_step(saddle_supervisor_t *supervisor,
                             const saddle_measurement_t *measurement)
{
    const float distance_m =
        measurement->foot[SADDLE_LEFT].cop_m.x - measurement->foot[SADDLE_RIGHT].cop_m.x;
    supervisor->half_step_m = 0.5f * (distance_m < 0.0f ? -distance_m : distance_m);
    supervisor->half_step_known = true;
}

static void score_steps(const saddle_config_t *config, const saddle_body_t *body,
                        const saddle_posture_t *posture, saddle_scores_t *scores)
{
    const saddle_step_bounds_t bounds = saddle_step_bounds(config, body, posture->v_comp_m_s);
    if (!bounds.feasible) {
        return;
    }
    scores->s_pend = saddle_step_score(posture->half_step_m, bounds.reference_m, bounds.min_m);
    scores->s_jump = saddle_step_score(posture->half_step_m, bounds.reference_m, bounds.max_m);
    scores->valid |= (uint32_t)SADDLE_VALID_STEP;
}

static void score_space(const saddle_config_t *config, const saddle_body_t *body,
                        const saddle_posture_t *posture, saddle_scores_t *scores)
{
    scores->bos = saddle_bos(posture->cop_m, config->cop_range_m);
    if (!scores->bos.defined) {
        return;
    }
    scores->mos_com_m = saddle_bos_margin_m(&scores->bos, posture->com_m);
    scores->valid |= (uint32_t)SADDLE_VALID_MOS_COM;
    if ((posture->known & SADDLE_KNOWN_VELOCITY) != 0u) {
        scores->mos_xcom_m = saddle_bos_margin_m(&scores->bos, scores->xcom_m);
        scores->valid |= (uint32_t)SADDLE_VALID_MOS_XCOM;
    }
    if (saddle_gravity_force(posture->cop_m, posture->com_m, body->pendulum_m,
                             config->body_mass_kg, &scores->gravity_n)) {
        scores->valid |= (uint32_t)SADDLE_VALID_GRAVITY;
    }
}

saddle_scores_t saddle_score_posture(const saddle_config_t *config, const saddle_body_t *body,
                                     const saddle_posture_t *posture)
{
    saddle_scores_t scores = {.valid = 0};
    const uint32_t known = posture->known;
    if ((known & SADDLE_KNOWN_VELOCITY) != 0u) {
        scores.xcom_m = saddle_xcom_m(posture->com_m, posture->com_velocity_m_s,
                                      body->natural_frequency_rad_s);
    }
    if ((known & SADDLE_KNOWN_SPEED) != 0u) {
        scores.v_comp_m_s = posture->v_comp_m_s;
        scores.valid |= (uint32_t)SADDLE_VALID_V_COMP;
        if ((known & SADDLE_KNOWN_HALF_STEP) != 0u) {
            score_steps(config, body, posture, &scores);
        }
        if ((known & SADDLE_KNOWN_FEET) != 0u) {
            const float midline_m =
                0.5f * (posture->cop_m[SADDLE_LEFT].y + posture->cop_m[SADDLE_RIGHT].y);
            scores.s_sw = saddle_width_score(posture->com_m.y - midline_m,
                                             saddle_step_width_m(config, posture->v_comp_m_s));
            scores.valid |= (uint32_t)SADDLE_VALID_S_SW;
        }
    }
    if ((known & SADDLE_KNOWN_FEET) != 0u) {
        score_space(config, body, posture, &scores);
    }
    return scores;
}

/* What was known and gave no score all the same. */
static uint32_t judge_scores(uint32_t known, const saddle_scores_t *scores)
{
    const uint32_t for_steps = (uint32_t)SADDLE_KNOWN_SPEED | (uint32_t)SADDLE_KNOWN_HALF_STEP;
    uint32_t faults = 0;
    if ((known & SADDLE_KNOWN_FEET) != 0u && !scores->bos.defined) {
        faults |= (uint32_t)SADDLE_FAULT_FEET_TOGETHER;
    }
    if ((known & for_steps) == for_steps && (scores->valid & SADDLE_VALID_STEP) == 0u) {
        faults |= (uint32_t)SADDLE_FAULT_SPEED_INFEASIBLE;
    }
    return faults;
}

uint32_t saddle_supervisor_judge(const saddle_config_t *config,
                                 const saddle_measurement_t *measurement)
{
    return judge_com(config, measurement) | judge_foot(config, measurement, SADDLE_LEFT) |
           judge_foot(config, measurement, SADDLE_RIGHT);
}

uint32_t saddle_supervisor_update(saddle_supervisor_t *supervisor, const saddle_config_t *config,
                                  const saddle_body_t *body,
                                  const saddle_measurement_t *measurement, uint32_t faults,
                                  float dt_s, float planned_speed_m_s, saddle_scores_t *scores)
{
    const bool com_known =
        (faults & ((uint32_t)SADDLE_FAULT_COM_STALE | (uint32_t)SADDLE_FAULT_COM_RANGE)) == 0u;
    const bool left_known =
        (faults & ((uint32_t)SADDLE_FAULT_LEFT_STALE | (uint32_t)SADDLE_FAULT_LEFT_RANGE)) == 0u;
    const bool right_known =
        (faults & ((uint32_t)SADDLE_FAULT_RIGHT_STALE | (uint32_t)SADDLE_FAULT_RIGHT_RANGE)) == 0u;
    const bool feet_known = left_known && right_known;

    const bool left_strike = left_known && heel_strike(supervisor, measurement, SADDLE_LEFT);
    const bool right_strike =
        right_known && heel_strike(supervisor, measurement, SADDLE_RIGHT);
    const bool strike = left_strike || right_strike;
    follow_speed(supervisor, com_known, measurement->com.velocity_m_s.x, dt_s, strike);
    if (strike && feet_known) {
        follow_half_step(supervisor, measurement);
    }

    const bool speed_known = supervisor->v_comp_known || planned_speed_m_s > 0.0f;
    const saddle_posture_t posture = {
        .com_velocity_m_s = measurement->com.velocity_m_s,
        .cop_m = {measurement->foot[SADDLE_LEFT].cop_m, measurement->foot[SADDLE_RIGHT].cop_m},
        .v_comp_m_s = supervisor->v_comp_known ? supervisor->v_comp_m_s : planned_speed_m_s,
        .half_step_m = supervisor->half_step_m,
        .known = (feet_known ? (uint32_t)SADDLE_KNOWN_FEET : 0u) |
                 (com_known ? (uint32_t)SADDLE_KNOWN_VELOCITY : 0u) |
                 (speed_known ? (uint32_t)SADDLE_KNOWN_SPEED : 0u) |
                 (supervisor->half_step_known ? (uint32_t)SADDLE_KNOWN_HALF_STEP : 0u),
    };
    *scores = saddle_score_posture(config, body, &posture);
    return faults | judge_scores(posture.known, scores);
}
