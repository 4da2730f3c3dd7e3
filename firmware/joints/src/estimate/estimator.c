#include "estimate/anchor.h"
#include "estimate/encoders.h"
#include "estimate/readings.h"
#include "estimate/tilt.h"
#include "estimate/track.h"
#include "kinematics/legs.h"
#include "math/bytes.h"
#include "math/elementary.h"
#include "math/rounding.h"
#include "space/axes.h"
#include "space/quaternion.h"
#include "space/vec3.h"

/* Longer steps in time start it anew. */
#define STEP_MAX_US 50000u

/* The velocity is the IMU's alone for no longer than this. */
#define COAST_MAX_S 0.3f

/* An age that is no longer counted. */
#define AGE_MAX_S 1000.0f

static const saddle_vec3_t ZERO = {0.0f, 0.0f, 0.0f};

/* Faults that leave the tilt unknown for a while, and those that leave the CoM's motion unknown. */
#define FAULTS_TILT                                                          \
    ((uint32_t)SADDLE_SENSOR_IMU_STALE | (uint32_t)SADDLE_SENSOR_IMU_RANGE | \
     (uint32_t)SADDLE_SENSOR_GYRO_SATURATED)
#define FAULTS_ALL                                                                   \
    (FAULTS_TILT | (uint32_t)SADDLE_SENSOR_SETTLING | (uint32_t)SADDLE_SENSOR_TILT | \
     (uint32_t)SADDLE_SENSOR_TIME)
#define FAULTS_MOTION \
    (FAULTS_ALL | (uint32_t)SADDLE_SENSOR_ACCELEROMETER_SATURATED | (uint32_t)SADDLE_SENSOR_SLIP)

saddle_status_t saddle_estimator_init(saddle_estimator_t *estimator, const saddle_legs_t *legs,
                                      const saddle_estimator_config_t *config)
{
    saddle_clear(estimator, sizeof *estimator);
    if (!saddle_rounds_as_written()) {
        return SADDLE_ERROR_BUILD;
    }
    if (saddle_legs_check(legs) != NULL || saddle_estimator_check(config) != NULL) {
        return SADDLE_ERROR_CONFIG;
    }
    saddle_copy(&estimator->legs, legs, sizeof *legs);
    saddle_copy(&estimator->config, config, sizeof *config);
    estimator->attitude.w = 1.0f;
    estimator->initialised = true;
    return SADDLE_OK;
}

/* The body along the trunk's axes, from the hips, with the angles that are used. */
static void body_of_trunk(saddle_estimator_t *estimator, saddle_joints_t *joints,
                          saddle_whole_body_t *body)
{
    static const saddle_trunk_t hips = {
        {0.0f, 0.0f, 0.0f},
        {0.0f, 0.0f, 0.0f},
        {{1.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, {0.0f, 0.0f, 1.0f}},
        {0.0f, 0.0f, 0.0f}};
    for (unsigned i = 0; i < 2u * SADDLE_LEG_JOINTS; i++) {
        const unsigned side = i / SADDLE_LEG_JOINTS;
        const unsigned joint = i % SADDLE_LEG_JOINTS;
        joints->angle_rad[side][joint] = estimator->encoder[side][joint].sound_rad;
        joints->rate_rad_s[side][joint] = 0.0f;
    }
    saddle_forward(&estimator->legs, &hips, joints, body);
    estimator->sole_m[SADDLE_LEFT] = body->foot[SADDLE_LEFT].sole_m;
    estimator->sole_m[SADDLE_RIGHT] = body->foot[SADDLE_RIGHT].sole_m;
}

/* The same, seen from the world; still from the hips. */
static void turn_to_world(const saddle_axes_t *trunk, saddle_whole_body_t *body)
{
    body->com.position_m = saddle_to_world(trunk, body->com.position_m);
    for (unsigned side = 0; side < 2; side++) {
        saddle_foot_pose_t *foot = &body->foot[side];
        foot->sole_m = saddle_to_world(trunk, foot->sole_m);
        foot->axes.x = saddle_to_world(trunk, foot->axes.x);
        foot->axes.y = saddle_to_world(trunk, foot->axes.y);
        foot->axes.z = saddle_to_world(trunk, foot->axes.z);
    }
}

/* IMU from the hips, seen from the world. */
static saddle_vec3_t imu_from_hips_m(const saddle_estimator_t *estimator,
                                     const saddle_axes_t *trunk)
{
    const saddle_estimator_config_t *config = &estimator->config;
    return saddle_to_world(trunk,
                           (saddle_vec3_t){config->imu_x_m, config->imu_y_m, config->imu_z_m});
}

/* [J13] Position and velocity of the IMU over the anchor, and of the CoM about the IMU. */
static bool follow(saddle_estimator_t *estimator, const saddle_imu_t *imu,
                   const saddle_axes_t *trunk, const saddle_whole_body_t *body, float dt_s)
{
    const saddle_vec3_t imu_m = imu_from_hips_m(estimator, trunk);
    const saddle_vec3_t over_anchor_m =
        saddle_vec3_sub(imu_m, saddle_anchor_m(estimator, body->foot));
    saddle_vec3_t acceleration_m_s2 = ZERO;
    if (imu->measured) {
        acceleration_m_s2 = saddle_to_world(trunk, imu->accelerometer_m_s2);
        acceleration_m_s2.z -= SADDLE_GRAVITY_M_S2;
    }
    saddle_track_gains_t gains = saddle_track_gains(estimator->config.contact_gain_1_s, dt_s);
    const bool anchored = estimator->contact[estimator->anchor_foot];
    const bool coasts =
        (estimator->slipping_s > 0.0f || !anchored) && estimator->coasting_s < COAST_MAX_S;
    estimator->coasting_s = estimator->slipping_s > 0.0f || !anchored
                                ? saddle_smaller(estimator->coasting_s + dt_s, COAST_MAX_S)
                                : 0.0f;
    gains.velocity_1_s = coasts ? 0.0f : gains.velocity_1_s;
    const saddle_vec3_t beyond_m_s =
        saddle_track_step(&estimator->imu, &gains, over_anchor_m, acceleration_m_s2);
    gains = saddle_track_gains(estimator->config.posture_gain_1_s, dt_s);
    (void)saddle_track_step(&estimator->com, &gains, saddle_vec3_sub(body->com.position_m, imu_m),
                            ZERO);
    return anchored && saddle_anchor_slips(estimator, beyond_m_s, dt_s);
}

static void start(saddle_estimator_t *estimator, const saddle_sensors_t *sensors,
                  const saddle_imu_t *imu)
{
    saddle_joints_t joints;
    saddle_whole_body_t body;
    saddle_encoders_start(estimator, sensors);
    estimator->anchor_foot = saddle_load_share(estimator, SADDLE_RIGHT) > 0.5f ? 1u : 0u;
    estimator->anchor_point = SADDLE_SOLE_MIDDLE;
    body_of_trunk(estimator, &joints, &body);
    saddle_tilt_start(estimator, imu, body.foot);
    const saddle_axes_t trunk = saddle_quaternion_axes(estimator->attitude);
    turn_to_world(&trunk, &body);
    const saddle_vec3_t imu_m = imu_from_hips_m(estimator, &trunk);
    estimator->imu =
        (saddle_track_t){saddle_vec3_sub(imu_m, saddle_anchor_m(estimator, body.foot)), ZERO};
    estimator->com = (saddle_track_t){saddle_vec3_sub(body.com.position_m, imu_m), ZERO};
    estimator->slip_m_s = ZERO;
    estimator->slipping_s = 0.0f;
    estimator->settling_s = estimator->config.settle_time_s;
    estimator->com_age_s = AGE_MAX_S;
    estimator->foot_age_s[SADDLE_LEFT] = estimator->foot_age_s[SADDLE_RIGHT] = AGE_MAX_S;
    estimator->started = true;
}

static void grow(float *age_s, bool sound, float dt_s)
{
    *age_s = sound ? 0.0f : saddle_smaller(*age_s + dt_s, AGE_MAX_S);
}

/* How long ago each was sound. */
static void count_ages(saddle_estimator_t *estimator, uint32_t faults, float dt_s)
{
    const uint32_t joints[2] = {(uint32_t)SADDLE_SENSOR_LEFT_JOINTS,
                                (uint32_t)SADDLE_SENSOR_RIGHT_JOINTS};
    const uint32_t loads[2] = {(uint32_t)SADDLE_SENSOR_LEFT_LOAD,
                               (uint32_t)SADDLE_SENSOR_RIGHT_LOAD};
    const uint32_t anchor = joints[estimator->anchor_foot] | loads[estimator->anchor_foot];
    grow(&estimator->com_age_s, (faults & (FAULTS_MOTION | anchor)) == 0u, dt_s);
    for (unsigned side = 0; side < 2; side++) {
        grow(&estimator->foot_age_s[side],
             (faults & (FAULTS_ALL | joints[side] | loads[side])) == 0u, dt_s);
    }
}

static uint32_t age_us(float age_s)
{
    return age_s >= AGE_MAX_S ? SADDLE_AGE_NEVER_US : (uint32_t)(1.0e6f * age_s);
}

/* The contact is what it is. */
static uint32_t since_us(const saddle_estimator_t *estimator, unsigned side)
{
    const uint64_t since = estimator->time_us - estimator->contact_from_us[side];
    return since < UINT32_MAX ? (uint32_t)since : UINT32_MAX;
}

static void write_measurement(const saddle_estimator_t *estimator, saddle_estimate_t *estimate)
{
    saddle_measurement_t *measurement = &estimate->measurement;
    const saddle_com_t *com = &estimate->body.com;
    measurement->com.height_m = com->position_m.z;
    measurement->com.velocity_m_s = (saddle_vec2_t){com->velocity_m_s.x, com->velocity_m_s.y};
    measurement->com.age_us = age_us(estimator->com_age_s);
    for (unsigned side = 0; side < 2; side++) {
        const saddle_vec3_t from_com_m =
            saddle_vec3_sub(estimate->body.foot[side].sole_m, com->position_m);
        measurement->foot[side].cop_m = (saddle_vec2_t){from_com_m.x, from_com_m.y};
        measurement->foot[side].contact = estimator->contact[side];
        measurement->foot[side].since_us = since_us(estimator, side);
        measurement->foot[side].age_us = age_us(estimator->foot_age_s[side]);
    }
}

/* Everything from the anchor. */
static void write_estimate(const saddle_estimator_t *estimator, const saddle_axes_t *trunk,
                           saddle_estimate_t *estimate)
{
    saddle_whole_body_t *body = &estimate->body;
    const saddle_vec3_t imu_m = imu_from_hips_m(estimator, trunk);
    const saddle_vec3_t raw_com_m = body->com.position_m;
    estimate->trunk.axes = *trunk;
    estimate->trunk.turn_rad_s =
        saddle_to_world(trunk, saddle_vec3_sub(estimator->gyro_rad_s, estimator->bias_rad_s));
    estimate->trunk.hips_m = saddle_vec3_sub(estimator->imu.value_m, imu_m);
    estimate->trunk.velocity_m_s = saddle_vec3_sub(
        estimator->imu.rate_m_s, saddle_vec3_cross(estimate->trunk.turn_rad_s, imu_m));
    body->com.position_m = saddle_vec3_add(estimator->imu.value_m, estimator->com.value_m);
    body->com.velocity_m_s = saddle_vec3_add(estimator->imu.rate_m_s, estimator->com.rate_m_s);
    for (unsigned side = 0; side < 2; side++) {
        body->foot[side].sole_m = saddle_vec3_add(
            body->com.position_m, saddle_vec3_sub(body->foot[side].sole_m, raw_com_m));
        estimate->load_n[side] = estimator->load_n[side];
    }
    estimate->anchor_foot = estimator->anchor_foot;
    estimate->anchor_point = estimator->anchor_point;
    estimate->slip_m_s = saddle_vec3_length(estimator->slip_m_s);
    write_measurement(estimator, estimate);
}

/* The time since the last update; 0 and a fault where that is no time to go on from. */
static float step_s(saddle_estimator_t *estimator, uint64_t time_us, uint32_t *faults)
{
    const uint64_t last_us = estimator->time_us;
    const bool goes_on = time_us > last_us && time_us - last_us <= STEP_MAX_US;
    estimator->time_us = time_us;
    if (estimator->started && !goes_on) {
        *faults |= (uint32_t)SADDLE_SENSOR_TIME;
        estimator->started = false;
    }
    return estimator->started ? 1.0e-6f * (float)(uint32_t)(time_us - last_us) : 0.0f;
}

static void settle(saddle_estimator_t *estimator, uint32_t *faults, float dt_s)
{
    if ((*faults & FAULTS_TILT) != 0u) {
        estimator->settling_s = estimator->config.settle_time_s;
    } else if (estimator->contact[estimator->anchor_foot]) {
        estimator->settling_s = saddle_larger(estimator->settling_s - dt_s, 0.0f);
    }
    if (estimator->settling_s > 0.0f) {
        *faults |= (uint32_t)SADDLE_SENSOR_SETTLING;
    }
}

static uint32_t faults_of_joints(uint32_t lost)
{
    return ((lost & 0x3Fu) != 0u ? (uint32_t)SADDLE_SENSOR_LEFT_JOINTS : 0u) |
           ((lost >> 6) != 0u ? (uint32_t)SADDLE_SENSOR_RIGHT_JOINTS : 0u);
}

saddle_status_t saddle_estimator_update(saddle_estimator_t *estimator,
                                        const saddle_sensors_t *sensors,
                                        saddle_estimate_t *estimate)
{
    saddle_clear(estimate, sizeof *estimate);
    if (!estimator->initialised) {
        estimate->measurement.com.age_us = SADDLE_AGE_NEVER_US;
        estimate->measurement.foot[SADDLE_LEFT].age_us = SADDLE_AGE_NEVER_US;
        estimate->measurement.foot[SADDLE_RIGHT].age_us = SADDLE_AGE_NEVER_US;
        return SADDLE_ERROR_UNINITIALISED;
    }
    const saddle_imu_t imu = saddle_imu_reading(estimator, sensors);
    uint32_t faults = imu.faults | saddle_load_readings(estimator, sensors);
    const float dt_s = step_s(estimator, sensors->time_us, &faults);
    if (!estimator->started) {
        start(estimator, sensors, &imu);
    }
    saddle_whole_body_t *body = &estimate->body;
    estimate->lost_joints = saddle_encoders_update(estimator, sensors, dt_s);
    body_of_trunk(estimator, &estimate->joints, body);
    if (dt_s > 0.0f) {
        saddle_tilt_update(estimator, &imu, body->foot, dt_s);
    }
    faults |= faults_of_joints(estimate->lost_joints);
    const saddle_axes_t trunk = saddle_quaternion_axes(estimator->attitude);
    turn_to_world(&trunk, body);
    if (dt_s > 0.0f) {
        saddle_anchor_choose(estimator, body->foot, estimate->lost_joints);
        const bool slips = follow(estimator, &imu, &trunk, body, dt_s);
        faults |= slips ? (uint32_t)SADDLE_SENSOR_SLIP : 0u;
    }
    if (saddle_sole_is_absurd(estimator, &body->foot[estimator->anchor_foot].axes)) {
        faults |= (uint32_t)SADDLE_SENSOR_TILT;
    }
    settle(estimator, &faults, dt_s);
    count_ages(estimator, faults, dt_s);
    estimate->faults = faults;
    write_estimate(estimator, &trunk, estimate);
    return SADDLE_OK;
}
