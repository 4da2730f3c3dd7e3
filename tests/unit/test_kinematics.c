/** Joint angles of random postures and back, against rotation matrices in double. */
#include "core_test.h"

#include <saddlewalk/joints.h>

#define POSITION_M 2e-6   /* the leg's length in floats, some roundings */
#define ANGLE_RAD 5e-6    /* near a straight knee the square root doubles a rounding's share */
#define VELOCITY_M_S 5e-5 /* rates of up to 15 rad/s, times the leg's length */

static saddle_legs_t legs;
static uint32_t seed;

void setUp(void)
{
    legs = saddle_legs_default(1.79f, 63.3f);
    seed = 20261130u;
}

void tearDown(void) {}

/* ---- an independent chain in double: rotation matrices, rows first -------------------------- */

typedef struct {
    double m[3][3];
} matrix_t;

static matrix_t product(matrix_t a, matrix_t b)
{
    matrix_t c;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            c.m[i][j] = a.m[i][0] * b.m[0][j] + a.m[i][1] * b.m[1][j] + a.m[i][2] * b.m[2][j];
        }
    }
    return c;
}

/* About an axis, 0 to 2. */
static matrix_t rotation(int axis, double angle)
{
    const int j = (axis + 1) % 3;
    const int k = (axis + 2) % 3;
    matrix_t r = {{{0.0}}};
    r.m[axis][axis] = 1.0;
    r.m[j][j] = r.m[k][k] = cos(angle);
    r.m[k][j] = sin(angle);
    r.m[j][k] = -sin(angle);
    return r;
}

static void move(double point[3], const matrix_t *r, double x, double y, double z)
{
    for (int i = 0; i < 3; i++) {
        point[i] += r->m[i][0] * x + r->m[i][1] * y + r->m[i][2] * z;
    }
}

static matrix_t matrix_of(const saddle_axes_t *axes)
{
    return (matrix_t){{{(double)axes->x.x, (double)axes->y.x, (double)axes->z.x},
                       {(double)axes->x.y, (double)axes->y.y, (double)axes->z.y},
                       {(double)axes->x.z, (double)axes->y.z, (double)axes->z.z}}};
}

typedef struct {
    double sole[3], com[3];
    matrix_t foot;
} twin_leg_t;

/* The mass-weighted CoM of the leg's three segments, and its sole. */
static twin_leg_t twin_leg(matrix_t r, const double hips[3], const double q[6], int side)
{
    const double thigh = (double)legs.thigh_m;
    const double shank = (double)legs.shank_m;
    const double mass[3] = {(double)legs.thigh_kg, (double)legs.shank_kg, (double)legs.foot_kg};
    twin_leg_t twin = {{hips[0], hips[1], hips[2]}, {0.0, 0.0, 0.0}, r};
    double c[3][3];
    move(twin.sole, &r, 0.0, (side == SADDLE_LEFT ? 1.0 : -1.0) * (double)legs.hip_half_width_m, 0);
    r = product(product(product(r, rotation(2, q[0])), rotation(0, q[1])), rotation(1, q[2]));
    memcpy(c[0], twin.sole, sizeof c[0]);
    move(c[0], &r, 0.0, 0.0, -(double)legs.thigh_com_share * thigh);
    move(twin.sole, &r, 0.0, 0.0, -thigh);
    r = product(r, rotation(1, q[3]));
    memcpy(c[1], twin.sole, sizeof c[1]);
    move(c[1], &r, 0.0, 0.0, -(double)legs.shank_com_share * shank);
    move(twin.sole, &r, 0.0, 0.0, -shank);
    r = product(product(r, rotation(1, q[4])), rotation(0, q[5]));
    memcpy(c[2], twin.sole, sizeof c[2]);
    const double ankle = (double)legs.ankle_height_m;
    move(c[2], &r, (double)legs.ankle_to_middle_m, 0.0, -0.5 * ankle);
    move(twin.sole, &r, (double)legs.ankle_to_middle_m, 0.0, -ankle);
    twin.foot = r;
    for (int i = 0; i < 3; i++) {
        twin.com[i] = mass[0] * c[0][i] + mass[1] * c[1][i] + mass[2] * c[2][i];
    }
    return twin;
}

/* ---- random postures ------------------------------------------------------------------------ */

static float between(float min, float max)
{
    return random_in(&seed, min, max);
}

static saddle_vec3_t vec3_in(float size)
{
    saddle_vec3_t vector;
    vector.x = between(-size, size);
    vector.y = between(-size, size);
    vector.z = between(-size, size);
    return vector;
}

static saddle_axes_t axes_of(float yaw, float roll, float pitch)
{
    const matrix_t r = product(product(rotation(2, (double)yaw), rotation(0, (double)roll)),
                               rotation(1, (double)pitch));
    return (saddle_axes_t){{(float)r.m[0][0], (float)r.m[1][0], (float)r.m[2][0]},
                           {(float)r.m[0][1], (float)r.m[1][1], (float)r.m[2][1]},
                           {(float)r.m[0][2], (float)r.m[1][2], (float)r.m[2][2]}};
}

static saddle_trunk_t some_trunk(void)
{
    saddle_trunk_t trunk;
    trunk.hips_m.x = between(-0.1f, 0.1f);
    trunk.hips_m.y = between(-0.08f, 0.08f);
    trunk.hips_m.z = between(0.76f, 0.82f);
    trunk.velocity_m_s = vec3_in(0.5f);
    const float yaw = between(-0.2f, 0.2f);
    const float roll = between(-0.2f, 0.2f);
    trunk.axes = axes_of(yaw, roll, between(-0.3f, 0.3f));
    trunk.turn_rad_s = vec3_in(0.5f);
    return trunk;
}

/* Nearly always in reach of those hips and within the joints' ranges. */
static saddle_foot_t some_foot(saddle_side_t side, uint8_t point)
{
    const float outward = side == SADDLE_LEFT ? 1.0f : -1.0f;
    saddle_foot_t foot;
    foot.point = point;
    foot.position_m.x = between(-0.2f, 0.2f);
    foot.position_m.y = outward * between(0.05f, 0.2f);
    foot.position_m.z = between(0.0f, 0.05f);
    foot.velocity_m_s = vec3_in(0.5f);
    foot.yaw_rad = between(-0.25f, 0.25f);
    foot.yaw_rate_rad_s = between(-0.5f, 0.5f);
    foot.pitch_rad = between(0.0f, 0.5f);
    foot.pitch_rate_rad_s = between(-1.0f, 1.0f);
    return foot;
}

static void some_feet(saddle_foot_t foot[2], uint8_t point)
{
    foot[SADDLE_LEFT] = some_foot(SADDLE_LEFT, point);
    foot[SADDLE_RIGHT] = some_foot(SADDLE_RIGHT, point);
}

static void assert_same_place(double tolerance, saddle_vec3_t expected, saddle_vec3_t actual)
{
    TEST_ASSERT_DOUBLE_WITHIN(tolerance, (double)expected.x, (double)actual.x);
    TEST_ASSERT_DOUBLE_WITHIN(tolerance, (double)expected.y, (double)actual.y);
    TEST_ASSERT_DOUBLE_WITHIN(tolerance, (double)expected.z, (double)actual.z);
}

/* A point of the sole as a posture has it, and its velocity. */
static saddle_com_t sole_point(const saddle_foot_pose_t *foot, uint8_t point)
{
    const float share = point == SADDLE_SOLE_MIDDLE ? 0.0f
                        : point == SADDLE_SOLE_HEEL ? -0.5f
                                                    : 0.5f;
    const float x = share * legs.foot_length_m;
    const saddle_vec3_t arm = {x * foot->axes.x.x, x * foot->axes.x.y, x * foot->axes.x.z};
    const saddle_vec3_t w = foot->turn_rad_s;
    return (saddle_com_t){{foot->sole_m.x + arm.x, foot->sole_m.y + arm.y, foot->sole_m.z + arm.z},
                          {foot->velocity_m_s.x + w.y * arm.z - w.z * arm.y,
                           foot->velocity_m_s.y + w.z * arm.x - w.x * arm.z,
                           foot->velocity_m_s.z + w.x * arm.y - w.y * arm.x}};
}

/* ---- tests ---------------------------------------------------------------------------------- */

static void test_forward_is_the_chain_of_rotations(void)
{
    for (int n = 0; n < MANY(2000); n++) {
        const saddle_trunk_t trunk = some_trunk();
        const double hips[3] = {(double)trunk.hips_m.x, (double)trunk.hips_m.y,
                                (double)trunk.hips_m.z};
        saddle_joints_t joints;
        saddle_whole_body_t posture;
        double q[2][6];
        for (int i = 0; i < 12; i++) {
            joints.angle_rad[i / 6][i % 6] = between(-1.5f, 1.5f);
            joints.rate_rad_s[i / 6][i % 6] = 0.0f;
            q[i / 6][i % 6] = (double)joints.angle_rad[i / 6][i % 6];
        }
        saddle_forward(&legs, &trunk, &joints, &posture);
        const matrix_t r = matrix_of(&trunk.axes);
        const twin_leg_t left = twin_leg(r, hips, q[0], SADDLE_LEFT);
        const twin_leg_t right = twin_leg(r, hips, q[1], SADDLE_RIGHT);
        double com[3] = {hips[0], hips[1], hips[2]};
        move(com, &r, 0.0, 0.0, (double)legs.trunk_com_m);
        const float actual[3] = {posture.com.position_m.x, posture.com.position_m.y,
                                 posture.com.position_m.z};
        const float sole[3] = {posture.foot[0].sole_m.x, posture.foot[0].sole_m.y,
                               posture.foot[0].sole_m.z};
        for (int i = 0; i < 3; i++) {
            const double sum = (double)legs.trunk_kg * com[i] + left.com[i] + right.com[i];
            TEST_ASSERT_DOUBLE_WITHIN(POSITION_M, sum / 63.3, (double)actual[i]);
            TEST_ASSERT_DOUBLE_WITHIN(POSITION_M, left.sole[i], (double)sole[i]);
        }
        const matrix_t foot = matrix_of(&posture.foot[1].axes);
        for (int i = 0; i < 9; i++) {
            TEST_ASSERT_DOUBLE_WITHIN(POSITION_M, right.foot.m[i / 3][i % 3], foot.m[i / 3][i % 3]);
        }
    }
}

static void test_velocities_are_the_change_of_positions(void)
{
    const double h = 1e-3;
    for (int n = 0; n < MANY(1000); n++) {
        saddle_trunk_t trunk = some_trunk();
        saddle_joints_t joints;
        saddle_whole_body_t posture;
        trunk.velocity_m_s = trunk.turn_rad_s = (saddle_vec3_t){0.0f, 0.0f, 0.0f};
        double ahead[6];
        double behind[6];
        for (int i = 0; i < 6; i++) {
            joints.angle_rad[0][i] = joints.angle_rad[1][i] = between(-1.5f, 1.5f);
            joints.rate_rad_s[0][i] = joints.rate_rad_s[1][i] = between(-5.0f, 5.0f);
            ahead[i] = (double)joints.angle_rad[0][i] + h * (double)joints.rate_rad_s[0][i];
            behind[i] = (double)joints.angle_rad[0][i] - h * (double)joints.rate_rad_s[0][i];
        }
        saddle_forward(&legs, &trunk, &joints, &posture);
        const double hips[3] = {(double)trunk.hips_m.x, (double)trunk.hips_m.y,
                                (double)trunk.hips_m.z};
        const matrix_t r = matrix_of(&trunk.axes);
        const twin_leg_t next = twin_leg(r, hips, ahead, SADDLE_LEFT);
        const twin_leg_t last = twin_leg(r, hips, behind, SADDLE_LEFT);
        const float velocity[3] = {posture.foot[0].velocity_m_s.x, posture.foot[0].velocity_m_s.y,
                                   posture.foot[0].velocity_m_s.z};
        for (int i = 0; i < 3;
             i++) { /* the difference errs by h^2 times the third derivative / 6 */
            const double expected = (next.sole[i] - last.sole[i]) / (2.0 * h);
            TEST_ASSERT_DOUBLE_WITHIN(1.5e-3, expected, (double)velocity[i]);
        }
    }
}

static void test_inverse_puts_the_feet_where_they_should_be_and_moves_them_so(void)
{
    int at_ease = 0;
    for (int n = 0; n < MANY(20000); n++) {
        const saddle_trunk_t trunk = some_trunk();
        const uint8_t point = (uint8_t)(n % 3);
        saddle_foot_t foot[2];
        saddle_joints_t joints;
        saddle_whole_body_t posture;
        some_feet(foot, point);
        const saddle_reach_t reach = saddle_inverse(&legs, &trunk, foot, &joints);
        TEST_ASSERT_TRUE(reach.valid);
        const bool reached = !reach.out_of_reach[0] && !reach.out_of_reach[1];
        if (!reached || reach.angle_limits != 0u || reach.rate_limits != 0u) {
            continue;
        }
        at_ease++;
        saddle_forward(&legs, &trunk, &joints, &posture);
        for (int side = 0; side < 2; side++) {
            const saddle_com_t sole = sole_point(&posture.foot[side], point);
            const saddle_axes_t axes = axes_of(foot[side].yaw_rad, 0.0f, foot[side].pitch_rad);
            assert_same_place(POSITION_M, foot[side].position_m, sole.position_m);
            assert_same_place(VELOCITY_M_S, foot[side].velocity_m_s, sole.velocity_m_s);
            assert_same_place(ANGLE_RAD, axes.x, posture.foot[side].axes.x);
            assert_same_place(ANGLE_RAD, axes.z, posture.foot[side].axes.z);
            const saddle_vec3_t turn = posture.foot[side].turn_rad_s;
            TEST_ASSERT_DOUBLE_WITHIN(VELOCITY_M_S, (double)foot[side].yaw_rate_rad_s,
                                      (double)turn.z);
            TEST_ASSERT_DOUBLE_WITHIN(
                VELOCITY_M_S, (double)foot[side].pitch_rate_rad_s * cos((double)foot[side].yaw_rad),
                (double)turn.y);
        }
    }
    TEST_ASSERT_GREATER_THAN(MANY(10000), at_ease);
}

static void test_rates_are_the_change_of_angles(void)
{
    const float h = 1e-3f;
    int compared = 0;
    for (int n = 0; n < MANY(6000); n++) {
        saddle_trunk_t trunk = some_trunk();
        saddle_foot_t foot[2];
        saddle_joints_t now;
        saddle_joints_t later;
        saddle_joints_t sooner;
        some_feet(foot, (uint8_t)(n % 3));
        trunk.turn_rad_s = (saddle_vec3_t){0.0f, 0.0f, 0.0f};
        const saddle_reach_t reach = saddle_inverse(&legs, &trunk, foot, &now);
        bool at_a_limit = reach.angle_limits != 0u || reach.rate_limits != 0u;
        for (int way = -1; way <= 1; way += 2) {
            const float t = (float)way * h;
            saddle_foot_t moved[2] = {foot[0], foot[1]};
            saddle_trunk_t trunk_then = trunk;
            for (int side = 0; side < 2; side++) {
                moved[side].position_m.x += t * foot[side].velocity_m_s.x;
                moved[side].position_m.y += t * foot[side].velocity_m_s.y;
                moved[side].position_m.z += t * foot[side].velocity_m_s.z;
                moved[side].yaw_rad += t * foot[side].yaw_rate_rad_s;
                moved[side].pitch_rad += t * foot[side].pitch_rate_rad_s;
            }
            trunk_then.hips_m.x += t * trunk.velocity_m_s.x;
            trunk_then.hips_m.y += t * trunk.velocity_m_s.y;
            trunk_then.hips_m.z += t * trunk.velocity_m_s.z;
            at_a_limit |= saddle_inverse(&legs, &trunk_then, moved, way > 0 ? &later : &sooner)
                              .angle_limits != 0u;
        }
        if (at_a_limit) {
            continue;
        }
        compared++;
        for (int i = 0; i < 12; i++) {
            const double expected =
                ((double)later.angle_rad[i / 6][i % 6] - (double)sooner.angle_rad[i / 6][i % 6]) /
                (2.0 * (double)h);
            const double rate = (double)now.rate_rad_s[i / 6][i % 6];
            /* angles in floats, over 2 ms, and the curvature at nearly straight knees */
            TEST_ASSERT_DOUBLE_WITHIN(0.01 + 0.02 * fabs(rate), expected, rate);
        }
    }
    TEST_ASSERT_GREATER_THAN(MANY(2000), compared);
}

static void test_a_foot_beyond_reach_is_approached_and_said(void)
{
    const saddle_trunk_t trunk = {
        {0.0f, 0.0f, 0.9f}, {1.0f, 0.0f, 0.5f}, axes_of(0.0f, 0.0f, 0.0f), {0.0f, 0.0f, 0.0f}};
    saddle_joints_t joints;
    saddle_foot_t foot[2] = {{.position_m = {0.6f, 0.1f, 0.0f}},
                             {.position_m = {0.0f, -0.1f, 0.1f}}};
    const saddle_reach_t reach = saddle_inverse(&legs, &trunk, foot, &joints);
    TEST_ASSERT_TRUE(reach.valid && reach.out_of_reach[0] && !reach.out_of_reach[1]);
    const double least = (double)legs.joint[SADDLE_KNEE].min_rad;
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, least, (double)joints.angle_rad[0][SADDLE_KNEE]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.0, (double)joints.rate_rad_s[0][SADDLE_KNEE]); /* floats */
    saddle_whole_body_t posture;
    saddle_forward(&legs, &trunk, &joints, &posture);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 1.0, (double)posture.foot[0].axes.z.z); /* still flat */
    TEST_ASSERT_TRUE(posture.foot[0].sole_m.z > 0.02f && posture.foot[0].sole_m.x > 0.4f);
}

static void test_a_straight_knee_is_never_singular(void)
{
    for (int i = 0; i <= 2000; i++) { /* the hip rises through the end of reach */
        const float z = 0.85f + 0.0001f * (float)i;
        const saddle_trunk_t trunk = {
            {0.0f, 0.0f, z}, {0.0f, 0.0f, 0.2f}, axes_of(0.0f, 0.0f, 0.0f), {0.0f, 0.0f, 0.0f}};
        const saddle_foot_t foot[2] = {{.position_m = {0.0f, 0.1f, 0.0f}},
                                       {.position_m = {0.0f, -0.1f, 0.0f}}};
        saddle_joints_t joints;
        saddle_inverse(&legs, &trunk, foot, &joints);
        for (int k = 0; k < 12; k++) { /* 0.2 m/s over a b sin(0.1) / (a + b) = 0.022 m */
            TEST_ASSERT_DOUBLE_WITHIN(9.2, 0.0, (double)joints.rate_rad_s[k / 6][k % 6]);
        }
        TEST_ASSERT_TRUE(joints.angle_rad[0][SADDLE_KNEE] >= legs.joint[SADDLE_KNEE].min_rad);
    }
}

static void test_limits_hold_and_are_said_joint_by_joint(void)
{
    static const saddle_trunk_t upright = {
        {0.0f, 0.0f, 0.8f},
        {0.0f, 0.0f, 0.0f},
        {{1.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, {0.0f, 0.0f, 1.0f}},
        {0.0f, 0.0f, 0.0f}};
    saddle_foot_t foot[2] = {{.position_m = {0.0f, 0.1f, 0.0f}},
                             {.position_m = {0.0f, -0.1f, 0.0f}, .yaw_rad = -0.9f}};
    saddle_joints_t joints;
    saddle_reach_t reach = saddle_inverse(&legs, &upright, foot, &joints);
    TEST_ASSERT_EQUAL_HEX32(SADDLE_JOINT_BIT(SADDLE_RIGHT, SADDLE_HIP_YAW), reach.angle_limits);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -0.7, (double)joints.angle_rad[1][SADDLE_HIP_YAW]);
    legs.joint[SADDLE_HIP_YAW].min_rad = -0.1f; /* inward on the left, so outward is 0.7 on both */
    foot[1].yaw_rad = 0.3f;
    reach = saddle_inverse(&legs, &upright, foot, &joints);
    TEST_ASSERT_EQUAL_HEX32(SADDLE_JOINT_BIT(SADDLE_RIGHT, SADDLE_HIP_YAW), reach.angle_limits);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.1, (double)joints.angle_rad[1][SADDLE_HIP_YAW]);
    foot[1].yaw_rad = 0.0f;
    foot[0].pitch_rate_rad_s = 40.0f;
    reach = saddle_inverse(&legs, &upright, foot, &joints);
    TEST_ASSERT_TRUE((reach.rate_limits & SADDLE_JOINT_BIT(0, SADDLE_ANKLE_PITCH)) != 0u);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 15.0, fabs((double)joints.rate_rad_s[0][SADDLE_ANKLE_PITCH]));
}

static void test_the_com_comes_where_it_should_be(void)
{
    for (int n = 0; n < MANY(2000); n++) {
        saddle_trunk_t trunk = some_trunk();
        const saddle_vec3_t near = {trunk.hips_m.x + between(-0.03f, 0.03f),
                                    trunk.hips_m.y + between(-0.03f, 0.03f),
                                    trunk.hips_m.z + between(-0.03f, 0.03f)};
        saddle_foot_t foot[2];
        saddle_joints_t joints;
        saddle_whole_body_t posture;
        some_feet(foot, SADDLE_SOLE_HEEL);
        saddle_inverse(&legs, &trunk, foot, &joints);
        saddle_forward(&legs, &trunk, &joints, &posture);
        const saddle_com_t com = posture.com;
        trunk.hips_m = near;
        const saddle_reach_t reach = saddle_inverse_of_com(&legs, &com, foot, &trunk, &joints);
        if (reach.angle_limits != 0u || reach.rate_limits != 0u) {
            continue;
        }
        saddle_forward(&legs, &trunk, &joints, &posture);
        assert_same_place(5e-4, com.position_m, posture.com.position_m); /* 5 cm x 0.2^3 */
    }
}

static void test_absurd_input_is_refused_and_gives_no_number(void)
{
    const float absurd[] = {NAN, INFINITY, -INFINITY, 1e30f};
    saddle_joints_t joints;
    for (size_t i = 0; i < COUNT_OF(absurd); i++) {
        for (size_t word = 0; word < sizeof(saddle_trunk_t) / sizeof(float); word++) {
            saddle_trunk_t trunk = some_trunk();
            saddle_foot_t foot[2];
            some_feet(foot, SADDLE_SOLE_MIDDLE);
            memcpy((char *)&trunk + word * sizeof(float), &absurd[i], sizeof(float));
            const saddle_reach_t reach = saddle_inverse(&legs, &trunk, foot, &joints);
            TEST_ASSERT_FALSE(reach.valid);
            for (int k = 0; k < 12; k++) {
                TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, (double)joints.angle_rad[k / 6][k % 6]);
                TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, (double)joints.rate_rad_s[k / 6][k % 6]);
            }
        }
        saddle_trunk_t trunk = some_trunk();
        const saddle_trunk_t before = trunk;
        saddle_foot_t foot[2];
        some_feet(foot, SADDLE_SOLE_MIDDLE);
        saddle_com_t com = {trunk.hips_m, trunk.velocity_m_s};
        com.velocity_m_s.y = absurd[i];
        TEST_ASSERT_FALSE(saddle_inverse_of_com(&legs, &com, foot, &trunk, &joints).valid);
        TEST_ASSERT_EQUAL_MEMORY(&before, &trunk, sizeof trunk);
        com = (saddle_com_t){{trunk.hips_m.x, absurd[i], trunk.hips_m.z}, trunk.velocity_m_s};
        TEST_ASSERT_FALSE(saddle_inverse_of_com(&legs, &com, foot, &trunk, &joints).valid);
        com.position_m = trunk.hips_m;
        const size_t first = offsetof(saddle_foot_t, position_m);
        for (size_t at = first; at < sizeof(saddle_foot_t); at += sizeof(float)) {
            some_feet(foot, SADDLE_SOLE_MIDDLE);
            memcpy((char *)&foot[1] + at, &absurd[i], sizeof(float));
            TEST_ASSERT_FALSE(saddle_inverse(&legs, &trunk, foot, &joints).valid);
            TEST_ASSERT_FALSE(saddle_inverse_of_com(&legs, &com, foot, &trunk, &joints).valid);
            TEST_ASSERT_EQUAL_MEMORY(&before, &trunk, sizeof trunk);
        }
    }
}

static void test_a_point_that_no_sole_has_is_refused(void)
{
    const saddle_trunk_t trunk = some_trunk();
    saddle_foot_t foot[2];
    saddle_joints_t joints;
    some_feet(foot, SADDLE_SOLE_TOE + 1);
    TEST_ASSERT_FALSE(saddle_inverse(&legs, &trunk, foot, &joints).valid);
}

/* Whatever the finite input, the answer is finite and within the joints' ranges. */
static void test_no_posture_escapes_the_ranges(void)
{
    for (int n = 0; n < MANY(20000); n++) {
        saddle_trunk_t trunk = some_trunk();
        saddle_foot_t foot[2];
        saddle_joints_t joints;
        some_feet(foot, (uint8_t)(n % 3));
        const float yaw = between(-3.0f, 3.0f);
        const float roll = between(-3.0f, 3.0f);
        trunk.axes = axes_of(yaw, roll, between(-3.0f, 3.0f));
        trunk.hips_m = vec3_in(2.0f);
        trunk.velocity_m_s = vec3_in(100.0f);
        foot[0].position_m = n % 5 == 0 ? trunk.hips_m : foot[0].position_m;
        foot[1].yaw_rad = between(-6.2f, 6.2f);
        foot[1].pitch_rad = between(-6.2f, 6.2f);
        TEST_ASSERT_TRUE(saddle_inverse(&legs, &trunk, foot, &joints).valid);
        for (int k = 0; k < 12; k++) {
            const saddle_joint_range_t range = legs.joint[k % 6];
            const bool mirrored =
                k >= 6 && (k % 6 < SADDLE_HIP_PITCH || k % 6 == SADDLE_ANKLE_ROLL);
            const float low = mirrored ? -range.max_rad : range.min_rad;
            const float high = mirrored ? -range.min_rad : range.max_rad;
            const float angle = joints.angle_rad[k / 6][k % 6];
            const float rate = joints.rate_rad_s[k / 6][k % 6];
            TEST_ASSERT_TRUE(angle >= low && angle <= high);
            TEST_ASSERT_TRUE(fabsf(rate) <= range.rate_max_rad_s);
        }
    }
}

static void test_the_default_body_has_its_height_s_and_mass_s_shares(void)
{
    TEST_ASSERT_NULL(saddle_legs_check(&legs));
    const double mass =
        (double)legs.trunk_kg + 2.0 * (double)(legs.thigh_kg + legs.shank_kg + legs.foot_kg);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 63.3, mass);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.530 * 1.79,
                              (double)(legs.thigh_m + legs.shank_m + legs.ankle_height_m));
}

static void test_each_field_out_of_its_range_is_named(void)
{
    const saddle_config_field_t *field;
    size_t count = 0;
    for (; (field = saddle_legs_field(count)) != NULL; count++) {
        const float bad[] = {field->min - 0.1f, field->max + 0.1f, NAN};
        for (size_t i = 0; i < COUNT_OF(bad); i++) {
            saddle_legs_t wrong = legs;
            memcpy((char *)&wrong + field->offset, &bad[i], sizeof(float));
            TEST_ASSERT_EQUAL_STRING(field->name, saddle_legs_check(&wrong));
        }
        TEST_ASSERT_EQUAL_size_t(count * sizeof(float), field->offset); /* none is left out */
    }
    TEST_ASSERT_EQUAL_size_t(sizeof legs, count * sizeof(float));
    legs.joint[SADDLE_ANKLE_PITCH].min_rad = 2.0f;
    TEST_ASSERT_EQUAL_STRING("ankle_pitch_min_rad", saddle_legs_check(&legs));
    legs = saddle_legs_default(1.79f, 63.3f);
    legs.joint[SADDLE_KNEE].min_rad = 0.0f;
    TEST_ASSERT_EQUAL_STRING("knee_min_rad", saddle_legs_check(&legs));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_forward_is_the_chain_of_rotations);
    RUN_TEST(test_velocities_are_the_change_of_positions);
    RUN_TEST(test_inverse_puts_the_feet_where_they_should_be_and_moves_them_so);
    RUN_TEST(test_rates_are_the_change_of_angles);
    RUN_TEST(test_a_foot_beyond_reach_is_approached_and_said);
    RUN_TEST(test_a_straight_knee_is_never_singular);
    RUN_TEST(test_limits_hold_and_are_said_joint_by_joint);
    RUN_TEST(test_the_com_comes_where_it_should_be);
    RUN_TEST(test_absurd_input_is_refused_and_gives_no_number);
    RUN_TEST(test_a_point_that_no_sole_has_is_refused);
    RUN_TEST(test_no_posture_escapes_the_ranges);
    RUN_TEST(test_the_default_body_has_its_height_s_and_mass_s_shares);
    RUN_TEST(test_each_field_out_of_its_range_is_named);
    return UNITY_END();
}
