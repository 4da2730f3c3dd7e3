/** The plan against eq:01 to eq:08 as functions of time, in double; start, stop, feet, events. */
#include "core_test.h"

#include "motion/plan_output.h"
#include "motion/planner.h"
#include "motion/standing.h"
#include "motion/stopping.h"

/* Metres, rad, m/s: floats of order 1 in a chain of ten operations. */
static const double TOLERANCE = 5e-6;

static const float SPEEDS[] = {0.05f, 0.2f, 0.45f, 0.7f, 1.0f, 1.2f, 1.6f, 1.9f};

static saddle_config_t config;
static saddle_body_t body;
static saddle_planner_t planner;
static saddle_plan_t plan;
static saddle_command_t command;
static saddle_measurement_t measured;
static bool feet_known;

static void stand(float speed_m_s)
{
    body = model_of(&config)->body;
    saddle_planner_reset(&planner, model_of(&config));
    command = (saddle_command_t){SADDLE_COMMAND_WALK, speed_m_s, 0.17453293f, 0.0f};
    feet_known = false;
}

static uint32_t tick(uint32_t dt_us)
{
    const uint32_t limits = saddle_planner_update(&planner, model_of(&config), &command,
                                                  feet_known ? &measured : NULL, dt_us);
    return limits | saddle_plan_write(&planner, model_of(&config), &plan);
}

/* A steady walk from the left foot via point. */
static void join(float speed_m_s)
{
    stand(speed_m_s);
    saddle_planner_join(&planner, model_of(&config), &command);
    tick(0);
}

void setUp(void)
{
    config = paper_config();
    join(1.2f);
}

void tearDown(void) {}

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
    const double later = tolerance * fmax(1.0, 1.0 / walk->speed);
    TEST_ASSERT_DOUBLE_WITHIN(later, e.to_saddle, plan.time_to_toe_off_s);
    TEST_ASSERT_DOUBLE_WITHIN(later, fmax(e.to_saddle - walk->lead_s, 0.0),
                              plan.time_to_heel_strike_s);
}

static void test_constant_speed_is_the_closed_form(void)
{
    uint32_t state = 29;
    for (size_t i = 0; i < COUNT_OF(SPEEDS); i++) {
        join(SPEEDS[i]);
        const walk_t walk = walk_at((double)SPEEDS[i]);
        double t = 0.0;
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
            }
            const uint32_t dt_us = random_bits(&state) % (uint32_t)fmin(2e5, 1e5 * walk.step_time);
            TEST_ASSERT_EQUAL_HEX32(0, tick(dt_us));
            t += dt_us * 1e-6;
        }
        TEST_ASSERT_EQUAL_UINT32(4, plan.step_count);
        TEST_ASSERT_EQUAL_UINT32(2, plan.stride_count);
    }
}

static void test_velocities_are_derivatives(void)
{
    for (size_t i = 0; i < COUNT_OF(SPEEDS); i++) {
        join(SPEEDS[i]);
        const walk_t walk = walk_at((double)SPEEDS[i]);
        const double h = 1e-6;
        for (double t = 0.0; t < 2.0 * walk.step_time; t += 0.02) {
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
                TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, plan.swing_velocity_m_s.y);
            }
            tick(20000);
        }
    }
}

/* Peak-to-peak z over a stride at 10 degrees, 2,000 points a step: the model page's table. */
static void test_vertical_excursion_is_as_documented(void)
{
    static const struct {
        float speed;
        double excursion[3]; /* erf, rigid, cycloid */
    } table[] = {{0.7f, {0.0198, 0.0375, 0.0212}},
                 {1.0f, {0.0331, 0.0512, 0.0291}},
                 {1.2f, {0.0447, 0.0630, 0.0344}},
                 {1.6f, {0.0736, 0.0926, 0.0451}}};
    for (size_t i = 0; i < 3 * COUNT_OF(table); i++) {
        config.ankle = (saddle_ankle_t)(i % 3);
        join(table[i / 3].speed);
        const uint32_t dt_us = (uint32_t)(walk_at((double)table[i / 3].speed).step_time * 500.0);
        double low = 10.0;
        double high = 0.0;
        for (int k = 0; k < 4000; k++) {
            low = fmin(low, (double)plan.com_m.z);
            high = fmax(high, (double)plan.com_m.z);
            tick(dt_us);
        }
        /* Half of the last printed digit, and one sample at the jump of erf: 0.4 m/s x 0.25 ms. */
        const double tolerance = 6e-5 + (i % 3 == 2 ? 0.0 : 1e-4);
        TEST_ASSERT_DOUBLE_WITHIN(tolerance, table[i / 3].excursion[i % 3], high - low);
    }
}

static const float CYCLOID_SPEEDS[] = {0.02f, 0.1f, 0.3f, 0.5f, 0.7f, 0.9f,
                                       1.1f,  1.2f, 1.4f, 1.6f, 1.8f, 1.9f};

static void test_cycloid_excursion_is_delta_z_and_the_ankle_is_real_everywhere(void)
{
    config.ankle = SADDLE_ANKLE_CYCLOID;
    for (size_t i = 0; i < COUNT_OF(CYCLOID_SPEEDS); i++) {
        join(CYCLOID_SPEEDS[i]);
        const double delta_z = 0.02656 * (double)CYCLOID_SPEEDS[i] + 0.002575;
        const uint32_t dt_us = (uint32_t)(walk_at((double)CYCLOID_SPEEDS[i]).step_time * 500.0);
        double low = 10.0;
        double high = 0.0;
        double flexion = 0.0;
        for (int k = 0; k < 4001; k++) {
            low = fmin(low, (double)plan.com_m.z);
            high = fmax(high, (double)plan.com_m.z);
            flexion = fmax(flexion, (double)plan.knee_flexion_m);
            TEST_ASSERT_TRUE(plan.toe_off_rad >= 0.0f && (double)plan.toe_off_rad < 0.7);
            TEST_ASSERT_TRUE(plan.heel_strike_rad >= 0.0f && (double)plan.heel_strike_rad < 0.7);
            TEST_ASSERT_EQUAL_HEX32(0, tick(dt_us));
        }
        TEST_ASSERT_DOUBLE_WITHIN(2e-6, delta_z, high - low); /* at most a sample off the ends */
        TEST_ASSERT_TRUE(flexion < 0.004);
    }
}

/* A person's shape in a steady walk: the path, and the ankle angles that eq:05 gives of the leg. */
static void test_shape_is_in_the_steady_plan(void)
{
    config.ankle = SADDLE_ANKLE_CYCLOID;
    config.lateral_offset_m = 0.01f;
    config.lateral_delay_rad = 0.2f;
    config.vertical_offset_m = 0.004f;
    config.vertical_delay_rad = 0.3f;
    for (size_t i = 0; i < COUNT_OF(SPEEDS); i++) {
        const walk_t walk = walk_at((double)SPEEDS[i]);
        const double leg_m = (double)model_of(&config)->body.leg_m;
        const double gap = 0.5 * walk.width - walk.amplitude;
        const double delta_z = 0.02656 * walk.speed + 0.002575;
        const double mean = sqrt(0.57 * 1.79 * 0.57 * 1.79 - gap * gap) - 0.5 * delta_z + 0.004;
        join(SPEEDS[i]);
        for (double t = 0.0; t < 4.2 * walk.step_time; t += 0.008) {
            const double turn = PI * t / walk.step_time;
            const double leg = (double)plan.leg_length_m;
            const double angle = (double)(plan.toe_off_rad + plan.heel_strike_rad);
            TEST_ASSERT_DOUBLE_WITHIN(TOLERANCE, 0.01 + walk.amplitude * cos(turn - 0.2),
                                      plan.com_m.y);
            TEST_ASSERT_DOUBLE_WITHIN(TOLERANCE, mean + 0.5 * delta_z * cos(2.0 * turn - 0.3),
                                      plan.com_m.z);
            TEST_ASSERT_DOUBLE_WITHIN(
                TOLERANCE, leg_m + 0.2 * sin(0.5 * angle) - (double)plan.knee_flexion_m, leg);
            TEST_ASSERT_EQUAL_HEX32(0, tick(8000));
        }
    }
}

/* From behind the stance foot, where it stood until the last landing, to ahead of it. */
static void check_swing_with_skew(double skew)
{
    config.swing_begin = -0.32f;
    config.swing_end = 1.04f;
    config.swing_skew = (float)skew;
    for (size_t i = 0; i < COUNT_OF(SPEEDS); i++) {
        const walk_t walk = walk_at((double)SPEEDS[i]);
        const double s_end = pow(1.32 / 1.36, skew);
        const double s_lift = pow(0.32 / 1.36, skew);
        const double full = pow(s_end, 3) * (10.0 + s_end * (6.0 * s_end - 15.0));
        const double lift = pow(s_lift, 3) * (10.0 + s_lift * (6.0 * s_lift - 15.0)) / full;
        join(SPEEDS[i]);
        for (double t = 0.0; t < 4.2 * walk.step_time; t += 0.008) {
            const double step = t / walk.step_time + 0.5;
            const double p = step - floor(step);
            const double s = pow((p + 0.32) / 1.36, skew);
            const double share = pow(s, 3) * (10.0 + s * (6.0 * s - 15.0)) / full;
            const double f = fmin(2.0 * p, 1.0);
            const double rest = 1.0 - pow(f, 3) * (10.0 + f * (6.0 * f - 15.0));
            const double x =
                walk.step * (2.0 * (share - lift * (t < 0.5 * walk.step_time ? 0.0 : rest)) - 1.0);
            if (p > 1e-4 && p < 1.0 - 1e-4) {
                TEST_ASSERT_DOUBLE_WITHIN(3.0 * TOLERANCE, x, plan.foot_m[1 - plan.support].x);
            }
            TEST_ASSERT_EQUAL_HEX32(0, tick(8000));
        }
    }
}

static void test_swing_of_a_person_is_in_the_steady_plan(void)
{
    check_swing_with_skew(1.47);
    check_swing_with_skew(0.75);
}

static void check_heel_strikes_at(double strike_share)
{
    config.strike_share = (float)strike_share;
    for (size_t i = 0; i < COUNT_OF(SPEEDS); i++) {
        const walk_t walk = walk_at((double)SPEEDS[i]);
        join(SPEEDS[i]);
        double t = 0.0;
        for (int k = 0; k < 100; k++) {
            const expected_t e = expected_at(&walk, t);
            const double late = (strike_share - 0.5) * walk.step_time;
            const double due = e.to_saddle + late - walk.step_time; /* of the step before */
            const double left = due > 0.0 ? due : e.to_saddle + late;
            if (e.to_saddle > 1e-5 && walk.step_time - e.to_saddle > 1e-5 && fabs(due) > 1e-5) {
                TEST_ASSERT_DOUBLE_WITHIN(TOLERANCE * fmax(1.0, 1.0 / walk.speed), fmax(left, 0.0),
                                          plan.time_to_heel_strike_s);
            }
            TEST_ASSERT_EQUAL_HEX32(0, tick(40000));
            t += 0.04;
        }
    }
}

static void test_heel_strikes_at_its_share_of_a_step(void)
{
    check_heel_strikes_at(0.36);
}

static void test_heel_strikes_after_the_foot_carries(void)
{
    check_heel_strikes_at(0.58);
}

static void test_cycloid_beyond_the_ankle_is_reported(void)
{
    config.ankle = SADDLE_ANKLE_CYCLOID;
    config.cop_range_m = 0.01f; /* an elongation of at most 2 cm */
    join(1.6f);
    uint32_t limits = 0;
    for (int k = 0; k < 10; k++) {
        limits |= tick(80000);
    }
    TEST_ASSERT_EQUAL_HEX32(SADDLE_LIMIT_TOE_OFF, limits);
}

static void test_toe_off_limit_is_reported(void)
{
    config.cop_range_m = 0.01f;
    join(1.6f);
    TEST_ASSERT_EQUAL_HEX32(SADDLE_LIMIT_TOE_OFF, tick(0));
}

static double absolute(double x)
{
    return (double)plan.origin_x_nm * 1e-9 + x;
}

/* What must not jump, in the frame of the ground. */
typedef struct {
    double com[3], foot[2][3], velocity[3], pitch[2];
} ground_t;

static ground_t on_ground(void)
{
    ground_t g = {
        .com = {absolute((double)plan.com_m.x), plan.com_m.y, plan.com_m.z},
        .velocity = {plan.com_velocity_m_s.x, plan.com_velocity_m_s.y, plan.com_velocity_m_s.z}};
    for (int side = 0; side < 2; side++) {
        g.foot[side][0] = absolute((double)plan.foot_m[side].x);
        g.foot[side][1] = plan.foot_m[side].y;
        g.foot[side][2] = plan.foot_m[side].z;
        g.pitch[side] = plan.foot_pitch_rad[side];
    }
    return g;
}

/* 1 ms further: nothing jumps, what stands stays, each step lands where it was said. */
static void smooth_millisecond(bool cycloid)
{
    const saddle_plan_t said = plan;
    const ground_t before = on_ground();
    tick(1000);
    const ground_t after = on_ground();
    const bool stepped = plan.step_count != said.step_count;
    for (int axis = 0; axis < 3; axis++) {
        if (axis < 2 || cycloid) {
            TEST_ASSERT_DOUBLE_WITHIN(2.1e-3 + 1e-5, before.com[axis], after.com[axis]);
            /* 40 m/s^2 for 1 ms, as after a misplaced start */
            TEST_ASSERT_DOUBLE_WITHIN(4e-2, before.velocity[axis], after.velocity[axis]);
        }
        for (int side = 0; side < 2; side++) {
            TEST_ASSERT_DOUBLE_WITHIN(7e-3 + 1e-5, before.foot[side][axis], after.foot[side][axis]);
        }
        const uint8_t stood = said.support;
        const double moved = after.foot[stood][axis] - before.foot[stood][axis];
        TEST_ASSERT_DOUBLE_WITHIN(stepped ? 7e-3 : 1e-12, 0.0, moved);
    }
    if (stepped) {
        const double landing = (double)said.origin_x_nm * 1e-9 + (double)said.landing_m.x;
        /* The speed at the foot via point is a float of the state before it. */
        TEST_ASSERT_DOUBLE_WITHIN(2e-6, landing, after.foot[plan.support][0]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, (double)said.landing_m.y, after.foot[plan.support][1]);
    }
    for (int side = 0; side < 2; side++) {
        const bool on_the_ground = before.foot[side][2] == 0.0 && after.foot[side][2] == 0.0;
        if (on_the_ground && !stepped) { /* never slides */
            TEST_ASSERT_DOUBLE_WITHIN(1e-6, before.foot[side][0], after.foot[side][0]);
        }
        TEST_ASSERT_DOUBLE_WITHIN(0.02, before.pitch[side], after.pitch[side]); /* 20 rad/s */
    }
}

static void test_start_change_and_stop_are_smooth_in_every_ankle(void)
{
    for (int ankle = 0; ankle < (int)SADDLE_ANKLE_COUNT; ankle++) {
        for (size_t i = 0; i < COUNT_OF(SPEEDS); i += EVERY(5)) {
            config.ankle = (saddle_ankle_t)ankle;
            stand(SPEEDS[i]);
            tick(0);
            TEST_ASSERT_EQUAL_UINT8(SADDLE_MODE_STARTING, plan.mode);
            for (int k = 0; k < 24000; k++) {
                command.speed_m_s = k < 6000 ? SPEEDS[i] : k < 10000 ? 0.9f : 0.0f;
                smooth_millisecond(ankle == (int)SADDLE_ANKLE_CYCLOID);
            }
            TEST_ASSERT_EQUAL_UINT8(SADDLE_MODE_STANDING, plan.mode);
        }
    }
}

static void assert_stands_side_by_side(void)
{
    TEST_ASSERT_EQUAL_UINT8(SADDLE_MODE_STANDING, plan.mode);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, plan.speed_m_s);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, plan.com_velocity_m_s.x);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, plan.com_velocity_m_s.y);
    ASSERT_SAME_FLOAT(plan.foot_m[SADDLE_LEFT].x, plan.foot_m[SADDLE_RIGHT].x);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, plan.foot_m[SADDLE_LEFT].z);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, plan.foot_m[SADDLE_RIGHT].z);
    const double middle =
        0.5 * ((double)plan.foot_m[SADDLE_LEFT].y + (double)plan.foot_m[SADDLE_RIGHT].y);
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, middle, plan.com_m.y);
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, 0.0, plan.com_m.x);
    TEST_ASSERT_TRUE(plan.foot_m[SADDLE_LEFT].y > plan.foot_m[SADDLE_RIGHT].y);
}

/* Ticks of dt_us until it stands; the most is 20 s: braking from 1.9 m/s takes 4, then crawling. */
static double time_to_stand(uint32_t dt_us)
{
    double t = 0.0;
    float speed = plan.speed_m_s;
    while (plan.mode != (uint8_t)SADDLE_MODE_STANDING && t < 20.0) {
        tick(dt_us);
        t += dt_us * 1e-6;
        const double change = (double)plan.speed_m_s - (double)speed;
        TEST_ASSERT_DOUBLE_WITHIN(0.5 * dt_us * 1e-6 + 2e-3, 0.0, change);
        speed = plan.speed_m_s;
    }
    return t;
}

static void test_stop_at_any_moment_ends_side_by_side(void)
{
    static const uint32_t ticks[] = {80000, 13000, 160000};
    uint32_t state = 37;
    for (int i = 0; i < MANY(3000); i++) {
        stand(random_in(&state, 0.02f, 1.92f));
        const int until = (int)(random_bits(&state) % 200u);
        tick(0);
        for (int k = 0; k < until; k++) {
            tick(random_bits(&state) % 80000u);
        }
        command.speed_m_s = 0.0f;
        tick(ticks[i % 3]);
        TEST_ASSERT_TRUE(time_to_stand(ticks[i % 3]) < 14.0);
        assert_stands_side_by_side();
    }
}

static void test_command_at_any_moment_takes_effect(void)
{
    uint32_t state = 41;
    int braked = 0;
    for (int i = 0; i < MANY(3000); i++) {
        stand(random_in(&state, 0.05f, 1.9f));
        tick(0);
        for (int k = 0; k < 100; k++) {
            tick(random_bits(&state) % 80000u);
        }
        command.mode = SADDLE_COMMAND_STAND;
        const int until = (int)(random_bits(&state) % 100u);
        for (int k = 0; k < until; k++) {
            tick(random_bits(&state) % 80000u);
        }
        braked += planner.braking || planner.shifting ? 1 : 0;
        command = (saddle_command_t){SADDLE_COMMAND_WALK, 0.8f, 0.1f, 0.0f};
        for (int k = 0; k < 150; k++) {
            tick(80000);
        }
        TEST_ASSERT_EQUAL_UINT8(SADDLE_MODE_WALKING, plan.mode);
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, 0.8, plan.speed_m_s);
    }
    TEST_ASSERT_GREATER_THAN_INT(MANY(300), braked);
}

/* Before and after the last lift-off, while shifting: 60 moments of a stop. */
static void test_restart_while_stopping_is_smooth(void)
{
    config.ankle = SADDLE_ANKLE_CYCLOID;
    for (int moment = 0; moment < 60; moment += EVERY(20)) {
        join(0.9f);
        command.speed_m_s = 0.0f;
        for (int k = 0; k < 70 * moment; k++) {
            smooth_millisecond(true);
        }
        command.speed_m_s = 0.9f;
        for (int k = 0; k < 4000; k++) {
            smooth_millisecond(true);
        }
        TEST_ASSERT_TRUE(plan.mode == (uint8_t)SADDLE_MODE_WALKING ||
                         plan.mode == (uint8_t)SADDLE_MODE_STARTING);
    }
}

/* v = 0.9 (a s + sqrt(a^2 s^2 + 2 a i)) = 0.42 m/s: a step at it is long enough to brake. */
static void test_stop_slows_no_further_than_a_step_can_brake(void)
{
    for (int moment = 0; moment < 40; moment += EVERY(7)) {
        join(0.7f);
        for (int k = 0; k < moment; k++) {
            tick(40000);
        }
        command.mode = SADDLE_COMMAND_STAND;
        tick(80000);
        float before_braking_m_s = plan.speed_m_s;
        while (!planner.braking) {
            before_braking_m_s = plan.speed_m_s;
            tick(80000);
        }
        TEST_ASSERT_TRUE(before_braking_m_s > 0.4209f);
    }
}

/* As where braking has become too weak: the stop waits for a later step. */
static void test_stop_that_cannot_brake_in_time_brakes_no_longer(void)
{
    join(1.9f);
    planner.braking = true;
    saddle_plan_stop(&planner, model_of(&config));
    TEST_ASSERT_FALSE(planner.braking);
    TEST_ASSERT_FALSE(planner.cycle.last_swing);
}

static void test_stop_of_a_slow_walk_stays_slow(void)
{
    static const float accelerations[] = {0.5f, 5.0f};
    for (size_t i = 0; i < COUNT_OF(accelerations); i++) {
        config.acceleration_m_s2 = accelerations[i];
        join(0.05f);
        command.mode = SADDLE_COMMAND_STAND;
        while (plan.mode != (uint8_t)SADDLE_MODE_STANDING) {
            tick(80000);
            TEST_ASSERT_TRUE(plan.speed_m_s < 0.3001f);
        }
    }
    config.half_step_intercept_m = 0.46f;
    join(0.05f);
    const double ceiling = (double)body.speed_ceiling_m_s;
    TEST_ASSERT_TRUE(ceiling < 0.2);
    command.mode = SADDLE_COMMAND_STAND;
    while (plan.mode != (uint8_t)SADDLE_MODE_STANDING) {
        tick(80000);
        TEST_ASSERT_TRUE((double)plan.speed_m_s < ceiling);
    }
}

static void test_ticks_of_any_length_start_alike(void)
{
    static const uint32_t ticks[] = {1000, 70000, 80000, 200000};
    for (size_t i = 0; i < COUNT_OF(ticks); i++) {
        stand(1.0f);
        tick(0);
        for (uint32_t t = 0; t < 2800000u; t += ticks[i]) {
            tick(ticks[i]);
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.0, plan.speed_m_s);
        TEST_ASSERT_DOUBLE_WITHIN(2e-6, 1.0, absolute((double)plan.com_m.x)); /* 2 s at 0.5 m/s^2 */
    }
}

static void test_stop_while_starting(void)
{
    stand(1.2f);
    tick(0);
    for (uint32_t until = 0; until < 2400000u; until += 80000u) { /* the shift, then half a step */
        stand(1.2f);
        tick(0);
        for (uint32_t t = 0; t < until; t += 80000u) {
            tick(80000);
        }
        command.mode = SADDLE_COMMAND_STAND;
        TEST_ASSERT_TRUE(time_to_stand(80000) < 8.0);
        assert_stands_side_by_side();
        /* The command is applied 80 ms later: before the shift's end no step was begun. */
        TEST_ASSERT_EQUAL(until < 720000u, plan.step_count == 0u);
    }
}

static void test_start_stands_then_shifts_then_steps(void)
{
    stand(0.0f);
    tick(80000);
    TEST_ASSERT_EQUAL_UINT8(SADDLE_MODE_STANDING, plan.mode);
    command.speed_m_s = 1.2f;
    tick(80000);
    TEST_ASSERT_EQUAL_UINT8(SADDLE_MODE_STARTING, plan.mode);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.8, plan.time_to_via_point_s);
    tick(400000);
    const double over_foot = 0.11 - 0.22 / PI; /* CoM inside the left foot, from its line */
    TEST_ASSERT_DOUBLE_WITHIN(TOLERANCE, 0.5 * (0.11 - over_foot), plan.com_m.y);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.4, plan.time_to_via_point_s);
    tick(400000);
    TEST_ASSERT_DOUBLE_WITHIN(TOLERANCE, 0.11 - over_foot, plan.com_m.y);
    TEST_ASSERT_EQUAL_UINT8(SADDLE_LEFT, plan.support);
    TEST_ASSERT_EQUAL_UINT8(0, plan.phase);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, plan.foot_m[SADDLE_RIGHT].x);
    tick(200000);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.1, plan.speed_m_s);
    TEST_ASSERT_TRUE(plan.foot_m[SADDLE_RIGHT].x > 0.0f && plan.foot_m[SADDLE_RIGHT].z > 0.0f);
    while (plan.step_count == 0u) {
        tick(80000);
    }
    TEST_ASSERT_EQUAL_UINT8(SADDLE_MODE_WALKING, plan.mode);
    TEST_ASSERT_EQUAL_UINT8(SADDLE_RIGHT, plan.support);
}

static void measure(float left_x, float left_y, float right_x, float right_y)
{
    feet_known = true;
    measured.foot[SADDLE_LEFT].cop_m = (saddle_vec2_t){left_x, left_y};
    measured.foot[SADDLE_RIGHT].cop_m = (saddle_vec2_t){right_x, right_y};
    measured.foot[SADDLE_LEFT].contact = true;
    measured.foot[SADDLE_RIGHT].contact = true;
}

static void test_measured_feet_give_the_nearest_phase(void)
{
    static const struct {
        float left_x, right_x;
        uint8_t phase, support;
    } table[] = {{0.0f, 0.0f, 0, SADDLE_LEFT},     {0.05f, 0.0f, 0, SADDLE_LEFT},
                 {0.0f, 0.05f, 2, SADDLE_RIGHT},   {0.15f, -0.15f, 3, SADDLE_LEFT},
                 {-0.15f, 0.15f, 1, SADDLE_RIGHT}, {0.4f, -0.4f, 3, SADDLE_LEFT}};
    for (size_t i = 0; i < COUNT_OF(table); i++) {
        stand(1.0f);
        measure(table[i].left_x, 0.12f, table[i].right_x, -0.08f);
        TEST_ASSERT_EQUAL_HEX32(0, tick(80000));
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, (double)table[i].left_x - (double)table[i].right_x,
                                  (double)plan.foot_m[SADDLE_LEFT].x -
                                      (double)plan.foot_m[SADDLE_RIGHT].x);
        TEST_ASSERT_DOUBLE_WITHIN(
            1e-6, 0.2, (double)plan.foot_m[SADDLE_LEFT].y - (double)plan.foot_m[SADDLE_RIGHT].y);
        for (int k = 0; k < 800; k++) {
            smooth_millisecond(false);
        }
        TEST_ASSERT_EQUAL_UINT8(table[i].phase, plan.phase);
        TEST_ASSERT_EQUAL_UINT8(table[i].support, plan.support);
        feet_known = false;
        while (plan.step_count < 2u) { /* joins the reference within one step */
            smooth_millisecond(false);
        }
    }
}

/* A landing that was never measured is not taken for the first stance foot of the next walk. */
static void test_start_after_an_unmeasured_walk_uses_no_old_landing(void)
{
    join(0.5f);
    command.mode = SADDLE_COMMAND_STAND;
    time_to_stand(80000);
    command = (saddle_command_t){SADDLE_COMMAND_WALK, 1.0f, 0.1f, 0.0f};
    measure(0.2f, 0.1f, -0.1f, -0.1f);
    for (int k = 0; k < 14; k++) {
        TEST_ASSERT_EQUAL_HEX32(0, tick(80000));
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.1, plan.foot_m[SADDLE_LEFT].y);
}

static void test_feet_from_which_no_walk_can_start_are_reported(void)
{
    static const float bad[][4] = {{0.0f, -0.1f, 0.0f, 0.1f},
                                   {0.0f, 0.02f, 0.0f, -0.02f},
                                   {1.0f, 0.1f, 0.0f, -0.1f},
                                   {0.0f, 0.1f, 1.0f, -0.1f},
                                   {0.0f, 0.3f, 0.0f, -0.3f}};
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        stand(1.0f);
        measure(bad[i][0], bad[i][1], bad[i][2], bad[i][3]);
        TEST_ASSERT_EQUAL_HEX32(SADDLE_LIMIT_FEET, tick(80000));
        ASSERT_SAME_FLOAT(0.11f, plan.foot_m[SADDLE_LEFT].y); /* the default feet */
    }
    stand(1.0f);
    measure(0.0f, 0.1f, 0.0f, -0.1f);
    measured.foot[SADDLE_RIGHT].contact = false; /* in the air: no stance to start from */
    for (int k = 0; k < 20; k++) {
        TEST_ASSERT_EQUAL_HEX32(SADDLE_LIMIT_FEET, tick(80000));
        TEST_ASSERT_EQUAL_UINT8(SADDLE_MODE_STANDING, plan.mode);
    }
    measured.foot[SADDLE_RIGHT].contact = true;
    TEST_ASSERT_EQUAL_HEX32(0, tick(80000));
    TEST_ASSERT_EQUAL_UINT8(SADDLE_MODE_STARTING, plan.mode);
}

/* The planned landing as it is measured, shifted, with the rear foot at the origin. */
static void land_there(float dx, float dy)
{
    measure(0.0f, 0.0f, 0.0f, 0.0f);
    measured.foot[plan.support].cop_m =
        (saddle_vec2_t){planner.cycle.last_step_m.x + dx, planner.cycle.last_step_m.y + dy};
}

/* The last step lands up to 0.3 m short: what is left of the way may be too short to brake on. */
static void test_short_landing_does_not_stop_the_plan_at_once(void)
{
    static const float rates_m_s2[] = {0.5f, 2.0f};
    int refused = 0;
    for (int i = 0; i < 2 * 15 * 16; i += EVERY(7)) {
        const float rate_m_s2 = rates_m_s2[i % 2];
        config.acceleration_m_s2 = rate_m_s2;
        join(0.3f + 0.1f * (float)(i / 2 % 15));
        command.mode = SADDLE_COMMAND_STAND;
        float last_m_s = plan.speed_m_s;
        uint32_t steps = plan.step_count;
        while (plan.mode != (uint8_t)SADDLE_MODE_STANDING) {
            feet_known = plan.step_count != steps;
            if (feet_known) {
                land_there(-0.02f * (float)(i / 30), 0.0f);
            }
            steps = plan.step_count;
            refused += (tick(80000) & (uint32_t)SADDLE_LIMIT_FEET) != 0u ? 1 : 0;
            TEST_ASSERT_TRUE(last_m_s - plan.speed_m_s < 1.001f * 0.08f * rate_m_s2 + 1e-6f);
            last_m_s = plan.speed_m_s;
        }
    }
    TEST_ASSERT_GREATER_THAN_INT(MANY(20), refused);
}

/* Walk in ms until the next landing; then its measurement. */
static void land_shifted(float dx, float dy)
{
    const uint32_t steps = plan.step_count;
    feet_known = false;
    while (plan.step_count == steps) {
        tick(1000);
    }
    land_there(dx, dy);
}

static void test_misplaced_landing_is_where_the_next_step_starts(void)
{
    static const float shifts[][2] = {
        {0.0f, 0.0f}, {0.06f, 0.0f}, {-0.06f, 0.0f}, {0.0f, 0.04f}, {0.03f, 0.03f}};
    for (size_t i = 0; i < 2 * COUNT_OF(shifts); i++) {
        const float *shift = shifts[i / 2];
        config.ankle = i % 2 == 0 ? SADDLE_ANKLE_ERF : SADDLE_ANKLE_CYCLOID;
        join(1.0f);
        land_shifted(0.0f, 0.0f);
        land_shifted(shift[0], shift[1]); /* a left foot: outward is up */
        const ground_t planned = on_ground();
        TEST_ASSERT_EQUAL_HEX32(0, tick(0));
        const ground_t taken = on_ground();
        const saddle_side_t stance = (saddle_side_t)plan.support;
        for (int axis = 0; axis < 3; axis++) {
            const double moved = axis < 2 ? (double)shift[axis] : 0.0;
            TEST_ASSERT_DOUBLE_WITHIN(1e-6, planned.foot[stance][axis] + moved,
                                      taken.foot[stance][axis]);
            TEST_ASSERT_DOUBLE_WITHIN(1e-6, planned.foot[1 - stance][axis],
                                      taken.foot[1 - stance][axis]);
            if (axis < 2 || i % 2 == 1) { /* z of erf follows the leg */
                TEST_ASSERT_DOUBLE_WITHIN(1e-6, planned.com[axis], taken.com[axis]);
                TEST_ASSERT_DOUBLE_WITHIN(1e-5, planned.velocity[axis], taken.velocity[axis]);
            }
        }
        const uint32_t steps = plan.step_count;
        for (int k = 0; k < 3000; k++) { /* taken over once, though the feet are still known */
            feet_known = plan.step_count == steps;
            smooth_millisecond(config.ankle == SADDLE_ANKLE_CYCLOID);
        }
    }
}

static void test_landing_without_a_possible_next_step_is_reported_and_not_used(void)
{
    static const float shifts[][2] = {{-0.65f, 0.0f}, {0.6f, 0.0f}, {0.0f, -0.12f}, {0.0f, 0.4f}};
    for (size_t i = 0; i < COUNT_OF(shifts); i++) {
        join(1.0f);
        land_shifted(0.0f, 0.0f);
        land_shifted(shifts[i][0], shifts[i][1]);
        const saddle_plan_t before = plan;
        TEST_ASSERT_EQUAL_HEX32(SADDLE_LIMIT_FEET, tick(0));
        ASSERT_SAME_FLOAT(before.com_m.y, plan.com_m.y);
        TEST_ASSERT_TRUE(before.origin_x_nm == plan.origin_x_nm);
        TEST_ASSERT_EQUAL_HEX32(0, tick(0)); /* said once */
    }
}

static void test_landing_is_taken_over_early_with_both_feet_on_the_ground_only(void)
{
    join(1.0f);
    land_shifted(0.0f, 0.0f);
    land_shifted(0.05f, 0.0f);
    measured.foot[1 - plan.support].contact = false;
    const int64_t origin = plan.origin_x_nm;
    TEST_ASSERT_EQUAL_HEX32(0, tick(0));
    TEST_ASSERT_TRUE(origin == plan.origin_x_nm);

    land_shifted(0.05f, 0.0f);
    feet_known = false;
    tick(200000); /* beyond half of the quarter of 0.315 s */
    feet_known = true;
    TEST_ASSERT_EQUAL_HEX32(SADDLE_LIMIT_FEET, tick(0));

    land_shifted(0.05f, 0.0f);
    measured.foot[plan.support].contact = false; /* not down yet: waits */
    TEST_ASSERT_EQUAL_HEX32(0, tick(0));
    measured.foot[plan.support].contact = true;
    const int64_t waited = plan.origin_x_nm;
    tick(20000);
    TEST_ASSERT_DOUBLE_WITHIN(60.0, 5e7, (double)(plan.origin_x_nm - waited));
}

/* At any moment of a start, a change of speed and a stop: when ticks of 10 us see the events. */
static void test_events_are_predicted_between_ticks(void)
{
    uint32_t state = 43;
    for (int i = 0; i < 40; i++) {
        stand(random_in(&state, 0.3f, 1.8f));
        tick(0);
        for (uint32_t until = random_bits(&state) % 60u + 12u; until > 0u; until--) {
            tick(80000);
        }
        command.speed_m_s = i % 3 == 0 ? 0.0f : i % 3 == 1 ? 0.7f : 1.5f;
        tick(0);
        const saddle_plan_t said = plan;
        saddle_planner_t predicted = planner; /* time alone passes: no new command */
        uint32_t via_us = 0;
        uint32_t land_us = 0;
        for (uint32_t t = 0; t < 3000000u && land_us == 0u; t += 10u) {
            saddle_planner_advance(&predicted, model_of(&config), 10u);
            via_us = via_us == 0u && predicted.cycle.phase != said.phase ? t + 10u : via_us;
            land_us = predicted.cycle.step_count != said.step_count ? t + 10u : 0u;
            if (predicted.shifting) {
                break;
            }
        }
        if (via_us != 0u) {
            TEST_ASSERT_DOUBLE_WITHIN(11e-6, via_us * 1e-6 - 5e-6, said.time_to_via_point_s);
        }
        if (land_us != 0u && planner.mode == (uint8_t)SADDLE_MODE_WALKING) {
            TEST_ASSERT_DOUBLE_WITHIN(15e-6, land_us * 1e-6 - 5e-6, said.time_to_toe_off_s);
            TEST_ASSERT_TRUE(said.time_to_heel_strike_s < said.time_to_toe_off_s);
        }
    }
}

static void test_sides_step_by_their_own_factors(void)
{
    config.step_length_factor_left = 0.8f;
    config.step_width_factor_right = 1.3f;
    join(1.0f);
    for (int k = 0; k < 8; k++) {
        const uint32_t steps = plan.step_count;
        const int64_t before = plan.origin_x_nm;
        while (plan.step_count == steps) {
            smooth_millisecond(false);
        }
        const bool left = plan.support == (uint8_t)SADDLE_LEFT;
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, (left ? 0.8 : 1.0) * 0.6306,
                                  (double)(plan.origin_x_nm - before) * 1e-9);
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, left ? 0.0664 : -1.3 * 0.0664, plan.foot_m[plan.support].y);
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
        {1e-6f, SADDLE_SPEED_FLOOR_M_S, SADDLE_LIMIT_SPEED},
        {0.0f, 0.0f, 0},
        {-1.0f, 0.0f, SADDLE_LIMIT_SPEED},
        {-1e6f, 0.0f, SADDLE_LIMIT_SPEED},
    };
    for (size_t i = 0; i < COUNT_OF(table); i++) {
        stand(table[i].commanded);
        for (int k = 0; k < 100; k++) {
            TEST_ASSERT_EQUAL_HEX32(table[i].limits, tick(80000) & ~(uint32_t)SADDLE_LIMIT_TOE_OFF);
        }
        TEST_ASSERT_DOUBLE_WITHIN(2e-7, (double)table[i].planned, plan.speed_m_s);
        TEST_ASSERT_EQUAL(table[i].planned > 0.0f, plan.mode != (uint8_t)SADDLE_MODE_STANDING);
    }
}

static void test_longer_side_stays_within_reach_up_to_the_ceiling(void)
{
    const float factors[] = {1.0f, 1.2f, 1.5f};
    for (size_t i = 0; i < COUNT_OF(factors); i++) {
        config.step_length_factor_left = factors[i];
        stand(10.0f);
        float longest_m = 0.0f;
        for (int k = 0; k < 200; k++) {
            tick(80000);
            longest_m = fmaxf(longest_m, 0.5f * plan.step_length_m);
        }
        TEST_ASSERT_TRUE(longest_m < body.half_step_max_m);
        TEST_ASSERT_TRUE(longest_m > 0.98f * body.half_step_max_m);
    }
}

static void test_turning_rate_is_limited_to_what_the_speed_bears(void)
{
    static const struct {
        float speed_m_s, rate_rad_s;
        bool limited;
    } table[] = {{1.2f, 0.28f, false}, {1.2f, -0.31f, true},  {0.6f, 0.6f, false},
                 {0.6f, 0.63f, true},  {0.05f, 0.08f, false}, {0.05f, 0.1f, true},
                 {1.9f, 0.02f, false}, {1.9f, 0.25f, true},   {0.0f, 5.0f, false},
                 {1.2f, 1.0f, true}};
    for (size_t i = 0; i < COUNT_OF(table); i++) {
        stand(table[i].speed_m_s);
        command.turn_rate_rad_s = table[i].rate_rad_s;
        TEST_ASSERT_EQUAL(table[i].limited, (tick(0) & (uint32_t)SADDLE_LIMIT_TURN) != 0u);
    }
}

/* [E48] [E49] A circle of 2 m, from the first instant. */
static void test_joined_turn_is_steady(void)
{
    stand(0.8f);
    command.turn_rate_rad_s = 0.4f;
    saddle_planner_join(&planner, model_of(&config), &command);
    tick(0);
    const double lean = 0.4 * 0.8 * 1.0203 / GRAVITY;
    const double amplitude = (double)(0.3456f - 0.2128f * 0.8f) / (2.0 * PI * 0.8);
    TEST_ASSERT_DOUBLE_WITHIN(TOLERANCE, 0.5, plan.curvature_1_m[0]);
    TEST_ASSERT_DOUBLE_WITHIN(TOLERANCE, 0.5, plan.curvature_1_m[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, amplitude + lean, plan.com_m.y);
    for (int step = 1; step < 60; step++) {
        tick(80000);
        TEST_ASSERT_DOUBLE_WITHIN(TOLERANCE, 0.5, plan.curvature_1_m[1]);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, plan.step_count * 0.5 * (double)plan.step_length_m,
                              plan.heading_rad);
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
        join(1.2f);
        command.heel_strike_rad = table[i].commanded;
        TEST_ASSERT_EQUAL_HEX32(table[i].limits, tick(0));
        for (int k = 0; k < 25; k++) { /* beyond the heel strike after the next */
            tick(80000);
        }
        ASSERT_SAME_FLOAT(table[i].planned, planner.cycle.next_strike.angle_rad);
        ASSERT_SAME_FLOAT(table[i].planned, planner.cycle.transition.strike.angle_rad);
    }
}

static void test_limits_of_one_command_end_with_it(void)
{
    command.speed_m_s = 3.0f;
    command.heel_strike_rad = 1.0f;
    TEST_ASSERT_EQUAL_HEX32(SADDLE_LIMIT_SPEED | SADDLE_LIMIT_HEEL_STRIKE, tick(0));
    command.mode = SADDLE_COMMAND_STAND;
    TEST_ASSERT_EQUAL_HEX32(0, tick(80000));
    command = (saddle_command_t){SADDLE_COMMAND_WALK, 1.2f, 0.1f, 0.0f};
    TEST_ASSERT_EQUAL_HEX32(0, tick(80000));
}

static void test_usable_commands(void)
{
    const struct {
        saddle_command_t command;
        bool usable;
    } table[] = {
        {{SADDLE_COMMAND_STAND, 0.0f, 0.0f, 0.0f}, true},
        {{SADDLE_COMMAND_WALK, 1.2f, 0.1f, 0.0f}, true},
        {{SADDLE_COMMAND_WALK, -5.0f, -1.0f, 0.0f}, true},
        {{SADDLE_COMMAND_WALK, 1e6f, 1e6f, 0.0f}, true},
        {{2, 1.2f, 0.1f, 0.0f}, false},
        {{255, 1.2f, 0.1f, 0.0f}, false},
        {{SADDLE_COMMAND_WALK, NAN, 0.1f, 0.0f}, false},
        {{SADDLE_COMMAND_WALK, 1.2f, NAN, 0.0f}, false},
        {{SADDLE_COMMAND_STAND, NAN, NAN, 0.0f}, true},
        {{SADDLE_COMMAND_WALK, INFINITY, 0.1f, 0.0f}, false},
        {{SADDLE_COMMAND_WALK, 1.2f, -INFINITY, 0.0f}, false},
        {{SADDLE_COMMAND_WALK, 1.2f, 0.1f, -1e6f}, true},
        {{SADDLE_COMMAND_WALK, 1.2f, 0.1f, NAN}, false},
        {{SADDLE_COMMAND_STAND, 1.2f, 0.1f, NAN}, true},
    };
    for (size_t i = 0; i < COUNT_OF(table); i++) {
        TEST_ASSERT_EQUAL(table[i].usable, saddle_command_usable(&table[i].command));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_constant_speed_is_the_closed_form);
    RUN_TEST(test_velocities_are_derivatives);
    RUN_TEST(test_vertical_excursion_is_as_documented);
    RUN_TEST(test_cycloid_excursion_is_delta_z_and_the_ankle_is_real_everywhere);
    RUN_TEST(test_shape_is_in_the_steady_plan);
    RUN_TEST(test_swing_of_a_person_is_in_the_steady_plan);
    RUN_TEST(test_heel_strikes_at_its_share_of_a_step);
    RUN_TEST(test_heel_strikes_after_the_foot_carries);
    RUN_TEST(test_cycloid_beyond_the_ankle_is_reported);
    RUN_TEST(test_toe_off_limit_is_reported);
    RUN_TEST(test_start_change_and_stop_are_smooth_in_every_ankle);
    RUN_TEST(test_stop_at_any_moment_ends_side_by_side);
    RUN_TEST(test_command_at_any_moment_takes_effect);
    RUN_TEST(test_restart_while_stopping_is_smooth);
    RUN_TEST(test_stop_slows_no_further_than_a_step_can_brake);
    RUN_TEST(test_stop_that_cannot_brake_in_time_brakes_no_longer);
    RUN_TEST(test_stop_of_a_slow_walk_stays_slow);
    RUN_TEST(test_ticks_of_any_length_start_alike);
    RUN_TEST(test_stop_while_starting);
    RUN_TEST(test_start_after_an_unmeasured_walk_uses_no_old_landing);
    RUN_TEST(test_start_stands_then_shifts_then_steps);
    RUN_TEST(test_measured_feet_give_the_nearest_phase);
    RUN_TEST(test_feet_from_which_no_walk_can_start_are_reported);
    RUN_TEST(test_short_landing_does_not_stop_the_plan_at_once);
    RUN_TEST(test_misplaced_landing_is_where_the_next_step_starts);
    RUN_TEST(test_landing_without_a_possible_next_step_is_reported_and_not_used);
    RUN_TEST(test_landing_is_taken_over_early_with_both_feet_on_the_ground_only);
    RUN_TEST(test_events_are_predicted_between_ticks);
    RUN_TEST(test_sides_step_by_their_own_factors);
    RUN_TEST(test_speed_is_limited_to_what_is_feasible);
    RUN_TEST(test_longer_side_stays_within_reach_up_to_the_ceiling);
    RUN_TEST(test_turning_rate_is_limited_to_what_the_speed_bears);
    RUN_TEST(test_joined_turn_is_steady);
    RUN_TEST(test_heel_strike_angle_is_limited);
    RUN_TEST(test_limits_of_one_command_end_with_it);
    RUN_TEST(test_usable_commands);
    return UNITY_END();
}
