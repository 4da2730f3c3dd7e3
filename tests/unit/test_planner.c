/** The plan against eq:01 to eq:08 as functions of time, in double; landings, limits, a day's walk. */
#include "core_test.h"

#include <saddlewalk/planner.h>

/* Metres, rad, m/s: floats of order 1 in a chain of ten operations; the phase runs within 1e-7 of
 * its rate, for strides of seconds. */
static const double TOLERANCE = 5e-6;

static const float SPEEDS[] = {0.05f, 0.2f, 0.45f, 0.7f, 1.0f, 1.2f, 1.6f, 1.9f};

static saddle_config_t config;
static saddle_body_t body;
static saddle_planner_t planner;
static saddle_plan_t plan;
static saddle_command_t command;

static void restart(float speed_m_s)
{
    memset(&planner, 0, sizeof planner);
    command = (saddle_command_t){SADDLE_COMMAND_WALK, speed_m_s, 0.17453293f};
}

void setUp(void)
{
    config = paper_config();
    body = saddle_body(&config);
    restart(1.2f);
}

void tearDown(void) {}

static uint32_t tick(float dt_s)
{
    return saddle_planner_update(&planner, &config, &body, &command, dt_s, &plan);
}

/* A steady walk in double: t from the first left foot via point. */
typedef struct {
    double speed, step, width, amplitude, step_time, toe_off, lead_s;
} walk_t;

static walk_t walk_at(double speed)
{
    const double pendulum = 0.57 * 1.79;
    walk_t walk = {.speed = speed, .step = 2.0 * (0.1802 * speed + 0.1351)};
    walk.width = speed < 0.6 ? 0.22 : speed > 1.1 ? 0.10 : 0.3456 - 0.2128 * speed;
    walk.amplitude = walk.width / (2.0 * PI * fmax(speed, 0.5));
    walk.step_time = walk.step / speed;
    const double lead_m = 0.1 * (1.0 - cos(0.17453293));
    const double x = 0.5 * walk.step - lead_m;
    const double y = walk.amplitude * cos(PI * x / walk.step) - 0.5 * walk.width;
    const double height = pendulum - (0.02656 * speed + 0.002575);
    walk.toe_off = 2.0 * asin((sqrt(height * height + x * x + y * y) - pendulum) / 0.2);
    walk.lead_s = lead_m / speed;
    return walk;
}

/* What the plan should be at t, x from the stance foot. */
typedef struct {
    int steps;
    double com[3], vy, swing_x, swing_z, leg, toe_off, heel_strike, to_saddle;
} expected_t;

static expected_t expected_at(const walk_t *walk, double t)
{
    expected_t e;
    e.steps = (int)floor(t / walk->step_time + 0.5);
    const double sign = e.steps % 2 == 0 ? 1.0 : -1.0;
    const double since = t - e.steps * walk->step_time; /* the foot via point */
    const double rate = PI / walk->step_time;
    const double stance_y = sign * 0.5 * walk->width;
    e.com[0] = walk->speed * since;
    e.com[1] = sign * walk->amplitude * cos(rate * since);
    e.vy = -sign * walk->amplitude * rate * sin(rate * since);
    e.swing_x = -2.0 * stance_y * e.com[0] / (e.com[1] - stance_y);
    const double s = 1.0 - 2.0 * fabs(since) / walk->step_time;
    e.swing_z = 0.05 * (10.0 * pow(s, 3) - 15.0 * pow(s, 4) + 6.0 * pow(s, 5));
    const bool ahead = since >= 0.0;
    const double from_saddle = since + (ahead ? -0.5 : 0.5) * walk->step_time;
    const double rise = erf((from_saddle + walk->lead_s) / 0.11);
    e.toe_off = walk->toe_off * (1.0 + rise);
    e.heel_strike = 0.17453293 * (1.0 - rise);
    e.leg = 0.57 * 1.79 + 0.2 * sin(0.5 * (ahead ? e.toe_off : e.heel_strike));
    const double dy = e.com[1] - stance_y;
    e.com[2] = sqrt(e.leg * e.leg - e.com[0] * e.com[0] - dy * dy);
    e.to_saddle = 0.5 * walk->step_time - since;
    return e;
}

static void assert_plan(const walk_t *walk, double t, double tolerance)
{
    const expected_t e = expected_at(walk, t);
    const int swing = 1 - plan.support;
    TEST_ASSERT_DOUBLE_WITHIN(tolerance, e.com[0], plan.com_m.x);
    TEST_ASSERT_DOUBLE_WITHIN(tolerance, e.com[1], plan.com_m.y);
    TEST_ASSERT_DOUBLE_WITHIN(tolerance, e.com[2], plan.com_m.z);
    TEST_ASSERT_DOUBLE_WITHIN(tolerance, walk->speed, plan.com_velocity_m_s.x);
    TEST_ASSERT_DOUBLE_WITHIN(tolerance, e.vy, plan.com_velocity_m_s.y);
    TEST_ASSERT_DOUBLE_WITHIN(tolerance, e.swing_x, plan.foot_m[swing].x);
    TEST_ASSERT_DOUBLE_WITHIN(tolerance, e.swing_z, plan.foot_m[swing].z);
    TEST_ASSERT_DOUBLE_WITHIN(tolerance, e.leg, plan.leg_length_m);
    TEST_ASSERT_DOUBLE_WITHIN(tolerance, e.toe_off, plan.toe_off_rad);
    TEST_ASSERT_DOUBLE_WITHIN(tolerance, e.heel_strike, plan.heel_strike_rad);
    TEST_ASSERT_DOUBLE_WITHIN(tolerance * fmax(1.0, 1.0 / walk->speed), e.to_saddle,
                              plan.time_to_heel_strike_s);
}

static void test_constant_speed_is_the_closed_form(void)
{
    uint32_t state = 29;
    for (size_t i = 0; i < COUNT_OF(SPEEDS); i++) {
        restart(SPEEDS[i]);
        const walk_t walk = walk_at((double)SPEEDS[i]);
        double t = 0.0;
        TEST_ASSERT_EQUAL_HEX32(0, tick(0.08f)); /* the first tick plans t = 0 whatever dt is */
        while (t < 4.2 * walk.step_time) {
            const expected_t e = expected_at(&walk, t);
            const double theta = PI * t / walk.step_time;
            /* Closer to the saddle than the phase is exact, the step may be on either side. */
            if (e.to_saddle > 1e-5 && walk.step_time - e.to_saddle > 1e-5) {
                TEST_ASSERT_EQUAL_UINT32(e.steps, plan.step_count);
                TEST_ASSERT_EQUAL_UINT8(e.steps % 2, plan.support);
                assert_plan(&walk, t, TOLERANCE);
                const double turns = 2.0 * PI * plan.stride_count + (double)plan.theta_rad;
                TEST_ASSERT_DOUBLE_WITHIN(TOLERANCE, theta, turns);
                TEST_ASSERT_EQUAL_UINT8((int)floor(turns / (0.5 * PI)) % 4, plan.phase);
            }
            const float dt = random_in(&state, 0.0f, fminf(0.2f, 0.1f * (float)walk.step_time));
            TEST_ASSERT_EQUAL_HEX32(0, tick(dt));
            t += (double)dt;
        }
        TEST_ASSERT_EQUAL_UINT32(4, plan.step_count);
        TEST_ASSERT_EQUAL_UINT32(2, plan.stride_count);
    }
}

static void test_velocities_are_derivatives(void)
{
    for (size_t i = 0; i < COUNT_OF(SPEEDS); i++) {
        restart(SPEEDS[i]);
        const walk_t walk = walk_at((double)SPEEDS[i]);
        const double h = 1e-6;
        tick(0.0f);
        for (double t = 0.0; t < 2.0 * walk.step_time; t += (double)0.02f) {
            const expected_t now = expected_at(&walk, t);
            if (now.to_saddle > 1e-4 && walk.step_time - now.to_saddle > 1e-4 &&
                fabs(now.com[0]) > 1e-4) {
                const expected_t a = expected_at(&walk, t - h);
                const expected_t b = expected_at(&walk, t + h);
                TEST_ASSERT_DOUBLE_WITHIN(4 * TOLERANCE, (b.com[2] - a.com[2]) / (2 * h),
                                          plan.com_velocity_m_s.z);
                TEST_ASSERT_DOUBLE_WITHIN(4 * TOLERANCE, (b.swing_x - a.swing_x) / (2 * h),
                                          plan.swing_velocity_m_s.x);
                TEST_ASSERT_DOUBLE_WITHIN(4 * TOLERANCE, (b.swing_z - a.swing_z) / (2 * h),
                                          plan.swing_velocity_m_s.z);
                ASSERT_SAME_FLOAT(0.0f, plan.swing_velocity_m_s.y);
            }
            tick(0.02f);
        }
    }
}

/* Peak-to-peak z over a stride at 10 degrees, 2,000 points a step: the model page's table. */
static void test_vertical_excursion_is_the_model_page_s(void)
{
    static const struct {
        float speed;
        double planner, rigid;
    } table[] = {{0.7f, 0.0198, 0.0375}, {1.0f, 0.0331, 0.0512},
                 {1.2f, 0.0447, 0.0630}, {1.6f, 0.0736, 0.0926}};
    for (size_t i = 0; i < 2 * COUNT_OF(table); i++) {
        config.ankle = i % 2 == 0 ? SADDLE_ANKLE_ERF : SADDLE_ANKLE_RIGID;
        restart(table[i / 2].speed);
        const float dt = (float)(walk_at((double)table[i / 2].speed).step_time / 2000.0);
        double low = 10.0;
        double high = 0.0;
        tick(0.0f);
        for (int k = 0; k < 4000; k++) {
            low = fmin(low, (double)plan.com_m.z);
            high = fmax(high, (double)plan.com_m.z);
            tick(dt);
        }
        /* Half of the last printed digit, and one sample at the jump: 0.4 m/s x 0.25 ms. */
        const double expected = i % 2 == 0 ? table[i / 2].planner : table[i / 2].rigid;
        TEST_ASSERT_DOUBLE_WITHIN(5e-5 + 1e-4, expected, high - low);
    }
}

static void test_feet_stand_still_swing_without_a_jump_and_land_where_said(void)
{
    const float dt = 0.001f;
    for (size_t i = 0; i < COUNT_OF(SPEEDS); i++) {
        restart(SPEEDS[i]);
        tick(dt);
        double fastest = 0.0;
        for (int k = 0; k < 15000; k++) {
            const saddle_plan_t before = plan;
            tick(dt);
            const uint8_t stance = before.support;
            TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, before.foot_m[stance].x);
            TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, before.foot_m[stance].z);
            ASSERT_SAME_FLOAT((stance == SADDLE_LEFT ? 0.5f : -0.5f) * before.step_width_m,
                              before.foot_m[stance].y);
            ASSERT_SAME_FLOAT(before.foot_m[stance].y, plan.foot_m[stance].y);
            const double walked = (double)(plan.origin_x_nm - before.origin_x_nm) * 1e-9;
            if (plan.support == stance) {
                TEST_ASSERT_TRUE(plan.origin_x_nm == before.origin_x_nm);
            } else {
                /* A float of up to 1 m, in nanometres: the integer is as exact as the float is. */
                TEST_ASSERT_DOUBLE_WITHIN(6e-8, (double)before.landing_m.x, walked);
                ASSERT_SAME_FLOAT(before.landing_m.y, plan.foot_m[plan.support].y);
            }
            for (int side = 0; side < 2; side++) {
                const double moved =
                    walked + (double)plan.foot_m[side].x - (double)before.foot_m[side].x;
                fastest = fmax(fastest, fabs(moved) / (double)dt);
            }
        }
        /* The swing foot is fastest at the foot via point: v d_SW / (d_SW / 2 - A_y). */
        const walk_t walk = walk_at((double)SPEEDS[i]);
        const double peak = walk.speed * walk.width / (0.5 * walk.width - walk.amplitude);
        TEST_ASSERT_DOUBLE_WITHIN(2e-3, peak, fastest); /* two roundings of 1e-6 m in 1 ms */
    }
}

static void test_swing_foot_arrives_at_the_landing_point(void)
{
    for (size_t i = 0; i < COUNT_OF(SPEEDS); i++) {
        restart(SPEEDS[i]);
        tick(0.0f);
        while (plan.step_count == 0u && plan.time_to_heel_strike_s > 2e-6f) {
            tick(plan.time_to_heel_strike_s > 0.1f ? 0.05f : 1e-6f);
            if (plan.time_to_heel_strike_s < 0.1f && plan.time_to_heel_strike_s > 1e-4f) {
                tick(plan.time_to_heel_strike_s - 2e-5f);
            }
        }
        TEST_ASSERT_EQUAL_UINT32(0, plan.step_count);
        /* 2 us before landing at up to 4 m/s: 8 um. */
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, (double)plan.landing_m.x, plan.foot_m[SADDLE_RIGHT].x);
        ASSERT_SAME_FLOAT(plan.landing_m.y, plan.foot_m[SADDLE_RIGHT].y);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, plan.foot_m[SADDLE_RIGHT].z);
    }
}

static void test_time_to_heel_strike_is_when_the_next_step_begins(void)
{
    uint32_t state = 31;
    for (size_t i = 0; i < COUNT_OF(SPEEDS); i++) {
        restart(SPEEDS[i]);
        tick(0.0f);
        for (int k = 0; k < 2000; k++) {
            const saddle_plan_t before = plan;
            const float dt = random_in(&state, 0.0f, 0.2f);
            tick(dt);
            const double left = (double)before.time_to_heel_strike_s - (double)dt;
            if (fabs(left) < 2e-6) {
                continue; /* a float of up to 5 s is exact to 5e-7 */
            }
            TEST_ASSERT_EQUAL_UINT32(before.step_count + (left < 0.0 ? 1u : 0u), plan.step_count);
            if (left > 0.0) {
                TEST_ASSERT_DOUBLE_WITHIN(2e-6, left, plan.time_to_heel_strike_s);
            }
        }
    }
}

/* The plan's own phase puts it in the closed form; that must not lose a digit in a day. */
static void assert_plan_at_its_phase(const walk_t *walk)
{
    const double phase = (double)plan.theta_rad / PI; /* steps, within the stride */
    const expected_t e = expected_at(walk, phase * walk->step_time);
    if (e.to_saddle > 1e-5 && walk->step_time - e.to_saddle > 1e-5) {
        assert_plan(walk, phase * walk->step_time, TOLERANCE);
    }
}

static void test_a_day_of_ticks_is_as_exact_as_the_first_stride(void)
{
    const walk_t walk = walk_at(1.2);
    const int day = 1080000;
    const float dt = 80000.0f * 1.0e-6f;
    tick(dt);
    int64_t step_nm = 0;
    for (int k = 1; k < day; k++) {
        TEST_ASSERT_EQUAL_HEX32(0, tick(dt));
        if (plan.step_count == 1u) {
            step_nm = plan.origin_x_nm;
        }
        if (plan.origin_x_nm != step_nm * (int64_t)plan.step_count) {
            TEST_FAIL_MESSAGE("the walked distance is not steps x step length");
        }
        if (k < 20 || k > day - 1000) {
            assert_plan_at_its_phase(&walk);
        }
    }
    TEST_ASSERT_DOUBLE_WITHIN(6e-8, walk.step, (double)step_nm * 1e-9);
    /* The rate of the phase is a product of three floats, each within 2^-24: 2e-7 of the day. */
    const double strides = plan.stride_count + (double)plan.theta_rad / (2.0 * PI);
    const double expected = (day - 1) * 0.08 / (2.0 * walk.step_time);
    TEST_ASSERT_DOUBLE_WITHIN(2e-7 * expected, expected, strides);
}

static void test_ticks_of_any_length_take_the_same_path(void)
{
    static const struct {
        float dt;
        int count;
    } paths[] = {{1e-6f, 800000}, {1.25e-4f, 6400}, {0.08f, 10}, {0.16f, 5}, {0.2f, 4}};
    const walk_t walk = walk_at(1.2);
    for (size_t i = 0; i < COUNT_OF(paths); i++) {
        restart(1.2f);
        tick(0.0f);
        for (int k = 0; k < paths[i].count; k++) {
            tick(paths[i].dt);
        }
        assert_plan(&walk, 0.8, TOLERANCE);
    }
}

static void test_standing_still_in_time_keeps_the_plan(void)
{
    tick(0.0f);
    tick(0.08f);
    const saddle_plan_t before = plan;
    tick(0.0f);
    ASSERT_SAME_FLOAT(before.theta_rad, plan.theta_rad);
    ASSERT_SAME_FLOAT(before.com_m.x, plan.com_m.x);
    TEST_ASSERT_TRUE(before.origin_x_nm == plan.origin_x_nm);
}

/* 2^64 - 1 parts of a stride are a float's 1.0; the range says [0, 2 pi). */
static void test_theta_stays_below_a_full_turn(void)
{
    tick(0.0f);
    planner.phase_q64 = UINT64_MAX;
    tick(0.0f);
    TEST_ASSERT_TRUE((double)plan.theta_rad < 2.0 * PI);
    TEST_ASSERT_EQUAL_UINT8(3, plan.phase);
    TEST_ASSERT_EQUAL_UINT8(SADDLE_LEFT, plan.support);
}

static void test_usable_commands(void)
{
    const struct {
        saddle_command_t command;
        bool usable;
    } table[] = {
        {{SADDLE_COMMAND_STAND, 0.0f, 0.0f}, true}, {{SADDLE_COMMAND_WALK, 1.2f, 0.1f}, true},
        {{SADDLE_COMMAND_WALK, -5.0f, -1.0f}, true}, {{SADDLE_COMMAND_WALK, 1e6f, 1e6f}, true},
        {{2, 1.2f, 0.1f}, false},                    {{255, 1.2f, 0.1f}, false},
        {{SADDLE_COMMAND_WALK, NAN, 0.1f}, false},   {{SADDLE_COMMAND_WALK, 1.2f, NAN}, false},
        {{SADDLE_COMMAND_STAND, NAN, NAN}, true},    {{SADDLE_COMMAND_WALK, INFINITY, 0.1f}, false},
        {{SADDLE_COMMAND_WALK, 1.2f, -INFINITY}, false},
    };
    for (size_t i = 0; i < COUNT_OF(table); i++) {
        TEST_ASSERT_EQUAL(table[i].usable, saddle_command_usable(&table[i].command));
    }
}

static void test_speed_is_limited_to_what_is_feasible(void)
{
    const float ceiling = body.speed_ceiling_m_s;
    const struct {
        float commanded, planned;
        uint32_t limits;
    } table[] = {
        {1.2f, 1.2f, 0},
        {nextafterf(ceiling, 0.0f), nextafterf(ceiling, 0.0f), 0},
        {ceiling, SADDLE_CEILING_MARGIN * ceiling, SADDLE_LIMIT_SPEED},
        {1e6f, SADDLE_CEILING_MARGIN * ceiling, SADDLE_LIMIT_SPEED},
        {SADDLE_SPEED_FLOOR_M_S, SADDLE_SPEED_FLOOR_M_S, 0},
        {0.0f, SADDLE_SPEED_FLOOR_M_S, SADDLE_LIMIT_SPEED},
        {-1.0f, SADDLE_SPEED_FLOOR_M_S, SADDLE_LIMIT_SPEED},
    };
    for (size_t i = 0; i < COUNT_OF(table); i++) {
        restart(table[i].commanded);
        TEST_ASSERT_EQUAL_HEX32(table[i].limits, tick(0.0f) & ~(uint32_t)SADDLE_LIMIT_TOE_OFF);
        ASSERT_SAME_FLOAT(table[i].planned, plan.speed_m_s);
        TEST_ASSERT_TRUE(saddle_step_bounds(&config, &body, plan.speed_m_s).feasible);
        TEST_ASSERT_EQUAL_HEX32(table[i].limits, tick(0.08f) & ~(uint32_t)SADDLE_LIMIT_TOE_OFF);
    }
}

static void test_heel_strike_angle_is_limited(void)
{
    const struct {
        float commanded, planned;
        uint32_t limits;
    } table[] = {{0.1f, 0.1f, 0},
                 {0.0f, 0.0f, 0},
                 {0.5236f, 0.5236f, 0},
                 {0.53f, 0.5236f, SADDLE_LIMIT_HEEL_STRIKE},
                 {-0.1f, 0.0f, SADDLE_LIMIT_HEEL_STRIKE},
                 {1e6f, 0.5236f, SADDLE_LIMIT_HEEL_STRIKE}};
    for (size_t i = 0; i < COUNT_OF(table); i++) {
        restart(1.2f);
        command.heel_strike_rad = table[i].commanded;
        TEST_ASSERT_EQUAL_HEX32(table[i].limits, tick(0.0f));
        ASSERT_SAME_FLOAT(table[i].planned, planner.transition.heel_strike_rad);
    }
}

static void test_limits_of_one_walk_end_with_it(void)
{
    command.speed_m_s = 3.0f;
    command.heel_strike_rad = 1.0f;
    TEST_ASSERT_EQUAL_HEX32(SADDLE_LIMIT_SPEED | SADDLE_LIMIT_HEEL_STRIKE, tick(0.0f));
    command.mode = SADDLE_COMMAND_STAND;
    TEST_ASSERT_EQUAL_HEX32(0, tick(0.08f));
    command = (saddle_command_t){SADDLE_COMMAND_WALK, 1.2f, 0.1f};
    TEST_ASSERT_EQUAL_HEX32(0, tick(0.08f));
}

static void test_toe_off_limit_is_said(void)
{
    config.cop_range_m = 0.01f;
    restart(1.6f);
    TEST_ASSERT_EQUAL_HEX32(SADDLE_LIMIT_TOE_OFF, tick(0.0f));
}

static void test_change_of_command_is_held_until_the_next_walk(void)
{
    tick(0.0f);
    while (plan.step_count < 3u) {
        tick(0.08f);
    }
    command.speed_m_s = 0.8f;
    TEST_ASSERT_EQUAL_HEX32(SADDLE_LIMIT_COMMAND_HELD, tick(0.08f));
    ASSERT_SAME_FLOAT(1.2f, plan.speed_m_s);
    command.speed_m_s = 1.2f;
    TEST_ASSERT_EQUAL_HEX32(0, tick(0.08f));
    command.heel_strike_rad = 0.1f;
    TEST_ASSERT_EQUAL_HEX32(SADDLE_LIMIT_COMMAND_HELD, tick(0.08f));

    command = (saddle_command_t){SADDLE_COMMAND_STAND, 0.8f, 0.1f};
    TEST_ASSERT_EQUAL_HEX32(0, tick(0.08f));
    TEST_ASSERT_FALSE(plan.valid);
    ASSERT_SAME_FLOAT(0.0f, plan.speed_m_s);
    ASSERT_SAME_FLOAT(0.0f, plan.com_m.z);
    command.mode = SADDLE_COMMAND_WALK;
    TEST_ASSERT_EQUAL_HEX32(0, tick(0.08f));
    TEST_ASSERT_TRUE(plan.valid);
    ASSERT_SAME_FLOAT(0.8f, plan.speed_m_s);
    ASSERT_SAME_FLOAT(0.0f, plan.theta_rad);
    TEST_ASSERT_EQUAL_UINT32(0, plan.step_count);
    TEST_ASSERT_TRUE(plan.origin_x_nm == 0);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_constant_speed_is_the_closed_form);
    RUN_TEST(test_velocities_are_derivatives);
    RUN_TEST(test_vertical_excursion_is_the_model_page_s);
    RUN_TEST(test_feet_stand_still_swing_without_a_jump_and_land_where_said);
    RUN_TEST(test_swing_foot_arrives_at_the_landing_point);
    RUN_TEST(test_time_to_heel_strike_is_when_the_next_step_begins);
    RUN_TEST(test_a_day_of_ticks_is_as_exact_as_the_first_stride);
    RUN_TEST(test_ticks_of_any_length_take_the_same_path);
    RUN_TEST(test_standing_still_in_time_keeps_the_plan);
    RUN_TEST(test_theta_stays_below_a_full_turn);
    RUN_TEST(test_usable_commands);
    RUN_TEST(test_speed_is_limited_to_what_is_feasible);
    RUN_TEST(test_heel_strike_angle_is_limited);
    RUN_TEST(test_limits_of_one_walk_end_with_it);
    RUN_TEST(test_toe_off_limit_is_said);
    RUN_TEST(test_change_of_command_is_held_until_the_next_walk);
    return UNITY_END();
}
