#include "device.h"

#include <string.h>

#define STEP_MS 600u
#define WEIGHT_N 620.0f

static uint32_t random_bits(uint32_t *state)
{
    *state ^= *state << 13;
    *state ^= *state >> 17;
    *state ^= *state << 5;
    return *state;
}

static float random_in(uint32_t *state, float min, float max)
{
    return min + (max - min) * ((float)(random_bits(state) >> 8) / 16777216.0f);
}

static saddle_vec3_t random_vec3(uint32_t *state, float size)
{
    saddle_vec3_t v;
    v.x = random_in(state, -size, size);
    v.y = random_in(state, -size, size);
    v.z = random_in(state, -size, size);
    return v;
}

void device_begin(device_t *device, bool absurd)
{
    memset(device, 0, sizeof *device);
    device->absurd = absurd;
    device->random = 20261201u;
    device->legs = saddle_legs_default(1.79f, 63.3f);
    device->trunk.hips_m.z = 0.8f;
    device->trunk.axes.x.x = device->trunk.axes.y.y = device->trunk.axes.z.z = 1.0f;
    const saddle_estimator_config_t config = saddle_estimator_default();
    device->drive = saddle_drive_default();
    const saddle_joint_walk_config_t walk = saddle_joint_walk_default();
    (void)saddle_joint_walk_init(&device->walk, &device->legs, &walk);
    (void)saddle_estimator_init(&device->estimator, &device->legs, &config);
}

/* Left and right in turn rise and come down again, and point anywhere. */
static void step_in_place(device_t *device)
{
    const uint32_t ms = device->updates % (2u * STEP_MS);
    const unsigned swing = ms < STEP_MS ? SADDLE_RIGHT : SADDLE_LEFT;
    const float s = (float)(ms % STEP_MS) / (float)STEP_MS;
    const float height_m = 0.3f * s * (1.0f - s);
    for (unsigned side = 0; side < 2; side++) {
        saddle_foot_t *foot = &device->foot[side];
        foot->point = (uint8_t)(device->updates / STEP_MS % 3u);
        foot->position_m.x = random_in(&device->random, -0.001f, 0.001f);
        foot->position_m.y = side == SADDLE_LEFT ? 0.1f : -0.1f;
        foot->position_m.z = side == swing ? height_m : 0.0f;
        foot->velocity_m_s = random_vec3(&device->random, 0.3f);
        foot->pitch_rad = side == swing ? 2.0f * height_m : 0.0f;
        foot->yaw_rad = random_in(&device->random, -0.001f, 0.001f);
    }
    device->trunk.hips_m.y = swing == SADDLE_RIGHT ? height_m : -height_m;
    device->trunk.velocity_m_s = random_vec3(&device->random, 0.3f);
    device->sensors.load_n[swing] = 0.0f;
    device->sensors.load_n[1u - swing] = WEIGHT_N;
}

static void sense(device_t *device)
{
    saddle_sensors_t *sensors = &device->sensors;
    sensors->time_us += 1000u;
    sensors->gyro_rad_s = random_vec3(&device->random, 0.05f);
    sensors->accelerometer_m_s2 = random_vec3(&device->random, 0.5f);
    sensors->accelerometer_m_s2.z += SADDLE_GRAVITY_M_S2;
    for (unsigned i = 0; i < 2u * SADDLE_LEG_JOINTS; i++) {
        sensors->angle_rad[i / SADDLE_LEG_JOINTS][i % SADDLE_LEG_JOINTS] =
            device->joints.angle_rad[i / SADDLE_LEG_JOINTS][i % SADDLE_LEG_JOINTS] +
            random_in(&device->random, -0.001f, 0.001f);
    }
}

/* Any bits in one word in so many. */
static void spoil(device_t *device, void *object, size_t size)
{
    for (size_t offset = 0; device->absurd && offset + 4u <= size; offset += 4u) {
        const uint32_t bits = random_bits(&device->random);
        if (random_bits(&device->random) % 64u == 0u) {
            memcpy((char *)object + offset, &bits, sizeof bits);
        }
    }
}

/* Small steps in the same rhythm, with a CoP near the foot that stands. */
static void plan_steps(device_t *device)
{
    saddle_plan_t *plan = &device->plan;
    const uint32_t ms = device->updates % (2u * STEP_MS);
    const unsigned swing = ms < STEP_MS ? SADDLE_RIGHT : SADDLE_LEFT;
    const float s = (float)(ms % STEP_MS) / (float)STEP_MS;
    plan->valid = true;
    plan->mode = SADDLE_MODE_WALKING;
    plan->support = (uint8_t)(1u - swing);
    plan->speed_m_s = 0.1f;
    plan->step_length_m = 0.06f;
    plan->com_m.z = random_in(&device->random, 0.85f, 0.95f);
    plan->foot_m[1u - swing].y = swing == SADDLE_RIGHT ? 0.1f : -0.1f;
    plan->foot_m[swing].x = -0.06f + 0.12f * s;
    plan->foot_m[swing].y = -plan->foot_m[1u - swing].y;
    plan->foot_m[swing].z = 0.3f * s * (1.0f - s);
    plan->foot_pitch_rad[swing] = 0.5f * (1.0f - s);
    plan->foot_pitch_rad[1u - swing] = 0.0f;
    plan->swing_velocity_m_s.x = 0.2f;
    plan->time_to_toe_off_s = (1.0f - s) * 0.001f * (float)STEP_MS;
    plan->time_to_via_point_s = plan->time_to_toe_off_s;
    plan->landing_m.x = device->updates / STEP_MS % 4u == 3u ? 0.0f : 0.06f;
    plan->landing_m.y = plan->foot_m[swing].y;
    plan->reference.cop_m.x = random_in(&device->random, -0.05f, 0.05f);
    plan->reference.xcom_m.x = random_in(&device->random, -0.05f, 0.05f);
}

static void intend(device_t *device)
{
    plan_steps(device);
    saddle_plan_t plan = device->plan;
    spoil(device, &plan.speed_m_s,
          sizeof plan - offsetof(saddle_plan_t, speed_m_s)); /* from there on floats */
    saddle_verdict_t verdict;
    memset(&verdict, 0, sizeof verdict);
    verdict.recovery.found = device->updates / STEP_MS % 3u == 0u;
    verdict.recovery.foot = (uint8_t)(1u - device->plan.support);
    verdict.recovery.landing_m.x = random_in(&device->random, -0.5f, 0.5f);
    verdict.xcom_deviation_m.x = random_in(&device->random, -0.2f, 0.2f);
    const saddle_joint_walk_input_t input = {device->sensors.time_us, &plan, &verdict};
    (void)saddle_joint_walk_update(&device->walk, &input, &device->estimate, &device->intent);
}

void device_update(device_t *device)
{
    step_in_place(device);
    saddle_trunk_t trunk = device->trunk;
    saddle_foot_t foot[2] = {device->foot[0], device->foot[1]};
    spoil(device, &trunk, sizeof trunk);
    spoil(device, &foot[0].position_m, sizeof foot[0].position_m);
    const saddle_com_t com = {trunk.hips_m, trunk.velocity_m_s};
    (void)saddle_inverse_of_com(&device->legs, &com, foot, &trunk, &device->joints);
    device->reach = saddle_inverse(&device->legs, &device->trunk, foot, &device->joints);
    saddle_forward(&device->legs, &device->trunk, &device->joints, &device->body);
    sense(device);
    saddle_sensors_t sensors = device->sensors;
    spoil(device, &sensors.gyro_rad_s,
          offsetof(saddle_sensors_t, imu_age_us) - offsetof(saddle_sensors_t, gyro_rad_s));
    (void)saddle_estimator_update(&device->estimator, &sensors, &device->estimate);
    intend(device);
    saddle_intent_t intent = device->intent;
    spoil(device, &intent.trailing_share_max,
          sizeof intent - offsetof(saddle_intent_t, trailing_share_max));
    saddle_joint_commands(&device->legs, &device->drive, &device->estimate, &intent,
                          &device->commands);
    device->updates++;
}
