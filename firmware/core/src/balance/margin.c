#include "balance/margin.h"

#include "math/elementary.h"
#include "math/vec2.h"

#include <math.h>

/* What the plan says of a step counts up to here, in CoM heights: beyond it a fall is no nearer. */
#define PLAN_MARGIN_MIN (-0.5f)
#define PLAN_MARGIN_MAX 0.2f

/* Nobody catches a CoM that sinks faster, in sqrt(g h): of the pushed walks of two simulated robots
 * that went on, the fastest sank at 0.29, and sitting down takes less (2026-11). */
#define SINKING_MAX 0.36f
#define SINKING_WEIGHT 6.0f

/* A caution begins at this share of the usual lowest margin of a step, within these shares of
 * caution_margin. */
#define OWN_CAUTION_SHARE 0.5f
#define LEAST_CAUTION 0.25f
#define MOST_CAUTION 2.5f

/* [E33] */
saddle_departure_t saddle_departure(const saddle_model_t *model, const saddle_learning_t *learning,
                                    const saddle_measurement_t *measurement)
{
    const saddle_config_t *config = &model->config;
    const saddle_learned_walk_t *walk = &learning->walk;
    const saddle_vec2_t left_m = measurement->foot[SADDLE_LEFT].cop_m;
    const saddle_vec2_t right_m = measurement->foot[SADDLE_RIGHT].cop_m;
    const float per_height = 1.0f / walk->height_m;
    const float per_speed = 1.0f / sqrtf(SADDLE_GRAVITY_M_S2 * walk->height_m);
    const saddle_vec2_t from_middle_m = saddle_vec2_scale(-0.5f, saddle_vec2_add(left_m, right_m));
    const saddle_vec2_t unusual_m_s =
        saddle_vec2_sub(measurement->com.velocity_m_s, walk->velocity_m_s);
    const float apart_m = saddle_vec2_length(saddle_vec2_sub(left_m, right_m));
    saddle_departure_t departure;
    departure.offset =
        saddle_vec2_add(saddle_vec2_scale(per_height, from_middle_m),
                        saddle_vec2_scale(config->departure_foresight * per_speed, unusual_m_s));
    departure.offset.y *= config->departure_lateral_weight;
    departure.step = 0.5f * config->departure_step_share * apart_m * per_height;
    const float slower_m_s = saddle_larger(learning->climb_m_s, learning->last_climb_m_s);
    departure.sinking = per_speed * saddle_larger(0.0f, -slower_m_s);
    departure.sink =
        config->departure_sink_share * per_speed * saddle_larger(0.0f, -learning->climb_m_s);
    return departure;
}

/* [E34] */
static float tolerance(const saddle_config_t *config, float ripple)
{
    const float tolerated = config->tolerance_max - config->tolerance_ripple_slope * ripple;
    return saddle_larger(tolerated, config->tolerance_min);
}

float saddle_own_margin(const saddle_model_t *model, const saddle_learning_t *learning,
                        const saddle_departure_t *departure)
{
    return tolerance(&model->config, learning->walk.ripple) -
           (saddle_vec2_length(departure->offset) - departure->step + departure->sink);
}

/* [E35] */
float saddle_plan_margin(const saddle_model_t *model, const saddle_learning_t *learning,
                         const saddle_verdict_t *verdict)
{
    const float per_height = 1.0f / learning->walk.height_m;
    const float recovery = verdict->recovery.margin_m * per_height;
    const float landing = verdict->ebos_com_m * per_height;
    const float caught = saddle_clamp(recovery, PLAN_MARGIN_MIN, PLAN_MARGIN_MAX) +
                         saddle_clamp(landing, PLAN_MARGIN_MIN, PLAN_MARGIN_MAX);
    return model->config.plan_weight * caught + model->config.plan_reserve;
}

/* [E37] */
float saddle_sinking_margin(const saddle_departure_t *departure)
{
    return SINKING_WEIGHT * (SINKING_MAX - departure->sinking);
}

saddle_reason_t saddle_driver(const saddle_departure_t *departure, float plan)
{
    const float ap = saddle_magnitude(departure->offset.x);
    const float ml = saddle_magnitude(departure->offset.y);
    const float largest = saddle_larger(ap, ml);
    if (-plan > saddle_larger(largest, departure->sink)) {
        return SADDLE_REASON_NO_STEP;
    }
    if (departure->sink > largest) {
        return SADDLE_REASON_SINKING;
    }
    if (ml > ap) {
        return departure->offset.y > 0.0f ? SADDLE_REASON_LEFT : SADDLE_REASON_RIGHT;
    }
    return departure->offset.x > 0.0f ? SADDLE_REASON_FORWARD : SADDLE_REASON_BACKWARD;
}

/* [E31] */
float saddle_caution_below(const saddle_model_t *model, const saddle_learning_t *learning,
                           float plan)
{
    const float usual = learning->walk.step_margin;
    const float band = model->config.caution_margin;
    const float own = usual > 0.0f ? saddle_clamp(OWN_CAUTION_SHARE * usual, LEAST_CAUTION * band,
                                                  MOST_CAUTION * band)
                                   : band;
    return own + OWN_CAUTION_SHARE * saddle_larger(0.0f, plan);
}
