/** The reference by itself: the pendulum's equations, the soles, and what it does not follow. */
#include "core_test.h"

#include "motion/plan_output.h"
#include "motion/planner.h"
#include "motion/reference.h"

#define TICK_US 1000u
#define TICK_S 1e-3

static saddle_config_t config;
static saddle_planner_t planner;
static saddle_plan_t plan;

void setUp(void)
{
    config = paper_config();
    memset(&planner, 0, sizeof planner);
}

void tearDown(void) {}

/* A steady walk, some way into it. */
static void walk(float speed_m_s, uint32_t time_us)
{
    const saddle_command_t command = {(uint8_t)SADDLE_COMMAND_WALK, speed_m_s, 0.17f, 0.0f};
    saddle_planner_join(&planner, model_of(&config), &command);
    for (uint32_t us = 0; us < time_us; us += TICK_US) {
        saddle_planner_update(&planner, model_of(&config), &command, NULL, TICK_US);
    }
    saddle_plan_write(&planner, model_of(&config), &plan);
}

static saddle_reference_t reference_after(double after_s)
{
    saddle_reference_t reference;
    saddle_reference(model_of(&config), &plan, (float)after_s, &reference);
    return reference;
}

/* [E39] By the pendulum's closed form about a CoP that moves evenly over the millisecond. A float of the
 * distance is rounded to 6e-8, and a corner of the CoP's path lies within one of them: 3e-4 m. */
static void test_steady_reference_is_a_pendulum_about_its_cop(void)
{
    static const float speeds[] = {0.3f, 0.7f, 1.2f, 1.8f};
    for (size_t i = 0; i < COUNT_OF(speeds); i++) {
        walk(speeds[i], 3000000u);
        const double w = (double)model_of(&config)->body.natural_frequency_rad_s;
        int corners = 0;
        saddle_reference_t last = reference_after(0.0);
        for (int k = 1; k < 350; k++) {
            const saddle_reference_t next = reference_after(k * TICK_S);
            const double cop = 0.5 * ((double)last.cop_m.x + (double)next.cop_m.x);
            const double xcom = cop + ((double)last.xcom_m.x - cop) * exp(w * TICK_S);
            const double between = 0.5 * ((double)last.xcom_m.x + (double)next.xcom_m.x);
            const double com = between + ((double)last.com_m.x - between) * exp(-w * TICK_S);
            corners += fabs(xcom - (double)next.xcom_m.x) > 2e-6 ? 1 : 0;
            TEST_ASSERT_DOUBLE_WITHIN(3e-4, xcom, next.xcom_m.x);
            TEST_ASSERT_DOUBLE_WITHIN(2e-6, com, next.com_m.x);
            last = next;
        }
        TEST_ASSERT_TRUE(corners <= 2); /* of the landing, and of the crossing's end */
    }
}

static void test_cop_stays_on_the_soles_and_the_loads_add_up(void)
{
    const double sole = (double)config.cop_range_m + 1e-6;
    walk(1.2f, 3000000u);
    for (int k = 0; k < 350; k++) {
        const saddle_reference_t at = reference_after(k * TICK_S);
        TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 1.0, at.load[0] + at.load[1]);
        TEST_ASSERT_TRUE(at.load[0] >= 0.0f && at.load[1] >= 0.0f);
        if (at.load[plan.support] == 1.0f) {
            TEST_ASSERT_TRUE(fabs((double)at.cop_m.x) <= sole);
        }
    }
}

static void test_continued_reference_is_that_of_the_plan_then(void)
{
    walk(1.0f, 2500000u);
    for (int k = 0; k < 5; k++) {
        const saddle_reference_t foreseen = reference_after(0.08);
        const int64_t origin_nm = plan.origin_x_nm;
        walk(1.0f, 2580000u + 80000u * (uint32_t)k);
        const double moved = 1e-9 * (double)(plan.origin_x_nm - origin_nm);
        /* The plan's distance and after_s times its speed are rounded apart. */
        TEST_ASSERT_DOUBLE_WITHIN(5e-6, foreseen.xcom_m.x, moved + (double)plan.reference.xcom_m.x);
        TEST_ASSERT_DOUBLE_WITHIN(5e-6, foreseen.xcom_m.y, plan.reference.xcom_m.y);
    }
}

static void test_landing_that_was_moved_is_not_in_the_reference(void)
{
    walk(1.2f, 3000000u);
    while (planner.cycle.phase % 2u != 0u || planner.cycle.x_m < 0.05f) {
        saddle_planner_advance(&planner, model_of(&config), TICK_US);
    }
    saddle_plan_write(&planner, model_of(&config), &plan);
    const saddle_plan_t unmoved = plan;
    const saddle_vec2_t landing_m = saddle_unmoved_landing_m(&unmoved);
    ASSERT_SAME_FLOAT(unmoved.landing_m.x, landing_m.x);
    ASSERT_SAME_FLOAT(unmoved.landing_m.y, landing_m.y);
    plan.landing_m.x += 0.1f;
    plan.landing_m.y += 0.05f;
    for (int k = 0; k < 5; k++) { /* into the step after it */
        const saddle_reference_t moved = reference_after(0.08 * k);
        saddle_reference_t as_planned;
        saddle_reference(model_of(&config), &unmoved, 0.08f * (float)k, &as_planned);
        ASSERT_SAME_FLOAT(as_planned.xcom_m.x, moved.xcom_m.x);
        ASSERT_SAME_FLOAT(as_planned.cop_m.y, moved.cop_m.y);
    }
}

static void test_who_stands_is_at_rest_between_the_feet(void)
{
    saddle_planner_reset(&planner, model_of(&config));
    saddle_plan_write(&planner, model_of(&config), &plan);
    const saddle_reference_t at = reference_after(0.1);
    const double middle = 0.5 * ((double)plan.foot_m[0].y + (double)plan.foot_m[1].y);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, middle, at.com_m.y);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, middle, at.xcom_m.y);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, middle, at.cop_m.y);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.5, at.load[0]);
}

/* A plan without a step has no other landing than its own. */
static void test_a_plan_without_a_step_keeps_its_landing(void)
{
    memset(&plan, 0, sizeof plan);
    plan.landing_m = (saddle_vec2_t){0.3f, -0.1f};
    const saddle_vec2_t landing_m = saddle_unmoved_landing_m(&plan);
    TEST_ASSERT_EQUAL_FLOAT(0.3f, landing_m.x);
    TEST_ASSERT_EQUAL_FLOAT(-0.1f, landing_m.y);
}

/* [E47] By the last plan alone, as by the tick. The mismatch of the way's direction fades within a step: the place
 * of the CoM is then known to 2 mm. */
static void test_reference_follows_the_bent_way(void)
{
    const saddle_model_t *model = model_of(&config);
    saddle_command_t command = {(uint8_t)SADDLE_COMMAND_WALK, 0.8f, 0.17f, 0.4f};
    saddle_planner_join(&planner, model, &command);
    for (int tick = 0; tick < 6000; tick++) {
        if (tick == 1000 || tick == 3500) {
            command.turn_rate_rad_s = tick == 1000 ? 0.0f : -0.3f;
        }
        saddle_planner_update(&planner, model, &command, NULL, TICK_US);
        saddle_plan_write(&planner, model, &plan);
        saddle_plan_bend(&planner.cycle.way, model, &plan);
        saddle_reference_t now;
        saddle_reference_after_plan(model, &plan, 0.0f, &now);
        const double tolerance = tick < 1000 ? 5e-6 : 2e-3;
        TEST_ASSERT_DOUBLE_WITHIN(tolerance, plan.reference.com_m.x, now.com_m.x);
        TEST_ASSERT_DOUBLE_WITHIN(tolerance, plan.reference.com_m.y, now.com_m.y);
        TEST_ASSERT_DOUBLE_WITHIN(tolerance, plan.reference.xcom_m.x, now.xcom_m.x);
        TEST_ASSERT_DOUBLE_WITHIN(tolerance, plan.reference.xcom_m.y, now.xcom_m.y);
        TEST_ASSERT_DOUBLE_WITHIN(tolerance, plan.reference.cop_m.y, now.cop_m.y);
    }
    TEST_ASSERT_TRUE(plan.curvature_1_m[1] < -0.3f);
}

static double onward(double cop, double xcom, double w)
{
    return cop + (xcom - cop) * exp(w * TICK_S);
}

/* [E49] In a steady turn, by the same closed form on the ground. */
static void test_reference_in_a_turn_is_a_pendulum_about_its_cop(void)
{
    const saddle_model_t *model = model_of(&config);
    const double w = (double)model->body.natural_frequency_rad_s;
    const saddle_command_t command = {(uint8_t)SADDLE_COMMAND_WALK, 0.6f, 0.17f, -0.4f};
    saddle_planner_join(&planner, model, &command);
    for (int tick = 0; tick < 3000; tick++) {
        saddle_planner_update(&planner, model, &command, NULL, TICK_US);
    }
    saddle_plan_write(&planner, model, &plan);
    saddle_plan_bend(&planner.cycle.way, model, &plan);
    int corners = 0;
    saddle_reference_t last;
    saddle_reference_after_plan(model, &plan, 0.0f, &last);
    for (int k = 1; k < 700; k++) {
        saddle_reference_t next;
        saddle_reference_after_plan(model, &plan, (float)(k * TICK_S), &next);
        const double x =
            onward(0.5 * ((double)last.cop_m.x + (double)next.cop_m.x), (double)last.xcom_m.x, w);
        const double y =
            onward(0.5 * ((double)last.cop_m.y + (double)next.cop_m.y), (double)last.xcom_m.y, w);
        const double off = hypot(x - (double)next.xcom_m.x, y - (double)next.xcom_m.y);
        corners += off > 5e-6 ? 1 : 0;
        TEST_ASSERT_DOUBLE_WITHIN(3e-4, 0.0, off);
        last = next;
    }
    TEST_ASSERT_TRUE(corners <= 2); /* of the landing, and of the crossing's end */
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_steady_reference_is_a_pendulum_about_its_cop);
    RUN_TEST(test_cop_stays_on_the_soles_and_the_loads_add_up);
    RUN_TEST(test_continued_reference_is_that_of_the_plan_then);
    RUN_TEST(test_landing_that_was_moved_is_not_in_the_reference);
    RUN_TEST(test_a_plan_without_a_step_keeps_its_landing);
    RUN_TEST(test_who_stands_is_at_rest_between_the_feet);
    RUN_TEST(test_reference_follows_the_bent_way);
    RUN_TEST(test_reference_in_a_turn_is_a_pendulum_about_its_cop);
    return UNITY_END();
}
