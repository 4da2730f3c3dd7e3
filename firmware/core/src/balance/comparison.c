#include "balance/comparison.h"

#include "balance/recovery_step.h"
#include "balance/stability_scores.h"
#include "math/elementary.h"
#include "math/fixed.h"
#include "math/vec2.h"
#include "model/gait_model.h"

/* A foot that landed by less ahead made no step to go by. */
#define HALF_STEP_MIN_M 0.02f

/* Walks that a measured one is compared with. */
#define SPEED_MIN_M_S 0.01f
#define SPEED_MAX_M_S 3.9f

static saddle_vec2_t xcom_of(const saddle_model_t *model, const saddle_com_state_t *state)
{
    return saddle_xcom_m(state->com_m, state->velocity_m_s, model->body.natural_frequency_rad_s);
}

void saddle_compare_nothing(saddle_verdict_t *verdict)
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
static void compare_state(const saddle_model_t *model, const saddle_wearer_t *wearer,
                          const saddle_com_state_t *planned, saddle_verdict_t *verdict)
{
    const bool reached = saddle_excess_track_j(model, wearer->support, &wearer->posture->com,
                                               planned, &verdict->excess_track_j);
    verdict->compared = true;
    verdict->on_track = reached && model->body.ankle_work_j >= verdict->excess_track_j;
    verdict->xcom_deviation_m = saddle_vec2_sub(wearer->scores->xcom_m, xcom_of(model, planned));
}

/* trailing_m: the other foot, from the stance foot. */
static saddle_vec2_t least_deviation_m(const saddle_model_t *model, saddle_vec2_t deviation_m,
                                       saddle_vec2_t trailing_m, const saddle_growth_t *growth)
{
    const saddle_cop_shift_t ap = {model->config.cop_shift_ap_m, trailing_m.x};
    const saddle_cop_shift_t ml = {model->config.cop_shift_ml_m, trailing_m.y};
    const saddle_vec2_t least_m = {saddle_least_deviation_m(deviation_m.x, ap, growth),
                                   saddle_least_deviation_m(deviation_m.y, ml, growth)};
    return least_m;
}

/* Both feet are to stand: no heel strike is expected, and the foot on the side to which the XCoM
 * departs can make a recovery step. from_middle: the planned CoM, from midway between the feet. */
static SADDLE_NOINLINE void compare_standing(const saddle_model_t *model,
                                             const saddle_wearer_t *wearer,
                                             const saddle_com_state_t *from_middle,
                                             saddle_verdict_t *verdict)
{
    const saddle_posture_t *posture = wearer->posture;
    const saddle_scores_t *scores = wearer->scores;
    const saddle_com_state_t planned = {saddle_vec2_add(scores->bos.centre_m, from_middle->com_m),
                                        from_middle->velocity_m_s};
    compare_state(model, wearer, &planned, verdict);
    verdict->ebos_com_m = scores->mos_com_m;
    verdict->ebos_xcom_m = scores->mos_xcom_m;

    const saddle_growth_t growth = saddle_growth(model, model->config.prediction_horizon_s, false);
    const saddle_side_t foot = verdict->xcom_deviation_m.y > 0.0f ? SADDLE_LEFT : SADDLE_RIGHT;
    const saddle_side_t stance = saddle_other_side(foot);
    const saddle_vec2_t from_stance_m =
        saddle_vec2_sub(posture->cop_m[foot], posture->cop_m[stance]);
    const saddle_recovery_target_t target = {
        .stance = stance,
        .landing_m = from_stance_m,
        .xcom_m = saddle_vec2_sub(xcom_of(model, &planned), posture->cop_m[stance]),
        .departure_m = least_deviation_m(model, verdict->xcom_deviation_m, from_stance_m, &growth),
        .placement_m = {0.0f, 0.0f},
        .step_time_s = model->config.prediction_horizon_s,
    };
    saddle_recovery_step(model, &target, &verdict->recovery);
}

/* The step that a steady walk makes on the stance foot, after a step as the last one was. Who is
 * faster than the ceiling makes steps of full reach. */
static void nominal_step(const saddle_model_t *model, const saddle_step_tracker_t *steps,
                         float speed_m_s, saddle_step_t *step)
{
    const saddle_side_t stance = (saddle_side_t)steps->stance;
    const saddle_side_t foot = saddle_other_side(stance);
    const float walked_m_s = saddle_clamp(speed_m_s, 0.0f, model->body.speed_ceiling_m_s);
    const float half_step_m =
        saddle_position_to_m(saddle_half_step(model, foot, saddle_speed_from_m_s(walked_m_s)));
    const float width_m = saddle_step_width_m(model, speed_m_s);
    const bool stepped = steps->half_step_known && steps->half_step_m > HALF_STEP_MIN_M;
    const float last_width_m =
        stepped ? saddle_clamp(steps->step_width_m, 0.5f * width_m, 2.0f * width_m) : width_m;
    step->stance = stance;
    step->speed_m_s = speed_m_s;
    step->half_behind_m = stepped ? steps->half_step_m : half_step_m;
    step->width_behind_m = last_width_m;
    step->landing_m.x = 2.0f * half_step_m;
    step->landing_m.y = saddle_outward(foot) * last_width_m;
}

/* The wearer was on the planned step: on its stance foot, if with the other one too. */
static bool matches_planned_step(const saddle_wearer_t *wearer, const saddle_intent_t *intent)
{
    const saddle_measurement_t *measurement = wearer->measurement;
    const bool both =
        measurement->foot[SADDLE_LEFT].contact && measurement->foot[SADDLE_RIGHT].contact;
    return intent->walking && (both || wearer->steps->stance == (uint8_t)intent->stance_then);
}

/* What the deviation now will have become when the foot lands: in the BoS expected there. */
static void predict(const saddle_model_t *model, const saddle_expectation_t *expected,
                    saddle_vec2_t deviation_m, const saddle_growth_t *growth,
                    saddle_verdict_t *verdict)
{
    const saddle_vec2_t landed_m[2] = {{0.0f, 0.0f}, expected->landing_m};
    const saddle_bos_t ebos =
        saddle_bos(landed_m, model->config.cop_range_m, model->config.bos_factor);
    const saddle_vec2_t xcom_deviation_m = verdict->xcom_deviation_m;
    const saddle_vec2_t grown_m = {saddle_grown_m(deviation_m.x, xcom_deviation_m.x, growth),
                                   saddle_grown_m(deviation_m.y, xcom_deviation_m.y, growth)};
    const saddle_vec2_t grown_xcom_m = saddle_vec2_scale(growth->factor, xcom_deviation_m);
    verdict->ebos_com_m =
        saddle_bos_margin_m(&ebos, saddle_vec2_add(expected->landing.com_m, grown_m));
    verdict->ebos_xcom_m = saddle_bos_margin_m(
        &ebos, saddle_vec2_add(xcom_of(model, &expected->landing), grown_xcom_m));
}

/* A step, the phase where its CoM is at a place, and what it was compared by. */
typedef struct {
    const saddle_step_t *step;
    const saddle_step_place_t *place;
    saddle_growth_t growth;
    saddle_recovery_target_t target;
    saddle_vec2_t trailing_m;
} step_comparison_t;

static void compare_step(const saddle_model_t *model, const saddle_wearer_t *wearer,
                         step_comparison_t *compared, saddle_verdict_t *verdict)
{
    const saddle_posture_t *posture = wearer->posture;
    const saddle_side_t stance = compared->step->stance;
    const saddle_side_t other = saddle_other_side(stance);
    saddle_expectation_t expected;
    saddle_expect(model, compared->step, compared->place, &expected);
    const saddle_vec2_t stance_m = posture->cop_m[stance];
    const saddle_vec2_t trailing_m = saddle_vec2_sub(posture->cop_m[other], stance_m);
    const saddle_growth_t growth =
        saddle_growth(model, expected.time_s, wearer->measurement->foot[other].contact);
    compared->growth = growth;
    compared->trailing_m = trailing_m;
    saddle_com_state_t *planned = &expected.now;
    planned->com_m = saddle_vec2_add(stance_m, planned->com_m);
    compare_state(model, wearer, planned, verdict);
    predict(model, &expected, saddle_vec2_sub(posture->com.com_m, planned->com_m), &growth,
            verdict);
    compared->target = (saddle_recovery_target_t){
        .stance = stance,
        .landing_m = expected.landing_m,
        .xcom_m = xcom_of(model, &expected.landing),
        .departure_m = least_deviation_m(model, verdict->xcom_deviation_m, trailing_m, &growth),
        .placement_m = {0.0f, 0.0f},
        .step_time_s = expected.step_time_s,
    };
    saddle_recovery_step(model, &compared->target, &verdict->recovery);
}

/* [E45] The recovery step from the reference's XCoM, which a wearer on the plan keeps to; and a share of
 * what the ankles can correct. */
static SADDLE_NOINLINE void place_landing(const saddle_model_t *model,
                                          const saddle_wearer_t *wearer,
                                          const saddle_intent_t *intent,
                                          const step_comparison_t *compared,
                                          saddle_placement_t *placement)
{
    const saddle_vec2_t xcom_m =
        saddle_vec2_sub(wearer->scores->xcom_m, wearer->posture->cop_m[intent->step.stance]);
    const saddle_vec2_t departure_m = saddle_vec2_sub(xcom_m, intent->reference_xcom_m);
    const saddle_vec2_t least_m =
        least_deviation_m(model, departure_m, compared->trailing_m, &compared->growth);
    const saddle_vec2_t corrected_m =
        saddle_vec2_sub(saddle_vec2_scale(compared->growth.factor, departure_m), least_m);
    saddle_recovery_target_t target = compared->target;
    target.departure_m = least_m;
    target.placement_m = saddle_vec2_scale(model->config.placement_gain, corrected_m);
    saddle_recovery_t step;
    saddle_recovery_step(model, &target, &step);
    placement->known = step.found;
    placement->landing_m = step.landing_m;
}

bool saddle_compare(const saddle_model_t *model, const saddle_wearer_t *wearer,
                    const saddle_intent_t *intent, saddle_verdict_t *verdict,
                    saddle_placement_t *placement)
{
    const saddle_step_tracker_t *steps = wearer->steps;
    step_comparison_t compared;
    if (matches_planned_step(wearer, intent)) {
        compared.step = &intent->step;
        compared.place = &intent->place;
        compare_step(model, wearer, &compared, verdict);
        const bool on_stance = steps->stance == (uint8_t)intent->stance_then;
        if (on_stance && intent->may_place) {
            place_landing(model, wearer, intent, &compared, placement);
        }
        return on_stance && intent->stance_then == intent->step.stance;
    }
    const bool walks = intent->leads ? intent->walking : steps->v_comp_known;
    const float speed_m_s = intent->leads ? intent->step.speed_m_s : steps->v_comp_m_s;
    if (walks && saddle_in_range(speed_m_s, SPEED_MIN_M_S, SPEED_MAX_M_S)) {
        const saddle_posture_t *posture = wearer->posture;
        saddle_step_t own;
        nominal_step(model, steps, speed_m_s, &own);
        const saddle_step_place_t place =
            saddle_step_place(&own, posture->com.com_m.x - posture->cop_m[own.stance].x);
        compared.step = &own;
        compared.place = &place;
        compare_step(model, wearer, &compared, verdict);
    } else if (!walks && (intent->leads || steps->stands)) {
        compare_standing(model, wearer, &intent->com, verdict);
    }
    return intent->leads && !walks;
}
