#include "motion/stopping.h"

#include "math/elementary.h"
#include "math/fixed.h"
#include "motion/gait_cycle.h"
#include "motion/speed_profile.h"

#include <math.h>

/* Way to the place where a stop can end: the foot via point after the next landing. */
static float stopping_distance_m(const saddle_cycle_t *cycle)
{
    const float distance_m = saddle_cycle_distance_to_via_point_m(cycle);
    return saddle_cycle_before_landing(cycle) ? distance_m + cycle->quarter.length_m : distance_m;
}

/* May the step after the next landing be the last, braking no harder than allowed? */
static void choose_last_swing(saddle_planner_t *planner, const saddle_model_t *model,
                              float speed_m_s)
{
    saddle_cycle_t *cycle = &planner->cycle;
    if (saddle_cycle_before_landing(cycle)) {
        const float distance_m = stopping_distance_m(cycle);
        saddle_cycle_set_last_swing(
            cycle, saddle_can_brake(speed_m_s, model->config.acceleration_m_s2, distance_m));
        planner->braking = planner->braking && cycle->last_swing;
    }
}

/* The speed from which, after the longest tick at it, a stop within distance_m brakes as hard as allowed:
 * below it there is time until the next tick. */
static float latest_braking_speed_m_s(const saddle_model_t *model, float distance_m)
{
    const float rate_m_s2 = model->config.acceleration_m_s2;
    const float in_a_tick_m_s = model->body.braked_in_a_tick_m_s;
    return sqrtf(in_a_tick_m_s * in_a_tick_m_s + 2.0f * rate_m_s2 * distance_m) - in_a_tick_m_s;
}

void saddle_plan_stop(saddle_planner_t *planner, const saddle_model_t *model)
{
    saddle_cycle_t *cycle = &planner->cycle;
    const float speed_m_s = cycle->profile.speed_m_s;
    choose_last_swing(planner, model, speed_m_s);
    const float distance_m = stopping_distance_m(cycle);
    const float latest_m_s = latest_braking_speed_m_s(model, distance_m);
    const float crawl = model->body.crawl_m_s;
    const float slow_m_s = cycle->last_swing && latest_m_s < crawl ? latest_m_s : crawl;
    planner->braking = cycle->last_swing && (planner->braking || speed_m_s >= slow_m_s);
    if (planner->braking) {
        saddle_cycle_set_pace(
            cycle, 0.0f, distance_m > 0.0f ? speed_m_s * speed_m_s / (2.0f * distance_m) : 0.0f);
    } else {
        const float fast_m_s = saddle_larger(model->body.braked_in_a_step_m_s, slow_m_s);
        saddle_cycle_set_pace(cycle, saddle_clamp(speed_m_s, slow_m_s, fast_m_s),
                              model->config.acceleration_m_s2);
    }
}
