#include "sense/plausibility.h"

#include "math/elementary.h"
#include "math/vec2.h"

#include <saddlewalk/saddlewalk.h>

/* Not even a body that lies has its CoM nearer to the ground. */
#define COM_HEIGHT_MIN_M 0.05f

/* Beyond these a measurement of a person who stands or walks is absurd. */
#define COM_SPEED_MAX_M_S 6.0f
#define COP_DISTANCE_MAX_M 2.5f

/* A number that keeps its bits is frozen once the rest of the body says that it moved by this. */
#define FROZEN_DISTANCE_M 0.02f

/* A CoM that is slower may leave the feet where they are, to the bit. */
#define REST_M_S 0.02f

saddle_measurement_t saddle_no_measurement(void)
{
    const saddle_vec2_t zero = {0.0f, 0.0f};
    saddle_measurement_t none;
    none.com.height_m = 0.0f;
    none.com.velocity_m_s = zero;
    none.com.age_us = SADDLE_AGE_NEVER_US;
    for (int side = 0; side < 2; side++) {
        none.foot[side].cop_m = zero;
        none.foot[side].ground_m_s = 0.0f;
        none.foot[side].contact = false;
        none.foot[side].since_us = 0;
        none.foot[side].age_us = SADDLE_AGE_NEVER_US;
    }
    return none;
}

static bool vec2_within(saddle_vec2_t v, float max)
{
    return saddle_magnitude(v.x) <= max && saddle_magnitude(v.y) <= max;
}

static bool same(saddle_vec2_t a, saddle_vec2_t b)
{
    return a.x == b.x && a.y == b.y;
}

static uint32_t check_com(const saddle_model_t *model, const saddle_measurement_t *measurement)
{
    if ((float)measurement->com.age_us > model->body.com_max_age_us) {
        return (uint32_t)SADDLE_FAULT_COM_STALE;
    }
    if (!saddle_in_range(measurement->com.height_m, COM_HEIGHT_MIN_M,
                         model->config.body_height_m) ||
        !vec2_within(measurement->com.velocity_m_s, COM_SPEED_MAX_M_S)) {
        return (uint32_t)SADDLE_FAULT_COM_RANGE;
    }
    return measurement->com.height_m < model->body.com_height_min_m ? (uint32_t)SADDLE_FAULT_COM_LOW
                                                                    : 0u;
}

static uint32_t check_foot(const saddle_model_t *model, const saddle_measurement_t *measurement,
                           saddle_side_t side)
{
    const bool left = side == SADDLE_LEFT;
    if ((float)measurement->foot[side].age_us > model->body.foot_max_age_us) {
        return (uint32_t)(left ? SADDLE_FAULT_LEFT_STALE : SADDLE_FAULT_RIGHT_STALE);
    }
    if (!vec2_within(measurement->foot[side].cop_m, COP_DISTANCE_MAX_M) ||
        !saddle_in_range(measurement->foot[side].ground_m_s, -COM_SPEED_MAX_M_S,
                         COM_SPEED_MAX_M_S)) {
        return (uint32_t)(left ? SADDLE_FAULT_LEFT_RANGE : SADDLE_FAULT_RIGHT_RANGE);
    }
    return 0;
}

static void begin_timer(saddle_frozen_timer_t *timer)
{
    *timer = (saddle_frozen_timer_t){.unchanged_s = 0.0f};
}

/* Let time pass for a number that keeps its bits. */
static void follow_timer(saddle_frozen_timer_t *timer, saddle_vec2_t velocity_m_s, float dt_s)
{
    timer->unchanged_s += dt_s;
    timer->moved_m = saddle_vec2_add(timer->moved_m, saddle_vec2_scale(dt_s, velocity_m_s));
}

/* The CoM moved over a foot whose place relative to it did not. */
static bool foot_frozen(saddle_plausibility_t *plausibility, const saddle_model_t *model,
                        const saddle_measurement_t *measurement, saddle_side_t side, float dt_s)
{
    saddle_frozen_timer_t *timer = &plausibility->foot_timer[side];
    const saddle_vec2_t velocity_m_s = measurement->com.velocity_m_s;
    if (!same(measurement->foot[side].cop_m, plausibility->cop_m[side]) ||
        vec2_within(velocity_m_s, REST_M_S)) {
        begin_timer(timer);
        return false;
    }
    follow_timer(timer, velocity_m_s, dt_s);
    return timer->unchanged_s > model->config.foot_max_age_s &&
           !vec2_within(timer->moved_m, FROZEN_DISTANCE_M);
}

/* The CoM has changed: from now on a foot on the ground should stay where it is. */
static void begin_watch(saddle_plausibility_t *plausibility,
                        const saddle_measurement_t *measurement)
{
    begin_timer(&plausibility->com_timer);
    plausibility->planned_distance_m = 0.0f;
    plausibility->com_contradicted = false;
    for (int side = 0; side < 2; side++) {
        plausibility->stood[side] = measurement->foot[side].contact;
        plausibility->anchor_m[side] = measurement->foot[side].cop_m;
    }
}

/* A foot on the ground is where it was, if the CoM went the way that its velocity says. */
static bool contradicts(saddle_vec2_t *anchor_m, bool anchored, saddle_vec2_t cop_m,
                        saddle_vec2_t distance_m)
{
    const saddle_vec2_t place_m = saddle_vec2_add(cop_m, distance_m);
    if (!anchored) {
        *anchor_m = place_m;
        return false;
    }
    return !vec2_within(saddle_vec2_sub(place_m, *anchor_m), FROZEN_DISTANCE_M);
}

/* The CoM kept its bits, and a foot on the ground went another way than they say, or a walk was
 * planned: nobody walks without a change. */
static bool com_frozen(saddle_plausibility_t *plausibility, const saddle_model_t *model,
                       const saddle_measurement_t *measurement, float planned_m_s, float dt_s)
{
    saddle_frozen_timer_t *timer = &plausibility->com_timer;
    if (measurement->com.height_m != plausibility->height_m ||
        !same(measurement->com.velocity_m_s, plausibility->velocity_m_s)) {
        begin_watch(plausibility, measurement);
        return false;
    }
    follow_timer(timer, measurement->com.velocity_m_s, dt_s);
    plausibility->planned_distance_m += planned_m_s * dt_s;
    if (plausibility->planned_distance_m > FROZEN_DISTANCE_M) {
        plausibility->com_contradicted = true;
    }
    for (int side = 0; side < 2; side++) {
        const bool contact = measurement->foot[side].contact;
        const bool anchored = contact && plausibility->stood[side];
        plausibility->stood[side] = contact;
        if (contradicts(&plausibility->anchor_m[side], anchored, measurement->foot[side].cop_m,
                        timer->moved_m)) {
            plausibility->com_contradicted = true;
        }
    }
    return plausibility->com_contradicted && timer->unchanged_s > model->config.com_max_age_s;
}

static uint32_t check_frozen(saddle_plausibility_t *plausibility, const saddle_model_t *model,
                             const saddle_measurement_t *measurement, float planned_m_s, float dt_s)
{
    uint32_t faults = 0;
    if (com_frozen(plausibility, model, measurement, planned_m_s, dt_s)) {
        faults |= (uint32_t)SADDLE_FAULT_COM_FROZEN;
    }
    if (foot_frozen(plausibility, model, measurement, SADDLE_LEFT, dt_s)) {
        faults |= (uint32_t)SADDLE_FAULT_LEFT_FROZEN;
    }
    if (foot_frozen(plausibility, model, measurement, SADDLE_RIGHT, dt_s)) {
        faults |= (uint32_t)SADDLE_FAULT_RIGHT_FROZEN;
    }
    plausibility->velocity_m_s = measurement->com.velocity_m_s;
    plausibility->height_m = measurement->com.height_m;
    plausibility->cop_m[SADDLE_LEFT] = measurement->foot[SADDLE_LEFT].cop_m;
    plausibility->cop_m[SADDLE_RIGHT] = measurement->foot[SADDLE_RIGHT].cop_m;
    return faults;
}

/* What was not measured contradicts nothing. */
static void forget_frozen(saddle_plausibility_t *plausibility)
{
    begin_timer(&plausibility->com_timer);
    plausibility->planned_distance_m = 0.0f;
    plausibility->com_contradicted = false;
    for (int side = 0; side < 2; side++) {
        begin_timer(&plausibility->foot_timer[side]);
        plausibility->stood[side] = false;
    }
}

static uint32_t check_feet(saddle_plausibility_t *plausibility, const saddle_model_t *model,
                           const saddle_measurement_t *measurement, float dt_s)
{
    const float width_m =
        measurement->foot[SADDLE_LEFT].cop_m.y - measurement->foot[SADDLE_RIGHT].cop_m.y;
    const bool flight =
        !measurement->foot[SADDLE_LEFT].contact && !measurement->foot[SADDLE_RIGHT].contact;
    plausibility->flight_s = flight ? plausibility->flight_s + dt_s : 0.0f;
    uint32_t faults = 0;
    if (plausibility->flight_s > model->config.flight_max_s) {
        faults |= (uint32_t)SADDLE_FAULT_AIRBORNE;
    }
    if (width_m < -model->config.crossing_max_m) {
        faults |= (uint32_t)SADDLE_FAULT_FEET_CROSSED;
    }
    return faults;
}

SADDLE_NOINLINE uint32_t saddle_measurement_check(saddle_plausibility_t *plausibility,
                                                  const saddle_model_t *model,
                                                  const saddle_measurement_t *measurement,
                                                  float planned_m_s, float dt_s)
{
    const uint32_t feet =
        check_foot(model, measurement, SADDLE_LEFT) | check_foot(model, measurement, SADDLE_RIGHT);
    uint32_t faults = check_com(model, measurement) | feet;
    if (feet == 0u) {
        faults |= check_feet(plausibility, model, measurement, dt_s);
    }
    if ((faults & (SADDLE_FAULTS_COM | SADDLE_FAULTS_LEFT | SADDLE_FAULTS_RIGHT)) == 0u) {
        faults |= check_frozen(plausibility, model, measurement, planned_m_s, dt_s);
    } else {
        forget_frozen(plausibility);
    }
    return faults;
}
