/** The supervisor's scores: what is scored of which input, and the paper's verdict on it. */
#include "balance_twin.h"

#include "balance/comparison.h"
#include "balance/saddle_space.h"
#include "balance/scores.h"
#include "balance/supervisor.h"
#include "sense/plausibility.h"

#define PLANNED_M_S 1.2f

static const float DT_S = 0.08f;

static saddle_config_t config;
static saddle_body_t body;
static saddle_plausibility_t plausibility;
static saddle_supervisor_t supervisor;
static saddle_measurement_t measured;
static saddle_scores_t scores;
static saddle_verdict_t verdict;
static saddle_intent_t intent;

/* Mid-step, both feet down, CoM a little behind the middle. */
static saddle_measurement_t good_measurement(void)
{
    return (saddle_measurement_t){
        .com = {.height_m = 1.0f, .velocity_m_s = {1.1f, 0.05f}},
        .foot = {{.cop_m = {0.35f, 0.06f}, .contact = true},
                 {.cop_m = {-0.25f, -0.05f}, .contact = true}},
    };
}

static saddle_scores_t score(const saddle_posture_t *posture)
{
    saddle_scores_t scored;
    memset(&scored, 0, sizeof scored);
    saddle_support_t support;
    saddle_score_posture(model_of(&config), posture, &scored, &support);
    return scored;
}

void setUp(void)
{
    config = paper_config();
    body = model_of(&config)->body;
    memset(&supervisor, 0, sizeof supervisor);
    measured = good_measurement();
    intent = (saddle_intent_t){.leads = true,
                               .walking = true,
                               .step = {.stance = SADDLE_LEFT,
                                        .speed_m_s = PLANNED_M_S,
                                        .half_behind_m = 0.35f,
                                        .width_behind_m = 0.1f,
                                        .landing_m = {0.7f, -0.1f}}};
    intent.place = saddle_step_place(&intent.step, 0.0f);
}

void tearDown(void) {}

static uint32_t update_with(uint32_t faults)
{
    memset(&scores, 0xFF, sizeof scores); /* NaN, but for bools, where only 0 and 1 are values */
    scores.bos.defined = true;
    scores.can_stop = true;
    scores.paper_stable = true;
    const saddle_sensed_t sensed = {&measured, &measured, faults, DT_S};
    saddle_output_t output = {.scores = scores, .verdict = verdict};
    const uint32_t said =
        saddle_supervisor_update(&supervisor, model_of(&config), &sensed, &intent, &output);
    scores = output.scores;
    verdict = output.verdict;
    return said;
}

/* Each measurement by itself: none is frozen. */
static uint32_t update(void)
{
    memset(&plausibility, 0, sizeof plausibility);
    return update_with(
        saddle_measurement_check(&plausibility, model_of(&config), &measured, 0.0f, DT_S));
}

static const uint32_t UNTIL_STEP = (uint32_t)SADDLE_VALID_ALL & ~(uint32_t)SADDLE_VALID_STEP;
static const uint32_t WITHOUT_COM =
    SADDLE_VALID_V_COMP | SADDLE_VALID_S_SW | SADDLE_VALID_MOS_COM | SADDLE_VALID_GRAVITY;

static void strike_with(saddle_side_t side)
{
    measured.foot[side].contact = false;
    update();
    update();
    measured.foot[side].contact = true;
    update();
}

/* What is not valid is 0. */
static void assert_unscored_is_zero(void)
{
    const struct {
        uint32_t valid;
        float number;
    } numbers[] = {
        {SADDLE_VALID_V_COMP, scores.v_comp_m_s},
        {SADDLE_VALID_STEP, scores.s_pend},
        {SADDLE_VALID_STEP, scores.s_jump},
        {SADDLE_VALID_S_SW, scores.s_sw},
        {SADDLE_VALID_MOS_COM, scores.mos_com_m},
        {SADDLE_VALID_MOS_XCOM, scores.mos_xcom_m},
        {SADDLE_VALID_GRAVITY, scores.gravity_n.x},
        {SADDLE_VALID_GRAVITY, scores.gravity_n.y},
        {SADDLE_VALID_STOP, scores.excess_stop_j},
        {SADDLE_VALID_STOP, scores.can_stop ? 1.0f : 0.0f},
    };
    for (size_t i = 0; i < COUNT_OF(numbers); i++) {
        if ((scores.valid & numbers[i].valid) == 0u) {
            ASSERT_SAME_FLOAT(0.0f, numbers[i].number);
        }
    }
}

static void test_valid_measurement_has_no_fault_and_every_score_but_those_of_the_step(void)
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

static void assert_finite_scores(void)
{
    const float numbers[] = {
        scores.v_comp_m_s,   scores.s_pend,       scores.s_jump,         scores.s_sw,
        scores.mos_com_m,    scores.mos_xcom_m,   scores.gravity_n.x,    scores.gravity_n.y,
        scores.xcom_m.x,     scores.xcom_m.y,     scores.bos.centre_m.x, scores.bos.centre_m.y,
        scores.bos.axis_x.x, scores.bos.axis_x.y, scores.bos.radius_m,   scores.excess_stop_j};
    for (size_t i = 0; i < COUNT_OF(numbers); i++) {
        TEST_ASSERT_TRUE(isfinite(numbers[i]));
    }
}

/* What a fault says is not usable is not read: NaN or plausible, it changes nothing. */
static void test_each_fault_takes_the_scores_that_need_its_input(void)
{
    const uint32_t of_com[] = {SADDLE_FAULT_COM_STALE, SADDLE_FAULT_COM_RANGE,
                               SADDLE_FAULT_COM_FROZEN};
    const uint32_t of_feet[] = {SADDLE_FAULT_LEFT_STALE,   SADDLE_FAULT_LEFT_RANGE,
                                SADDLE_FAULT_LEFT_FROZEN,  SADDLE_FAULT_RIGHT_STALE,
                                SADDLE_FAULT_RIGHT_RANGE,  SADDLE_FAULT_RIGHT_FROZEN,
                                SADDLE_FAULT_FEET_CROSSED, SADDLE_FAULT_AIRBORNE};
    const float numbers[] = {0.3f, NAN, INFINITY, -1e30f};
    for (size_t k = 0; k < COUNT_OF(numbers); k++) {
        for (size_t i = 0; i < COUNT_OF(of_com); i++) {
            measured = good_measurement();
            measured.com.velocity_m_s = (saddle_vec2_t){numbers[k], numbers[k]};
            TEST_ASSERT_EQUAL_HEX32(of_com[i], update_with(of_com[i]));
            TEST_ASSERT_EQUAL_HEX32(WITHOUT_COM, scores.valid);
            ASSERT_SAME_FLOAT(0.0f, scores.xcom_m.x);
            ASSERT_SAME_FLOAT(0.0f, scores.xcom_m.y);
            assert_unscored_is_zero();
            assert_finite_scores();
        }
        for (size_t i = 0; i < COUNT_OF(of_feet); i++) {
            measured = good_measurement();
            measured.foot[SADDLE_LEFT].cop_m.x = numbers[k];
            measured.foot[SADDLE_RIGHT].cop_m.y = numbers[k];
            TEST_ASSERT_EQUAL_HEX32(of_feet[i], update_with(of_feet[i]));
            TEST_ASSERT_EQUAL_HEX32(SADDLE_VALID_V_COMP, scores.valid);
            TEST_ASSERT_FALSE(scores.can_stop || scores.paper_stable || scores.bos.defined);
            ASSERT_SAME_FLOAT(0.0f, scores.bos.radius_m);
            assert_unscored_is_zero();
            assert_finite_scores();
        }
    }
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
    TEST_ASSERT_EQUAL_HEX32(SADDLE_FAULT_FEET_TOGETHER | SADDLE_FAULT_COM_STALE,
                            update_with(SADDLE_FAULT_COM_STALE));
    supervisor.steps.v_comp_known = true;
    supervisor.steps.half_step_known = true;
    supervisor.steps.v_comp_m_s = 2.5f;
    TEST_ASSERT_EQUAL_HEX32(SADDLE_FAULT_FEET_TOGETHER | SADDLE_FAULT_SPEED_INFEASIBLE,
                            update_with(0));
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

static void test_v_comp_is_the_planners_until_a_step_is_complete_then_the_mean(void)
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
}

static void test_infeasible_speed_is_reported(void)
{
    const float speeds[] = {-0.5f, 0.0f, 2.5f};
    for (size_t i = 0; i < COUNT_OF(speeds); i++) {
        setUp();
        measured.com.velocity_m_s.x = speeds[i];
        strike_with(SADDLE_LEFT);
        measured.foot[SADDLE_RIGHT].contact = false;
        update();
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
    intent = (saddle_intent_t){.leads = false};
    update();
    TEST_ASSERT_EQUAL_HEX32(SADDLE_VALID_MOS_COM | SADDLE_VALID_MOS_XCOM | SADDLE_VALID_GRAVITY |
                                SADDLE_VALID_STOP,
                            scores.valid);
    ASSERT_SAME_FLOAT(0.0f, scores.v_comp_m_s);
}

static void test_walk_goes_on_having_a_speed_when_nothing_is_planned(void)
{
    strike_with(SADDLE_LEFT);
    strike_with(SADDLE_RIGHT);
    intent = (saddle_intent_t){.leads = false};
    update();
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
            .com.velocity_m_s = {velocity ? 1.2f : NAN, velocity ? 0.0f : NAN},
            .cop_m = {{feet ? 0.3f : NAN, feet ? 0.05f : NAN},
                      {feet ? -0.3f : NAN, feet ? -0.05f : NAN}},
            .v_comp_m_s = speed ? 1.2f : NAN,
            .half_step_m = half_step ? 0.3f : NAN,
            .known = known,
        };
        scores = score(&posture);
        uint32_t expected = 0;
        expected |= speed ? (uint32_t)SADDLE_VALID_V_COMP : 0u;
        expected |= speed && half_step ? (uint32_t)SADDLE_VALID_STEP : 0u;
        expected |= speed && feet ? (uint32_t)SADDLE_VALID_S_SW : 0u;
        expected |= feet ? (uint32_t)SADDLE_VALID_MOS_COM | (uint32_t)SADDLE_VALID_GRAVITY : 0u;
        expected |=
            feet && velocity ? (uint32_t)SADDLE_VALID_MOS_XCOM | (uint32_t)SADDLE_VALID_STOP : 0u;
        TEST_ASSERT_EQUAL_HEX32(expected, scores.valid);
        assert_finite_scores();
        TEST_ASSERT_EQUAL(velocity, scores.xcom_m.x > 0.0f);
        TEST_ASSERT_EQUAL(speed && half_step, scores.s_pend > 0.0f);
        TEST_ASSERT_EQUAL(feet, scores.bos.defined);
    }
}

static void test_com_out_of_the_pendulum_s_reach_has_no_energy(void)
{
    measured.foot[SADDLE_LEFT].cop_m.x = 1.5f;
    measured.foot[SADDLE_RIGHT].cop_m.x = 1.2f;
    TEST_ASSERT_EQUAL_HEX32(0, update());
    const uint32_t of_energy = SADDLE_VALID_GRAVITY | SADDLE_VALID_STOP;
    TEST_ASSERT_EQUAL_HEX32(UNTIL_STEP & ~of_energy, scores.valid);
    ASSERT_SAME_FLOAT(0.0f, scores.excess_stop_j);
    TEST_ASSERT_FALSE(scores.can_stop);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, scores.gravity_n.x);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, scores.gravity_n.y);
}

/* ---- the paper's verdict ------------------------------------------------------------------- */

/* Standing, and pushed ever harder: can_stop ends where the energy exceeds the ankles' work. */
static void test_can_stop_is_the_energy_within_the_ankles_work(void)
{
    const point_t left = {0.0, 0.11};
    const point_t right = {0.0, -0.11};
    const twin_base_t base = twin_base(left, right, 0.1, 1.0);
    const double work = BODY_MASS * GRAVITY * 0.01 / PENDULUM;
    int stops = 0;
    for (int k = 0; k <= 200; k++) {
        const point_t velocity = {0.003 * k, 0.001 * k};
        const point_t com = {0.01, 0.0};
        const double excess = twin_kinetic(velocity) + twin_potential(left, right, com) -
                              twin_potential(left, right, twin_exit(&base, com, velocity));
        const saddle_posture_t posture = {
            .com.com_m = {(float)com.x, (float)com.y},
            .com.velocity_m_s = {(float)velocity.x, (float)velocity.y},
            .cop_m = {{0.0f, 0.11f}, {0.0f, -0.11f}},
            .known = (uint32_t)SADDLE_KNOWN_FEET | (uint32_t)SADDLE_KNOWN_VELOCITY,
        };
        scores = score(&posture);
        TEST_ASSERT_DOUBLE_WITHIN(5e-4, excess, scores.excess_stop_j);
        if (fabs(excess - work) > 1e-3) {
            TEST_ASSERT_EQUAL(excess < work, scores.can_stop);
            TEST_ASSERT_EQUAL(excess < work, scores.paper_stable); /* no step to count on */
        }
        stops += scores.can_stop ? 1 : 0;
    }
    TEST_ASSERT_TRUE(stops > 50 && stops < 150);
}

static void test_twice_the_ankles_work_stops_twice_the_energy(void)
{
    saddle_posture_t posture = {
        .cop_m = {{0.0f, 0.11f}, {0.0f, -0.11f}},
        .known = (uint32_t)SADDLE_KNOWN_FEET | (uint32_t)SADDLE_KNOWN_VELOCITY,
    };
    posture.com.velocity_m_s.x = 0.5f; /* 7.9 J and 3 J on the way down */
    TEST_ASSERT_FALSE(score(&posture).can_stop);
    config.ankle_work_factor = 2.0f;
    TEST_ASSERT_TRUE(score(&posture).can_stop);
}

/* A walk at 1.2 m/s, too fast to stop: a stable step is all three scores above 0. */
static void test_papers_verdict_needs_all_three_scores_or_the_stop(void)
{
    const struct {
        float half_step, com_y, speed_x;
        bool stable;
    } table[] = {
        {0.35f, 0.0f, 1.2f, true},    {0.19f, 0.0f, 1.2f, false},   /* below v / (2 w) = 0.1935 */
        {0.20f, 0.0f, 1.2f, true},    {0.49f, 0.0f, 1.2f, false},   /* beyond the reach of 0.4838 */
        {0.48f, 0.0f, 1.2f, true},    {0.35f, 0.051f, 1.2f, false}, /* beyond the foot */
        {0.35f, -0.049f, 1.2f, true}, {0.19f, 0.0f, 0.0f, true},    /* at rest: it can stop */
    };
    for (size_t i = 0; i < COUNT_OF(table); i++) {
        const saddle_posture_t posture = {
            .com.com_m = {0.2f, table[i].com_y + 0.5f}, /* any frame will do */
            .com.velocity_m_s = {table[i].speed_x, 0.0f},
            .cop_m = {{0.5f, 0.55f}, {-0.1f, 0.45f}},
            .v_comp_m_s = 1.2f,
            .half_step_m = table[i].half_step,
            .known = (uint32_t)SADDLE_KNOWN_ALL,
        };
        scores = score(&posture);
        TEST_ASSERT_EQUAL_HEX32(SADDLE_VALID_ALL, scores.valid);
        TEST_ASSERT_EQUAL(table[i].stable, scores.paper_stable);
        TEST_ASSERT_EQUAL(table[i].speed_x == 0.0f, scores.can_stop);
    }
}

static void test_papers_verdict_needs_known_scores(void)
{
    const uint32_t missing[] = {SADDLE_KNOWN_FEET, SADDLE_KNOWN_SPEED, SADDLE_KNOWN_HALF_STEP};
    saddle_posture_t posture = {
        .com.velocity_m_s = {1.2f, 0.0f},
        .cop_m = {{0.3f, 0.05f}, {-0.3f, -0.05f}},
        .v_comp_m_s = 1.2f,
        .half_step_m = 0.35f,
    };
    for (size_t i = 0; i < COUNT_OF(missing); i++) {
        posture.known = (uint32_t)SADDLE_KNOWN_ALL & ~missing[i];
        TEST_ASSERT_FALSE(score(&posture).paper_stable);
    }
    posture.known = (uint32_t)SADDLE_KNOWN_ALL & ~(uint32_t)SADDLE_KNOWN_VELOCITY;
    TEST_ASSERT_TRUE(score(&posture).paper_stable);
}

/* A person who uses less of the base has less of a margin. */
static void test_used_share_of_the_base_is_that_of_the_configuration(void)
{
    update();
    const float whole_m = scores.bos.radius_m;
    const saddle_vec2_t xcom_m = scores.xcom_m;
    config.bos_factor = 0.5f;
    update();
    ASSERT_SAME_FLOAT(0.5f * whole_m, scores.bos.radius_m);
    ASSERT_SAME_FLOAT(0.5f * config.cop_range_m, scores.bos.half_depth_m);
    const twin_base_t base = twin_base((point_t){0.35, 0.06}, (point_t){-0.25, -0.05}, 0.1, 0.5);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, twin_margin(&base, point_of(xcom_m)),
                              scores.mos_xcom_m);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_valid_measurement_has_no_fault_and_every_score_but_those_of_the_step);
    RUN_TEST(test_each_fault_takes_the_scores_that_need_its_input);
    RUN_TEST(test_recovery_is_at_once_and_complete);
    RUN_TEST(test_feet_together_have_no_saddle_space);
    RUN_TEST(test_heel_strike_opens_the_step_scores);
    RUN_TEST(test_v_comp_is_the_planners_until_a_step_is_complete_then_the_mean);
    RUN_TEST(test_infeasible_speed_is_reported);
    RUN_TEST(test_nobody_walking_and_nothing_planned_has_no_speed);
    RUN_TEST(test_walk_goes_on_having_a_speed_when_nothing_is_planned);
    RUN_TEST(test_validity_follows_from_what_is_known);
    RUN_TEST(test_com_out_of_the_pendulum_s_reach_has_no_energy);
    RUN_TEST(test_can_stop_is_the_energy_within_the_ankles_work);
    RUN_TEST(test_twice_the_ankles_work_stops_twice_the_energy);
    RUN_TEST(test_papers_verdict_needs_all_three_scores_or_the_stop);
    RUN_TEST(test_papers_verdict_needs_known_scores);
    RUN_TEST(test_used_share_of_the_base_is_that_of_the_configuration);
    return UNITY_END();
}
