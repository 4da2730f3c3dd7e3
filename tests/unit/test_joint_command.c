/** Joint commands against statics in double, and against the limits of the drives. */
#include "core_test.h"

#include <saddlewalk/joint_command.h>

#define TORQUE_NM 0.02 /* of up to 200, from positions in floats over arms of a metre */

static saddle_legs_t legs;
static saddle_drive_config_t config;
static saddle_estimate_t estimate;
static saddle_intent_t intent;
static saddle_joint_commands_t commands;
static uint32_t seed;

static const saddle_axes_t WORLD = {{1.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, {0.0f, 0.0f, 1.0f}};

/* Somebody with these hips over two soles, at rest; the reference is the posture. */
static void stand(float hips_x, float hips_y, float hips_z)
{
    memset(&estimate, 0, sizeof estimate);
    memset(&intent, 0, sizeof intent);
    estimate.trunk.hips_m = (saddle_vec3_t){hips_x, hips_y, hips_z};
    estimate.trunk.axes = WORLD;
    const saddle_foot_t foot[2] = {{.position_m = {0.0f, 0.1f, 0.0f}},
                                   {.position_m = {0.0f, -0.1f, 0.0f}}};
    const saddle_reach_t reach = saddle_inverse(&legs, &estimate.trunk, foot, &estimate.joints);
    TEST_ASSERT_TRUE(reach.valid && reach.angle_limits == 0u);
    saddle_forward(&legs, &estimate.trunk, &estimate.joints, &estimate.body);
    const saddle_vec3_t com = estimate.body.com.position_m;
    estimate.load_n[0] = estimate.load_n[1] = 310.0f;
    intent.role[0] = intent.role[1] = SADDLE_LEG_STANDS;
    intent.trailing_share_max = 1.0f;
    intent.joints = estimate.joints;
    intent.com_height_m = com.z;
    intent.cop_m = intent.xcom_m = (saddle_vec2_t){com.x, com.y};
}

void setUp(void)
{
    legs = saddle_legs_default(1.79f, 63.3f);
    config = saddle_drive_default();
    seed = 20261202u;
    stand(-0.03f, 0.0f, 0.85f);
}

void tearDown(void) {}

static void command(void)
{
    saddle_joint_commands(&legs, &config, &estimate, &intent, &commands);
}

/* ---- statics -------------------------------------------------------------------------------- */

/* Virtual work: move one joint, and see what the weight of what hangs from the fixed foot gains. The
 * trunk with both legs' masses stands on one foot; the ground force does no work there. */
static double potential_j(unsigned side, const saddle_joints_t *joints)
{
    saddle_trunk_t trunk = estimate.trunk;
    saddle_whole_body_t body;
    saddle_forward(&legs, &trunk, joints, &body);
    /* as seen from that foot: turn the whole body so that its sole is level again */
    const saddle_foot_pose_t *foot = &body.foot[side];
    const double arm[3] = {(double)(body.com.position_m.x - foot->sole_m.x),
                           (double)(body.com.position_m.y - foot->sole_m.y),
                           (double)(body.com.position_m.z - foot->sole_m.z)};
    const double up = arm[0] * (double)foot->axes.z.x + arm[1] * (double)foot->axes.z.y +
                      arm[2] * (double)foot->axes.z.z;
    return 63.3 * GRAVITY * up;
}

static void test_on_one_leg_the_torques_are_the_work_of_the_weight(void)
{
    stand(-0.02f, 0.10f, 0.84f);
    intent.role[1] = SADDLE_LEG_SWINGS;
    intent.leading = SADDLE_LEFT;
    estimate.load_n[0] = 620.0f;
    estimate.load_n[1] = 0.0f;
    command();
    for (unsigned joint = 0; joint < SADDLE_LEG_JOINTS; joint++) {
        const float h = 0.01f;
        saddle_joints_t more = estimate.joints;
        saddle_joints_t less = estimate.joints;
        more.angle_rad[0][joint] += h;
        less.angle_rad[0][joint] -= h;
        const double work =
            (potential_j(SADDLE_LEFT, &more) - potential_j(SADDLE_LEFT, &less)) / (2.0 * 0.01);
        TEST_ASSERT_DOUBLE_WITHIN(0.1, work, (double)commands.joint[0][joint].torque_nm);
    }
}

static void test_a_swinging_leg_carries_its_own_weight(void)
{
    stand(-0.02f, 0.10f, 0.84f);
    intent.role[1] = SADDLE_LEG_SWINGS;
    command();
    for (unsigned joint = 0; joint < SADDLE_LEG_JOINTS; joint++) {
        const float h = 0.01f;
        double com_z[2];
        for (int way = 0; way < 2; way++) {
            saddle_joints_t moved = estimate.joints;
            saddle_whole_body_t body;
            moved.angle_rad[1][joint] += way == 0 ? -h : h;
            saddle_forward(&legs, &estimate.trunk, &moved, &body);
            com_z[way] = (double)body.com.position_m.z;
        }
        const double work = 63.3 * GRAVITY * (com_z[1] - com_z[0]) / (2.0 * (double)h);
        TEST_ASSERT_DOUBLE_WITHIN(0.05, work, (double)commands.joint[1][joint].torque_nm);
    }
}

static void test_who_stands_evenly_shares_the_load_evenly(void)
{
    command();
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.5, (double)commands.load_share[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.5, (double)commands.load_share[1]);
    const float mirrored[SADDLE_LEG_JOINTS] = {-1.0f, -1.0f, 1.0f, 1.0f, 1.0f, -1.0f};
    for (unsigned joint = 0; joint < SADDLE_LEG_JOINTS; joint++) {
        TEST_ASSERT_DOUBLE_WITHIN(TORQUE_NM, (double)commands.joint[0][joint].torque_nm,
                                  (double)(mirrored[joint] * commands.joint[1][joint].torque_nm));
    }
}

static void test_feet_in_one_place_share_the_load_evenly(void)
{
    estimate.body.foot[1].sole_m = estimate.body.foot[0].sole_m;
    command();
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.5, (double)commands.load_share[0]);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.5, (double)commands.load_share[1]);
}

/* ---- balance -------------------------------------------------------------------------------- */

static void test_the_cop_goes_beyond_the_error_of_the_xcom(void)
{
    estimate.body.com.velocity_m_s.x = 0.05f;
    command();
    const double time = sqrt((double)estimate.body.com.position_m.z / GRAVITY);
    const double expected = (double)intent.cop_m.x + 2.0 * 0.05 * time;
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, expected, (double)commands.cop_m.x);
    estimate.body.com.velocity_m_s.x = 2.0f; /* no further than the sole */
    command();
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.09, (double)commands.cop_m.x);
    estimate.body.com.velocity_m_s.x = -2.0f;
    command();
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, -0.09, (double)commands.cop_m.x);
}

static void test_leaning_to_a_side_loads_that_leg(void)
{
    estimate.body.com.velocity_m_s.y = 0.1f;
    command();
    TEST_ASSERT_TRUE(commands.load_share[0] > 0.7f);
    intent.leading = SADDLE_LEFT;
    intent.trailing_share_max = 0.2f;
    estimate.body.com.velocity_m_s.y = -0.5f; /* but no more than it may keep */
    command();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.2, (double)commands.load_share[1]);
}

static void test_a_trunk_that_leans_is_turned_back(void)
{
    command();
    const float upright = commands.joint[0][SADDLE_HIP_PITCH].torque_nm +
                          commands.joint[1][SADDLE_HIP_PITCH].torque_nm;
    estimate.trunk.axes = (saddle_axes_t){{0.995f, 0.0f, -0.0998f}, /* 0.1 rad forward */
                                          {0.0f, 1.0f, 0.0f},
                                          {0.0998f, 0.0f, 0.995f}};
    command();
    const float leaning = commands.joint[0][SADDLE_HIP_PITCH].torque_nm +
                          commands.joint[1][SADDLE_HIP_PITCH].torque_nm;
    /* the hips push the thighs forward and down, the trunk back: 1,200 N m/rad */
    TEST_ASSERT_TRUE(leaning - upright > 60.0f);
}

static void test_the_height_is_held_if_asked_for(void)
{
    command();
    const float before = commands.joint[0][SADDLE_KNEE].torque_nm;
    config.height_stiffness_1_s2 = 80.0f;
    intent.com_height_m += 0.05f; /* too low: 4 m/s^2 more */
    command();
    TEST_ASSERT_TRUE(fabsf(commands.joint[0][SADDLE_KNEE].torque_nm) > 1.3f * fabsf(before));
}

/* ---- gains ---------------------------------------------------------------------------------- */

static void test_gains_go_from_swing_to_stance_with_the_load(void)
{
    const saddle_joint_drive_t *knee = &config.joint[SADDLE_KNEE];
    intent.role[1] = SADDLE_LEG_SWINGS;
    command();
    ASSERT_SAME_FLOAT(knee->swing_stiffness, commands.joint[1][SADDLE_KNEE].stiffness);
    ASSERT_SAME_FLOAT(knee->swing_damping, commands.joint[1][SADDLE_KNEE].damping);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, (double)knee->stance_stiffness,
                              (double)commands.joint[0][SADDLE_KNEE].stiffness);
    estimate.load_n[0] = 0.5f * 0.4f * 63.3f * SADDLE_GRAVITY_M_S2;
    command();
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 0.5 * (double)(knee->stance_stiffness + knee->swing_stiffness),
                              (double)commands.joint[0][SADDLE_KNEE].stiffness);
}

static void test_a_swing_s_acceleration_has_its_torque(void)
{
    intent.role[1] = SADDLE_LEG_SWINGS;
    command();
    const float at_rest = commands.joint[1][SADDLE_HIP_PITCH].torque_nm;
    intent.acceleration_rad_s2[1][SADDLE_HIP_PITCH] = 10.0f;
    command();
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 12.0,
                              (double)(commands.joint[1][SADDLE_HIP_PITCH].torque_nm - at_rest));
}

static void test_ankles_keep_the_cop_in_the_sole(void)
{
    estimate.load_n[0] = 300.0f;
    command();
    const saddle_joint_command_t *pitch = &commands.joint[0][SADDLE_ANKLE_PITCH];
    const double half = 0.5 * (double)legs.foot_length_m;
    const double ahead = (double)legs.ankle_to_middle_m;
    TEST_ASSERT_TRUE((double)pitch->torque_max_nm / 300.0 < half + ahead);
    TEST_ASSERT_TRUE((double)pitch->torque_min_nm / 300.0 > -(half - ahead));
    TEST_ASSERT_TRUE(pitch->torque_min_nm < -5.0f && pitch->torque_max_nm > 40.0f);
    estimate.load_n[0] = 0.0f; /* hardly any foot on the ground, hardly any torque */
    command();
    TEST_ASSERT_TRUE(commands.joint[0][SADDLE_ANKLE_PITCH].torque_max_nm < 10.0f);
}

/* ---- the limits of the drives ---------------------------------------------------------------- */

static void assert_within_limits(void)
{
    for (unsigned i = 0; i < 12u; i++) {
        const saddle_joint_command_t *c = &commands.joint[i / 6u][i % 6u];
        const saddle_joint_range_t range = legs.joint[i % 6u];
        const bool mirrored = i >= 6u && (i % 6u < SADDLE_HIP_PITCH || i % 6u == SADDLE_ANKLE_ROLL);
        const float low = mirrored ? -range.max_rad : range.min_rad;
        const float high = mirrored ? -range.min_rad : range.max_rad;
        const float most = config.joint[i % 6u].torque_max_nm;
        TEST_ASSERT_TRUE(c->angle_rad >= low && c->angle_rad <= high);
        TEST_ASSERT_TRUE(fabsf(c->rate_rad_s) <= range.rate_max_rad_s);
        TEST_ASSERT_TRUE(c->torque_nm >= c->torque_min_nm && c->torque_nm <= c->torque_max_nm);
        TEST_ASSERT_TRUE(c->torque_min_nm >= -most && c->torque_max_nm <= most);
        TEST_ASSERT_TRUE(c->stiffness >= 0.0f && c->stiffness <= 10000.0f);
        TEST_ASSERT_TRUE(c->damping >= 0.0f && c->damping <= 1000.0f);
    }
}

static void test_an_old_estimate_moves_nothing(void)
{
    estimate.measurement.com.age_us = 240001u;
    command();
    TEST_ASSERT_TRUE(commands.fallback);
    assert_within_limits();
    for (unsigned i = 0; i < 12u; i++) {
        const saddle_joint_command_t *c = &commands.joint[i / 6u][i % 6u];
        ASSERT_SAME_FLOAT(0.0f, c->torque_nm);
        ASSERT_SAME_FLOAT(0.0f, c->stiffness); /* damped, not held */
        ASSERT_SAME_FLOAT(config.joint[i % 6u].stance_damping, c->damping);
    }
    config.fallback_stiffness = 2.0f; /* held at the last angles */
    command();
    ASSERT_SAME_FLOAT(2.0f * config.joint[SADDLE_KNEE].stance_stiffness,
                      commands.joint[1][SADDLE_KNEE].stiffness);
    ASSERT_SAME_FLOAT(estimate.joints.angle_rad[1][SADDLE_KNEE],
                      commands.joint[1][SADDLE_KNEE].angle_rad);
    estimate.measurement.com.age_us = 239000u;
    command();
    TEST_ASSERT_FALSE(commands.fallback);
}

static void test_an_intent_that_is_none_moves_nothing(void)
{
    const saddle_intent_t good = intent;
    for (size_t word = 1; word < sizeof intent / 4u; word++) { /* all floats; before them bytes */
        intent = good;
        const float bad = word % 2u == 0u ? NAN : -1e30f;
        memcpy((char *)&intent + 4u * word, &bad, sizeof bad);
        command();
        TEST_ASSERT_TRUE(commands.fallback);
        assert_within_limits();
    }
    intent = good;
    intent.role[1] = SADDLE_LEG_TRAILS + 1;
    command();
    TEST_ASSERT_TRUE(commands.fallback);
    intent = good;
    intent.role[0] = SADDLE_LEG_TRAILS + 1;
    command();
    TEST_ASSERT_TRUE(commands.fallback);
    intent = good;
    intent.leading = 2;
    command();
    TEST_ASSERT_TRUE(commands.fallback);
}

static void test_whatever_is_wanted_the_commands_are_within_the_limits(void)
{
    for (int n = 0; n < MANY(20000); n++) {
        stand(random_in(&seed, -0.05f, 0.05f), random_in(&seed, -0.05f, 0.05f),
              random_in(&seed, 0.82f, 0.86f));
        for (unsigned i = 0; i < 12u; i++) {
            intent.joints.angle_rad[i / 6u][i % 6u] = random_in(&seed, -9000.0f, 9000.0f);
            intent.joints.rate_rad_s[i / 6u][i % 6u] = random_in(&seed, -9000.0f, 9000.0f);
            intent.acceleration_rad_s2[i / 6u][i % 6u] = random_in(&seed, -9000.0f, 9000.0f);
        }
        intent.role[0] = (uint8_t)(random_bits(&seed) % 3u);
        intent.role[1] = (uint8_t)(random_bits(&seed) % 3u);
        intent.leading = (uint8_t)(random_bits(&seed) % 2u);
        intent.xcom_m.x = random_in(&seed, -100.0f, 100.0f);
        intent.trailing_share_max = random_in(&seed, -1.0f, 2.0f);
        estimate.load_n[0] = random_in(&seed, 0.0f, 5000.0f);
        command();
        TEST_ASSERT_FALSE(commands.fallback);
        assert_within_limits();
    }
}

static void test_each_gain_out_of_its_range_is_named(void)
{
    const saddle_config_field_t *field;
    size_t count = 0;
    TEST_ASSERT_NULL(saddle_drive_check(&config));
    for (; (field = saddle_drive_field(count)) != NULL; count++) {
        const float bad[] = {field->min - 0.1f, field->max * 1.01f, NAN};
        for (size_t i = 0; i < COUNT_OF(bad); i++) {
            saddle_drive_config_t wrong = config;
            memcpy((char *)&wrong + field->offset, &bad[i], sizeof(float));
            TEST_ASSERT_EQUAL_STRING(field->name, saddle_drive_check(&wrong));
        }
        TEST_ASSERT_EQUAL_size_t(count * sizeof(float), field->offset);
    }
    TEST_ASSERT_EQUAL_size_t(sizeof config, count * sizeof(float));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_on_one_leg_the_torques_are_the_work_of_the_weight);
    RUN_TEST(test_a_swinging_leg_carries_its_own_weight);
    RUN_TEST(test_who_stands_evenly_shares_the_load_evenly);
    RUN_TEST(test_feet_in_one_place_share_the_load_evenly);
    RUN_TEST(test_the_cop_goes_beyond_the_error_of_the_xcom);
    RUN_TEST(test_leaning_to_a_side_loads_that_leg);
    RUN_TEST(test_a_trunk_that_leans_is_turned_back);
    RUN_TEST(test_the_height_is_held_if_asked_for);
    RUN_TEST(test_gains_go_from_swing_to_stance_with_the_load);
    RUN_TEST(test_a_swing_s_acceleration_has_its_torque);
    RUN_TEST(test_ankles_keep_the_cop_in_the_sole);
    RUN_TEST(test_an_old_estimate_moves_nothing);
    RUN_TEST(test_an_intent_that_is_none_moves_nothing);
    RUN_TEST(test_whatever_is_wanted_the_commands_are_within_the_limits);
    RUN_TEST(test_each_gain_out_of_its_range_is_named);
    return UNITY_END();
}
