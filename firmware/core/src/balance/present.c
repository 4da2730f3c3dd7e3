#include "balance/present.h"

#include "balance/expected_step.h"
#include "math/bytes.h"
#include "math/elementary.h"
#include "math/vec2.h"

/* What a wearer has done for longer than this does not follow from what was measured. */
#define FORWARD_MAX_US 200000u

/* A departure grows for so much of the age; in the rest the wearer corrects it. Tuned on emulated wearers
 * who are pushed, with measurements 80 and 120 ms late (2026-12): at 1 one in nine who stays up is
 * announced unstable, at 0 the recovery step comes too late for every fourth. */
#define GROWING_SHARE 0.5f

/* Where ticks are closer together than that, not every plan is remembered. */
#define APART_US 70000u

/* The plan of some time ago, in the frame of the newest. */
typedef struct {
    const saddle_past_plan_t *plan; /* the nearest that is remembered */
    saddle_vec2_t foot_m[2], com_m, xcom_m;
} moment_t;

/* A CoM's state, or what it departs from another by. */
typedef struct {
    saddle_vec2_t com_m, xcom_m;
} departure_t;

/* So many before the newest. */
static uint32_t slot(const saddle_past_t *past, uint32_t back)
{
    return (past->newest + SADDLE_PAST_PLANS - back) % SADDLE_PAST_PLANS;
}

static void keep(saddle_past_plan_t *kept, const saddle_plan_t *plan, uint32_t walked_nm)
{
    kept->walked_nm = walked_nm;
    kept->until_next_us = 0;
    kept->support = plan->support;
    for (int side = 0; side < 2; side++) {
        kept->carries[side] = plan->reference.load[side] > 0.0f;
        kept->foot_m[side].x = plan->foot_m[side].x;
        kept->foot_m[side].y = plan->foot_m[side].y;
    }
    kept->com_m = plan->reference.com_m;
    kept->xcom_m = plan->reference.xcom_m;
}

void saddle_remember_plan(saddle_past_t *past, const saddle_plan_t *plan, uint32_t walked_nm,
                          uint32_t dt_us)
{
    saddle_past_plan_t *last = &past->plans[slot(past, 1u)];
    if (past->count > 1u && last->until_next_us < APART_US) {
        last->until_next_us += dt_us;
    } else {
        past->plans[slot(past, 0u)].until_next_us = dt_us;
        past->newest = (uint8_t)((past->newest + 1u) % SADDLE_PAST_PLANS);
        past->count = (uint8_t)(past->count < SADDLE_PAST_PLANS ? past->count + 1u : past->count);
    }
    keep(&past->plans[slot(past, 0u)], plan, walked_nm);
}

static saddle_vec2_t between_m(saddle_vec2_t later_m, saddle_vec2_t earlier_m, float share)
{
    return saddle_vec2_add(later_m, saddle_vec2_scale(share, saddle_vec2_sub(earlier_m, later_m)));
}

/* Its stance foot from the newest's: in so short a time less than 2 m. */
static saddle_vec2_t origin_m(const saddle_past_plan_t *plan, const saddle_past_plan_t *newest)
{
    const uint32_t ahead_nm = plan->walked_nm - newest->walked_nm;
    return (saddle_vec2_t){1.0e-9f * (float)(int32_t)ahead_nm, 0.0f};
}

/* So long ago, or as long as is remembered. */
static void moment_at(const saddle_past_t *past, uint32_t age_us, moment_t *moment)
{
    const saddle_past_plan_t *newest = &past->plans[slot(past, 0u)];
    const saddle_past_plan_t *later = newest;
    const saddle_past_plan_t *earlier = newest;
    uint32_t left_us = age_us;
    float share = 0.0f;
    for (uint32_t back = 1; back < past->count && left_us > 0u; back++) {
        later = earlier;
        earlier = &past->plans[slot(past, back)];
        const uint32_t apart_us = earlier->until_next_us;
        share = left_us < apart_us ? (float)left_us / (float)apart_us : 1.0f;
        left_us = left_us < apart_us ? 0u : left_us - apart_us;
    }
    const saddle_vec2_t from_m =
        between_m(origin_m(later, newest), origin_m(earlier, newest), share);
    moment->plan = share < 0.5f ? later : earlier;
    moment->com_m = saddle_vec2_add(from_m, between_m(later->com_m, earlier->com_m, share));
    moment->xcom_m = saddle_vec2_add(from_m, between_m(later->xcom_m, earlier->xcom_m, share));
    for (int side = 0; side < 2; side++) {
        moment->foot_m[side] =
            saddle_vec2_add(from_m, between_m(later->foot_m[side], earlier->foot_m[side], share));
    }
}

/* A part of the measurement: the plan when it was made, and how a departure has grown since. */
typedef struct {
    moment_t then;
    saddle_growth_t growth;
} part_t;

/* The foot landed before it was planned to, or stayed. */
static bool stays(const moment_t *then, const saddle_measurement_t *measured, int side)
{
    return measured->foot[side].contact && !then->plan->carries[side];
}

static void part_of_age(const saddle_past_t *past, const saddle_model_t *model, uint32_t age_us,
                        const saddle_measurement_t *measured, part_t *part)
{
    const uint32_t forward_us = age_us < FORWARD_MAX_US ? age_us : FORWARD_MAX_US;
    moment_at(past, forward_us, &part->then);
    const bool as_planned =
        !stays(&part->then, measured, SADDLE_LEFT) && !stays(&part->then, measured, SADDLE_RIGHT);
    const float grows_s = as_planned ? GROWING_SHARE * 1.0e-6f * (float)forward_us : 0.0f;
    part->growth = saddle_growth(model, grows_s, false);
}

/* From the reference's. The stance foot's part says where the CoM is, com how fast. */
static departure_t departure_from(const moment_t *com, const moment_t *stance_foot,
                                  const saddle_measurement_t *measured, float w)
{
    const int stance = com->plan->support;
    const saddle_vec2_t planned_m =
        saddle_vec2_sub(stance_foot->com_m, stance_foot->foot_m[stance]);
    const saddle_vec2_t ahead_m =
        saddle_vec2_sub(saddle_vec2_scale(1.0f / w, measured->com.velocity_m_s),
                        saddle_vec2_sub(com->xcom_m, com->com_m));
    departure_t departure;
    departure.com_m =
        saddle_vec2_scale(-1.0f, saddle_vec2_add(measured->foot[stance].cop_m, planned_m));
    departure.xcom_m = saddle_vec2_add(departure.com_m, ahead_m);
    return departure;
}

/* As a pendulum's about the reference's CoP. */
static departure_t grown(const departure_t *departure, const saddle_growth_t *growth)
{
    departure_t grown;
    grown.com_m.x = saddle_grown_m(departure->com_m.x, departure->xcom_m.x, growth);
    grown.com_m.y = saddle_grown_m(departure->com_m.y, departure->xcom_m.y, growth);
    grown.xcom_m = saddle_vec2_scale(growth->factor, departure->xcom_m);
    return grown;
}

static void bring_foot(const saddle_past_plan_t *now, const part_t *part,
                       const departure_t *departure, int side, saddle_measurement_t *present)
{
    const moment_t *then = &part->then;
    saddle_vec2_t *cop_m = &present->foot[side].cop_m;
    const departure_t departed = grown(departure, &part->growth);
    const saddle_vec2_t moved_m =
        saddle_vec2_add(saddle_vec2_sub(now->com_m, then->com_m),
                        saddle_vec2_sub(departed.com_m, departure->com_m));
    *cop_m = saddle_vec2_sub(*cop_m, moved_m);
    if (!stays(then, present, side)) {
        *cop_m = saddle_vec2_add(*cop_m, saddle_vec2_sub(now->foot_m[side], then->foot_m[side]));
        if (now->carries[side] != then->plan->carries[side]) {
            present->foot[side].contact = now->carries[side];
        }
    }
}

/* [E46] */
SADDLE_NOINLINE saddle_side_t saddle_bring_forward(const saddle_past_t *past,
                                                   const saddle_model_t *model,
                                                   const saddle_measurement_t *measured,
                                                   saddle_measurement_t *present)
{
    const float w = model->body.natural_frequency_rad_s;
    const saddle_past_plan_t *now = &past->plans[slot(past, 0u)];
    part_t com, foot[2];
    part_of_age(past, model, measured->com.age_us, measured, &com);
    for (int side = 0; side < 2; side++) {
        part_of_age(past, model, measured->foot[side].age_us, measured, &foot[side]);
    }
    const saddle_side_t stance = (saddle_side_t)com.then.plan->support;
    const departure_t departure = departure_from(&com.then, &foot[stance].then, measured, w);
    const departure_t departed = grown(&departure, &com.growth);
    const saddle_vec2_t ahead_m = saddle_vec2_add(saddle_vec2_sub(now->xcom_m, now->com_m),
                                                  saddle_vec2_sub(departed.xcom_m, departed.com_m));
    saddle_copy(present, measured, sizeof *present);
    present->com.velocity_m_s = saddle_vec2_scale(w, ahead_m);
    bring_foot(now, &foot[SADDLE_LEFT], &departure, SADDLE_LEFT, present);
    bring_foot(now, &foot[SADDLE_RIGHT], &departure, SADDLE_RIGHT, present);
    return stance;
}
