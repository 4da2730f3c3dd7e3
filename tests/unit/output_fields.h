/** Every field of the output, so that it can be compared and hashed without its padding.
 *  test_saddlewalk.c holds that none is missing. An array has elements of one float. */
#ifndef SADDLEWALK_OUTPUT_FIELDS_H
#define SADDLEWALK_OUTPUT_FIELDS_H

#include <saddlewalk/saddlewalk.h>

typedef enum { FLOATS, OTHER } kind_t;

#define FIELD(path, kind) \
    {offsetof(saddle_output_t, path), sizeof(((saddle_output_t *)0)->path), kind}
#define SCORES(scores)                                                                             \
    FIELD(scores.valid, OTHER), FIELD(scores.v_comp_m_s, FLOATS), FIELD(scores.s_pend, FLOATS),    \
        FIELD(scores.s_jump, FLOATS), FIELD(scores.s_sw, FLOATS), FIELD(scores.mos_com_m, FLOATS), \
        FIELD(scores.mos_xcom_m, FLOATS), FIELD(scores.gravity_n, FLOATS),                         \
        FIELD(scores.excess_stop_j, FLOATS), FIELD(scores.can_stop, OTHER),                        \
        FIELD(scores.paper_stable, OTHER), FIELD(scores.xcom_m, FLOATS),                           \
        FIELD(scores.bos.centre_m, FLOATS), FIELD(scores.bos.axis_x, FLOATS),                      \
        FIELD(scores.bos.radius_m, FLOATS), FIELD(scores.bos.half_depth_m, FLOATS),                \
        FIELD(scores.bos.defined, OTHER)

static const struct {
    size_t offset, size;
    kind_t kind;
} FIELDS[] = {
    FIELD(status, OTHER),
    FIELD(limits, OTHER),
    FIELD(faults, OTHER),
    FIELD(plan.valid, OTHER),
    FIELD(plan.mode, OTHER),
    FIELD(plan.phase, OTHER),
    FIELD(plan.support, OTHER),
    FIELD(plan.step_count, OTHER),
    FIELD(plan.stride_count, OTHER),
    FIELD(plan.theta_rad, FLOATS),
    FIELD(plan.origin_x_nm, OTHER),
    FIELD(plan.origin_y_nm, OTHER),
    FIELD(plan.heading_rad, FLOATS),
    FIELD(plan.curvature_1_m, FLOATS),
    FIELD(plan.speed_m_s, FLOATS),
    FIELD(plan.step_length_m, FLOATS),
    FIELD(plan.step_width_m, FLOATS),
    FIELD(plan.acceleration_m_s2, FLOATS),
    FIELD(plan.com_m, FLOATS),
    FIELD(plan.com_velocity_m_s, FLOATS),
    FIELD(plan.foot_m, FLOATS),
    FIELD(plan.foot_pitch_rad, FLOATS),
    FIELD(plan.foot_yaw_rad, FLOATS),
    FIELD(plan.pelvis_yaw_rad, FLOATS),
    FIELD(plan.swing_velocity_m_s, FLOATS),
    FIELD(plan.leg_length_m, FLOATS),
    FIELD(plan.knee_flexion_m, FLOATS),
    FIELD(plan.toe_off_rad, FLOATS),
    FIELD(plan.heel_strike_rad, FLOATS),
    FIELD(plan.time_to_via_point_s, FLOATS),
    FIELD(plan.time_to_heel_strike_s, FLOATS),
    FIELD(plan.time_to_toe_off_s, FLOATS),
    FIELD(plan.landing_m, FLOATS),
    FIELD(plan.last_step_m, FLOATS),
    FIELD(plan.reference.com_m, FLOATS),
    FIELD(plan.reference.xcom_m, FLOATS),
    FIELD(plan.reference.cop_m, FLOATS),
    FIELD(plan.reference.load, FLOATS),
    SCORES(scores),
    FIELD(verdict.level, OTHER),
    FIELD(verdict.reason, OTHER),
    FIELD(verdict.driver, OTHER),
    FIELD(verdict.margin_known, OTHER),
    FIELD(verdict.margin, FLOATS),
    FIELD(verdict.caution_below, FLOATS),
    FIELD(verdict.compared, OTHER),
    FIELD(verdict.on_track, OTHER),
    FIELD(verdict.excess_track_j, FLOATS),
    FIELD(verdict.ebos_com_m, FLOATS),
    FIELD(verdict.ebos_xcom_m, FLOATS),
    FIELD(verdict.xcom_deviation_m, FLOATS),
    FIELD(verdict.recovery.found, OTHER),
    FIELD(verdict.recovery.stops, OTHER),
    FIELD(verdict.recovery.foot, OTHER),
    FIELD(verdict.recovery.landing_m, FLOATS),
    FIELD(verdict.recovery.margin_m, FLOATS),
    FIELD(walk.velocity_m_s, FLOATS),
    FIELD(walk.height_m, FLOATS),
    FIELD(walk.ripple, FLOATS),
    FIELD(walk.step_time_s, FLOATS),
    FIELD(walk.step_length_m, FLOATS),
    FIELD(walk.step_width_m, FLOATS),
    FIELD(walk.step_margin, FLOATS),
};

#endif
