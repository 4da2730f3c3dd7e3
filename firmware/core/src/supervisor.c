#include <saddlewalk/saddle_math.h>
#include <saddlewalk/stability_scores.h>
#include <saddlewalk/supervisor.h>

/* A foot that landed by less ahead made no step to go by. */
#define HALF_STEP_MIN_M 0.02f

/* Walks that a measured one is compared with. */
#define SPEED_MIN_M_S 0.01f
#define SPEED_MAX_M_S 3.9f

static bool holds(const saddle_scores_t *scores, uint32_t results)
{
    return (scores->valid & results) == results;
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

static void score_energy(const saddle_config_t *config, const saddle_body_t *body,
                         const saddle_posture_t *posture, saddle_scores_t *scores)
{
    const saddle_com_state_t state = {posture->com_m, posture->com_velocity_m_s};
    if (saddle_excess_stop_j(config, body, posture->cop_m, &scores->bos, &state,
                             &scores->excess_stop_j)) {
        scores->can_stop = saddle_ankle_work_j(config, body) >= scores->excess_stop_j;
        scores->valid |= (uint32_t)SADDLE_VALID_STOP;
    }
}

static void score_space(const saddle_config_t *config, const saddle_body_t *body,
                        const saddle_posture_t *posture, saddle_scores_t *scores)
{
    scores->bos = saddle_bos(posture->cop_m, config->cop_range_m, config->bos_factor);
    if (!scores->bos.defined) {
        return;
    }
    scores->mos_com_m = saddle_bos_margin_m(&scores->bos, posture->com_m);
    scores->valid |= (uint32_t)SADDLE_VALID_MOS_COM;
    if ((posture->known & SADDLE_KNOWN_VELOCITY) != 0u) {
        scores->mos_xcom_m = saddle_bos_margin_m(&scores->bos, scores->xcom_m);
        scores->valid |= (uint32_t)SADDLE_VALID_MOS_XCOM;
        score_energy(config, body, posture, scores);
    }
    if (saddle_gravity_force(posture->cop_m, posture->com_m, body->pendulum_m,
                             config->body_mass_kg, &scores->gravity_n)) {
        scores->valid |= (uint32_t)SADDLE_VALID_GRAVITY;
    }
}

static bool stable_step(const saddle_scores_t *scores)
{
    return holds(scores, (uint32_t)SADDLE_VALID_STEP | (uint32_t)SADDLE_VALID_S_SW) &&
           scores->s_pend > 0.0f && scores->s_jump > 0.0f && scores->s_sw > 0.0f;
}

static void score_walk(const saddle_config_t *config, const saddle_body_t *body,
                       const saddle_posture_t *posture, saddle_scores_t *scores)
{
    const uint32_t known = posture->known;
    scores->v_comp_m_s = posture->v_comp_m_s;
    scores->valid |= (uint32_t)SADDLE_VALID_V_COMP;
    if ((known & SADDLE_KNOWN_HALF_STEP) != 0u) {
        score_steps(config, body, posture, scores);
    }
    if ((known & SADDLE_KNOWN_FEET) != 0u) {
        const float midline_m =
            0.5f * (posture->cop_m[SADDLE_LEFT].y + posture->cop_m[SADDLE_RIGHT].y);
        scores->s_sw = saddle_width_score(posture->com_m.y - midline_m,
                                          saddle_step_width_m(config, posture->v_comp_m_s));
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

void saddle_score_posture(const saddle_config_t *config, const saddle_body_t *body,
                          const saddle_posture_t *posture, saddle_scores_t *scores)
{
    score_nothing(scores);
    if ((posture->known & SADDLE_KNOWN_VELOCITY) != 0u) {
        scores->xcom_m = saddle_xcom_m(posture->com_m, posture->com_velocity_m_s,
                                       body->natural_frequency_rad_s);
    }
    if ((posture->known & SADDLE_KNOWN_SPEED) != 0u) {
        score_walk(config, body, posture, scores);
    }
    if ((posture->known & SADDLE_KNOWN_FEET) != 0u) {
        score_space(config, body, posture, scores);
    }
    scores->paper_stable = scores->can_stop || stable_step(scores);
}

/* What was known and gave no score all the same. */
static uint32_t judge_scores(uint32_t known, const saddle_scores_t *scores)
{
    const uint32_t for_steps = (uint32_t)SADDLE_KNOWN_SPEED | (uint32_t)SADDLE_KNOWN_HALF_STEP;
    uint32_t faults = 0;
    if ((known & SADDLE_KNOWN_FEET) != 0u && !scores->bos.defined) {
        faults |= (uint32_t)SADDLE_FAULT_FEET_TOGETHER;
    }
    if ((known & for_steps) == for_steps && !holds(scores, (uint32_t)SADDLE_VALID_STEP)) {
        faults |= (uint32_t)SADDLE_FAULT_SPEED_INFEASIBLE;
    }
    return faults;
}

static saddle_vec2_t less(saddle_vec2_t a, saddle_vec2_t b)
{
    return (saddle_vec2_t){a.x - b.x, a.y - b.y};
}

static saddle_vec2_t plus(saddle_vec2_t a, saddle_vec2_t b)
{
    return (saddle_vec2_t){a.x + b.x, a.y + b.y};
}

static saddle_vec2_t xcom_of(const saddle_body_t *body, const saddle_com_state_t *state)
{
    return saddle_xcom_m(state->com_m, state->velocity_m_s, body->natural_frequency_rad_s);
}

static void compare_nothing(saddle_verdict_t *verdict)
{
    const saddle_vec2_t zero_m = {0.0f, 0.0f};
    verdict->compared = false;
    verdict->on_track = false;
    verdict->excess_track_j = 0.0f;
    verdict->ebos_com_m = 0.0f;
    verdict->ebos_xcom_m = 0.0f;
    verdict->xcom_deviation_m = zero_m;
    verdict->recovery.found = false;
    verdict->recovery.stops = false;
    verdict->recovery.foot = 0;
    verdict->recovery.landing_m = zero_m;
    verdict->recovery.margin_m = 0.0f;
}

/* What any planned state says about the measured one. */
static void compare_state(const saddle_config_t *config, const saddle_body_t *body,
                          const saddle_posture_t *posture, const saddle_scores_t *scores,
                          const saddle_com_state_t *planned, saddle_verdict_t *verdict)
{
    const saddle_com_state_t measured = {posture->com_m, posture->com_velocity_m_s};
    const bool reached = saddle_excess_track_j(config, body, posture->cop_m, &scores->bos,
                                               &measured, planned, &verdict->excess_track_j);
    verdict->compared = true;
    verdict->on_track = reached && saddle_ankle_work_j(config, body) >= verdict->excess_track_j;
    verdict->xcom_deviation_m = less(scores->xcom_m, xcom_of(body, planned));
}

/* trailing_m: the other foot, from the stance foot. */
static saddle_vec2_t least_deviation_m(const saddle_config_t *config, saddle_vec2_t deviation_m,
                                       saddle_vec2_t trailing_m, const saddle_growth_t *growth)
{
    const saddle_cop_shift_t ap = {config->cop_shift_ap_m, trailing_m.x};
    const saddle_cop_shift_t ml = {config->cop_shift_ml_m, trailing_m.y};
    const saddle_vec2_t least_m = {saddle_least_deviation_m(deviation_m.x, ap, growth),
                                   saddle_least_deviation_m(deviation_m.y, ml, growth)};
    return least_m;
}

/* Both feet are to stand: no heel strike is expected, and the foot on the side to which the XCoM
 * departs can make a recovery step. from_middle: the planned CoM, from midway between the feet. */
static void compare_standing(const saddle_config_t *config, const saddle_body_t *body,
                             const saddle_posture_t *posture, const saddle_scores_t *scores,
                             const saddle_com_state_t *from_middle, saddle_verdict_t *verdict)
{
    const saddle_com_state_t planned = {plus(scores->bos.centre_m, from_middle->com_m),
                                        from_middle->velocity_m_s};
    compare_state(config, body, posture, scores, &planned, verdict);
    verdict->ebos_com_m = scores->mos_com_m;
    verdict->ebos_xcom_m = scores->mos_xcom_m;

    const saddle_growth_t growth = saddle_growth(body, config->foresight_s, false);
    const saddle_side_t foot =
        verdict->xcom_deviation_m.y > 0.0f ? SADDLE_LEFT : SADDLE_RIGHT;
    const saddle_side_t stance = saddle_other_side(foot);
    const saddle_vec2_t from_stance_m = less(posture->cop_m[foot], posture->cop_m[stance]);
    const saddle_catch_t to_catch = {
        .stance = stance,
        .landing_m = from_stance_m,
        .xcom_m = less(xcom_of(body, &planned), posture->cop_m[stance]),
        .departure_m =
            least_deviation_m(config, verdict->xcom_deviation_m, from_stance_m, &growth),
        .step_time_s = config->foresight_s,
    };
    saddle_recovery_step(config, body, &to_catch, &verdict->recovery);
}

/* The step that a steady walk makes on the stance foot, after a step as the last one was. Who is
 * faster than the ceiling makes steps of full reach. */
static saddle_step_t usual_step(const saddle_config_t *config, const saddle_body_t *body,
                                const saddle_step_tracker_t *steps, float speed_m_s)
{
    const saddle_side_t stance = (saddle_side_t)steps->stance;
    const saddle_side_t foot = saddle_other_side(stance);
    const float walked_m_s = saddle_clamp(speed_m_s, 0.0f, body->speed_ceiling_m_s);
    const float half_step_m =
        saddle_position_to_m(saddle_half_step(config, foot, saddle_speed_from_m_s(walked_m_s)));
    const float width_m = saddle_step_width_m(config, speed_m_s);
    const bool stepped = steps->half_step_known && steps->half_step_m > HALF_STEP_MIN_M;
    const float last_width_m =
        stepped ? saddle_clamp(steps->step_width_m, 0.5f * width_m, 2.0f * width_m) : width_m;
    const saddle_step_t step = {
        .stance = stance,
        .speed_m_s = speed_m_s,
        .half_behind_m = stepped ? steps->half_step_m : half_step_m,
        .width_behind_m = last_width_m,
        .landing_m = {2.0f * half_step_m, foot == SADDLE_LEFT ? last_width_m : -last_width_m},
    };
    return step;
}

/* The wearer is on the planned step: on its stance foot, if with the other one too. */
static bool on_planned_step(const saddle_step_tracker_t *steps,
                            const saddle_measurement_t *measurement,
                            const saddle_intent_t *intent)
{
    const bool both = measurement->foot[SADDLE_LEFT].contact &&
                      measurement->foot[SADDLE_RIGHT].contact;
    return intent->walking && (both || steps->stance == (uint8_t)intent->step.stance);
}

/* What the deviation now will have become when the foot lands: in the BoS expected there. */
static void foretell(const saddle_config_t *config, const saddle_body_t *body,
                     const saddle_expectation_t *expected, saddle_vec2_t deviation_m,
                     const saddle_growth_t *growth, saddle_verdict_t *verdict)
{
    const saddle_vec2_t landed_m[2] = {{0.0f, 0.0f}, expected->landing_m};
    const saddle_bos_t ebos = saddle_bos(landed_m, config->cop_range_m, config->bos_factor);
    const saddle_vec2_t xcom_deviation_m = verdict->xcom_deviation_m;
    const saddle_vec2_t grown_m = {saddle_grown_m(deviation_m.x, xcom_deviation_m.x, growth),
                                   saddle_grown_m(deviation_m.y, xcom_deviation_m.y, growth)};
    const saddle_vec2_t grown_xcom_m = {growth->factor * xcom_deviation_m.x,
                                        growth->factor * xcom_deviation_m.y};
    verdict->ebos_com_m = saddle_bos_margin_m(&ebos, plus(expected->landing.com_m, grown_m));
    verdict->ebos_xcom_m =
        saddle_bos_margin_m(&ebos, plus(xcom_of(body, &expected->landing), grown_xcom_m));
}

/* trailing: the foot that is to land still carries. */
static void compare_walking(const saddle_config_t *config, const saddle_body_t *body,
                            const saddle_posture_t *posture, const saddle_scores_t *scores,
                            saddle_side_t stance, bool trailing,
                            const saddle_expectation_t *expected, saddle_verdict_t *verdict)
{
    const saddle_vec2_t stance_m = posture->cop_m[stance];
    const saddle_vec2_t trailing_m = less(posture->cop_m[saddle_other_side(stance)], stance_m);
    const saddle_com_state_t planned = {plus(stance_m, expected->now.com_m),
                                        expected->now.velocity_m_s};
    const saddle_growth_t growth = saddle_growth(body, expected->time_s, trailing);
    compare_state(config, body, posture, scores, &planned, verdict);
    foretell(config, body, expected, less(posture->com_m, planned.com_m), &growth, verdict);
    const saddle_catch_t to_catch = {
        .stance = stance,
        .landing_m = expected->landing_m,
        .xcom_m = xcom_of(body, &expected->landing),
        .departure_m =
            least_deviation_m(config, verdict->xcom_deviation_m, trailing_m, &growth),
        .step_time_s = expected->step_time_s,
    };
    saddle_recovery_step(config, body, &to_catch, &verdict->recovery);
}

/* The step that is compared: the planned one, or one at speed_m_s, in the phase where the CoM is. */
static void compare_step(const saddle_config_t *config, const saddle_body_t *body,
                         const saddle_measurement_t *measurement,
                         const saddle_posture_t *posture, const saddle_scores_t *scores,
                         const saddle_step_t *step, float x_m, saddle_verdict_t *verdict)
{
    const saddle_expectation_t expected = saddle_expect(config, step, x_m);
    const bool trailing = measurement->foot[saddle_other_side(step->stance)].contact;
    compare_walking(config, body, posture, scores, step->stance, trailing, &expected, verdict);
}

/* Against what is planned; without a command, against the walk of the last step or standing. */
static void compare(const saddle_config_t *config, const saddle_body_t *body,
                    const saddle_step_tracker_t *steps, const saddle_measurement_t *measurement,
                    const saddle_posture_t *posture, const saddle_scores_t *scores,
                    const saddle_intent_t *intent, saddle_verdict_t *verdict)
{
    if (on_planned_step(steps, measurement, intent)) {
        compare_step(config, body, measurement, posture, scores, &intent->step,
                     intent->com.com_m.x, verdict);
        return;
    }
    const bool walks = intent->leads ? intent->walking : steps->v_comp_known;
    const float speed_m_s = intent->leads ? intent->step.speed_m_s : steps->v_comp_m_s;
    if (walks && saddle_in_range(speed_m_s, SPEED_MIN_M_S, SPEED_MAX_M_S)) {
        const saddle_step_t step = usual_step(config, body, steps, speed_m_s);
        compare_step(config, body, measurement, posture, scores, &step,
                     posture->com_m.x - posture->cop_m[step.stance].x, verdict);
    } else if (!walks && (intent->leads || steps->stands)) {
        compare_standing(config, body, posture, scores, &intent->com, verdict);
    }
}

/* A score that a walk is judged by and that is too low. */
static saddle_reason_t low_score(const saddle_config_t *config, uint32_t faults,
                                 const saddle_scores_t *scores)
{
    const bool steps = holds(scores, (uint32_t)SADDLE_VALID_STEP);
    if ((faults & (uint32_t)SADDLE_FAULT_SPEED_INFEASIBLE) != 0u) {
        return SADDLE_REASON_SPEED;
    }
    if (steps && scores->s_pend < config->caution_score) {
        return SADDLE_REASON_S_PEND;
    }
    if (steps && scores->s_jump < config->caution_score) {
        return SADDLE_REASON_S_JUMP;
    }
    if (holds(scores, (uint32_t)SADDLE_VALID_S_SW) && scores->s_sw < config->caution_score) {
        return SADDLE_REASON_S_SW;
    }
    return SADDLE_REASON_NONE;
}

static saddle_reason_t departure(const saddle_config_t *config, const saddle_verdict_t *verdict)
{
    if (saddle_magnitude(verdict->xcom_deviation_m.x) > config->caution_xcom_ap_m) {
        return SADDLE_REASON_XCOM_AP;
    }
    if (saddle_magnitude(verdict->xcom_deviation_m.y) > config->caution_xcom_ml_m) {
        return SADDLE_REASON_XCOM_ML;
    }
    return verdict->on_track ? SADDLE_REASON_NONE : SADDLE_REASON_OFF_TRACK;
}

static saddle_reason_t reason_of(const saddle_config_t *config, uint32_t faults,
                                 const saddle_scores_t *scores,
                                 const saddle_verdict_t *verdict)
{
    const uint32_t unusable = SADDLE_FAULTS_COM | SADDLE_FAULTS_FEET |
                              (uint32_t)SADDLE_FAULT_FEET_TOGETHER;
    if ((faults & unusable) != 0u) {
        return SADDLE_REASON_INPUT;
    }
    if (!verdict->compared) {
        return SADDLE_REASON_NO_WALK;
    }
    const bool stays = scores->can_stop && scores->mos_xcom_m >= config->stop_margin_m;
    if (!stays && !verdict->recovery.found) {
        return SADDLE_REASON_NO_STEP;
    }
    const saddle_reason_t low = low_score(config, faults, scores);
    return low != SADDLE_REASON_NONE ? low : departure(config, verdict);
}

static saddle_level_t level_of(saddle_reason_t reason)
{
    switch (reason) {
    case SADDLE_REASON_NONE: return SADDLE_LEVEL_STABLE;
    case SADDLE_REASON_INPUT:
    case SADDLE_REASON_NO_WALK:
    case SADDLE_REASON_SETTLING: return SADDLE_LEVEL_UNKNOWN;
    case SADDLE_REASON_NO_STEP: return SADDLE_LEVEL_UNSTABLE;
    default: return SADDLE_LEVEL_CAUTION;
    }
}

static void count(uint8_t *ticks, bool goes_on)
{
    *ticks = (uint8_t)(goes_on ? (*ticks < UINT8_MAX ? *ticks + 1u : UINT8_MAX) : 0u);
}

static void count_levels(saddle_supervisor_t *supervisor, uint8_t level)
{
    const bool known = level != (uint8_t)SADDLE_LEVEL_UNKNOWN;
    for (uint8_t i = SADDLE_LEVEL_STABLE; i <= (uint8_t)SADDLE_LEVEL_UNSTABLE; i++) {
        count(&supervisor->at_least_ticks[i], known && level >= i);
        count(&supervisor->at_most_ticks[i], known && level <= i);
    }
}

/* The worst level that has been reached or passed for long enough; the best one likewise if that is
 * better than the announced one. The announced one if neither has. */
static uint8_t level_held(const saddle_supervisor_t *supervisor, const saddle_config_t *config)
{
    const uint8_t announced = supervisor->level;
    for (uint8_t i = SADDLE_LEVEL_UNSTABLE; i > announced && i > 0u; i--) {
        if ((float)supervisor->at_least_ticks[i] >= config->level_hold_ticks) {
            return i;
        }
    }
    for (uint8_t i = SADDLE_LEVEL_STABLE; i < announced; i++) {
        if ((float)supervisor->at_most_ticks[i] >= config->level_hold_ticks) {
            return i;
        }
    }
    return announced;
}

/* Why the announced level is that, whatever this tick's own reason is. */
static saddle_reason_t announced_reason(const saddle_supervisor_t *supervisor,
                                        saddle_reason_t reason)
{
    switch (supervisor->level) {
    case SADDLE_LEVEL_STABLE: return SADDLE_REASON_NONE;
    case SADDLE_LEVEL_CAUTION: return (saddle_reason_t)supervisor->caution_reason;
    case SADDLE_LEVEL_UNSTABLE: return SADDLE_REASON_NO_STEP;
    default:
        return level_of(reason) == SADDLE_LEVEL_UNKNOWN ? reason : SADDLE_REASON_SETTLING;
    }
}

/* A level is announced once it, or a worse one, has held for long enough, a better one likewise;
 * unknown at once. */
static void announce(saddle_supervisor_t *supervisor, const saddle_config_t *config,
                     saddle_reason_t reason)
{
    const saddle_level_t level = level_of(reason);
    count_levels(supervisor, (uint8_t)level);
    if (level == SADDLE_LEVEL_CAUTION) {
        supervisor->caution_reason = (uint8_t)reason;
    }
    supervisor->level = level == SADDLE_LEVEL_UNKNOWN ? (uint8_t)level
                                                      : level_held(supervisor, config);
    supervisor->reason = (uint8_t)announced_reason(supervisor, reason);
}

void saddle_supervisor_gap(saddle_supervisor_t *supervisor, float gap_s)
{
    saddle_track_gap(&supervisor->steps, gap_s);
    supervisor->level = (uint8_t)SADDLE_LEVEL_UNKNOWN;
    for (int i = 0; i <= (int)SADDLE_LEVEL_UNSTABLE; i++) {
        supervisor->at_least_ticks[i] = 0;
        supervisor->at_most_ticks[i] = 0;
    }
}

uint32_t saddle_supervisor_update(saddle_supervisor_t *supervisor, const saddle_config_t *config,
                                  const saddle_body_t *body,
                                  const saddle_measurement_t *measurement, uint32_t faults,
                                  float dt_s, const saddle_intent_t *intent,
                                  saddle_scores_t *scores, saddle_verdict_t *verdict)
{
    saddle_step_tracker_t *steps = &supervisor->steps;
    saddle_track_steps(steps, config, measurement, faults, dt_s);
    const bool feet_known = (faults & SADDLE_FAULTS_FEET) == 0u;
    const bool com_known = (faults & SADDLE_FAULTS_COM) == 0u;
    const bool is_to_stand = intent->leads && !intent->walking;
    const bool speed_known = !is_to_stand && (steps->v_comp_known || intent->step.speed_m_s > 0.0f);
    const bool half_step_known =
        !is_to_stand && feet_known && com_known && steps->half_step_known;
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
    saddle_score_posture(config, body, &posture, scores);
    const uint32_t all_faults = faults | judge_scores(posture.known, scores);
    compare_nothing(verdict);
    if (com_known && feet_known && scores->bos.defined) {
        compare(config, body, steps, measurement, &posture, scores, intent, verdict);
    }
    announce(supervisor, config, reason_of(config, all_faults, scores, verdict));
    verdict->level = supervisor->level;
    verdict->reason = supervisor->reason;
    return all_faults;
}
