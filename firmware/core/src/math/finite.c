#include "math/finite.h"

/* A sum is finite only if each of its terms is: to infinity or NaN nothing can be added that makes it
 * finite again. One addition per number, and no branches. Finite terms overflow from 10^36 on only. */

static inline float sum_of_2(saddle_vec2_t v)
{
    return v.x + v.y;
}

static inline float sum_of_3(saddle_vec3_t v)
{
    return v.x + v.y + v.z;
}

static float sum_of_reference(const saddle_reference_t *reference)
{
    return sum_of_2(reference->com_m) + sum_of_2(reference->xcom_m) + sum_of_2(reference->cop_m) +
           reference->load[SADDLE_LEFT] + reference->load[SADDLE_RIGHT];
}

static float sum_of_plan(const saddle_plan_t *plan)
{
    const float body = plan->theta_rad + plan->speed_m_s + plan->step_length_m +
                       plan->step_width_m + plan->acceleration_m_s2 + sum_of_3(plan->com_m) +
                       sum_of_3(plan->com_velocity_m_s) + plan->leg_length_m + plan->knee_flexion_m;
    const float feet = sum_of_3(plan->foot_m[SADDLE_LEFT]) + sum_of_3(plan->foot_m[SADDLE_RIGHT]) +
                       plan->foot_pitch_rad[SADDLE_LEFT] + plan->foot_pitch_rad[SADDLE_RIGHT] +
                       sum_of_3(plan->swing_velocity_m_s) + plan->toe_off_rad +
                       plan->heel_strike_rad;
    const float way = plan->heading_rad + plan->curvature_1_m[0] + plan->curvature_1_m[1] +
                      plan->foot_yaw_rad[SADDLE_LEFT] + plan->foot_yaw_rad[SADDLE_RIGHT] +
                      plan->pelvis_yaw_rad;
    const float events = plan->time_to_via_point_s + plan->time_to_heel_strike_s +
                         plan->time_to_toe_off_s + sum_of_2(plan->landing_m) +
                         sum_of_2(plan->last_step_m);
    return body + feet + way + events + sum_of_reference(&plan->reference);
}

static float sum_of_scores(const saddle_scores_t *scores)
{
    const saddle_bos_t *bos = &scores->bos;
    return scores->v_comp_m_s + scores->s_pend + scores->s_jump + scores->s_sw + scores->mos_com_m +
           scores->mos_xcom_m + sum_of_2(scores->gravity_n) + scores->excess_stop_j +
           sum_of_2(scores->xcom_m) + sum_of_2(bos->centre_m) + sum_of_2(bos->axis_x) +
           bos->radius_m + bos->half_depth_m;
}

static float sum_of_verdict(const saddle_verdict_t *verdict)
{
    return verdict->margin + verdict->caution_below + verdict->excess_track_j +
           verdict->ebos_com_m + verdict->ebos_xcom_m + sum_of_2(verdict->xcom_deviation_m) +
           sum_of_2(verdict->recovery.landing_m) + verdict->recovery.margin_m;
}

static float sum_of_walk(const saddle_learned_walk_t *walk)
{
    return sum_of_2(walk->velocity_m_s) + walk->height_m + walk->ripple + walk->step_time_s +
           walk->step_length_m + walk->step_width_m + walk->step_margin;
}

static bool is_finite(float x)
{
    return 0.0f * x == 0.0f;
}

bool saddle_plan_finite(const saddle_plan_t *plan)
{
    return is_finite(sum_of_plan(plan));
}

bool saddle_output_finite(const saddle_output_t *output)
{
    return is_finite(sum_of_plan(&output->plan) + sum_of_scores(&output->scores) +
                     sum_of_verdict(&output->verdict) + sum_of_walk(&output->walk));
}
