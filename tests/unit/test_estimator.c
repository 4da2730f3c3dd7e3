/** The estimator on a kinematic walker: a trunk and feet that move as written here, joints by the inverse,
 *  an IMU by differences in double, and noise of ordinary sensors. */
#include "core_test.h"

#include <fenv.h>
#include <saddlewalk/estimator.h>
#include <stdio.h>

#define STEP_S 0.6
#define STEP_M 0.5
#define HALF_WIDTH_M 0.09
#define STAND_S 1.5    /* before the walk */
#define HANDOVER_S 0.1 /* the load goes from foot to foot */
#define WEIGHT_N 620.0

static saddle_legs_t legs;
static saddle_estimator_config_t config;
static saddle_estimator_t estimator;
static saddle_estimate_t estimate;
static uint32_t seed;

/* What sensors add, as large as the devices have it; all 0: perfect ones. */
static struct {
    float gyro, accelerometer, encoder;
    saddle_vec3_t gyro_bias, accelerometer_bias;
    float encoder_bias[2][SADDLE_LEG_JOINTS];
} noise;

static float normal(float deviation)
{
    float sum = 0.0f; /* of twelve, variance 1 */
    for (int i = 0; i < 12; i++) {
        sum += random_in(&seed, -0.5f, 0.5f);
    }
    return deviation * sum;
}

static saddle_vec3_t normal_vec3(float deviation)
{
    saddle_vec3_t vector;
    vector.x = normal(deviation);
    vector.y = normal(deviation);
    vector.z = normal(deviation);
    return vector;
}

void setUp(void)
{
    legs = saddle_legs_default(1.79f, 63.3f);
    legs.joint[SADDLE_ANKLE_PITCH].min_rad = -1.0f; /* this walker's feet are always flat */
    config = saddle_estimator_default();
    seed = 20261201u;
    memset(&noise, 0, sizeof noise);
    TEST_ASSERT_EQUAL(SADDLE_OK, saddle_estimator_init(&estimator, &legs, &config));
}

void tearDown(void) {}

static void ordinary_noise(void)
{
    noise.gyro = 0.005f;
    noise.accelerometer = 0.05f;
    noise.encoder = 0.001f;
    noise.gyro_bias = normal_vec3(0.003f);
    noise.accelerometer_bias = normal_vec3(0.03f);
    for (int i = 0; i < 12; i++) {
        noise.encoder_bias[i / 6][i % 6] = normal(0.002f);
    }
}

/* ---- the walker ----------------------------------------------------------------------------- */

typedef struct {
    double position[3], roll, pitch, yaw;
} trunk_pose_t;

/* Hips: at rest, then as fast as the feet. */
static trunk_pose_t trunk_at(double t)
{
    const double s = t > STAND_S ? t - STAND_S : 0.0;
    const double grown = 1.0 - exp(-s) * (1.0 + s);
    const double step = PI * s / STEP_S;
    return (trunk_pose_t){{STEP_M * (s / STEP_S - 0.5 + 0.5 * exp(-2.0 * s / STEP_S)) - 0.02,
                           0.03 * grown * sin(step), 0.85 + 0.010 * grown * cos(2.0 * step)},
                          0.03 * grown * sin(step),
                          0.05 + 0.03 * grown * cos(2.0 * step),
                          0.04 * grown * sin(step)};
}

/* Columns are the trunk's axes: yaw, then pitch, then roll. */
static void rotation_of(const trunk_pose_t *pose, double r[3][3])
{
    const double cy = cos(pose->yaw), sy = sin(pose->yaw);
    const double cp = cos(pose->pitch), sp = sin(pose->pitch);
    const double cr = cos(pose->roll), sr = sin(pose->roll);
    const double m[3][3] = {{cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr},
                            {sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr},
                            {-sp, cp * sr, cp * cr}};
    memcpy(r, m, sizeof m);
}

static double smooth(double s)
{
    s = s < 0.0 ? 0.0 : s > 1.0 ? 1.0 : s;
    return s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
}

typedef struct {
    double x[2], z[2], share_left;
} feet_t;

/* Step n has foot n mod 2 on the ground at n STEP_M, while the other swings from one step behind to one
 * ahead. */
static feet_t feet_at(double t)
{
    feet_t feet = {{0.0, 0.0}, {0.0, 0.0}, 0.5};
    if (t < STAND_S) {
        return feet;
    }
    const int n = (int)((t - STAND_S) / STEP_S);
    const double since = t - STAND_S - n * STEP_S;
    const int stance = n % 2;
    const double from = n == 0 ? 0.0 : (n - 1) * STEP_M;
    const double share = smooth((since - HANDOVER_S) / (STEP_S - HANDOVER_S));
    feet.x[stance] = n * STEP_M;
    feet.x[1 - stance] = from + share * ((n + 1) * STEP_M - from);
    feet.z[1 - stance] = 0.05 * sin(PI * share);
    const double taken = (n == 0 ? 0.5 : 0.0) + (n == 0 ? 0.5 : 1.0) * smooth(since / HANDOVER_S);
    feet.share_left = stance == SADDLE_LEFT ? taken : 1.0 - taken;
    return feet;
}

static saddle_trunk_t trunk_of(double t)
{
    const trunk_pose_t pose = trunk_at(t);
    double r[3][3];
    rotation_of(&pose, r);
    return (saddle_trunk_t){
        {(float)pose.position[0], (float)pose.position[1], (float)pose.position[2]},
        {0.0f, 0.0f, 0.0f},
        {{(float)r[0][0], (float)r[1][0], (float)r[2][0]},
         {(float)r[0][1], (float)r[1][1], (float)r[2][1]},
         {(float)r[0][2], (float)r[1][2], (float)r[2][2]}},
        {0.0f, 0.0f, 0.0f}};
}

/* The whole body; the left foot is shifted along x, for slips. */
static void body_at(double t, double left_shift_m, saddle_joints_t *joints,
                    saddle_whole_body_t *body)
{
    const feet_t feet = feet_at(t);
    const saddle_trunk_t trunk = trunk_of(t);
    const saddle_foot_t foot[2] = {
        {.position_m = {(float)(feet.x[0] + left_shift_m), (float)HALF_WIDTH_M, (float)feet.z[0]}},
        {.position_m = {(float)feet.x[1], -(float)HALF_WIDTH_M, (float)feet.z[1]}}};
    const saddle_reach_t reach = saddle_inverse(&legs, &trunk, foot, joints);
    TEST_ASSERT_TRUE(reach.valid && reach.angle_limits == 0u);
    saddle_forward(&legs, &trunk, joints, body);
}

static void imu_position(double t, double position[3])
{
    const trunk_pose_t pose = trunk_at(t);
    double r[3][3];
    rotation_of(&pose, r);
    for (int i = 0; i < 3; i++) {
        position[i] = pose.position[i] + r[i][2] * (double)config.imu_z_m;
    }
}

/* What a perfect IMU reads, from differences over 2 h. */
static void imu_at(double t, saddle_sensors_t *sensors)
{
    const double h = 1e-4;
    double p[3][3];
    double r[3][3][3];
    for (int k = 0; k < 3; k++) {
        const double then = t + (k - 1) * h;
        const trunk_pose_t pose = trunk_at(then);
        imu_position(then, p[k]);
        rotation_of(&pose, r[k]);
    }
    double force[3];
    double rate[3][3];
    for (int i = 0; i < 3; i++) {
        const double acceleration = (p[2][i] - 2.0 * p[1][i] + p[0][i]) / (h * h);
        force[i] = acceleration + (i == 2 ? GRAVITY : 0.0);
        for (int j = 0; j < 3; j++) {
            rate[i][j] = (r[2][i][j] - r[0][i][j]) / (2.0 * h);
        }
    }
    double f[3] = {0.0, 0.0, 0.0};
    double w[3] = {0.0, 0.0, 0.0}; /* of R' dR/dt, which is skew */
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            f[j] += r[1][i][j] * force[i];
        }
        w[0] += r[1][i][2] * rate[i][1];
        w[1] += r[1][i][0] * rate[i][2];
        w[2] += r[1][i][1] * rate[i][0];
    }
    sensors->gyro_rad_s = (saddle_vec3_t){(float)w[0], (float)w[1], (float)w[2]};
    sensors->accelerometer_m_s2 = (saddle_vec3_t){(float)f[0], (float)f[1], (float)f[2]};
}

static void add(saddle_vec3_t *to, saddle_vec3_t bias, float deviation)
{
    const saddle_vec3_t n = normal_vec3(deviation);
    to->x += bias.x + n.x;
    to->y += bias.y + n.y;
    to->z += bias.z + n.z;
}

static saddle_sensors_t sensors_at(double t, double left_shift_m)
{
    saddle_sensors_t sensors;
    saddle_joints_t joints;
    saddle_whole_body_t body;
    memset(&sensors, 0, sizeof sensors);
    sensors.time_us = (uint64_t)(t * 1e6 + 0.5);
    imu_at(t, &sensors);
    add(&sensors.gyro_rad_s, noise.gyro_bias, noise.gyro);
    add(&sensors.accelerometer_m_s2, noise.accelerometer_bias, noise.accelerometer);
    body_at(t, left_shift_m, &joints, &body);
    for (int i = 0; i < 12; i++) {
        sensors.angle_rad[i / 6][i % 6] = joints.angle_rad[i / 6][i % 6] +
                                          noise.encoder_bias[i / 6][i % 6] + normal(noise.encoder);
    }
    sensors.load_n[SADDLE_LEFT] = (float)(WEIGHT_N * feet_at(t).share_left);
    sensors.load_n[SADDLE_RIGHT] = (float)WEIGHT_N - sensors.load_n[SADDLE_LEFT];
    return sensors;
}

/* ---- errors --------------------------------------------------------------------------------- */

typedef struct {
    double velocity_x, velocity_y, foot_x, foot_y, height;
    int count;
} errors_t;

static void truth_at(double t, saddle_whole_body_t *body, double velocity[2])
{
    const double h = 2e-3;
    saddle_joints_t joints;
    saddle_whole_body_t next;
    saddle_whole_body_t last;
    body_at(t + h, 0.0, &joints, &next);
    body_at(t - h, 0.0, &joints, &last);
    body_at(t, 0.0, &joints, body);
    velocity[0] = ((double)next.com.position_m.x - (double)last.com.position_m.x) / (2.0 * h);
    velocity[1] = ((double)next.com.position_m.y - (double)last.com.position_m.y) / (2.0 * h);
}

static void add_errors(double t, errors_t *sums)
{
    saddle_whole_body_t body;
    double velocity[2];
    truth_at(t, &body, velocity);
    const saddle_measurement_t *m = &estimate.measurement;
    sums->velocity_x += pow((double)m->com.velocity_m_s.x - velocity[0], 2.0);
    sums->velocity_y += pow((double)m->com.velocity_m_s.y - velocity[1], 2.0);
    sums->height += pow((double)m->com.height_m - (double)body.com.position_m.z, 2.0);
    for (int side = 0; side < 2; side++) {
        const double x = (double)body.foot[side].sole_m.x - (double)body.com.position_m.x;
        const double y = (double)body.foot[side].sole_m.y - (double)body.com.position_m.y;
        sums->foot_x += pow((double)m->foot[side].cop_m.x - x, 2.0) / 2.0;
        sums->foot_y += pow((double)m->foot[side].cop_m.y - y, 2.0) / 2.0;
    }
    sums->count++;
}

static double rms(double sum, const errors_t *sums)
{
    return sqrt(sum / sums->count);
}

/* Walk from t to `until`; all updates succeed. */
static void walk(double *t, double until, double dt)
{
    for (; *t < until; *t += dt) {
        const saddle_sensors_t sensors = sensors_at(*t, 0.0);
        TEST_ASSERT_EQUAL(SADDLE_OK, saddle_estimator_update(&estimator, &sensors, &estimate));
    }
}

static errors_t errors_of_walk(double dt)
{
    errors_t sums = {0.0, 0.0, 0.0, 0.0, 0.0, 0};
    for (double t = 0.0; t < STAND_S + 5.0 + MANY(16.0); t += dt) {
        const saddle_sensors_t sensors = sensors_at(t, 0.0);
        saddle_estimator_update(&estimator, &sensors, &estimate);
        if (t > STAND_S + 0.2) {
            TEST_ASSERT_EQUAL_HEX32(0u, estimate.faults);
            TEST_ASSERT_EQUAL_UINT32(0u, estimate.measurement.com.age_us);
            add_errors(t, &sums);
        }
    }
    return sums;
}

/* ---- accuracy ------------------------------------------------------------------------------- */

static void test_perfect_sensors_give_the_walker(void)
{
    const errors_t sums = errors_of_walk(0.001);
    /* what is left: the CoM's track is 2 / posture_gain behind the swing leg, which gives the CoM
     * 2 m/s^2 */
    TEST_ASSERT_DOUBLE_WITHIN(4.0 / (double)config.posture_gain_1_s, 0.0,
                              rms(sums.velocity_x, &sums));
    TEST_ASSERT_DOUBLE_WITHIN(0.005, 0.0, rms(sums.velocity_y, &sums));
    TEST_ASSERT_DOUBLE_WITHIN(0.002, 0.0, rms(sums.foot_x, &sums));
    TEST_ASSERT_DOUBLE_WITHIN(0.002, 0.0, rms(sums.foot_y, &sums));
    TEST_ASSERT_DOUBLE_WITHIN(0.002, 0.0, rms(sums.height, &sums));
}

/* The reach of a device with such sensors, docs/joints.md. */
static void assert_within_reach(const errors_t *sums, double across_m_s)
{
    char line[100];
    (void)snprintf(line, sizeof line, "velocity %.1f %.1f mm/s, feet %.1f %.1f mm, height %.1f mm",
                   1e3 * rms(sums->velocity_x, sums), 1e3 * rms(sums->velocity_y, sums),
                   1e3 * rms(sums->foot_x, sums), 1e3 * rms(sums->foot_y, sums),
                   1e3 * rms(sums->height, sums));
    TEST_MESSAGE(line);
    TEST_ASSERT_DOUBLE_WITHIN(0.035, 0.0, rms(sums->velocity_x, sums));
    TEST_ASSERT_DOUBLE_WITHIN(across_m_s, 0.0, rms(sums->velocity_y, sums));
    TEST_ASSERT_DOUBLE_WITHIN(0.006, 0.0, rms(sums->foot_x, sums));
    TEST_ASSERT_DOUBLE_WITHIN(0.005, 0.0, rms(sums->foot_y, sums));
    TEST_ASSERT_DOUBLE_WITHIN(0.004, 0.0, rms(sums->height, sums));
}

static void test_ordinary_sensors_at_1_khz(void)
{
    ordinary_noise();
    const errors_t sums = errors_of_walk(0.001);
    assert_within_reach(&sums, 0.010);
}

static void test_ordinary_sensors_at_100_hz(void)
{
    ordinary_noise();
    const errors_t sums = errors_of_walk(0.01);
    assert_within_reach(&sums, 0.012);
}

static void test_a_walk_does_not_teach_a_bias(void)
{
    double t = 0.0;
    walk(&t, 10.0, 0.001);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.0, (double)estimator.bias_rad_s.x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.0, (double)estimator.bias_rad_s.y);
}

static void test_a_bias_is_learned_while_standing(void)
{
    double t = 0.0;
    noise.gyro_bias = (saddle_vec3_t){0.01f, -0.02f, 0.015f};
    walk(&t, STAND_S, 0.001);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.01, (double)estimator.bias_rad_s.x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, -0.02, (double)estimator.bias_rad_s.y);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.015, (double)estimator.bias_rad_s.z);
}

static void test_nothing_is_trusted_before_the_tilt_has_settled(void)
{
    double t = 0.0;
    walk(&t, 0.3, 0.001);
    TEST_ASSERT_EQUAL_HEX32(SADDLE_SENSOR_SETTLING, estimate.faults);
    TEST_ASSERT_EQUAL_UINT32(SADDLE_AGE_NEVER_US, estimate.measurement.com.age_us);
    TEST_ASSERT_EQUAL_UINT32(SADDLE_AGE_NEVER_US, estimate.measurement.foot[1].age_us);
    walk(&t, 0.5, 0.001);
    TEST_ASSERT_EQUAL_HEX32(0u, estimate.faults);
    TEST_ASSERT_EQUAL_UINT32(0u, estimate.measurement.foot[1].age_us);
}

/* The first update, with these loads and what the accelerometer reads of gravity. */
static void start_with(float left_n, float right_n, saddle_vec3_t up)
{
    saddle_sensors_t sensors = sensors_at(0.0, 0.0);
    sensors.load_n[SADDLE_LEFT] = left_n;
    sensors.load_n[SADDLE_RIGHT] = right_n;
    sensors.accelerometer_m_s2 = up;
    TEST_ASSERT_EQUAL(SADDLE_OK, saddle_estimator_init(&estimator, &legs, &config));
    TEST_ASSERT_EQUAL(SADDLE_OK, saddle_estimator_update(&estimator, &sensors, &estimate));
}

static void test_it_starts_from_the_foot_that_carries_or_in_the_air_from_gravity(void)
{
    const float g = (float)GRAVITY;
    const saddle_vec3_t tilted = {0.6f * g, 0.0f, 0.8f * g};
    start_with(100.0f, 500.0f, tilted); /* feet go before */
    TEST_ASSERT_EQUAL_UINT(SADDLE_RIGHT, estimate.anchor_foot);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, cos(0.05), (double)estimate.trunk.axes.z.z);
    start_with(0.0f, 0.0f, tilted);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.6, (double)estimate.trunk.axes.x.z);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.8, (double)estimate.trunk.axes.z.z);
    start_with(0.0f, 0.0f, (saddle_vec3_t){0.0f, 0.0f, -g}); /* no tilt leads there */
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 1.0, (double)estimate.trunk.axes.z.z);
    start_with(0.0f, 0.0f, (saddle_vec3_t){NAN, 0.0f, g});
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 1.0, (double)estimate.trunk.axes.z.z);
}

/* ---- faults --------------------------------------------------------------------------------- */

/* In the middle of a step on the left foot. */
#define LEFT_STANCE_S (STAND_S + 6.0 * STEP_S + 0.25)

static void test_a_slipping_foot_is_found_and_believed_again(void)
{
    double t = 0.0;
    ordinary_noise();
    walk(&t, LEFT_STANCE_S, 0.001);
    double found_s = 0.0;
    for (; t < LEFT_STANCE_S + 0.1; t += 0.001) { /* 0.6 m/s backwards */
        const saddle_sensors_t sensors = sensors_at(t, -0.6 * (t - LEFT_STANCE_S));
        saddle_estimator_update(&estimator, &sensors, &estimate);
        if (found_s == 0.0 && (estimate.faults & SADDLE_SENSOR_SLIP) != 0u) {
            found_s = t - LEFT_STANCE_S;
        }
    }
    TEST_ASSERT_TRUE(found_s > 0.0 && found_s < 0.03);
    TEST_ASSERT_GREATER_THAN_UINT32(50000u, estimate.measurement.com.age_us);
    TEST_ASSERT_EQUAL_UINT32(0u, estimate.measurement.foot[0].age_us); /* its place is known */
    saddle_whole_body_t body;
    double velocity[2];
    truth_at(t, &body, velocity); /* the IMU's velocity goes on through the slip */
    TEST_ASSERT_DOUBLE_WITHIN(0.2, velocity[0], (double)estimate.measurement.com.velocity_m_s.x);
    walk(&t, LEFT_STANCE_S + 2.0, 0.001);
    TEST_ASSERT_EQUAL_HEX32(0u, estimate.faults);
    TEST_ASSERT_EQUAL_UINT32(0u, estimate.measurement.com.age_us);
}

/* The next readings, for a test to spoil. */
static saddle_sensors_t readings(double *t)
{
    const double now = *t;
    *t += 0.001;
    return sensors_at(now, 0.0);
}

static void update(const saddle_sensors_t *sensors)
{
    TEST_ASSERT_EQUAL(SADDLE_OK, saddle_estimator_update(&estimator, sensors, &estimate));
}

static void test_saturated_sensors_are_said(void)
{
    double t = 0.0;
    walk(&t, LEFT_STANCE_S, 0.001);
    saddle_sensors_t sensors = readings(&t);
    sensors.accelerometer_m_s2.x = config.accelerometer_range_m_s2;
    update(&sensors);
    TEST_ASSERT_EQUAL_HEX32(SADDLE_SENSOR_ACCELEROMETER_SATURATED, estimate.faults);
    TEST_ASSERT_EQUAL_UINT32(0u, estimate.measurement.foot[0].age_us);
    TEST_ASSERT_EQUAL_UINT32(1000u, estimate.measurement.com.age_us);
    sensors = readings(&t);
    update(&sensors);
    TEST_ASSERT_EQUAL_UINT32(0u, estimate.measurement.com.age_us);
    sensors = readings(&t);
    sensors.gyro_rad_s.y = -config.gyro_range_rad_s;
    update(&sensors);
    TEST_ASSERT_EQUAL_HEX32(SADDLE_SENSOR_GYRO_SATURATED | SADDLE_SENSOR_SETTLING, estimate.faults);
    TEST_ASSERT_EQUAL_UINT32(1000u, estimate.measurement.foot[0].age_us);
    walk(&t, t + 1.0, 0.001);
    TEST_ASSERT_EQUAL_HEX32(0u, estimate.faults);
}

static void test_an_old_or_absurd_imu_is_said_and_the_ages_grow(void)
{
    double t = 0.0;
    walk(&t, LEFT_STANCE_S, 0.001);
    for (int i = 1; i <= 100; i++) {
        saddle_sensors_t sensors = readings(&t);
        sensors.imu_age_us = 30000u;
        update(&sensors);
        TEST_ASSERT_EQUAL_HEX32(SADDLE_SENSOR_IMU_STALE | SADDLE_SENSOR_SETTLING,
                                estimate.faults & ~(uint32_t)SADDLE_SENSOR_SLIP);
        TEST_ASSERT_UINT32_WITHIN(2u * (uint32_t)i, 1000u * (uint32_t)i,
                                  estimate.measurement.com.age_us);
    }
    saddle_sensors_t sensors = readings(&t);
    sensors.accelerometer_m_s2.z = NAN;
    update(&sensors);
    TEST_ASSERT_TRUE((estimate.faults & SADDLE_SENSOR_IMU_RANGE) != 0u);
}

static void assert_lost(unsigned side, unsigned joint)
{
    TEST_ASSERT_EQUAL_HEX32(SADDLE_JOINT_BIT(side, joint), estimate.lost_joints);
    TEST_ASSERT_TRUE((estimate.faults & ((uint32_t)SADDLE_SENSOR_LEFT_JOINTS << side)) != 0u);
    TEST_ASSERT_GREATER_THAN_UINT32(0u, estimate.measurement.foot[side].age_us);
}

static void test_an_encoder_that_gives_no_angle_is_lost_at_once_and_comes_back(void)
{
    const float bad[] = {NAN, INFINITY, 4.0f, -3.5f};
    double t = 0.0;
    walk(&t, LEFT_STANCE_S, 0.001);
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        saddle_sensors_t sensors = readings(&t);
        const float before = estimate.joints.angle_rad[1][SADDLE_KNEE];
        sensors.angle_rad[1][SADDLE_KNEE] = bad[i];
        update(&sensors);
        assert_lost(SADDLE_RIGHT, SADDLE_KNEE);
        ASSERT_SAME_FLOAT(before, estimate.joints.angle_rad[1][SADDLE_KNEE]);
        walk(&t, t + 0.6, 0.001);
        TEST_ASSERT_EQUAL_HEX32(0u, estimate.lost_joints);
        TEST_ASSERT_EQUAL_UINT32(0u, estimate.measurement.foot[1].age_us);
    }
}

static void test_an_encoder_that_leaps_is_lost(void)
{
    double t = 0.0;
    walk(&t, LEFT_STANCE_S, 0.001);
    saddle_sensors_t sensors = readings(&t);
    sensors.angle_rad[1][SADDLE_HIP_YAW] += 0.4f;
    update(&sensors);
    assert_lost(SADDLE_RIGHT, SADDLE_HIP_YAW);
}

static void test_a_frozen_encoder_of_a_moving_leg_is_lost(void)
{
    double t = 0.0;
    walk(&t, LEFT_STANCE_S, 0.001);
    const float frozen = sensors_at(t, 0.0).angle_rad[1][SADDLE_KNEE];
    const double begin = t;
    while (t < begin + 0.3 && estimate.lost_joints == 0u) {
        saddle_sensors_t sensors = readings(&t);
        sensors.angle_rad[1][SADDLE_KNEE] = frozen;
        update(&sensors);
    }
    assert_lost(SADDLE_RIGHT, SADDLE_KNEE);
    TEST_ASSERT_TRUE(t - begin < 0.25);
}

static void test_encoders_that_stand_still_are_not_lost(void)
{
    for (double t = 0.001; t < STAND_S; t += 0.001) { /* no noise: the same bits */
        saddle_sensors_t sensors = sensors_at(0.0, 0.0);
        sensors.time_us = (uint64_t)(t * 1e6);
        saddle_estimator_update(&estimator, &sensors, &estimate);
        TEST_ASSERT_EQUAL_HEX32(0u, estimate.lost_joints);
    }
}

static void test_contact_is_dated_to_the_step(void)
{
    double t = 0.0;
    walk(&t, LEFT_STANCE_S, 0.001);
    saddle_sensors_t sensors = readings(&t);
    sensors.load_n[0] = 0.0f;
    update(&sensors);
    TEST_ASSERT_FALSE(estimate.measurement.foot[0].contact);
    TEST_ASSERT_EQUAL_UINT32(0u, estimate.measurement.foot[0].since_us);
    sensors.time_us += 2000u;
    update(&sensors);
    TEST_ASSERT_EQUAL_UINT32(2000u, estimate.measurement.foot[0].since_us);
    sensors.time_us += 1000u;
    sensors.load_n[0] = 600.0f;
    update(&sensors);
    TEST_ASSERT_TRUE(estimate.measurement.foot[0].contact);
    TEST_ASSERT_EQUAL_UINT32(0u, estimate.measurement.foot[0].since_us);
    sensors.time_us += UINT64_C(1) << 33; /* for longer than can be said */
    update(&sensors);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, estimate.measurement.foot[0].since_us);
    sensors.time_us = 500u; /* a clock that goes back */
    update(&sensors);
    TEST_ASSERT_EQUAL_UINT32(0u, estimate.measurement.foot[0].since_us);
}

static void test_old_joints_and_lost_loads_age_their_foot(void)
{
    double t = 0.0;
    walk(&t, LEFT_STANCE_S, 0.001);
    saddle_sensors_t sensors = readings(&t);
    sensors.joints_age_us[1] = 21000u;
    sensors.load_n[0] = NAN;
    update(&sensors);
    TEST_ASSERT_EQUAL_HEX32(SADDLE_SENSOR_RIGHT_JOINTS | SADDLE_SENSOR_LEFT_LOAD, estimate.faults);
    TEST_ASSERT_EQUAL_HEX32(0x3Fu << 6, estimate.lost_joints);
    TEST_ASSERT_TRUE(estimate.measurement.foot[0].contact); /* as it was */
    TEST_ASSERT_EQUAL_UINT32(1000u, estimate.measurement.foot[0].age_us);
    TEST_ASSERT_EQUAL_UINT32(1000u, estimate.measurement.foot[1].age_us);
    TEST_ASSERT_EQUAL_UINT32(1000u, estimate.measurement.com.age_us);
}

static void test_a_lost_stance_leg_leaves_the_anchor_to_the_other(void)
{
    double t = 0.0;
    walk(&t, STAND_S - 0.1, 0.001);
    const unsigned anchor = estimate.anchor_foot;
    saddle_sensors_t sensors = readings(&t);
    sensors.joints_age_us[anchor] = 50000u;
    update(&sensors);
    TEST_ASSERT_EQUAL_UINT(1u - anchor, estimate.anchor_foot);
    TEST_ASSERT_EQUAL_UINT32(0u, estimate.measurement.com.age_us);
}

static void test_an_ankle_that_is_turned_on_its_shaft_is_a_tilt(void)
{
    double t = 0.0;
    walk(&t, 1.0, 0.001);
    for (; t < LEFT_STANCE_S + 0.01; t += 0.001) {
        saddle_sensors_t sensors = sensors_at(t, 0.0);
        sensors.angle_rad[0][SADDLE_ANKLE_ROLL] += t < 1.5 ? (float)(t - 1.0) : 0.5f;
        update(&sensors);
    }
    TEST_ASSERT_TRUE((estimate.faults & SADDLE_SENSOR_TILT) != 0u);
    TEST_ASSERT_GREATER_THAN_UINT32(0u, estimate.measurement.com.age_us);
}

/* ---- what no device sends -------------------------------------------------------------------- */

static void assert_finite(void)
{
    const float *const words[] = {&estimate.measurement.com.height_m,
                                  &estimate.measurement.com.velocity_m_s.x,
                                  &estimate.measurement.foot[0].cop_m.x,
                                  &estimate.measurement.foot[1].cop_m.y,
                                  &estimate.trunk.axes.x.x,
                                  &estimate.trunk.hips_m.z,
                                  &estimate.body.com.velocity_m_s.z,
                                  &estimate.slip_m_s};
    for (size_t i = 0; i < COUNT_OF(words); i++) {
        TEST_ASSERT_TRUE(isfinite(*words[i]));
    }
}

static void test_whatever_comes_the_estimate_is_finite_and_recovers(void)
{
    double t = 0.0;
    for (int n = 0; n < MANY(20000); n++) {
        saddle_sensors_t sensors = readings(&t);
        uint32_t *words = (uint32_t *)(void *)&sensors;
        for (int k = 0; k < 3; k++) { /* any bits in any words but the time's */
            words[2u + random_bits(&seed) % (sizeof sensors / 4u - 2u)] = random_bits(&seed);
        }
        update(&sensors);
        assert_finite();
    }
    const saddle_sensors_t back = sensors_at(0.5, 0.0);
    update(&back); /* time goes back: it starts anew */
    TEST_ASSERT_TRUE((estimate.faults & SADDLE_SENSOR_TIME) != 0u);
    t = 0.5;
    walk(&t, STAND_S + 3.0, 0.001);
    TEST_ASSERT_EQUAL_HEX32(0u, estimate.faults);
}

static void test_a_gap_in_time_starts_it_anew(void)
{
    double t = 0.0;
    walk(&t, 1.0, 0.001);
    const saddle_sensors_t sensors = sensors_at(t + 0.06, 0.0);
    update(&sensors);
    TEST_ASSERT_EQUAL_HEX32(SADDLE_SENSOR_TIME | SADDLE_SENSOR_SETTLING, estimate.faults);
}

static void test_without_init_there_is_no_estimate(void)
{
    static saddle_estimator_t blank;
    const saddle_sensors_t sensors = sensors_at(0.0, 0.0);
    TEST_ASSERT_EQUAL(SADDLE_ERROR_UNINITIALISED,
                      saddle_estimator_update(&blank, &sensors, &estimate));
    TEST_ASSERT_EQUAL_UINT32(SADDLE_AGE_NEVER_US, estimate.measurement.com.age_us);
    config.slip_m_s = -1.0f;
    TEST_ASSERT_EQUAL(SADDLE_ERROR_CONFIG, saddle_estimator_init(&blank, &legs, &config));
    TEST_ASSERT_EQUAL(SADDLE_ERROR_UNINITIALISED,
                      saddle_estimator_update(&blank, &sensors, &estimate));
    config = saddle_estimator_default();
    legs.thigh_m = -1.0f;
    TEST_ASSERT_EQUAL(SADDLE_ERROR_CONFIG, saddle_estimator_init(&blank, &legs, &config));
}

#if !defined SADDLE_EMULATED && defined FE_UPWARD
static void test_another_rounding_mode_is_refused(void)
{
    TEST_ASSERT_EQUAL_INT(0, fesetround(FE_UPWARD));
    const saddle_status_t status = saddle_estimator_init(&estimator, &legs, &config);
    fesetround(FE_TONEAREST);
    TEST_ASSERT_EQUAL(SADDLE_ERROR_BUILD, status);
}
#endif

static void test_each_setting_out_of_its_range_is_named(void)
{
    const saddle_config_field_t *field;
    size_t count = 0;
    TEST_ASSERT_NULL(saddle_estimator_check(&config));
    for (; (field = saddle_estimator_field(count)) != NULL; count++) {
        const float bad[] = {field->min - 0.1f, field->max * 1.01f, NAN};
        for (size_t i = 0; i < COUNT_OF(bad); i++) {
            saddle_estimator_config_t wrong = config;
            memcpy((char *)&wrong + field->offset, &bad[i], sizeof(float));
            TEST_ASSERT_EQUAL_STRING(field->name, saddle_estimator_check(&wrong));
        }
        TEST_ASSERT_EQUAL_size_t(count * sizeof(float), field->offset);
    }
    TEST_ASSERT_EQUAL_size_t(sizeof config, count * sizeof(float));
    config.contact_off_n = config.contact_on_n + 1.0f;
    TEST_ASSERT_EQUAL_STRING("contact_off_n", saddle_estimator_check(&config));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_perfect_sensors_give_the_walker);
    RUN_TEST(test_ordinary_sensors_at_1_khz);
    RUN_TEST(test_ordinary_sensors_at_100_hz);
    RUN_TEST(test_a_walk_does_not_teach_a_bias);
    RUN_TEST(test_a_bias_is_learned_while_standing);
    RUN_TEST(test_nothing_is_trusted_before_the_tilt_has_settled);
    RUN_TEST(test_it_starts_from_the_foot_that_carries_or_in_the_air_from_gravity);
    RUN_TEST(test_a_slipping_foot_is_found_and_believed_again);
    RUN_TEST(test_saturated_sensors_are_said);
    RUN_TEST(test_an_old_or_absurd_imu_is_said_and_the_ages_grow);
    RUN_TEST(test_an_encoder_that_gives_no_angle_is_lost_at_once_and_comes_back);
    RUN_TEST(test_an_encoder_that_leaps_is_lost);
    RUN_TEST(test_a_frozen_encoder_of_a_moving_leg_is_lost);
    RUN_TEST(test_encoders_that_stand_still_are_not_lost);
    RUN_TEST(test_contact_is_dated_to_the_step);
    RUN_TEST(test_old_joints_and_lost_loads_age_their_foot);
    RUN_TEST(test_a_lost_stance_leg_leaves_the_anchor_to_the_other);
    RUN_TEST(test_an_ankle_that_is_turned_on_its_shaft_is_a_tilt);
    RUN_TEST(test_whatever_comes_the_estimate_is_finite_and_recovers);
    RUN_TEST(test_a_gap_in_time_starts_it_anew);
    RUN_TEST(test_without_init_there_is_no_estimate);
#if !defined SADDLE_EMULATED && defined FE_UPWARD
    RUN_TEST(test_another_rounding_mode_is_refused);
#endif
    RUN_TEST(test_each_setting_out_of_its_range_is_named);
    return UNITY_END();
}
