/** The gait cycle by itself: where it begins, its via points, half swings, landings refused. */
#include "core_test.h"

#include "math/fixed.h"
#include "model/gait_model.h"
#include "motion/gait_cycle.h"
#include "motion/speed_profile.h"

static saddle_config_t config;
static saddle_body_t body;
static saddle_cycle_t cycle;

void setUp(void)
{
    config = paper_config();
    body = model_of(&config)->body;
    memset(&cycle, 0, sizeof cycle);
}

void tearDown(void) {}

static void begin(uint8_t phase, float speed, bool under_way)
{
    const bool left = phase == 0u || phase == 3u;
    const float half = 0.5f * saddle_step_width_m(model_of(&config), speed);
    const saddle_cycle_start_t start = {
        .phase = phase,
        .stance_y_m = left ? half : -half,
        .other_m = {phase % 2u == 0u ? 0.0f : -0.5f, left ? -2.0f * half : 2.0f * half},
        .com_y_m = left ? -half : half,
        .com_z_m = 1.0f,
        .speed = saddle_speed_from_m_s(speed),
        .under_way = under_way,
    };
    saddle_cycle_begin(&cycle, model_of(&config), &start);
    saddle_cycle_set_pace(&cycle, speed, 0.5f);
}

static uint32_t advance(uint32_t dt_us, bool *arrived)
{
    return saddle_cycle_advance(&cycle, model_of(&config), 0.1f, dt_us, arrived);
}

static void put_at(saddle_fixed_t position)
{
    bool arrived;
    cycle.position = position;
    advance(0, &arrived);
}

static saddle_pose_t pose(void)
{
    saddle_pose_t pose;
    saddle_cycle_pose(&cycle, model_of(&config), &pose);
    return pose;
}

static void test_walk_begins_beside_or_midway_with_both_feet_on_the_ground(void)
{
    for (uint8_t phase = 0; phase < 4u; phase++) {
        begin(phase, 0.0f, false);
        const saddle_pose_t at = pose();
        const bool midway = phase % 2u == 1u;
        TEST_ASSERT_EQUAL_INT(phase == 0u || phase == 3u ? SADDLE_LEFT : SADDLE_RIGHT,
                              cycle.quarter.stance);
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, midway ? -0.25 : 0.0, at.com_m.x);
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, midway ? -0.5 : 0.0, at.swing.position_m.x);
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, phase == 0u || phase == 3u ? -0.22 : 0.22,
                                  at.swing.position_m.y);
        TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, at.swing.position_m.z);
        TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, at.progress);
        ASSERT_SAME_FLOAT(midway ? 0.0f : 0.5f, cycle.swing.lift_progress);
        TEST_ASSERT_DOUBLE_WITHIN(0.0, midway ? 0.5 : 0.0, cycle.last_step_m.x);
    }
}

static void test_joined_walk_is_in_mid_swing(void)
{
    begin(0, 1.2f, true);
    const saddle_pose_t at = pose();
    ASSERT_SAME_FLOAT(0.05f, at.swing.position_m.z);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, at.swing.position_m.x);
    ASSERT_SAME_FLOAT(cycle.quarter.amplitude_m - 0.5f * cycle.quarter.width_m, at.com_m.y);
}

static void test_via_points_are_passed_in_order_and_to_the_nanometre(void)
{
    bool arrived;
    begin(0, 1.2f, true);
    const int64_t half_nm = saddle_position_to_nm(cycle.quarter_length);
    for (uint32_t quarter = 1; quarter <= 40u; quarter++) {
        const uint8_t phase = cycle.phase;
        const float way = saddle_cycle_distance_to_via_point_m(&cycle);
        TEST_ASSERT_TRUE(way > 0.0f && way <= cycle.quarter.length_m);
        while (cycle.phase == phase) {
            TEST_ASSERT_EQUAL_UINT32(0, advance(1000, &arrived));
            TEST_ASSERT_FALSE(arrived);
        }
        TEST_ASSERT_EQUAL_UINT8((phase + 1u) % 4u, cycle.phase);
        TEST_ASSERT_EQUAL_UINT32((quarter + 1u) / 2u, cycle.step_count);
        TEST_ASSERT_EQUAL_UINT32(quarter / 4u, cycle.stride_count);
        TEST_ASSERT_TRUE(cycle.way.origin_x_nm == 2 * half_nm * (int64_t)cycle.step_count);
    }
}

static void test_long_tick_passes_every_via_point(void)
{
    bool arrived;
    saddle_cycle_t fine;
    config.half_step_slope_s = 0.05f;
    config.half_step_intercept_m = 0.02f; /* quarters of 25 mm */
    begin(0, 0.1f, true);
    saddle_cycle_t start = cycle;
    for (int i = 0; i < 1600; i++) {
        advance(1000, &arrived);
    }
    fine = cycle;
    cycle = start;
    advance(1600000, &arrived); /* 6 of them at once */
    TEST_ASSERT_EQUAL_UINT32(fine.step_count, cycle.step_count);
    TEST_ASSERT_EQUAL_UINT8(fine.phase, cycle.phase);
    TEST_ASSERT_TRUE(fine.way.origin_x_nm == cycle.way.origin_x_nm);
    TEST_ASSERT_TRUE(fine.position == cycle.position);
}

static void test_last_swing_comes_to_rest_beside_the_stance_foot(void)
{
    bool arrived = false;
    begin(0, 0.3f, false);
    cycle.last_swing = true;
    while (cycle.phase == 0u) {
        advance(1000, &arrived);
    }
    ASSERT_SAME_FLOAT(0.5f, cycle.swing.land_progress);
    const float speed = cycle.profile.speed_m_s;
    const float way = saddle_cycle_distance_to_via_point_m(&cycle);
    saddle_cycle_set_pace(&cycle, 0.0f, speed * speed / (2.0f * way));
    const double expected_us = 2e6 * (double)way / (double)speed;
    double walked_us = 0.0;
    saddle_pose_t last = pose();
    while (!arrived) {
        last = pose();
        walked_us += 7000.0 - (double)advance(7000, &arrived);
        TEST_ASSERT_TRUE(walked_us < 1e7);
    }
    /* The rate is rounded: 0.1 um of the way, and at 0.24 m/s^2 the last of it takes a millisecond. */
    TEST_ASSERT_DOUBLE_WITHIN(1000.0, expected_us, walked_us);
    TEST_ASSERT_TRUE(cycle.profile.speed == 0 && cycle.position == 0);
    const saddle_pose_t end = pose();
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.0, (double)last.com_m.x); /* 7 ms before it stood */
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, end.com_m.x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, 0.0, end.swing.position_m.x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, end.swing.position_m.z);
    ASSERT_SAME_FLOAT(cycle.swing.line_y_m, end.swing.position_m.y);
}

/* Roundings may end the speed a nanometre early. */
static void test_last_swing_without_speed_is_complete(void)
{
    bool arrived = false;
    begin(1, 0.3f, false);
    cycle.last_swing = true;
    put_at(-1000 * (saddle_fixed_t)4398046511); /* 1 um before */
    saddle_profile_set_speed(&cycle.profile, 0);
    saddle_cycle_set_pace(&cycle, 0.0f, 0.5f);
    TEST_ASSERT_EQUAL_UINT32(80000, advance(80000, &arrived));
    TEST_ASSERT_TRUE(arrived);
}

static bool land_at(float dx, float dy)
{
    const saddle_vec2_t step = {cycle.last_step_m.x + dx, cycle.last_step_m.y + dy};
    return saddle_cycle_land(&cycle, model_of(&config), step);
}

static void walk_to_landing(bool last_swing, uint32_t further_us)
{
    bool arrived;
    begin(0, 1.0f, true);
    cycle.last_swing = last_swing;
    while (cycle.phase == 0u) {
        advance(1000, &arrived);
    }
    advance(further_us, &arrived);
}

static void test_rejected_landings_change_nothing(void)
{
    static const struct {
        bool last_swing;
        uint32_t further_us;
        float dx, dy;
        bool taken;
    } table[] = {
        {false, 0, 0.05f, 0.0f, true},
        {false, 150000, 0.05f, 0.0f, true}, /* half of the quarter takes 158 ms */
        {false, 160000, 0.05f, 0.0f, false},
        {true, 70000, 0.05f, 0.0f, true}, /* a last swing is in the air for half as long */
        {true, 85000, 0.05f, 0.0f, false},
        {false, 0, -0.29f, 0.0f, true},
        {false, 0, -0.30f, 0.0f, false}, /* CoM within 2 cm of the foot */
        {false, 0, 0.16f, 0.0f, true},
        {false, 0, 0.18f, 0.0f, false}, /* beyond reach */
        {false, 0, 0.0f, 0.11f, true},  /* a right foot: feet 2.3 cm apart */
        {false, 0, 0.0f, 0.12f, false},
        {false, 0, 0.0f, -0.30f, true}, /* 0.433 of 0.44 m apart */
        {false, 0, 0.0f, -0.31f, false},
    };
    for (size_t i = 0; i < COUNT_OF(table); i++) {
        walk_to_landing(table[i].last_swing, table[i].further_us);
        const saddle_cycle_t before = cycle;
        TEST_ASSERT_EQUAL_MESSAGE(table[i].taken, land_at(table[i].dx, table[i].dy), "taken");
        TEST_ASSERT_EQUAL(!table[i].taken, memcmp(&before, &cycle, sizeof cycle) == 0);
    }
    begin(0, 1.0f, true);
    TEST_ASSERT_FALSE(land_at(0.0f, 0.0f)); /* no landing yet */
}

/* A last swing that stands beside its foot has no quarter left to stretch. Whether something is divided
 * by it all the same only the sanitizer sees. */
static void test_landing_beside_the_stance_foot_does_not_divide_by_zero(void)
{
    walk_to_landing(true, 0);
    put_at(0);
    TEST_ASSERT_FALSE(land_at(0.05f, 0.0f));
}

static void test_landing_far_beyond_a_short_step_or_the_leg_is_rejected(void)
{
    bool arrived;
    begin(0, 0.1f, true); /* quarters of 0.153 m */
    while (cycle.phase == 0u) {
        advance(1000, &arrived);
    }
    TEST_ASSERT_FALSE(land_at(0.16f, 0.0f));
    TEST_ASSERT_TRUE(land_at(0.14f, 0.0f));

    config.body_height_m = 1.2f; /* 0.8 l_p^2 = 0.374 m^2 */
    config.peak_speed_m_s = 3.9f;
    body = model_of(&config)->body;
    walk_to_landing(false, 0);
    TEST_ASSERT_FALSE(land_at(0.19f, -0.30f)); /* CoM 0.50 m behind, 0.37 m beside */
    TEST_ASSERT_TRUE(land_at(0.14f, -0.30f));
}

static void test_swing_goes_on_from_where_it_is_when_a_late_landing_is_taken_over(void)
{
    walk_to_landing(false, 120000);
    const saddle_pose_t before = pose();
    TEST_ASSERT_TRUE(land_at(0.05f, -0.03f));
    const saddle_pose_t after = pose();
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, (double)before.swing.position_m.x - 0.05,
                              after.swing.position_m.x);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, (double)before.swing.position_m.y + 0.03,
                              after.swing.position_m.y);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, (double)before.com_m.x - 0.05, after.com_m.x);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, (double)before.com_m.y + 0.03, after.com_m.y);
}

static double next_line_after(float dy)
{
    bool arrived;
    walk_to_landing(false, 0);
    TEST_ASSERT_TRUE(land_at(0.0f, dy));
    const uint32_t steps = cycle.step_count;
    const float stance_y = cycle.stance_y_m;
    while (cycle.step_count == steps) {
        advance(1000, &arrived);
    }
    return (double)cycle.stance_y_m - (double)stance_y;
}

static void test_next_line_is_between_half_and_twice_a_step_width(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 2.0 * 0.1328, next_line_after(-0.30f));
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.5 * 0.1328, next_line_after(0.11f));
}

static void test_heel_strike_angle_waits_for_the_heel_strike_after_the_next(void)
{
    bool arrived;
    begin(0, 1.0f, true);
    cycle.next_strike = saddle_heel_strike(model_of(&config), 0.2f);
    cycle.transition.strike = cycle.next_strike;
    while (cycle.phase == 0u) {
        advance(1000, &arrived);
    }
    ASSERT_SAME_FLOAT(0.2f, cycle.transition.strike.angle_rad);
    ASSERT_SAME_FLOAT(0.1f, cycle.next_strike.angle_rad);
}

/* The new stance foot keeps its misplaced line; the next one is back beside the walking line. */
static void test_next_step_starts_from_the_foot_that_is_there(void)
{
    bool arrived;
    walk_to_landing(false, 0);
    const int64_t origin = cycle.way.origin_x_nm;
    TEST_ASSERT_TRUE(land_at(0.05f, -0.04f));
    TEST_ASSERT_DOUBLE_WITHIN(60.0, 5e7, (double)(cycle.way.origin_x_nm - origin));
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, -0.0664 - 0.04, cycle.stance_y_m);
    const uint32_t steps = cycle.step_count;
    const int64_t from = cycle.way.origin_x_nm;
    while (cycle.step_count == steps) {
        advance(1000, &arrived);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, 0.6306, (double)(cycle.way.origin_x_nm - from) * 1e-9);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.0664, cycle.stance_y_m);
}

/* ---- [E45] a moved landing ---- */

/* Ahead of the foot via point by a share of the quarter. */
static void walk_before_landing(float speed, double share)
{
    bool arrived;
    begin(0, speed, true);
    while (cycle.x_m < (float)share * cycle.quarter.length_m) {
        advance(1000, &arrived);
    }
}

static saddle_vec2_t planned_step(void)
{
    return (saddle_vec2_t){2.0f * cycle.quarter.length_m, cycle.swing.line_y_m};
}

static void place(float dx, float dy)
{
    const saddle_vec2_t step = planned_step();
    saddle_cycle_place(&cycle, model_of(&config), (saddle_vec2_t){step.x + dx, step.y + dy});
}

static void test_moved_landing_neither_moves_the_foot_at_once_nor_its_velocity(void)
{
    walk_before_landing(1.2f, 0.2);
    for (int k = 0; k < 2; k++) { /* the second while the foot is on its way to the first */
        const saddle_pose_t before = pose();
        place(k == 0 ? 0.1f : -0.05f, k == 0 ? -0.06f : 0.02f);
        const saddle_pose_t after = pose();
        /* Rounded where the way is added: 2^-24 of a metre, of metres per second. */
        TEST_ASSERT_DOUBLE_WITHIN(2e-7, before.swing.position_m.x, after.swing.position_m.x);
        TEST_ASSERT_DOUBLE_WITHIN(2e-7, before.swing.position_m.y, after.swing.position_m.y);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, before.swing.velocity_m_s.x, after.swing.velocity_m_s.x);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, before.swing.velocity_m_s.y, after.swing.velocity_m_s.y);
        bool arrived;
        advance(40000, &arrived);
    }
}

static void test_moved_landing_becomes_the_stance_foot_where_it_is(void)
{
    bool arrived;
    walk_before_landing(1.2f, 0.2);
    const saddle_vec2_t step = planned_step();
    const int64_t origin_nm = cycle.way.origin_x_nm;
    const float stance_y = cycle.stance_y_m;
    place(0.1f, -0.06f);
    saddle_pose_t last = pose();
    while (cycle.phase == 0u) {
        last = pose();
        advance(100, &arrived);
    }
    const saddle_pose_t landed = pose();
    TEST_ASSERT_DOUBLE_WITHIN(2e-7, (double)step.x + 0.1, cycle.last_step_m.x);
    TEST_ASSERT_DOUBLE_WITHIN(2e-7, (double)step.y - 0.06, cycle.last_step_m.y);
    TEST_ASSERT_DOUBLE_WITHIN(2e-7, cycle.last_step_m.x,
                              1e-9 * (double)(cycle.way.origin_x_nm - origin_nm));
    TEST_ASSERT_DOUBLE_WITHIN(2e-7, cycle.last_step_m.y, cycle.stance_y_m - stance_y);
    /* In 0.1 ms no more than at 2 m/s along x, by E9's line, and at 0.2 m/s across. */
    TEST_ASSERT_DOUBLE_WITHIN(2e-4, cycle.last_step_m.x, last.swing.position_m.x);
    TEST_ASSERT_DOUBLE_WITHIN(2e-5, cycle.last_step_m.y, last.swing.position_m.y);
    TEST_ASSERT_DOUBLE_WITHIN(2e-4, last.com_m.x, landed.com_m.x + cycle.last_step_m.x);
    TEST_ASSERT_DOUBLE_WITHIN(2e-5, last.com_m.y, landed.com_m.y + cycle.last_step_m.y);
    ASSERT_SAME_FLOAT(0.0f, cycle.swing.moved_m.x); /* the next swing lands as planned */
}

static void test_landing_is_frozen_before_the_foot_via_point_and_for_the_last_60_ms(void)
{
    bool arrived;
    walk_before_landing(1.2f, 0.2);
    while (saddle_cycle_distance_to_via_point_m(&cycle) > 0.0599f * 1.2f) {
        advance(1000, &arrived);
    }
    saddle_cycle_t before = cycle;
    place(0.02f, 0.0f);
    TEST_ASSERT_EQUAL_MEMORY(&before, &cycle, sizeof before);
    while (cycle.phase == 0u) {
        advance(1000, &arrived);
    }
    before = cycle;
    place(0.02f, 0.0f);
    TEST_ASSERT_EQUAL_MEMORY(&before, &cycle, sizeof before);
}

static void test_landing_moves_no_further_than_the_foot_comes_and_the_leg_reaches(void)
{
    const double frozen_s = 0.06, foot_m_s = 1.6;
    bool arrived;
    walk_before_landing(1.2f, 0.2);
    place(2.0f, 2.0f); /* the left leg stands: to the left is inward */
    const double half = (double)cycle.quarter.length_m, width = -(double)cycle.swing.line_y_m;
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, (double)body.half_step_max_m - half, cycle.swing.moved_m.x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, width - 0.02, cycle.swing.moved_m.y);
    walk_before_landing(1.2f, 0.2);
    while (saddle_cycle_distance_to_via_point_m(&cycle) > 0.07f * 1.2f) {
        advance(1000, &arrived);
    }
    place(-2.0f, 0.0f);
    TEST_ASSERT_TRUE(cycle.swing.moved_m.x < (float)(-frozen_s * foot_m_s) &&
                     cycle.swing.moved_m.x > (float)(-0.071 * foot_m_s));
    walk_before_landing(0.4f, 0.2);
    cycle.last_swing = true; /* the next one: it needs the way to brake */
    place(-0.1f, 0.0f);
    ASSERT_SAME_FLOAT(0.0f, cycle.swing.moved_m.x);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_walk_begins_beside_or_midway_with_both_feet_on_the_ground);
    RUN_TEST(test_joined_walk_is_in_mid_swing);
    RUN_TEST(test_via_points_are_passed_in_order_and_to_the_nanometre);
    RUN_TEST(test_long_tick_passes_every_via_point);
    RUN_TEST(test_last_swing_comes_to_rest_beside_the_stance_foot);
    RUN_TEST(test_last_swing_without_speed_is_complete);
    RUN_TEST(test_rejected_landings_change_nothing);
    RUN_TEST(test_landing_beside_the_stance_foot_does_not_divide_by_zero);
    RUN_TEST(test_landing_far_beyond_a_short_step_or_the_leg_is_rejected);
    RUN_TEST(test_swing_goes_on_from_where_it_is_when_a_late_landing_is_taken_over);
    RUN_TEST(test_next_line_is_between_half_and_twice_a_step_width);
    RUN_TEST(test_heel_strike_angle_waits_for_the_heel_strike_after_the_next);
    RUN_TEST(test_next_step_starts_from_the_foot_that_is_there);
    RUN_TEST(test_moved_landing_neither_moves_the_foot_at_once_nor_its_velocity);
    RUN_TEST(test_moved_landing_becomes_the_stance_foot_where_it_is);
    RUN_TEST(test_landing_is_frozen_before_the_foot_via_point_and_for_the_last_60_ms);
    RUN_TEST(test_landing_moves_no_further_than_the_foot_comes_and_the_leg_reaches);
    return UNITY_END();
}
