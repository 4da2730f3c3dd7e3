/** The supervisor: which input is refused and why, what is scored then, and how steps are followed. */
#include "core_test.h"

#include <saddlewalk/supervisor.h>

#define MAX_AGE_US 240000u
#define PLANNED_M_S 1.2f

static const float DT_S = 0.08f;

static saddle_config_t config;
static saddle_body_t body;
static saddle_supervisor_t supervisor;
static saddle_measurement_t measured;
static saddle_scores_t scores;

/* Mid-step, both feet down, CoM a little behind the middle. */
static saddle_measurement_t good_measurement(void)
{
    return (saddle_measurement_t){
        .com = {.height_m = 1.0f, .velocity_m_s = {1.1f, 0.05f}},
        .foot = {{.cop_m = {0.35f, 0.06f}, .contact = true},
                 {.cop_m = {-0.25f, -0.05f}, .contact = true}},
    };
}

void setUp(void)
{
    config = paper_config();
    body = saddle_body(&config);
    memset(&supervisor, 0, sizeof supervisor);
    measured = good_measurement();
}

void tearDown(void) {}

static uint32_t update(void)
{
    memset(&scores, 0xA5, sizeof scores);
    scores.bos.defined = false; /* any bytes but in a bool, where only 0 and 1 are values */
    const uint32_t faults = saddle_supervisor_judge(&config, &measured);
    return saddle_supervisor_update(&supervisor, &config, &body, &measured, faults, DT_S,
                                    PLANNED_M_S, &scores);
}

static const uint32_t UNTIL_STEP = (uint32_t)SADDLE_VALID_ALL & ~(uint32_t)SADDLE_VALID_STEP;
static const uint32_t WITHOUT_COM = SADDLE_VALID_V_COMP | SADDLE_VALID_S_SW |
                                    SADDLE_VALID_MOS_COM | SADDLE_VALID_GRAVITY;

static void strike_with(saddle_side_t side)
{
    measured.foot[side].contact = false;
    update();
    measured.foot[side].contact = true;
    update();
}

static void test_good_measurement_has_no_fault_and_every_score_but_the_step_s(void)
{
    TEST_ASSERT_EQUAL_HEX32(0, update());
    TEST_ASSERT_EQUAL_HEX32(UNTIL_STEP, scores.valid);
    const double width = 0.10;
    const double frequency = sqrt(GRAVITY / (0.57 * 1.79));
    ASSERT_SAME_FLOAT(PLANNED_M_S, scores.v_comp_m_s);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 1.0 - 2.0 * 0.005 / width, scores.s_sw);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 1.1 / frequency, scores.xcom_m.x);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.05 / frequency, scores.xcom_m.y);
    /* The right foot is nearer: f = m g (0 - x_st) / z. */
    const double z = sqrt(pow(0.57 * 1.79, 2) - 0.25 * 0.25 - 0.05 * 0.05);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 63.3 * GRAVITY * 0.25 / z, scores.gravity_n.x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 63.3 * GRAVITY * 0.05 / z, scores.gravity_n.y);
    /* On the line between the feet, 55 mm off their middle: d_h - |x_S|. */
    const double distance = hypot(0.60, 0.11);
    const double x_s = fabs(-0.05 * 0.11 / distance + 0.005 * 0.60 / distance);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.1 - x_s, scores.mos_com_m);
    ASSERT_SAME_FLOAT(saddle_bos_margin_m(&scores.bos, scores.xcom_m), scores.mos_xcom_m);
}

static void test_age_at_the_limit_is_fresh_and_above_it_stale(void)
{
    uint32_t *const ages[] = {&measured.com.age_us, &measured.foot[SADDLE_LEFT].age_us,
                              &measured.foot[SADDLE_RIGHT].age_us};
    const uint32_t faults[] = {SADDLE_FAULT_COM_STALE, SADDLE_FAULT_LEFT_STALE,
                               SADDLE_FAULT_RIGHT_STALE};
    for (size_t i = 0; i < COUNT_OF(ages); i++) {
        measured = good_measurement();
        *ages[i] = MAX_AGE_US;
        TEST_ASSERT_EQUAL_HEX32(0, update());
        *ages[i] = MAX_AGE_US + 1u;
        TEST_ASSERT_EQUAL_HEX32(faults[i], update());
        *ages[i] = SADDLE_AGE_NEVER_US;
        TEST_ASSERT_EQUAL_HEX32(faults[i], update());
    }
}

/* Every measured number, the values that it may have, and the fault of any other. */
typedef struct {
    float *number;
    float min, max;
    uint32_t fault;
} field_t;

#define FIELD_COUNT 7

static void list_fields(field_t fields[FIELD_COUNT])
{
    const field_t list[FIELD_COUNT] = {
        {&measured.com.height_m, 0.1f, 2.5f, SADDLE_FAULT_COM_RANGE},
        {&measured.com.velocity_m_s.x, -6.0f, 6.0f, SADDLE_FAULT_COM_RANGE},
        {&measured.com.velocity_m_s.y, -6.0f, 6.0f, SADDLE_FAULT_COM_RANGE},
        {&measured.foot[SADDLE_LEFT].cop_m.x, -2.5f, 2.5f, SADDLE_FAULT_LEFT_RANGE},
        {&measured.foot[SADDLE_LEFT].cop_m.y, -2.5f, 2.5f, SADDLE_FAULT_LEFT_RANGE},
        {&measured.foot[SADDLE_RIGHT].cop_m.x, -2.5f, 2.5f, SADDLE_FAULT_RIGHT_RANGE},
        {&measured.foot[SADDLE_RIGHT].cop_m.y, -2.5f, 2.5f, SADDLE_FAULT_RIGHT_RANGE},
    };
    memcpy(fields, list, sizeof list);
}

static void assert_finite_scores(void)
{
    const float numbers[] = {scores.v_comp_m_s,   scores.s_pend,       scores.s_jump,
                             scores.s_sw,         scores.mos_com_m,    scores.mos_xcom_m,
                             scores.gravity_n.x,  scores.gravity_n.y,  scores.xcom_m.x,
                             scores.xcom_m.y,     scores.bos.centre_m.x, scores.bos.centre_m.y,
                             scores.bos.axis_x.x, scores.bos.axis_x.y, scores.bos.radius_m};
    for (size_t i = 0; i < COUNT_OF(numbers); i++) {
        TEST_ASSERT_TRUE(isfinite(numbers[i]));
    }
}

static void test_absurd_number_in_any_field_is_a_range_fault_and_no_score(void)
{
    field_t fields[FIELD_COUNT];
    list_fields(fields);
    for (size_t i = 0; i < FIELD_COUNT; i++) {
        const float bad[] = {NAN, -NAN, INFINITY, -INFINITY, 1e30f, -1e30f, 3.4e38f,
                             nextafterf(fields[i].min, -INFINITY),
                             nextafterf(fields[i].max, INFINITY)};
        const bool com = fields[i].fault == SADDLE_FAULT_COM_RANGE;
        for (size_t k = 0; k < COUNT_OF(bad); k++) {
            measured = good_measurement();
            *fields[i].number = bad[k];
            TEST_ASSERT_EQUAL_HEX32(fields[i].fault, update());
            TEST_ASSERT_EQUAL_HEX32(com ? WITHOUT_COM : (uint32_t)SADDLE_VALID_V_COMP,
                                    scores.valid);
            assert_finite_scores();
        }
        const float ends[] = {fields[i].min, fields[i].max};
        for (size_t k = 0; k < COUNT_OF(ends); k++) {
            measured = good_measurement();
            *fields[i].number = ends[k];
            TEST_ASSERT_EQUAL_HEX32(0, update());
        }
    }
}

static void test_stale_measurement_is_not_also_out_of_range(void)
{
    measured.com.height_m = NAN;
    measured.com.age_us = SADDLE_AGE_NEVER_US;
    TEST_ASSERT_EQUAL_HEX32(SADDLE_FAULT_COM_STALE, update());
}

static void test_faults_add_up(void)
{
    measured.com.age_us = SADDLE_AGE_NEVER_US;
    measured.foot[SADDLE_LEFT].age_us = SADDLE_AGE_NEVER_US;
    measured.foot[SADDLE_RIGHT].cop_m.x = NAN;
    TEST_ASSERT_EQUAL_HEX32(
        SADDLE_FAULT_COM_STALE | SADDLE_FAULT_LEFT_STALE | SADDLE_FAULT_RIGHT_RANGE, update());
}

static void test_recovery_is_at_once_and_complete(void)
{
    update();
    const saddle_scores_t before = scores;
    measured.com.velocity_m_s.x = NAN;
    measured.foot[SADDLE_LEFT].cop_m.y = INFINITY;
    measured.foot[SADDLE_RIGHT].age_us = SADDLE_AGE_NEVER_US;
    TEST_ASSERT_NOT_EQUAL_UINT32(0, update());
    measured = good_measurement();
    TEST_ASSERT_EQUAL_HEX32(0, update());
    TEST_ASSERT_EQUAL_HEX32(before.valid, scores.valid);
    ASSERT_SAME_FLOAT(before.mos_xcom_m, scores.mos_xcom_m);
    ASSERT_SAME_FLOAT(before.gravity_n.x, scores.gravity_n.x);
    ASSERT_SAME_FLOAT(before.s_sw, scores.s_sw);
}

static void test_feet_together_have_no_saddle_space(void)
{
    measured.foot[SADDLE_RIGHT].cop_m = measured.foot[SADDLE_LEFT].cop_m;
    TEST_ASSERT_EQUAL_HEX32(SADDLE_FAULT_FEET_TOGETHER, update());
    TEST_ASSERT_EQUAL_HEX32(SADDLE_VALID_V_COMP | SADDLE_VALID_S_SW, scores.valid);
    TEST_ASSERT_FALSE(scores.bos.defined);
    assert_finite_scores();
}

static void test_heel_strike_opens_the_step_scores(void)
{
    update();
    TEST_ASSERT_EQUAL_HEX32(UNTIL_STEP, scores.valid); /* contact from the start is no strike */
    strike_with(SADDLE_LEFT);
    TEST_ASSERT_EQUAL_HEX32(SADDLE_VALID_ALL, scores.valid);
    /* M = 0.3 m at the planned 1.2 m/s. */
    const double frequency = sqrt(GRAVITY / (0.57 * 1.79));
    const double reference = 0.1802 * 1.2 + 0.1351;
    const double xcom = 1.2 / (2.0 * frequency);
    const double reach = 3.0 / (2.0 * frequency);
    TEST_ASSERT_DOUBLE_WITHIN(2e-6, (0.3 - xcom) / (reference - xcom), scores.s_pend);
    TEST_ASSERT_DOUBLE_WITHIN(2e-6, (0.3 - reach) / (reference - reach), scores.s_jump);
}

static void test_half_step_is_that_of_the_last_heel_strike(void)
{
    update();
    strike_with(SADDLE_LEFT);
    ASSERT_SAME_FLOAT(0.3f, supervisor.half_step_m);
    measured.foot[SADDLE_LEFT].cop_m.x = 0.1f; /* the body moves on, the half step stays */
    measured.foot[SADDLE_RIGHT].cop_m.x = -0.4f;
    update();
    ASSERT_SAME_FLOAT(0.3f, supervisor.half_step_m);
    measured.foot[SADDLE_RIGHT].cop_m.x = 0.3f;
    strike_with(SADDLE_RIGHT);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.1, supervisor.half_step_m);
}

static void test_half_step_needs_both_feet(void)
{
    measured.foot[SADDLE_RIGHT].age_us = SADDLE_AGE_NEVER_US;
    strike_with(SADDLE_LEFT);
    TEST_ASSERT_FALSE(supervisor.half_step_known);
    TEST_ASSERT_EQUAL_HEX32(SADDLE_VALID_V_COMP, scores.valid);
}

static void test_strike_during_an_outage_is_seen_when_the_foot_is_back(void)
{
    measured.foot[SADDLE_LEFT].contact = false;
    update();
    measured.foot[SADDLE_LEFT].contact = true;
    measured.foot[SADDLE_LEFT].age_us = SADDLE_AGE_NEVER_US;
    update();
    TEST_ASSERT_FALSE(supervisor.half_step_known);
    measured.foot[SADDLE_LEFT].age_us = 0;
    update();
    TEST_ASSERT_TRUE(supervisor.half_step_known);
}

static void test_v_comp_is_the_planner_s_until_a_step_is_complete_then_the_mean(void)
{
    update();
    strike_with(SADDLE_LEFT); /* opens the first step at 1.1 m/s */
    ASSERT_SAME_FLOAT(PLANNED_M_S, scores.v_comp_m_s);
    measured.foot[SADDLE_RIGHT].contact = false;
    const float speeds[] = {1.2f, 1.4f, 1.0f, 0.9f};
    for (size_t i = 0; i < COUNT_OF(speeds); i++) {
        measured.com.velocity_m_s.x = speeds[i];
        update();
        ASSERT_SAME_FLOAT(PLANNED_M_S, scores.v_comp_m_s);
    }
    measured.foot[SADDLE_RIGHT].contact = true;
    measured.com.velocity_m_s.x = 1.3f;
    update();
    /* Trapezoids: (1.1/2 + 1.2 + 1.4 + 1.0 + 0.9 + 1.3/2) / 5. */
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 1.14, scores.v_comp_m_s);
    measured.com.velocity_m_s.x = 0.5f;
    measured.foot[SADDLE_LEFT].contact = false;
    update();
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 1.14, scores.v_comp_m_s);
    measured.foot[SADDLE_LEFT].contact = true;
    update(); /* the second step: (1.3/2 + 0.5 + 0.5/2) / 2, nothing left over from the first */
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.7, scores.v_comp_m_s);
}

static void test_step_with_a_gap_in_the_velocity_gives_no_v_comp(void)
{
    strike_with(SADDLE_LEFT);
    measured.com.age_us = SADDLE_AGE_NEVER_US;
    update();
    measured.com.age_us = 0;
    strike_with(SADDLE_RIGHT);
    TEST_ASSERT_FALSE(supervisor.v_comp_known);
    ASSERT_SAME_FLOAT(PLANNED_M_S, scores.v_comp_m_s);
    strike_with(SADDLE_LEFT); /* the next whole step does */
    TEST_ASSERT_TRUE(supervisor.v_comp_known);
    ASSERT_SAME_FLOAT(1.1f, scores.v_comp_m_s);
}

static void test_step_that_begins_without_a_velocity_gives_no_v_comp(void)
{
    measured.com.age_us = SADDLE_AGE_NEVER_US;
    strike_with(SADDLE_LEFT);
    measured.com.age_us = 0;
    strike_with(SADDLE_RIGHT);
    TEST_ASSERT_FALSE(supervisor.v_comp_known);
}

static void test_speed_that_cannot_be_walked_is_said(void)
{
    const float speeds[] = {-0.5f, 0.0f, 2.5f};
    for (size_t i = 0; i < COUNT_OF(speeds); i++) {
        setUp();
        measured.com.velocity_m_s.x = speeds[i];
        strike_with(SADDLE_LEFT);
        measured.foot[SADDLE_RIGHT].contact = false;
        update();
        measured.foot[SADDLE_RIGHT].contact = true;
        TEST_ASSERT_EQUAL_HEX32(SADDLE_FAULT_SPEED_INFEASIBLE, update());
        TEST_ASSERT_EQUAL_HEX32(UNTIL_STEP, scores.valid);
        ASSERT_SAME_FLOAT(0.0f, scores.s_pend);
        ASSERT_SAME_FLOAT(0.0f, scores.s_jump);
    }
}

static void test_nobody_walking_and_nothing_planned_has_no_speed(void)
{
    saddle_supervisor_update(&supervisor, &config, &body, &measured, 0, DT_S, 0.0f, &scores);
    TEST_ASSERT_EQUAL_HEX32(
        SADDLE_VALID_MOS_COM | SADDLE_VALID_MOS_XCOM | SADDLE_VALID_GRAVITY, scores.valid);
    ASSERT_SAME_FLOAT(0.0f, scores.v_comp_m_s);
}

static void test_walk_goes_on_having_a_speed_when_nothing_is_planned(void)
{
    strike_with(SADDLE_LEFT);
    strike_with(SADDLE_RIGHT);
    saddle_supervisor_update(&supervisor, &config, &body, &measured, 0, DT_S, 0.0f, &scores);
    TEST_ASSERT_EQUAL_HEX32(SADDLE_VALID_ALL, scores.valid);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 1.1, scores.v_comp_m_s);
}

/* Each result needs exactly what it is made of; what is not known holds NaN and is not read. */
static void test_validity_follows_from_what_is_known(void)
{
    for (uint32_t known = 0; known <= (uint32_t)SADDLE_KNOWN_ALL; known++) {
        const bool feet = (known & SADDLE_KNOWN_FEET) != 0u;
        const bool velocity = (known & SADDLE_KNOWN_VELOCITY) != 0u;
        const bool speed = (known & SADDLE_KNOWN_SPEED) != 0u;
        const bool half_step = (known & SADDLE_KNOWN_HALF_STEP) != 0u;
        const saddle_posture_t posture = {
            .com_velocity_m_s = {velocity ? 1.2f : NAN, velocity ? 0.0f : NAN},
            .cop_m = {{feet ? 0.3f : NAN, feet ? 0.05f : NAN},
                      {feet ? -0.3f : NAN, feet ? -0.05f : NAN}},
            .v_comp_m_s = speed ? 1.2f : NAN,
            .half_step_m = half_step ? 0.3f : NAN,
            .known = known,
        };
        scores = saddle_score_posture(&config, &body, &posture);
        uint32_t expected = 0;
        expected |= speed ? (uint32_t)SADDLE_VALID_V_COMP : 0u;
        expected |= speed && half_step ? (uint32_t)SADDLE_VALID_STEP : 0u;
        expected |= speed && feet ? (uint32_t)SADDLE_VALID_S_SW : 0u;
        expected |= feet ? (uint32_t)SADDLE_VALID_MOS_COM | (uint32_t)SADDLE_VALID_GRAVITY : 0u;
        expected |= feet && velocity ? (uint32_t)SADDLE_VALID_MOS_XCOM : 0u;
        TEST_ASSERT_EQUAL_HEX32(expected, scores.valid);
        assert_finite_scores();
        TEST_ASSERT_EQUAL(velocity, scores.xcom_m.x > 0.0f);
        TEST_ASSERT_EQUAL(speed && half_step, scores.s_pend > 0.0f);
        TEST_ASSERT_EQUAL(feet, scores.bos.defined);
    }
}

static void test_com_out_of_the_pendulum_s_reach_has_no_gravity(void)
{
    measured.foot[SADDLE_LEFT].cop_m.x = 1.5f;
    measured.foot[SADDLE_RIGHT].cop_m.x = 1.2f;
    TEST_ASSERT_EQUAL_HEX32(0, update());
    TEST_ASSERT_EQUAL_HEX32(UNTIL_STEP & ~(uint32_t)SADDLE_VALID_GRAVITY, scores.valid);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, scores.gravity_n.x);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, scores.gravity_n.y);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_good_measurement_has_no_fault_and_every_score_but_the_step_s);
    RUN_TEST(test_age_at_the_limit_is_fresh_and_above_it_stale);
    RUN_TEST(test_absurd_number_in_any_field_is_a_range_fault_and_no_score);
    RUN_TEST(test_stale_measurement_is_not_also_out_of_range);
    RUN_TEST(test_faults_add_up);
    RUN_TEST(test_recovery_is_at_once_and_complete);
    RUN_TEST(test_feet_together_have_no_saddle_space);
    RUN_TEST(test_heel_strike_opens_the_step_scores);
    RUN_TEST(test_half_step_is_that_of_the_last_heel_strike);
    RUN_TEST(test_half_step_needs_both_feet);
    RUN_TEST(test_strike_during_an_outage_is_seen_when_the_foot_is_back);
    RUN_TEST(test_v_comp_is_the_planner_s_until_a_step_is_complete_then_the_mean);
    RUN_TEST(test_step_with_a_gap_in_the_velocity_gives_no_v_comp);
    RUN_TEST(test_step_that_begins_without_a_velocity_gives_no_v_comp);
    RUN_TEST(test_speed_that_cannot_be_walked_is_said);
    RUN_TEST(test_nobody_walking_and_nothing_planned_has_no_speed);
    RUN_TEST(test_walk_goes_on_having_a_speed_when_nothing_is_planned);
    RUN_TEST(test_validity_follows_from_what_is_known);
    RUN_TEST(test_com_out_of_the_pendulum_s_reach_has_no_gravity);
    return UNITY_END();
}
