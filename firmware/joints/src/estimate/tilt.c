#include "estimate/tilt.h"

#include "math/elementary.h"
#include "space/arctangent.h"
#include "space/axes.h"
#include "space/quaternion.h"
#include "space/vec3.h"

/* Gravity is believed while what is read is its size within this share, [J10]. */
#define GRAVITY_SHARE 0.3f

/* How fast the soles correct the tilt while it settles, [J11]. */
#define SETTLING_GAIN_1_S 10.0f

/* Longer than the double support of a slow step, [J12]. */
#define STILL_AFTER_S 0.5f

/* Of flat_max_rad: a sole on the ground rolls no further to the side. */
#define ABSURD_ROLL 2.0f

/* [J9] */
void saddle_tilt_start(saddle_estimator_t *estimator, const saddle_imu_t *imu,
                       const saddle_foot_pose_t foot[2])
{
    if (estimator->contact[estimator->anchor_foot]) {
        estimator->attitude = saddle_quaternion_of_up(foot[estimator->anchor_foot].axes.z);
    } else if (imu->measured) {
        estimator->attitude = saddle_quaternion_of_up(imu->accelerometer_m_s2);
    }
}

/* [J10] The rate that brings the upward direction to the accelerometer's. */
static saddle_vec3_t by_gravity(const saddle_estimator_t *estimator, const saddle_imu_t *imu,
                                saddle_vec3_t up)
{
    const float read_m_s2 = saddle_vec3_length(imu->accelerometer_m_s2);
    if (!saddle_in_range(read_m_s2, (1.0f - GRAVITY_SHARE) * SADDLE_GRAVITY_M_S2,
                         (1.0f + GRAVITY_SHARE) * SADDLE_GRAVITY_M_S2)) {
        return (saddle_vec3_t){0.0f, 0.0f, 0.0f};
    }
    return saddle_vec3_scale(estimator->config.gravity_gain_1_s / read_m_s2,
                             saddle_vec3_cross(imu->accelerometer_m_s2, up));
}

/* [J11] How far the anchor's sole is from lying flat, as a rotation along the trunk's axes. */
static saddle_vec3_t sole_tilt(const saddle_axes_t *sole, saddle_vec3_t up)
{
    return saddle_vec3_cross(sole->z, up);
}

/* [J11] A sole is flat that carries, or that somebody stands on, and is not tilted in earnest; at the
 * start every one that carries. */
static bool lies_flat(const saddle_estimator_t *estimator, saddle_vec3_t tilt)
{
    if (estimator->settling_s > 0.0f) {
        return estimator->contact[estimator->anchor_foot];
    }
    const float sine = saddle_sin(estimator->config.flat_max_rad);
    const bool carries =
        saddle_load_share(estimator, estimator->anchor_foot) >= estimator->config.sole_share;
    return (carries || estimator->still_s >= STILL_AFTER_S) &&
           saddle_vec3_dot(tilt, tilt) <= sine * sine;
}

/* [J11] The rate that turns the feet's heading to x. */
static saddle_vec3_t by_heading(const saddle_estimator_t *estimator, const saddle_axes_t *sole,
                                const saddle_axes_t *trunk, saddle_vec3_t up)
{
    const saddle_vec3_t forward = saddle_to_world(trunk, sole->x);
    const float yaw_rad = saddle_arctangent(forward.y, forward.x);
    return saddle_vec3_scale(-estimator->config.heading_gain_1_s * yaw_rad, up);
}

static bool stands_still(const saddle_estimator_t *estimator, const saddle_imu_t *imu)
{
    const float limit_rad_s = estimator->config.still_max_rad_s;
    return imu->measured && estimator->contact[SADDLE_LEFT] && estimator->contact[SADDLE_RIGHT] &&
           saddle_in_range(imu->gyro_rad_s.x, -limit_rad_s, limit_rad_s) &&
           saddle_in_range(imu->gyro_rad_s.y, -limit_rad_s, limit_rad_s) &&
           saddle_in_range(imu->gyro_rad_s.z, -limit_rad_s, limit_rad_s);
}

/* [J12] Whoever stands still does not turn; a slow step's double support is no standing. */
static void learn_bias(saddle_estimator_t *estimator, const saddle_imu_t *imu, float dt_s)
{
    if (!stands_still(estimator, imu)) {
        estimator->still_s = 0.0f;
        if (estimator->bias_s > 0.0f) {
            estimator->bias_s = estimator->config.bias_time_s; /* the first standing was for that */
        }
        return;
    }
    estimator->still_s = saddle_smaller(estimator->still_s + dt_s, STILL_AFTER_S);
    if (estimator->still_s < STILL_AFTER_S) {
        return;
    }
    estimator->bias_s = saddle_smaller(estimator->bias_s + dt_s, estimator->config.bias_time_s);
    estimator->bias_rad_s =
        saddle_vec3_along(estimator->bias_rad_s, dt_s / estimator->bias_s,
                          saddle_vec3_sub(imu->gyro_rad_s, estimator->bias_rad_s));
}

void saddle_tilt_update(saddle_estimator_t *estimator, const saddle_imu_t *imu,
                        const saddle_foot_pose_t foot[2], float dt_s)
{
    const saddle_axes_t trunk = saddle_quaternion_axes(estimator->attitude);
    const saddle_vec3_t up = {trunk.x.z, trunk.y.z, trunk.z.z};
    const saddle_axes_t *sole = &foot[estimator->anchor_foot].axes;
    learn_bias(estimator, imu, dt_s);
    saddle_vec3_t rate_rad_s = saddle_vec3_sub(imu->gyro_rad_s, estimator->bias_rad_s);
    const saddle_vec3_t tilt = sole_tilt(sole, up);
    const float sole_gain_1_s =
        estimator->settling_s > 0.0f ? SETTLING_GAIN_1_S : estimator->config.sole_gain_1_s;
    if (lies_flat(estimator, tilt)) {
        rate_rad_s = saddle_vec3_along(rate_rad_s, sole_gain_1_s, tilt);
    } else if (imu->measured) {
        rate_rad_s = saddle_vec3_add(rate_rad_s, by_gravity(estimator, imu, up));
    }
    rate_rad_s = saddle_vec3_add(rate_rad_s, by_heading(estimator, sole, &trunk, up));
    estimator->attitude = saddle_quaternion_turned(estimator->attitude, rate_rad_s, dt_s);
    estimator->gyro_rad_s = imu->gyro_rad_s;
}

bool saddle_sole_is_absurd(const saddle_estimator_t *estimator, const saddle_axes_t *sole)
{
    const float limit =
        saddle_sin(saddle_smaller(ABSURD_ROLL * estimator->config.flat_max_rad, SADDLE_HALF_PI));
    return saddle_load_share(estimator, estimator->anchor_foot) >= estimator->config.sole_share &&
           saddle_magnitude(sole->y.z) > limit;
}
