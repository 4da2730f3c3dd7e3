/** The verdict on a measured posture: against the planned step, one's own walk or standing; the
 *  numbers against the model in double, each level and reason, and when it is announced. */
#include "balance_twin.h"

#include "balance/comparison.h"
#include "balance/recovery_step.h"
#include "balance/supervisor.h"
#include "math/vec2.h"

static const float DT_S = 0.08f;

static const double PLACE_TOLERANCE = 5e-6;  /* a deviation's rounding, grown sixfold */
static const double ENERGY_TOLERANCE = 1e-3; /* of 630 J, and of speeds squared */

static saddle_config_t config;
static saddle_body_t body;
static saddle_supervisor_t supervisor;
static saddle_measurement_t measured;
static saddle_intent_t intent;
static saddle_scores_t scores;
static saddle_verdict_t verdict;

void setUp(void)
{
    config = paper_config();
    config.bos_factor = 1.0f;
    config.ankle_work_factor = 1.0f;
    config.stop_margin_m = 0.0f;
    config.prediction_horizon_s = 0.4f;
    config.cop_shift_ap_m = 0.0f;
    config.cop_shift_ml_m = 0.0f;
    config.recovery_width_min_m = 0.02f;
    config.recovery_width_max_m = 0.5f;
    config.recovery_margin_m = 0.0f;
    config.recovery_follow = 0.0f;
    config.caution_score = 0.1f;
    config.caution_xcom_ap_m = 0.13f;
    config.caution_xcom_ml_m = 0.07f;
    config.level_hold_ticks = 1.0f;
    config.previous_level = 1.0f; /* the margin has tests of its own */
    body = model_of(&config)->body;
    memset(&supervisor, 0, sizeof supervisor);
    saddle_supervisor_init(&supervisor, model_of(&config));
}

void tearDown(void) {}

static saddle_recovery_t recovery_from(const saddle_recovery_target_t *target)
{
    saddle_recovery_t recovery;
    memset(&recovery, 0xFF, sizeof recovery);
    saddle_recovery_step(model_of(&config), target, &recovery);
    return recovery;
}

/* ---- a walk in double ---------------------------------------------------------------------- */

/* Everything is seen from the stance foot. */
typedef struct {
    saddle_side_t stance;
    double speed, half, width;
} walk_t;

typedef struct {
    point_t com, velocity;
} state_t;

static walk_t walk_at(double v, saddle_side_t stance)
{
    const double width = v < 0.6 ? 0.22 : v > 1.1 ? 0.10 : -0.2128 * v + 0.3456;
    return (walk_t){stance, v, 0.1802 * v + 0.1351, width};
}

static double inward(const walk_t *walk)
{
    return walk->stance == SADDLE_LEFT ? -1.0 : 1.0;
}

static state_t planned_state(const walk_t *walk, double x)
{
    const double a = fmin(walk->width / (2.0 * PI * walk->speed), walk->width / PI);
    const double turn = 0.5 * PI / walk->half;
    return (state_t){
        .com = {x, inward(walk) * (0.5 * walk->width - a * cos(turn * x))},
        .velocity = {walk->speed, inward(walk) * a * turn * walk->speed * sin(turn * x)},
    };
}

static point_t landing_of(const walk_t *walk)
{
    return (point_t){2.0 * walk->half, inward(walk) * walk->width};
}

static double until_landing_s(const walk_t *walk, double x)
{
    return fmin((walk->half - x) / walk->speed, (double)config.prediction_horizon_s);
}

static point_t xcom(const state_t *state)
{
    return (point_t){state->com.x + state->velocity.x / FREQUENCY,
                     state->com.y + state->velocity.y / FREQUENCY};
}

static point_t sum(point_t a, point_t b)
{
    return (point_t){a.x + b.x, a.y + b.y};
}

static saddle_vec2_t rounded(point_t p)
{
    return (saddle_vec2_t){(float)p.x, (float)p.y};
}

/* The swing foot beside the stance foot at x = 0, on the line through the CoM. */
static point_t swing_foot(const walk_t *walk, double x)
{
    const state_t state = planned_state(walk, x);
    const double y = inward(walk) * walk->width;
    return (point_t){state.com.x * y / state.com.y, y};
}

/* The wearer on the planned feet, the CoM off the plan by a deviation. */
static void measure(const walk_t *walk, double x, state_t deviation)
{
    const state_t planned = planned_state(walk, x);
    const point_t com = sum(planned.com, deviation.com);
    const point_t swing = swing_foot(walk, x);
    const saddle_side_t other = saddle_other_side(walk->stance);
    memset(&measured, 0, sizeof measured);
    measured.com.height_m = 1.0f;
    measured.com.velocity_m_s = rounded(sum(planned.velocity, deviation.velocity));
    measured.foot[walk->stance].cop_m = rounded((point_t){-com.x, -com.y});
    measured.foot[walk->stance].contact = true;
    measured.foot[other].cop_m = rounded((point_t){swing.x - com.x, swing.y - com.y});
}

static void plan(const walk_t *walk, double x)
{
    const state_t planned = planned_state(walk, x);
    intent = (saddle_intent_t){
        .leads = true,
        .walking = true,
        .stance_then = walk->stance,
        .step = {.stance = walk->stance,
                 .speed_m_s = (float)walk->speed,
                 .half_behind_m = (float)walk->half,
                 .width_behind_m = (float)walk->width,
                 .landing_m = rounded(landing_of(walk))},
        .com = {rounded(planned.com), rounded(planned.velocity)},
    };
    intent.place = saddle_step_place(&intent.step, intent.com.com_m.x);
}

/* What a wearer who has walked so for a while is known by. */
static void has_walked(const walk_t *walk)
{
    supervisor.steps.v_comp_m_s = (float)walk->speed;
    supervisor.steps.half_step_m = (float)walk->half;
    supervisor.steps.step_width_m = (float)walk->width;
    supervisor.steps.v_comp_known = true;
    supervisor.steps.half_step_known = true;
    supervisor.steps.stance = (uint8_t)walk->stance;
}

/* Both feet side by side, 0.22 m apart, CoM midway. */
static void measure_standing(point_t com, point_t velocity)
{
    memset(&measured, 0, sizeof measured);
    measured.com.height_m = 1.0f;
    measured.com.velocity_m_s = rounded(velocity);
    measured.foot[SADDLE_LEFT].cop_m = rounded((point_t){-com.x, 0.11 - com.y});
    measured.foot[SADDLE_RIGHT].cop_m = rounded((point_t){-com.x, -0.11 - com.y});
    measured.foot[SADDLE_LEFT].contact = true;
    measured.foot[SADDLE_RIGHT].contact = true;
}

static const state_t NONE = {{0.0, 0.0}, {0.0, 0.0}};
static const point_t ORIGIN = {0.0, 0.0};

static uint32_t update(uint32_t faults)
{
    memset(&verdict, 0xFF, sizeof verdict); /* NaN, but for bools, where only 0 and 1 are values */
    verdict.compared = true;
    verdict.on_track = true;
    verdict.recovery.found = true;
    verdict.recovery.stops = true;
    const saddle_sensed_t sensed = {&measured, &measured, faults, DT_S};
    saddle_output_t output = {.scores = scores, .verdict = verdict};
    const uint32_t said =
        saddle_supervisor_update(&supervisor, model_of(&config), &sensed, &intent, &output);
    scores = output.scores;
    verdict = output.verdict;
    return said;
}

static void assert_verdict(saddle_level_t level, saddle_reason_t reason)
{
    TEST_ASSERT_EQUAL_UINT8(reason, verdict.reason);
    TEST_ASSERT_EQUAL_UINT8(level, verdict.level);
}

/* ---- the numbers --------------------------------------------------------------------------- */

static void assert_excess_track(const walk_t *walk, double x, const state_t *deviation)
{
    const state_t planned = planned_state(walk, x);
    const point_t swing = swing_foot(walk, x);
    const bool left = walk->stance == SADDLE_LEFT;
    const point_t feet[2] = {left ? ORIGIN : swing, left ? swing : ORIGIN};
    const twin_base_t base = twin_base(feet[0], feet[1], 0.1, 1.0);
    const point_t exit = twin_exit(&base, planned.com, planned.velocity);
    const double excess = twin_kinetic(sum(planned.velocity, deviation->velocity)) -
                          twin_kinetic(planned.velocity) +
                          twin_potential(feet[0], feet[1], sum(planned.com, deviation->com)) -
                          twin_potential(feet[0], feet[1], exit);
    const double work = BODY_MASS * GRAVITY * 0.01 / PENDULUM;
    TEST_ASSERT_DOUBLE_WITHIN(ENERGY_TOLERANCE, excess, verdict.excess_track_j);
    if (fabs(excess - work) > ENERGY_TOLERANCE) {
        TEST_ASSERT_EQUAL(excess < work, verdict.on_track);
    }
}

static void assert_expected_base(const walk_t *walk, double x, const state_t *deviation)
{
    const double wt = FREQUENCY * until_landing_s(walk, x);
    const state_t landing = planned_state(walk, walk->half);
    const point_t off = xcom(deviation);
    const point_t com = {deviation->com.x * cosh(wt) + deviation->velocity.x / FREQUENCY * sinh(wt),
                         deviation->com.y * cosh(wt) +
                             deviation->velocity.y / FREQUENCY * sinh(wt)};
    const point_t grown = {off.x * exp(wt), off.y * exp(wt)};
    const bool left = walk->stance == SADDLE_LEFT;
    const point_t landed = landing_of(walk);
    const twin_base_t base = twin_base(left ? ORIGIN : landed, left ? landed : ORIGIN, 0.1, 1.0);
    TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, twin_margin(&base, sum(landing.com, com)),
                              verdict.ebos_com_m);
    TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, twin_margin(&base, sum(xcom(&landing), grown)),
                              verdict.ebos_xcom_m);
}

/* The recovery step for an XCoM that departs by so much when the foot lands. */
static void assert_recovery(const walk_t *walk, point_t departure)
{
    const state_t landing = planned_state(walk, walk->half);
    const saddle_recovery_target_t target = {
        .stance = walk->stance,
        .landing_m = rounded(landing_of(walk)),
        .xcom_m = rounded(xcom(&landing)),
        .departure_m = rounded(departure),
        .step_time_s = (float)(2.0 * walk->half / walk->speed),
    };
    const saddle_recovery_t expected = recovery_from(&target);
    TEST_ASSERT_EQUAL_UINT8(saddle_other_side(walk->stance), verdict.recovery.foot);
    TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, expected.margin_m, verdict.recovery.margin_m);
    if (fabsf(expected.margin_m) > 1e-5f) {
        TEST_ASSERT_EQUAL(expected.found, verdict.recovery.found);
        TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, expected.landing_m.x,
                                  verdict.recovery.landing_m.x);
        TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, expected.landing_m.y,
                                  verdict.recovery.landing_m.y);
    }
}

static void assert_numbers(const walk_t *walk, double x, state_t deviation)
{
    const point_t off = xcom(&deviation);
    const double growth = exp(FREQUENCY * until_landing_s(walk, x));
    plan(walk, x);
    has_walked(walk);
    measure(walk, x, deviation);
    TEST_ASSERT_EQUAL_HEX32(0, update(0));
    TEST_ASSERT_TRUE(verdict.compared);
    TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, off.x, verdict.xcom_deviation_m.x);
    TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, off.y, verdict.xcom_deviation_m.y);
    assert_excess_track(walk, x, &deviation);
    assert_expected_base(walk, x, &deviation);
    assert_recovery(walk, (point_t){off.x * growth, off.y * growth});
}

static void test_wearer_on_the_plan_has_the_plans_numbers(void)
{
    const double speeds[] = {0.5, 0.7, 1.0, 1.2, 1.6};
    for (size_t i = 0; i < COUNT_OF(speeds); i++) {
        for (int k = -9; k <= 9; k++) {
            const walk_t left = walk_at(speeds[i], SADDLE_LEFT);
            const walk_t right = walk_at(speeds[i], SADDLE_RIGHT);
            assert_numbers(&left, 0.1 * k * left.half, NONE);
            assert_numbers(&right, 0.1 * k * right.half, NONE);
        }
    }
}

static void test_deviation_from_the_plan_gives_the_models_numbers(void)
{
    uint32_t state = 97;
    for (int i = 0; i < 2000; i++) {
        const walk_t walk =
            walk_at((double)random_in(&state, 0.4f, 1.7f), i % 2 == 0 ? SADDLE_LEFT : SADDLE_RIGHT);
        const double x = walk.half * (double)random_in(&state, -0.95f, 0.95f);
        const state_t deviation = {
            {(double)random_in(&state, -0.05f, 0.05f), (double)random_in(&state, -0.03f, 0.03f)},
            {(double)random_in(&state, -0.5f, 0.5f), (double)random_in(&state, -0.3f, 0.3f)}};
        assert_numbers(&walk, x, deviation);
    }
}

/* The wearer moves the CoP by up to cop_shift, and over to the trailing foot while it stands. */
static void test_recovery_step_is_for_deviations_beyond_the_cop(void)
{
    const double x = -0.5 * 0.35;
    const walk_t walk = walk_at(1.2, SADDLE_LEFT);
    const double t = until_landing_s(&walk, x);
    const double growth = exp(FREQUENCY * t);
    const double trailing_share = growth - exp(FREQUENCY * (t - 0.1));
    const point_t swing = swing_foot(&walk, x);
    config.cop_shift_ap_m = 0.06f;
    config.cop_shift_ml_m = 0.02f;
    config.recovery_follow = 1.0f; /* so that the landing tells the departure */
    for (int contact = 0; contact < 2; contact++) {
        const state_t deviation = {{-0.14, -0.02}, {-0.2, -0.2}}; /* back, and towards that foot */
        plan(&walk, x);
        has_walked(&walk);
        measure(&walk, x, deviation);
        measured.foot[SADDLE_RIGHT].contact = contact == 1;
        update(0);
        const point_t off = xcom(&deviation);
        const double back = contact == 1 ? -swing.x * trailing_share : 0.0;
        const double aside = contact == 1 ? -swing.y * trailing_share : 0.0;
        assert_recovery(&walk,
                        (point_t){fmin(0.0, off.x * growth + 0.06 * (growth - 1.0) + back),
                                  fmin(0.0, off.y * growth + 0.02 * (growth - 1.0) + aside)});
        TEST_ASSERT_TRUE(verdict.recovery.landing_m.x < (float)(2.0 * walk.half - 0.01));
    }
}

static void test_results_that_were_not_compared_are_zero(void)
{
    const uint32_t faults[] = {SADDLE_FAULT_COM_STALE, SADDLE_FAULT_LEFT_RANGE,
                               SADDLE_FAULT_AIRBORNE};
    const walk_t walk = walk_at(1.2, SADDLE_LEFT);
    for (size_t i = 0; i <= COUNT_OF(faults); i++) {
        plan(&walk, 0.0);
        has_walked(&walk);
        measure(&walk, 0.0, NONE);
        if (i == COUNT_OF(faults)) {
            measured.foot[SADDLE_RIGHT].cop_m = measured.foot[SADDLE_LEFT].cop_m;
            TEST_ASSERT_EQUAL_HEX32(SADDLE_FAULT_FEET_TOGETHER, update(0));
        } else {
            TEST_ASSERT_EQUAL_HEX32(faults[i], update(faults[i]));
        }
        const float numbers[] = {verdict.excess_track_j,       verdict.ebos_com_m,
                                 verdict.ebos_xcom_m,          verdict.xcom_deviation_m.x,
                                 verdict.xcom_deviation_m.y,   verdict.recovery.landing_m.x,
                                 verdict.recovery.landing_m.y, verdict.recovery.margin_m};
        for (size_t k = 0; k < COUNT_OF(numbers); k++) {
            ASSERT_SAME_FLOAT(0.0f, numbers[k]);
        }
        TEST_ASSERT_FALSE(verdict.compared || verdict.on_track || verdict.recovery.found ||
                          verdict.recovery.stops || verdict.recovery.foot != 0u);
    }
}

/* ---- each level and reason ----------------------------------------------------------------- */

/* A wearer at 1.2 m/s on the left foot, on the plan but for a deviation. */
static void deviate(double x, state_t deviation)
{
    const walk_t walk = walk_at(1.2, SADDLE_LEFT);
    plan(&walk, x);
    has_walked(&walk);
    measure(&walk, x, deviation);
}

static void test_wearer_on_the_plan_is_stable(void)
{
    for (int k = -9; k <= 9; k++) {
        deviate(0.035 * k, NONE);
        update(0);
        assert_verdict(SADDLE_LEVEL_STABLE, SADDLE_REASON_NONE);
    }
}

static void test_unusable_input_is_unknown(void)
{
    const uint32_t faults[] = {
        SADDLE_FAULT_COM_STALE,   SADDLE_FAULT_COM_RANGE,   SADDLE_FAULT_COM_FROZEN,
        SADDLE_FAULT_LEFT_STALE,  SADDLE_FAULT_LEFT_RANGE,  SADDLE_FAULT_LEFT_FROZEN,
        SADDLE_FAULT_RIGHT_STALE, SADDLE_FAULT_RIGHT_RANGE, SADDLE_FAULT_RIGHT_FROZEN,
        SADDLE_FAULT_AIRBORNE,    SADDLE_FAULT_FEET_CROSSED};
    for (size_t i = 0; i < COUNT_OF(faults); i++) {
        deviate(0.0, NONE);
        update(0);
        assert_verdict(SADDLE_LEVEL_STABLE, SADDLE_REASON_NONE);
        update(faults[i]);
        assert_verdict(SADDLE_LEVEL_UNKNOWN, SADDLE_REASON_INPUT);
    }
}

static void test_neither_walking_nor_standing_is_unknown(void)
{
    deviate(0.0, NONE);
    intent = (saddle_intent_t){.leads = false};
    supervisor.steps.v_comp_known = false;
    update(0);
    assert_verdict(SADDLE_LEVEL_UNKNOWN, SADDLE_REASON_NO_WALK);
    TEST_ASSERT_FALSE(verdict.compared);
}

static void test_xcom_off_the_planned_one_by_more_than_its_band_is_a_caution(void)
{
    const struct {
        double x, y;
        saddle_reason_t reason;
    } table[] = {
        {0.1299, 0.0, SADDLE_REASON_NONE},    {0.1301, 0.0, SADDLE_REASON_XCOM_AP},
        {-0.1299, 0.0, SADDLE_REASON_NONE},   {-0.1301, 0.0, SADDLE_REASON_XCOM_AP},
        {0.0, -0.0699, SADDLE_REASON_NONE},   {0.0, -0.0701, SADDLE_REASON_XCOM_ML},
        {0.14, -0.08, SADDLE_REASON_XCOM_AP}, {0.12, -0.08, SADDLE_REASON_XCOM_ML},
    };
    config.ankle_work_factor = 10.0f; /* any of these can be brought back */
    for (size_t i = 0; i < COUNT_OF(table); i++) {
        const double w = FREQUENCY;
        deviate(0.2, (state_t){ORIGIN, {table[i].x * w, table[i].y * w}});
        update(0);
        assert_verdict(table[i].reason == SADDLE_REASON_NONE ? SADDLE_LEVEL_STABLE
                                                             : SADDLE_LEVEL_CAUTION,
                       table[i].reason);
    }
}

/* 0.2 m/s too fast are 15 J and 0.065 m of XCoM. */
static void test_energy_beyond_the_ankles_is_a_caution(void)
{
    deviate(0.0, (state_t){ORIGIN, {0.2, 0.0}});
    update(0);
    TEST_ASSERT_FALSE(verdict.on_track);
    assert_verdict(SADDLE_LEVEL_CAUTION, SADDLE_REASON_OFF_TRACK);
    config.ankle_work_factor = 4.0f;
    update(0);
    TEST_ASSERT_TRUE(verdict.on_track);
    assert_verdict(SADDLE_LEVEL_STABLE, SADDLE_REASON_NONE);
}

/* At 1.2 m/s: d_min 0.1935, d 0.3513, d_Max 0.4838; a tenth of the way from a bound. */
static void test_step_that_is_almost_too_short_or_too_long_is_a_caution(void)
{
    const struct {
        float half_step_m;
        saddle_reason_t reason;
    } table[] = {{0.2095f, SADDLE_REASON_NONE},   {0.2090f, SADDLE_REASON_S_PEND},
                 {-0.3f, SADDLE_REASON_S_PEND},   {0.4703f, SADDLE_REASON_NONE},
                 {0.4708f, SADDLE_REASON_S_JUMP}, {0.6f, SADDLE_REASON_S_JUMP}};
    for (size_t i = 0; i < COUNT_OF(table); i++) {
        deviate(0.0, NONE);
        supervisor.steps.half_step_m = table[i].half_step_m;
        update(0);
        assert_verdict(table[i].reason == SADDLE_REASON_NONE ? SADDLE_LEVEL_STABLE
                                                             : SADDLE_LEVEL_CAUTION,
                       table[i].reason);
    }
}

/* Beside the stance foot the planned CoM is 13 mm off the middle; 45 mm are a tenth. */
static void test_body_almost_over_a_foot_is_a_caution(void)
{
    const double middle = 0.10 / (2.0 * PI * 1.2);
    const double offsets[] = {0.0449, 0.0451};
    for (size_t i = 0; i < COUNT_OF(offsets); i++) {
        deviate(0.0, (state_t){{0.0, offsets[i] - middle}, {0.0, 0.0}});
        update(0);
        TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE / 0.05, 1.0 - offsets[i] / 0.05, scores.s_sw);
        assert_verdict(i == 0u ? SADDLE_LEVEL_STABLE : SADDLE_LEVEL_CAUTION,
                       i == 0u ? SADDLE_REASON_NONE : SADDLE_REASON_S_SW);
    }
}

static void test_infeasible_speed_is_a_caution(void)
{
    deviate(0.0, NONE);
    supervisor.steps.v_comp_m_s = 2.5f;
    TEST_ASSERT_EQUAL_HEX32(SADDLE_FAULT_SPEED_INFEASIBLE, update(0));
    assert_verdict(SADDLE_LEVEL_CAUTION, SADDLE_REASON_SPEED);
}

static void test_no_place_to_step_to_is_unstable_in_any_direction(void)
{
    const point_t pushes[] = {{2.0, 0.0}, {-4.0, 0.0}, {0.0, 1.0}, {0.0, -2.0}};
    for (size_t i = 0; i < COUNT_OF(pushes); i++) {
        deviate(0.0, (state_t){ORIGIN, pushes[i]});
        update(0);
        TEST_ASSERT_FALSE(verdict.recovery.found);
        TEST_ASSERT_TRUE(verdict.recovery.margin_m < 0.0f);
        assert_verdict(SADDLE_LEVEL_UNSTABLE, SADDLE_REASON_NO_STEP);
    }
}

/* The worst comes first: no step, then a bad speed, the scores, the XCoM, the energy. */
static void test_reason_is_the_most_severe(void)
{
    deviate(0.0, (state_t){ORIGIN, {2.0, 0.0}});
    supervisor.steps.half_step_m = 0.1f;
    supervisor.steps.v_comp_m_s = 2.5f;
    update(0);
    TEST_ASSERT_EQUAL_UINT8(SADDLE_REASON_NO_STEP, verdict.reason);
    deviate(0.0, (state_t){ORIGIN, {0.5, -0.25}});
    supervisor.steps.v_comp_m_s = 2.5f;
    update(0);
    TEST_ASSERT_EQUAL_UINT8(SADDLE_REASON_SPEED, verdict.reason);
    deviate(0.0, (state_t){ORIGIN, {0.5, -0.25}});
    supervisor.steps.half_step_m = 0.1f;
    update(0);
    TEST_ASSERT_EQUAL_UINT8(SADDLE_REASON_S_PEND, verdict.reason);
    deviate(0.0, (state_t){ORIGIN, {0.5, -0.25}});
    update(0);
    TEST_ASSERT_EQUAL_UINT8(SADDLE_REASON_XCOM_AP, verdict.reason);
    deviate(0.0, (state_t){ORIGIN, {0.3, -0.25}});
    update(0);
    TEST_ASSERT_EQUAL_UINT8(SADDLE_REASON_XCOM_ML, verdict.reason);
}

/* ---- standing ------------------------------------------------------------------------------ */

static void stand_without_a_plan(point_t com, point_t velocity)
{
    intent = (saddle_intent_t){.leads = false};
    supervisor.steps.stands = true;
    measure_standing(com, velocity);
    update(0);
}

static void test_person_who_stands_is_compared_with_standing_midway(void)
{
    const point_t com = {0.03, -0.02};
    const point_t velocity = {0.1, 0.05};
    stand_without_a_plan(com, velocity);
    const state_t state = {com, velocity};
    const twin_base_t base = twin_base((point_t){0.0, 0.11}, (point_t){0.0, -0.11}, 0.1, 1.0);
    TEST_ASSERT_TRUE(verdict.compared);
    TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, xcom(&state).x, verdict.xcom_deviation_m.x);
    TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, xcom(&state).y, verdict.xcom_deviation_m.y);
    TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, twin_margin(&base, com), verdict.ebos_com_m);
    TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, twin_margin(&base, xcom(&state)),
                              verdict.ebos_xcom_m);
    assert_verdict(SADDLE_LEVEL_STABLE, SADDLE_REASON_NONE);
}

/* The plan shifts the weight over the left foot, as before a first step: that is no departure. */
static void test_planned_shift_of_weight_is_the_reference_while_it_leads(void)
{
    measure_standing((point_t){0.0, 0.08}, (point_t){0.0, 0.1});
    intent = (saddle_intent_t){.leads = true, .com = {{0.0f, 0.08f}, {0.0f, 0.1f}}};
    update(0);
    TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, 0.0, verdict.xcom_deviation_m.x);
    TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, 0.0, verdict.xcom_deviation_m.y);
    assert_verdict(SADDLE_LEVEL_STABLE, SADDLE_REASON_NONE);
    intent.com.com_m.y = 0.0f;
    intent.com.velocity_m_s.y = 0.0f;
    update(0);
    TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, 0.08 + 0.1 / FREQUENCY, verdict.xcom_deviation_m.y);
    assert_verdict(SADDLE_LEVEL_CAUTION, SADDLE_REASON_XCOM_ML);
}

/* The foot on the side to which the XCoM departs makes the step, from where it stands to as far off
 * as the XCoM will have departed, except for what the CoP can correct. */
static void test_standing_person_steps_to_the_side_of_the_push(void)
{
    const double growth = exp(FREQUENCY * (double)config.prediction_horizon_s);
    config.recovery_follow = 1.0f;
    config.cop_shift_ap_m = 0.01f;
    config.cop_shift_ml_m = 0.02f;
    for (int side = -1; side <= 1; side += 2) {
        stand_without_a_plan(ORIGIN, (point_t){0.1, 0.25 * side});
        const double ahead = 0.1 / FREQUENCY * growth - 0.01 * (growth - 1.0);
        const double aside = 0.25 / FREQUENCY * growth - 0.02 * (growth - 1.0);
        TEST_ASSERT_TRUE(verdict.recovery.found);
        TEST_ASSERT_EQUAL_UINT8(side > 0 ? SADDLE_LEFT : SADDLE_RIGHT, verdict.recovery.foot);
        TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, ahead, verdict.recovery.landing_m.x);
        TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, side * (0.22 + aside),
                                  verdict.recovery.landing_m.y);
    }
}

static void test_push_of_a_standing_person_is_a_caution_and_then_unstable(void)
{
    const point_t ways[] = {{1.0, 0.0}, {-1.0, 0.0}, {0.0, 1.0}, {0.0, -1.0}, {0.6, 0.6}};
    for (size_t i = 0; i < COUNT_OF(ways); i++) {
        uint8_t last = SADDLE_LEVEL_STABLE;
        for (double push = 0.0; push < 5.0; push += 0.02) {
            stand_without_a_plan(ORIGIN, (point_t){ways[i].x * push, ways[i].y * push});
            TEST_ASSERT_TRUE(verdict.level >= last);
            TEST_ASSERT_TRUE(verdict.level <= last + 1);
            last = verdict.level;
        }
        TEST_ASSERT_EQUAL_UINT8(SADDLE_LEVEL_UNSTABLE, last);
    }
}

/* Nowhere to step, but no need to: who can stop and has the XCoM inside by stop_margin stays. */
static void test_person_who_can_stop_needs_no_step(void)
{
    config.recovery_width_min_m = 0.1f;
    config.recovery_width_max_m = 0.1f;
    config.recovery_margin_m = 0.3f;
    stand_without_a_plan(ORIGIN, (point_t){0.1, 0.0}); /* XCoM 68 mm from the border */
    TEST_ASSERT_FALSE(verdict.recovery.found);
    TEST_ASSERT_TRUE(scores.can_stop);
    assert_verdict(SADDLE_LEVEL_STABLE, SADDLE_REASON_NONE);
    config.stop_margin_m = 0.07f;
    stand_without_a_plan(ORIGIN, (point_t){0.1, 0.0});
    assert_verdict(SADDLE_LEVEL_UNSTABLE, SADDLE_REASON_NO_STEP);
    config.stop_margin_m = -10.0f; /* as printed: the energy alone decides */
    stand_without_a_plan(ORIGIN, (point_t){0.1, 0.0});
    assert_verdict(SADDLE_LEVEL_STABLE, SADDLE_REASON_NONE);
    stand_without_a_plan(ORIGIN, (point_t){0.6, 0.0}); /* 11 J */
    TEST_ASSERT_FALSE(scores.can_stop);
    assert_verdict(SADDLE_LEVEL_UNSTABLE, SADDLE_REASON_NO_STEP);
}

/* Scores are of steps: of the last one nobody who is to stand is reminded. */
static void test_standing_has_no_scores_of_a_walk(void)
{
    measure_standing(ORIGIN, ORIGIN);
    intent = (saddle_intent_t){.leads = true};
    supervisor.steps.v_comp_known = true;
    supervisor.steps.v_comp_m_s = 1.2f;
    supervisor.steps.half_step_known = true;
    supervisor.steps.half_step_m = 0.1f;
    update(0);
    TEST_ASSERT_BITS_LOW(SADDLE_VALID_V_COMP | SADDLE_VALID_STEP | SADDLE_VALID_S_SW, scores.valid);
    ASSERT_SAME_FLOAT(0.0f, scores.s_pend);
    assert_verdict(SADDLE_LEVEL_STABLE, SADDLE_REASON_NONE);
}

/* ---- one's own walk ------------------------------------------------------------------------ */

/* In the phase in which the CoM is, a deviation along x is one of speed alone. */
static void assert_own_walk(const walk_t *own, double x, state_t deviation)
{
    const point_t off = xcom(&deviation);
    measure(own, x, deviation);
    TEST_ASSERT_EQUAL_HEX32(0, update(0));
    TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, off.x, verdict.xcom_deviation_m.x);
    TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, off.y, verdict.xcom_deviation_m.y);
    assert_excess_track(own, x, &deviation);
    assert_expected_base(own, x, &deviation);
}

static void test_walk_without_a_plan_is_compared_with_its_own_last_step(void)
{
    intent = (saddle_intent_t){.leads = false};
    for (int k = -9; k <= 9; k++) {
        const walk_t own = walk_at(0.9, k % 2 == 0 ? SADDLE_RIGHT : SADDLE_LEFT);
        has_walked(&own);
        assert_own_walk(&own, 0.1 * k * own.half, (state_t){ORIGIN, {0.2, -0.1}});
    }
}

/* The last half step was longer than usual at that speed: behind the stance foot it counts. A step
 * that was none, or is not known, is a usual one. */
static void test_distance_behind_the_stance_foot_is_the_last_half_step(void)
{
    const walk_t usual = walk_at(0.9, SADDLE_LEFT);
    walk_t behind = usual;
    behind.half = 0.36;
    intent = (saddle_intent_t){.leads = false};
    has_walked(&behind);
    measure(&behind, -0.3, NONE);
    update(0);
    TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, 0.0, verdict.xcom_deviation_m.y);
    const struct {
        float half_step_m;
        bool known;
    } no_step[] = {{0.36f, false}, {0.019f, true}, {-0.2f, true}};
    measure(&usual, -0.25, NONE);
    for (size_t i = 0; i < COUNT_OF(no_step); i++) {
        has_walked(&usual);
        supervisor.steps.half_step_m = no_step[i].half_step_m;
        supervisor.steps.half_step_known = no_step[i].known;
        update(0);
        TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, 0.0, verdict.xcom_deviation_m.y);
    }
    supervisor.steps.half_step_m = 0.021f; /* however short: the wearer is beyond its end */
    update(0);
    TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, 0.021 - 0.25, verdict.xcom_deviation_m.x);
}

/* A walk of narrow steps lands narrow again, but no narrower than half the usual width, nor wider
 * than twice. */
static void test_own_walk_continues_at_its_own_width(void)
{
    const struct {
        float last_m;
        double next_m;
    } widths[] = {{0.12f, 0.12}, {0.2f, 0.2}, {0.04f, 0.05}, {-0.1f, 0.05}, {0.3f, 0.2}};
    intent = (saddle_intent_t){.leads = false};
    for (size_t i = 0; i < COUNT_OF(widths); i++) {
        walk_t own = walk_at(1.2, SADDLE_LEFT);
        own.width = widths[i].next_m;
        has_walked(&own);
        supervisor.steps.step_width_m = widths[i].last_m;
        assert_own_walk(&own, 0.2, (state_t){ORIGIN, {0.1, 0.05}});
    }
}

static void test_own_walk_without_speed_is_unknown(void)
{
    const walk_t own = walk_at(1.2, SADDLE_LEFT);
    const float speeds[] = {-0.5f, 0.0f, 0.0099f, 3.91f};
    intent = (saddle_intent_t){.leads = false};
    for (size_t i = 0; i < COUNT_OF(speeds); i++) {
        has_walked(&own);
        supervisor.steps.v_comp_m_s = speeds[i];
        measure(&own, 0.1, NONE);
        update(0);
        TEST_ASSERT_FALSE(verdict.compared);
        assert_verdict(SADDLE_LEVEL_UNKNOWN, SADDLE_REASON_NO_WALK);
    }
    const float walked[] = {0.0101f, 3.89f};
    for (size_t i = 0; i < COUNT_OF(walked); i++) {
        has_walked(&own);
        supervisor.steps.v_comp_m_s = walked[i];
        update(0);
        TEST_ASSERT_TRUE(verdict.compared);
    }
}

/* A body whose regression goes beyond its reach: 0.56 s of 3.85 m/s would be half a step of 2.3 m. */
static void test_walk_above_the_ceiling_steps_no_further_than_the_leg_reaches(void)
{
    const walk_t own = walk_at(1.2, SADDLE_LEFT);
    config.half_step_slope_s = 0.56f;
    TEST_ASSERT_NULL(saddle_config_check(&config));
    body = model_of(&config)->body;
    intent = (saddle_intent_t){.leads = false};
    const float speeds[] = {1.0f, 1.01f * body.speed_ceiling_m_s, 2.5f, 3.85f};
    for (size_t i = 0; i < COUNT_OF(speeds); i++) {
        has_walked(&own);
        supervisor.steps.v_comp_m_s = speeds[i];
        measure(&own, 0.1, NONE);
        measured.com.velocity_m_s.x = speeds[i];
        update(0);
        TEST_ASSERT_TRUE(verdict.compared);
        TEST_ASSERT_DOUBLE_WITHIN(2.0, 0.0, verdict.ebos_com_m);
        TEST_ASSERT_DOUBLE_WITHIN(2.0, 0.0, verdict.ebos_xcom_m);
    }
}

static void test_own_walk_is_assessed_by_its_scores(void)
{
    const walk_t own = walk_at(1.2, SADDLE_LEFT);
    intent = (saddle_intent_t){.leads = false};
    has_walked(&own);
    supervisor.steps.half_step_m = 0.2f;
    measure(&own, 0.1, NONE);
    update(0);
    assert_verdict(SADDLE_LEVEL_CAUTION, SADDLE_REASON_S_PEND);
}

/* The plan leads in its own phase: who lags behind it has departed, though at the right speed. */
static void test_wearer_who_lags_behind_the_plan_deviates_from_it(void)
{
    const walk_t walk = walk_at(1.2, SADDLE_LEFT);
    plan(&walk, 0.2);
    has_walked(&walk);
    measure(&walk, 0.05, NONE);
    update(0);
    TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, -0.15, verdict.xcom_deviation_m.x);
    TEST_ASSERT_EQUAL_UINT8(SADDLE_REASON_XCOM_AP, verdict.reason);
    intent = (saddle_intent_t){.leads = false}; /* in one's own walk there is no lag */
    update(0);
    TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, 0.0, verdict.xcom_deviation_m.x);
    TEST_ASSERT_EQUAL_UINT8(SADDLE_REASON_NONE, verdict.reason);
}

/* The plan stands on its left foot already, the wearer alone on the right one still: they are
 * compared with a step at the plan's speed on the right foot; with both down, with the plan's. */
static void test_wearer_on_another_foot_than_the_plan_is_in_their_own_step(void)
{
    for (int side = 0; side < 2; side++) {
        const saddle_side_t ahead = (saddle_side_t)side;
        const walk_t planned = walk_at(1.2, ahead);
        const walk_t still = walk_at(1.2, saddle_other_side(ahead));
        plan(&planned, -planned.half);
        has_walked(&still);
        measure(&still, 0.3, NONE);
        update(0);
        TEST_ASSERT_EQUAL_UINT8(ahead, verdict.recovery.foot);
        TEST_ASSERT_DOUBLE_WITHIN(PLACE_TOLERANCE, 0.0, verdict.xcom_deviation_m.x);
        measured.foot[ahead].contact = true;
        update(0);
        TEST_ASSERT_EQUAL_UINT8(saddle_other_side(ahead), verdict.recovery.foot);
    }
}

/* ---- when a level is announced ------------------------------------------------------------- */

static void see(double push)
{
    deviate(0.0, (state_t){ORIGIN, {push, 0.0}});
    update(0);
}

#define CALM 0.0
#define OFF 0.5     /* XCOM_AP */
#define FALLING 2.0 /* NO_STEP */

static void test_level_is_announced_once_it_has_held(void)
{
    config.level_hold_ticks = 3.0f;
    for (int tick = 1; tick <= 4; tick++) {
        see(CALM);
        assert_verdict(tick < 3 ? SADDLE_LEVEL_UNKNOWN : SADDLE_LEVEL_STABLE,
                       tick < 3 ? SADDLE_REASON_SETTLING : SADDLE_REASON_NONE);
        TEST_ASSERT_TRUE(verdict.compared);
    }
    for (int tick = 1; tick <= 4; tick++) {
        see(FALLING);
        assert_verdict(tick < 3 ? SADDLE_LEVEL_STABLE : SADDLE_LEVEL_UNSTABLE,
                       tick < 3 ? SADDLE_REASON_NONE : SADDLE_REASON_NO_STEP);
    }
    for (int tick = 1; tick <= 4; tick++) {
        see(CALM);
        assert_verdict(tick < 3 ? SADDLE_LEVEL_UNSTABLE : SADDLE_LEVEL_STABLE,
                       tick < 3 ? SADDLE_REASON_NO_STEP : SADDLE_REASON_NONE);
    }
}

static void test_level_that_comes_and_goes_is_not_announced(void)
{
    config.level_hold_ticks = 3.0f;
    for (int tick = 0; tick < 3; tick++) {
        see(CALM);
    }
    for (int tick = 0; tick < 300; tick++) {
        see(tick % 3 == 0 ? CALM : OFF);
        assert_verdict(SADDLE_LEVEL_STABLE, SADDLE_REASON_NONE);
    }
}

/* Never stable, never unstable for three ticks: a caution, for the reason of the last one. */
static void test_level_that_alternates_is_announced_as_the_less_severe(void)
{
    config.level_hold_ticks = 3.0f;
    for (int tick = 0; tick < 3; tick++) {
        see(CALM);
    }
    for (int tick = 1; tick <= 300; tick++) {
        see(tick % 2 == 0 ? FALLING : OFF);
        assert_verdict(tick < 3 ? SADDLE_LEVEL_STABLE : SADDLE_LEVEL_CAUTION,
                       tick < 3 ? SADDLE_REASON_NONE : SADDLE_REASON_XCOM_AP);
    }
}

static void test_hold_of_a_hundred_ticks_is_kept(void)
{
    config.level_hold_ticks = 100.0f;
    for (int tick = 1; tick <= 600; tick++) {
        see(CALM);
        TEST_ASSERT_EQUAL_UINT8(tick < 100 ? SADDLE_LEVEL_UNKNOWN : SADDLE_LEVEL_STABLE,
                                verdict.level);
    }
}

static void test_unknown_is_announced_at_once_and_settles_again(void)
{
    config.level_hold_ticks = 3.0f;
    for (int tick = 0; tick < 5; tick++) {
        see(CALM);
    }
    update(SADDLE_FAULT_COM_STALE);
    assert_verdict(SADDLE_LEVEL_UNKNOWN, SADDLE_REASON_INPUT);
    for (int tick = 1; tick <= 4; tick++) {
        see(CALM);
        assert_verdict(tick < 3 ? SADDLE_LEVEL_UNKNOWN : SADDLE_LEVEL_STABLE,
                       tick < 3 ? SADDLE_REASON_SETTLING : SADDLE_REASON_NONE);
    }
}

/* Another reason for the same level is not a new level, and is reported at once. */
static void test_reason_of_an_announced_level_is_the_present_one(void)
{
    config.level_hold_ticks = 3.0f;
    for (int tick = 0; tick < 3; tick++) {
        see(OFF);
    }
    assert_verdict(SADDLE_LEVEL_CAUTION, SADDLE_REASON_XCOM_AP);
    see(0.2);
    assert_verdict(SADDLE_LEVEL_CAUTION, SADDLE_REASON_OFF_TRACK);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_wearer_on_the_plan_has_the_plans_numbers);
    RUN_TEST(test_deviation_from_the_plan_gives_the_models_numbers);
    RUN_TEST(test_recovery_step_is_for_deviations_beyond_the_cop);
    RUN_TEST(test_results_that_were_not_compared_are_zero);
    RUN_TEST(test_wearer_on_the_plan_is_stable);
    RUN_TEST(test_unusable_input_is_unknown);
    RUN_TEST(test_neither_walking_nor_standing_is_unknown);
    RUN_TEST(test_xcom_off_the_planned_one_by_more_than_its_band_is_a_caution);
    RUN_TEST(test_energy_beyond_the_ankles_is_a_caution);
    RUN_TEST(test_step_that_is_almost_too_short_or_too_long_is_a_caution);
    RUN_TEST(test_body_almost_over_a_foot_is_a_caution);
    RUN_TEST(test_infeasible_speed_is_a_caution);
    RUN_TEST(test_no_place_to_step_to_is_unstable_in_any_direction);
    RUN_TEST(test_reason_is_the_most_severe);
    RUN_TEST(test_person_who_stands_is_compared_with_standing_midway);
    RUN_TEST(test_planned_shift_of_weight_is_the_reference_while_it_leads);
    RUN_TEST(test_standing_person_steps_to_the_side_of_the_push);
    RUN_TEST(test_push_of_a_standing_person_is_a_caution_and_then_unstable);
    RUN_TEST(test_person_who_can_stop_needs_no_step);
    RUN_TEST(test_standing_has_no_scores_of_a_walk);
    RUN_TEST(test_walk_without_a_plan_is_compared_with_its_own_last_step);
    RUN_TEST(test_distance_behind_the_stance_foot_is_the_last_half_step);
    RUN_TEST(test_own_walk_continues_at_its_own_width);
    RUN_TEST(test_own_walk_without_speed_is_unknown);
    RUN_TEST(test_walk_above_the_ceiling_steps_no_further_than_the_leg_reaches);
    RUN_TEST(test_own_walk_is_assessed_by_its_scores);
    RUN_TEST(test_wearer_who_lags_behind_the_plan_deviates_from_it);
    RUN_TEST(test_wearer_on_another_foot_than_the_plan_is_in_their_own_step);
    RUN_TEST(test_level_is_announced_once_it_has_held);
    RUN_TEST(test_level_that_comes_and_goes_is_not_announced);
    RUN_TEST(test_level_that_alternates_is_announced_as_the_less_severe);
    RUN_TEST(test_hold_of_a_hundred_ticks_is_kept);
    RUN_TEST(test_unknown_is_announced_at_once_and_settles_again);
    RUN_TEST(test_reason_of_an_announced_level_is_the_present_one);
    return UNITY_END();
}
