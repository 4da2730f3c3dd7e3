#include "estimate/anchor.h"

#include "estimate/readings.h"
#include "kinematics/legs.h"
#include "math/elementary.h"
#include "space/vec3.h"

/* A single step's velocity is noise: it is averaged over so long, [J14]. */
#define SLIP_AVERAGE_S 0.015f

/* The anchor is trusted again after so long without a slip. */
#define SLIP_HOLD_S 0.1f

/* Ever slower than this, of slip_m_s, is no slip any more. */
#define SLIP_END 0.5f

static uint32_t joints_of(unsigned side)
{
    return 0x3Fu << (6u * side);
}

saddle_vec3_t saddle_anchor_m(const saddle_estimator_t *estimator, const saddle_foot_pose_t foot[2])
{
    const saddle_foot_pose_t *pose = &foot[estimator->anchor_foot];
    const float forward_m = saddle_sole_point_m(&estimator->legs, estimator->anchor_point);
    return saddle_vec3_along(pose->sole_m, forward_m, pose->axes.x);
}

static uint8_t chosen_foot(const saddle_estimator_t *estimator, uint32_t lost_joints)
{
    const unsigned now = estimator->anchor_foot;
    const unsigned other = 1u - now;
    const bool other_is_sound = estimator->contact[other] && (lost_joints & joints_of(other)) == 0u;
    const bool other_carries = saddle_load_share(estimator, other) > estimator->config.stance_share;
    const bool now_is_lost = (lost_joints & joints_of(now)) != 0u;
    return (uint8_t)(other_is_sound && (other_carries || now_is_lost) ? other : now);
}

/* A sole that is tilted in earnest rolls over its lower end. */
static uint8_t chosen_point(const saddle_estimator_t *estimator, const saddle_axes_t *sole)
{
    const float sine = saddle_sin(estimator->config.roll_min_rad);
    if (saddle_in_range(sole->x.z, -sine, sine)) {
        return SADDLE_SOLE_MIDDLE;
    }
    return sole->x.z < 0.0f ? SADDLE_SOLE_TOE : SADDLE_SOLE_HEEL;
}

void saddle_anchor_choose(saddle_estimator_t *estimator, const saddle_foot_pose_t foot[2],
                          uint32_t lost_joints)
{
    const saddle_vec3_t before_m = saddle_anchor_m(estimator, foot);
    estimator->anchor_foot = chosen_foot(estimator, lost_joints);
    estimator->anchor_point = chosen_point(estimator, &foot[estimator->anchor_foot].axes);
    const saddle_vec3_t moved_m = saddle_vec3_sub(before_m, saddle_anchor_m(estimator, foot));
    estimator->imu.value_m = saddle_vec3_add(estimator->imu.value_m, moved_m);
}

/* [J14] */
bool saddle_anchor_slips(saddle_estimator_t *estimator, saddle_vec3_t beyond_m_s, float dt_s)
{
    const float share = 1.0f - saddle_exp(-dt_s / SLIP_AVERAGE_S);
    estimator->slip_m_s = saddle_vec3_along(estimator->slip_m_s, share,
                                            saddle_vec3_sub(beyond_m_s, estimator->slip_m_s));
    const float slip_m_s = saddle_vec3_length(estimator->slip_m_s);
    const bool begins = slip_m_s > estimator->config.slip_m_s;
    const bool lasts =
        estimator->slipping_s > 0.0f && slip_m_s > SLIP_END * estimator->config.slip_m_s;
    estimator->slipping_s =
        begins || lasts ? SLIP_HOLD_S : saddle_larger(estimator->slipping_s - dt_s, 0.0f);
    return estimator->slipping_s > 0.0f;
}
