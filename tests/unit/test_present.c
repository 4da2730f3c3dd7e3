/** What was measured some time ago, brought forward: against the pendulum's closed form in doubles. */
#include "core_test.h"

#include "balance/present.h"
#include "motion/plan_output.h"
#include "motion/planner.h"

#define TICK_US 80000u
#define SPEED_M_S 1.2f
#define HEIGHT_M 1.01f

typedef struct {
    double x, y;
} point_t;

/* Of a CoM from the reference's. */
typedef struct {
    point_t com_m, xcom_m;
} departure_t;

static saddle_config_t config;
static saddle_planner_t planner;
static saddle_past_t past;
static saddle_plan_t plan;
static saddle_measurement_t present;

static void tick_of(uint32_t dt_us)
{
    const saddle_command_t command = {(uint8_t)SADDLE_COMMAND_WALK, SPEED_M_S, 0.17f, 0.0f};
    saddle_planner_update(&planner, model_of(&config), &command, NULL, dt_us);
    saddle_plan_write(&planner, model_of(&config), &plan);
    saddle_remember_plan(&past, &plan, (uint32_t)plan.origin_x_nm, dt_us);
}

/* A steady walk with ticks of dt_us, up to a time of it. */
static void walk(uint32_t time_us, uint32_t dt_us)
{
    const saddle_command_t command = {(uint8_t)SADDLE_COMMAND_WALK, SPEED_M_S, 0.17f, 0.0f};
    memset(&past, 0, sizeof past);
    memset(&planner, 0, sizeof planner);
    saddle_planner_join(&planner, model_of(&config), &command);
    for (uint32_t us = 0; us < time_us; us += dt_us) {
        tick_of(dt_us);
    }
}

void setUp(void)
{
    config = paper_config();
    walk(3 * TICK_US, TICK_US);
}

void tearDown(void) {}

static double frequency(void)
{
    return (double)model_of(&config)->body.natural_frequency_rad_s;
}

/* What a wearer measures who departs from the plan's reference by so much; the feet are the plan's. */
static saddle_measurement_t measured_of(const saddle_plan_t *of, const departure_t *departure,
                                        uint32_t age_us)
{
    const saddle_reference_t *reference = &of->reference;
    const double com_x = (double)reference->com_m.x + departure->com_m.x;
    const double com_y = (double)reference->com_m.y + departure->com_m.y;
    const double xcom_x = (double)reference->xcom_m.x + departure->xcom_m.x;
    const double xcom_y = (double)reference->xcom_m.y + departure->xcom_m.y;
    saddle_measurement_t measured = {.com = {.height_m = HEIGHT_M, .age_us = age_us}};
    measured.com.velocity_m_s.x = (float)(frequency() * (xcom_x - com_x));
    measured.com.velocity_m_s.y = (float)(frequency() * (xcom_y - com_y));
    for (int side = 0; side < 2; side++) {
        measured.foot[side].cop_m.x = (float)((double)of->foot_m[side].x - com_x);
        measured.foot[side].cop_m.y = (float)((double)of->foot_m[side].y - com_y);
        measured.foot[side].contact = reference->load[side] > 0.0f;
        measured.foot[side].age_us = age_us;
    }
    return measured;
}

/* The pendulum's closed form over half of an age, which the wearer corrects the other half of. */
static departure_t grown(const departure_t *departure, uint32_t age_us)
{
    const double c = cosh(frequency() * 0.5e-6 * age_us);
    const double s = sinh(frequency() * 0.5e-6 * age_us);
    const point_t ahead = {departure->xcom_m.x - departure->com_m.x,
                           departure->xcom_m.y - departure->com_m.y};
    const departure_t later = {
        .com_m = {c * departure->com_m.x + s * ahead.x, c * departure->com_m.y + s * ahead.y},
        .xcom_m = {(c + s) * departure->xcom_m.x, (c + s) * departure->xcom_m.y}};
    return later;
}

static const departure_t DEPARTURE = {{0.02, -0.01}, {0.05, 0.03}};
static const departure_t NONE = {{0.0, 0.0}, {0.0, 0.0}};

static saddle_side_t bring_forward(const saddle_measurement_t *measured)
{
    memset(&present, 0xFF, sizeof present);
    return saddle_bring_forward(&past, model_of(&config), measured, &present);
}

static void assert_measured(double tolerance, const saddle_measurement_t *expected)
{
    TEST_ASSERT_DOUBLE_WITHIN(4.0 * tolerance, expected->com.velocity_m_s.x,
                              present.com.velocity_m_s.x);
    TEST_ASSERT_DOUBLE_WITHIN(4.0 * tolerance, expected->com.velocity_m_s.y,
                              present.com.velocity_m_s.y);
    for (int side = 0; side < 2; side++) {
        TEST_ASSERT_DOUBLE_WITHIN(tolerance, expected->foot[side].cop_m.x,
                                  present.foot[side].cop_m.x);
        TEST_ASSERT_DOUBLE_WITHIN(tolerance, expected->foot[side].cop_m.y,
                                  present.foot[side].cop_m.y);
        TEST_ASSERT_EQUAL(expected->foot[side].contact, present.foot[side].contact);
    }
}

/* Two ticks old in every tick of three steps, so also over landings: what the plan and the pendulum make
 * of it, to some roundings of distances of 1 m, of which velocities are w = 3.1 times the difference. */
static void test_a_departure_from_the_plan_grows_as_a_pendulum(void)
{
    int landings = 0;
    for (int k = 0; k < 24; k++) {
        const saddle_plan_t then = plan;
        tick_of(TICK_US);
        tick_of(TICK_US);
        const saddle_measurement_t measured = measured_of(&then, &DEPARTURE, 2 * TICK_US);
        const departure_t later = grown(&DEPARTURE, 2 * TICK_US);
        const saddle_measurement_t expected = measured_of(&plan, &later, 2 * TICK_US);
        TEST_ASSERT_EQUAL(then.support, bring_forward(&measured));
        assert_measured(2e-6, &expected);
        TEST_ASSERT_EQUAL_UINT32(measured.com.age_us, present.com.age_us);
        ASSERT_SAME_FLOAT(HEIGHT_M, present.com.height_m);
        landings += then.support != plan.support ? 1 : 0;
    }
    TEST_ASSERT_GREATER_THAN_INT(5, landings);
}

/* A wearer on the plan whose parts were each measured at another of the last ticks. */
static void test_each_part_is_brought_forward_by_its_own_age(void)
{
    for (int k = 0; k < 24; k++) {
        saddle_measurement_t measured = measured_of(&plan, &NONE, 2 * TICK_US);
        tick_of(TICK_US);
        const saddle_measurement_t later = measured_of(&plan, &NONE, TICK_US);
        tick_of(TICK_US);
        const saddle_measurement_t expected = measured_of(&plan, &NONE, 0);
        if (k % 2 == 0) {
            measured.foot[SADDLE_LEFT] = later.foot[SADDLE_LEFT];
        } else {
            measured.com = later.com;
            measured.foot[SADDLE_LEFT] = expected.foot[SADDLE_LEFT];
        }
        bring_forward(&measured);
        assert_measured(2e-6, &expected);
    }
}

/* The plan so long after the last tick, which is before the next. */
static saddle_plan_t plan_after(uint32_t after_us)
{
    const saddle_planner_t kept = planner;
    saddle_plan_t after;
    saddle_planner_advance(&planner, model_of(&config), after_us);
    saddle_plan_write(&planner, model_of(&config), &after);
    planner = kept;
    return after;
}

/* Between them the plan is joined by straight lines. A foot that comes down at up to 4 m/s and stops is off
 * them by 4 m/s 80 ms / 4. */
static void assert_near_the_plan(uint32_t age_us, const saddle_plan_t *then)
{
    const saddle_measurement_t measured = measured_of(then, &NONE, age_us);
    const saddle_measurement_t expected = measured_of(&plan, &NONE, age_us);
    bring_forward(&measured);
    for (int side = 0; side < 2; side++) {
        TEST_ASSERT_DOUBLE_WITHIN(0.08, expected.foot[side].cop_m.x, present.foot[side].cop_m.x);
    }
}

static void test_between_two_ticks_the_plan_moves_evenly(void)
{
    for (int k = 0; k < 24; k++) {
        const saddle_plan_t then = plan_after(TICK_US / 2);
        tick_of(TICK_US);
        assert_near_the_plan(TICK_US / 2, &then);
    }
}

/* Every fourth of ticks of 20 ms is remembered: with only the last ones, 60 ms, the CoM would be 0.12 m
 * off. */
static void test_close_ticks_reach_as_far_back(void)
{
    walk(3 * TICK_US, TICK_US / 4);
    for (int k = 0; k < 12; k++) {
        const saddle_plan_t then = plan;
        for (int tick = 0; tick < 8; tick++) {
            tick_of(TICK_US / 4);
        }
        assert_near_the_plan(2 * TICK_US, &then);
    }
}

static void test_nothing_is_brought_further_forward_than_a_fifth_of_a_second(void)
{
    saddle_measurement_t measured = measured_of(&plan, &DEPARTURE, 200000u);
    bring_forward(&measured);
    const saddle_measurement_t at_bound = present;
    measured.com.age_us = 240000u;
    bring_forward(&measured);
    ASSERT_SAME_FLOAT(at_bound.com.velocity_m_s.x, present.com.velocity_m_s.x);
    ASSERT_SAME_FLOAT(at_bound.foot[0].cop_m.x, present.foot[0].cop_m.x);
    ASSERT_SAME_FLOAT(at_bound.foot[1].cop_m.y, present.foot[1].cop_m.y);
}

static void test_no_more_plans_are_remembered_than_there_is_room_for(void)
{
    for (uint32_t k = 0; k < 3u * SADDLE_PAST_PLANS; k++) {
        saddle_remember_plan(&past, &plan, (uint32_t)plan.origin_x_nm, TICK_US);
        TEST_ASSERT_TRUE(past.count <= SADDLE_PAST_PLANS && past.newest < SADDLE_PAST_PLANS);
    }
    TEST_ASSERT_EQUAL_UINT8(SADDLE_PAST_PLANS, past.count);
}

/* As after the first tick: the plan stands still, and only the departure goes on. */
static void test_before_a_plan_is_remembered_it_counts_as_the_present_one(void)
{
    memset(&past, 0, sizeof past);
    saddle_remember_plan(&past, &plan, (uint32_t)plan.origin_x_nm, 0);
    const saddle_measurement_t measured = measured_of(&plan, &DEPARTURE, TICK_US);
    const departure_t later = grown(&DEPARTURE, TICK_US);
    const saddle_measurement_t expected = measured_of(&plan, &later, TICK_US);
    TEST_ASSERT_EQUAL(plan.support, bring_forward(&measured));
    assert_measured(2e-6, &expected);
}

/* Of a wearer who stepped early nobody knows where the CoP is: the departure from the plan stays. */
static void assert_early_landing_stays(saddle_side_t swing)
{
    while (plan.support == (uint8_t)swing || plan.reference.load[swing] > 0.0f) {
        tick_of(TICK_US);
    }
    const saddle_plan_t then = plan;
    tick_of(TICK_US);
    TEST_ASSERT_EQUAL_INT64(then.origin_x_nm, plan.origin_x_nm);
    saddle_measurement_t measured = measured_of(&then, &DEPARTURE, TICK_US);
    measured.foot[swing].contact = true;
    saddle_measurement_t expected = measured_of(&plan, &DEPARTURE, TICK_US);
    expected.foot[swing] = measured.foot[swing];
    expected.foot[swing].cop_m.x -= plan.reference.com_m.x - then.reference.com_m.x;
    expected.foot[swing].cop_m.y -= plan.reference.com_m.y - then.reference.com_m.y;
    bring_forward(&measured);
    assert_measured(2e-6, &expected);
}

static void test_a_foot_that_landed_early_stays_and_nothing_grows(void)
{
    assert_early_landing_stays(SADDLE_LEFT);
    assert_early_landing_stays(SADDLE_RIGHT);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_departure_from_the_plan_grows_as_a_pendulum);
    RUN_TEST(test_each_part_is_brought_forward_by_its_own_age);
    RUN_TEST(test_between_two_ticks_the_plan_moves_evenly);
    RUN_TEST(test_close_ticks_reach_as_far_back);
    RUN_TEST(test_nothing_is_brought_further_forward_than_a_fifth_of_a_second);
    RUN_TEST(test_no_more_plans_are_remembered_than_there_is_room_for);
    RUN_TEST(test_before_a_plan_is_remembered_it_counts_as_the_present_one);
    RUN_TEST(test_a_foot_that_landed_early_stays_and_nothing_grows);
    return UNITY_END();
}
