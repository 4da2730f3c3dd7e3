/** The way that is walked against arcs in double: its geometry, where its arcs meet, its heading. */
#include "core_test.h"

#include "math/fixed.h"
#include "model/gait_model.h"
#include "motion/way.h"

/* Lengths below 2 m through a dozen operations. */
#define PLACE_M 1e-6

#define ANGLE_UNITS 4398046511104.0 /* 2^42 */

typedef struct {
    double x, y;
} point_t;

static saddle_config_t config;
static saddle_way_t way;

void setUp(void)
{
    config = paper_config();
    memset(&way, 0, sizeof way);
    saddle_way_begin(&way);
}

void tearDown(void) {}

static double heading(void)
{
    return (double)way.heading / ANGLE_UNITS;
}

static void land(double step_m, float speed_m_s, float wanted_rad_s)
{
    way.wanted_rad_s = wanted_rad_s;
    saddle_way_land(&way, model_of(&config), speed_m_s, llround(1e9 * step_m));
}

static saddle_on_ground_t on_ground(double along, double across, double vx, double vy)
{
    const saddle_course_t course = {{(float)along, (float)across}, {(float)vx, (float)vy}};
    return saddle_way_to_ground(way.arcs, &course);
}

/* From where the way began. */
static point_t placed(double along, double across)
{
    const saddle_vec2_t at = on_ground(along, across, 0.0, 0.0).position_m;
    const double psi = heading();
    return (point_t){
        1e-9 * (double)way.origin_x_nm + (double)at.x * cos(psi) - (double)at.y * sin(psi),
        1e-9 * (double)way.origin_y_nm + (double)at.x * sin(psi) + (double)at.y * cos(psi)};
}

static void assert_same_place(double tolerance, point_t expected, point_t actual)
{
    TEST_ASSERT_DOUBLE_WITHIN(tolerance, expected.x, actual.x);
    TEST_ASSERT_DOUBLE_WITHIN(tolerance, expected.y, actual.y);
}

static void test_straight_way_keeps_every_bit(void)
{
    for (int i = 1; i <= 5; i++) {
        land(0.698612345, 1.2f, 0.0f);
        TEST_ASSERT_FALSE(way.bent);
        TEST_ASSERT_TRUE(way.origin_x_nm == i * (int64_t)698612345);
        TEST_ASSERT_TRUE(way.origin_y_nm == 0 && way.heading == 0);
        const saddle_on_ground_t ground = on_ground(0.3, -0.05, 1.2, 0.2);
        ASSERT_SAME_FLOAT(0.3f, ground.position_m.x);
        ASSERT_SAME_FLOAT(-0.05f, ground.position_m.y);
        ASSERT_SAME_FLOAT(1.2f, ground.velocity_m_s.x);
        ASSERT_SAME_FLOAT(0.2f, ground.velocity_m_s.y);
    }
}

/* About a centre 1 / curvature to the left. */
static void test_steady_turn_is_a_circle(void)
{
    static const float rates[] = {0.3f, -0.3f, 0.01f, -0.8f};
    for (size_t i = 0; i < COUNT_OF(rates); i++) {
        way.wanted_rad_s = rates[i];
        saddle_way_join(&way, 0.6f);
        const double radius = 0.6 / (double)rates[i];
        for (double along = -0.6; along < 0.7; along += 0.1) {
            for (double across = -0.2; across < 0.3; across += 0.1) {
                const double psi = along / radius;
                const saddle_on_ground_t ground = on_ground(along, across, 0.6, 0.1);
                TEST_ASSERT_DOUBLE_WITHIN(PLACE_M, (radius - across) * sin(psi),
                                          ground.position_m.x);
                TEST_ASSERT_DOUBLE_WITHIN(PLACE_M, radius - (radius - across) * cos(psi),
                                          ground.position_m.y);
                TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, psi, ground.yaw_rad);
                const double forward = 0.6 * (1.0 - across / radius);
                TEST_ASSERT_DOUBLE_WITHIN(PLACE_M, forward * cos(psi) - 0.1 * sin(psi),
                                          ground.velocity_m_s.x);
                TEST_ASSERT_DOUBLE_WITHIN(PLACE_M, forward * sin(psi) + 0.1 * cos(psi),
                                          ground.velocity_m_s.y);
                const saddle_vec2_t back = saddle_way_from_ground(way.arcs, ground.position_m);
                if (fabs(along) > 0.05) { /* beside the foot a point may be seen on the other arc */
                    TEST_ASSERT_DOUBLE_WITHIN(PLACE_M, along, back.x);
                    TEST_ASSERT_DOUBLE_WITHIN(PLACE_M, across, back.y);
                }
            }
        }
    }
}

/* Beside a foot where the turning rate changes by what a step may change it. */
static void test_neither_place_nor_velocity_jumps_where_arcs_meet(void)
{
    land(0.5, 0.8f, 0.4f);
    land(0.5, 0.8f, -0.4f);
    TEST_ASSERT_TRUE(way.arcs[1].before_1_m > 0.15f);
    for (double across = -0.15; across < 0.2; across += 0.1) {
        const saddle_on_ground_t before = on_ground(-1e-7, across, 3.0, 0.1);
        const saddle_on_ground_t after = on_ground(1e-7, across, 3.0, 0.1);
        TEST_ASSERT_DOUBLE_WITHIN(PLACE_M, before.position_m.x, after.position_m.x);
        TEST_ASSERT_DOUBLE_WITHIN(PLACE_M, before.position_m.y, after.position_m.y);
        TEST_ASSERT_DOUBLE_WITHIN(PLACE_M, before.velocity_m_s.x, after.velocity_m_s.x);
        TEST_ASSERT_DOUBLE_WITHIN(PLACE_M, before.velocity_m_s.y, after.velocity_m_s.y);
        TEST_ASSERT_DOUBLE_WITHIN(PLACE_M, before.yaw_rad, after.yaw_rad);
    }
}

/* Over 2 mm a central difference is exact to the change of curvature: 1e-6; a place is rounded to 6e-8. */
static void test_velocity_is_the_derivative_of_the_place(void)
{
    land(0.5, 0.8f, 0.4f);
    land(0.5, 0.8f, -0.4f);
    for (double along = -0.45; along < 0.5; along += 0.0301) {
        const saddle_vec2_t ahead = on_ground(along + 1e-3, 0.1 + 2e-4, 0.0, 0.0).position_m;
        const saddle_vec2_t behind = on_ground(along - 1e-3, 0.1 - 2e-4, 0.0, 0.0).position_m;
        const saddle_vec2_t rate = on_ground(along, 0.1, 1.0, 0.2).velocity_m_s;
        TEST_ASSERT_DOUBLE_WITHIN(2e-4, ((double)ahead.x - (double)behind.x) / 2e-3, rate.x);
        TEST_ASSERT_DOUBLE_WITHIN(2e-4, ((double)ahead.y - (double)behind.y) / 2e-3, rate.y);
    }
}

/* The ground under both feet, and what lies on the way between them. */
static void test_landing_moves_nothing_that_is_on_the_ground(void)
{
    uint32_t random = 7;
    for (int i = 0; i < 200; i++) {
        const double step = (double)random_in(&random, 0.3f, 0.8f);
        const point_t stance = placed(0.0, 0.1);
        const point_t com = placed(0.5 * step, 0.02);
        const point_t foot = placed(step, -0.1);
        land(step, 0.9f, random_in(&random, -0.6f, 0.6f));
        assert_same_place(PLACE_M, stance, placed(-step, 0.1));
        assert_same_place(PLACE_M, com, placed(-0.5 * step, 0.02));
        assert_same_place(PLACE_M, foot, placed(0.0, -0.1));
    }
    TEST_ASSERT_TRUE(fabs(heading()) <= PI);
}

/* As far as the foot was seen to be from where it was to land. */
static void test_shifted_landing_leaves_the_way_behind_it(void)
{
    static const float shifts[] = {0.08f, -0.05f};
    land(0.5, 0.8f, 0.4f);
    land(0.5, 0.8f, 0.4f);
    for (size_t i = 0; i < COUNT_OF(shifts); i++) {
        const point_t com = placed(-0.25, 0.03);
        const point_t trailing = placed(-0.5, -0.1);
        const double turned = heading() + (double)way.arcs[0].curvature_1_m * (double)shifts[i];
        saddle_way_shift(&way, shifts[i]);
        assert_same_place(PLACE_M, com, placed(-0.25 - (double)shifts[i], 0.03));
        assert_same_place(PLACE_M, trailing, placed(-0.5 - (double)shifts[i], -0.1));
        TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, turned, heading());
        saddle_way_shift(&way, -shifts[i]);
    }
}

/* [E48] A step's way is rounded to 2^-32 m: 1e-10 rad of a turn here, 2.3e-5 in 31 hours. */
static void test_heading_does_not_drift(void)
{
    const double step = 0.486420000;
    const double rate = (double)0.3f / (double)0.6f;
    way.wanted_rad_s = 0.3f;
    saddle_way_join(&way, 0.6f);
    for (int i = 1; i <= 200000; i++) {
        land(step, 0.6f, 0.3f);
        TEST_ASSERT_TRUE(fabs(heading()) <= PI + 1e-12);
    }
    TEST_ASSERT_DOUBLE_WITHIN(2.4e-5, remainder(200000.0 * rate * step, 2.0 * PI), heading());
}

/* [E48] By turn_acceleration_rad_s2 times the time of a step, and straight again likewise. */
static void test_turning_rate_changes_within_its_acceleration(void)
{
    config.turn_acceleration_rad_s2 = 0.5f;
    const double change = 0.5 * 0.5 / 0.8;
    land(0.5, 0.8f, 0.5f);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, change / 0.8, way.arcs[1].curvature_1_m);
    land(0.5, 0.8f, 0.5f);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.5 / 0.8, way.arcs[1].curvature_1_m);
    land(0.5, 0.8f, 0.0f);
    land(0.5, 0.8f, 0.0f);
    ASSERT_SAME_FLOAT(0.0f, way.arcs[1].curvature_1_m);
    TEST_ASSERT_TRUE(way.bent);
    land(0.5, 0.8f, 0.0f);
    TEST_ASSERT_TRUE(way.bent); /* the last change fades */
    land(0.5, 0.8f, 0.0f);
    TEST_ASSERT_FALSE(way.bent);
    const int64_t y_nm = way.origin_y_nm;
    land(0.5, 0.8f, 0.0f);
    TEST_ASSERT_DOUBLE_WITHIN(PLACE_M, 0.5 * sin(heading()),
                              1e-9 * (double)(way.origin_y_nm - y_nm));
}

/* At the speed that the CoM has on the arc; at rest nothing turns. */
static void test_turning_rate_is_limited_at_the_speed_of_the_arc(void)
{
    config.turn_acceleration_rad_s2 = 10.0f;
    land(0.7, 1.2f, 5.0f);
    const float most_rad_s = saddle_turn_max_rad_s(model_of(&config), 1.2f);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, (double)most_rad_s / 1.2, way.arcs[1].curvature_1_m);
    land(0.7, 0.0f, 5.0f);
    ASSERT_SAME_FLOAT(0.0f, way.arcs[1].curvature_1_m);
}

/* The inverse of a posture as a pelvis sees it that faces along the way. */
static void test_measured_feet_are_along_the_way(void)
{
    static const double places[] = {-0.3, -0.1, 0.05, 0.2};
    const double feet[2][2] = {{-0.35, 0.1}, {0.0, -0.1}};
    way.wanted_rad_s = 0.35f;
    saddle_way_join(&way, 0.9f);
    for (size_t i = 0; i < COUNT_OF(places); i++) {
        const saddle_vec2_t com_m = {(float)places[i], 0.03f};
        const saddle_on_ground_t com = on_ground(places[i], 0.03, 0.9, 0.05);
        const double c = cos((double)com.yaw_rad), s = sin((double)com.yaw_rad);
        saddle_measurement_t measured = saddle_no_measurement();
        const double vx = (double)com.velocity_m_s.x, vy = (double)com.velocity_m_s.y;
        measured.com.velocity_m_s =
            (saddle_vec2_t){(float)(vx * c + vy * s), (float)(vy * c - vx * s)};
        for (int side = 0; side < 2; side++) {
            const saddle_vec2_t at = on_ground(feet[side][0], feet[side][1], 0.0, 0.0).position_m;
            const double x = (double)at.x - (double)com.position_m.x;
            const double y = (double)at.y - (double)com.position_m.y;
            measured.foot[side].cop_m =
                (saddle_vec2_t){(float)(x * c + y * s), (float)(y * c - x * s)};
        }
        saddle_way_measured(way.arcs, com_m, &measured);
        TEST_ASSERT_DOUBLE_WITHIN(2e-6, 0.9, measured.com.velocity_m_s.x);
        TEST_ASSERT_DOUBLE_WITHIN(2e-6, 0.05, measured.com.velocity_m_s.y);
        for (int side = 0; side < 2; side++) {
            TEST_ASSERT_DOUBLE_WITHIN(2e-6, feet[side][0] - places[i], measured.foot[side].cop_m.x);
            TEST_ASSERT_DOUBLE_WITHIN(2e-6, feet[side][1] - 0.03, measured.foot[side].cop_m.y);
        }
    }
}

/* [E49] What the centripetal acceleration needs of a pendulum. */
static void test_lean_carries_the_turn(void)
{
    const double w2 = GRAVITY / (0.57 * 1.79);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.5 * 0.6 * 0.6 / w2,
                              saddle_lean_m(model_of(&config), 0.5f, 0.6f));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_straight_way_keeps_every_bit);
    RUN_TEST(test_steady_turn_is_a_circle);
    RUN_TEST(test_neither_place_nor_velocity_jumps_where_arcs_meet);
    RUN_TEST(test_velocity_is_the_derivative_of_the_place);
    RUN_TEST(test_landing_moves_nothing_that_is_on_the_ground);
    RUN_TEST(test_shifted_landing_leaves_the_way_behind_it);
    RUN_TEST(test_heading_does_not_drift);
    RUN_TEST(test_turning_rate_changes_within_its_acceleration);
    RUN_TEST(test_turning_rate_is_limited_at_the_speed_of_the_arc);
    RUN_TEST(test_measured_feet_are_along_the_way);
    RUN_TEST(test_lean_carries_the_turn);
    return UNITY_END();
}
