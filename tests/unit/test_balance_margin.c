/** The learned walk, the margin of balance and the level that it decides, [E31] to [E35]. */
#include "core_test.h"

#include "balance/learned_walk.h"
#include "balance/margin.h"

#define DT_S 0.08

static saddle_config_t config;
static saddle_context_t context;
static saddle_input_t input;
static saddle_output_t output;
static uint32_t seed, tick_us;

void setUp(void)
{
    config = paper_config();
    config.lost_inputs_stop = 0.0f;
    TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_init(&context, &config));
    input = (saddle_input_t){.command = {SADDLE_COMMAND_STAND, 0.0f, 0.0f, 0.0f}};
    seed = 20261130;
    tick_us = 80000u;
}

void tearDown(void) {}

/* ---- the equations once more, in double ---------------------------------------------------- */

typedef struct {
    double vx, vy, height, square, watched, walked, last_height, same_height, climb, last_climb;
    bool begun;
} twin_t;

static twin_t twin_start(void)
{
    return (twin_t){.square = 0.035 * 0.035, .watched = 0.08, .walked = 0.8};
}

static double share(double *learned_s, double most_s, double dt_s)
{
    *learned_s = fmin(*learned_s + dt_s, most_s);
    return fmin(dt_s / *learned_s, 1.0);
}

static double twin_margin_of(twin_t *twin, const saddle_measurement_t *seen, double dt_s)
{
    const double vx = (double)seen->com.velocity_m_s.x;
    const double vy = (double)seen->com.velocity_m_s.y;
    const double z = (double)seen->com.height_m;
    const saddle_vec2_t left = seen->foot[SADDLE_LEFT].cop_m;
    const saddle_vec2_t right = seen->foot[SADDLE_RIGHT].cop_m;
    if (!twin->begun) {
        *twin = (twin_t){.vx = vx,
                         .vy = vy,
                         .height = z,
                         .square = twin->square,
                         .watched = twin->watched,
                         .walked = twin->walked,
                         .last_height = z,
                         .begun = true};
    } else {
        twin->same_height += dt_s;
        if (z != twin->last_height) {
            const double since_s = twin->same_height;
            const double rate = (z - twin->last_height) / since_s;
            twin->last_climb = twin->climb;
            twin->climb += fmin(since_s / 0.08, 1.0) * (rate - twin->climb);
            twin->last_height = z;
            twin->same_height = 0.0;
        }
    }
    const double h = twin->height;
    const double s = sqrt(GRAVITY * h);
    const double ex = -0.5 * ((double)left.x + (double)right.x) / h + (vx - twin->vx) / (3.0 * s);
    const double ey = -0.5 * ((double)left.y + (double)right.y) / h + (vy - twin->vy) / (3.0 * s);
    const double apart = hypot((double)left.x - (double)right.x, (double)left.y - (double)right.y);
    const double tolerance = fmax(0.42 - 2.4 * sqrt(twin->square), 0.25);
    const double margin = tolerance - hypot(ex, 1.2 * ey) + 0.2 * 0.5 * apart / h -
                          0.45 * fmax(0.0, -twin->climb) / s;
    const double unusual = vx - twin->vx;
    const double mean_share = share(&twin->watched, 1.0, dt_s);
    twin->vx += mean_share * (vx - twin->vx);
    twin->vy += mean_share * (vy - twin->vy);
    twin->height += mean_share * (z - twin->height);
    if (margin > 0.15 && fabs(twin->vx) > 0.1) {
        const double square =
            (unusual * unusual + twin->climb * twin->climb) / (GRAVITY * twin->height);
        const double ripple_share = share(&twin->walked, 4.0, dt_s);
        const double counted = fmax(fmin(square, 4.0 * twin->square), 0.005 * 0.005);
        twin->square += ripple_share * (counted - twin->square);
    }
    return fmin(margin, 6.0 * (0.36 - fmax(0.0, -fmax(twin->climb, twin->last_climb)) / s));
}

/* ---- what is measured ---------------------------------------------------------------------- */

/* Feet side by side, 0.2 m apart, CoM midway and at rest. */
static saddle_measurement_t standing(void)
{
    return (saddle_measurement_t){.com = {.height_m = 1.0f},
                                  .foot = {{.cop_m = {0.0f, 0.1f}, .contact = true},
                                           {.cop_m = {0.0f, -0.1f}, .contact = true}}};
}

/* Steps in the frame of the CoM at 1 m/s, one in 0.56 s, with the heel strikes and toe-offs. */
static saddle_measurement_t striding(int tick)
{
    const int in_step = tick % 7;
    const bool left_stands = tick / 7 % 2 == 0;
    const float stance_x = 0.28f - 0.08f * (float)in_step;
    const float swing_x = -0.28f + 0.08f * (float)in_step;
    saddle_measurement_t seen = standing();
    seen.com.height_m = 1.0f - 0.01f * (float)(in_step == 0 || in_step == 6);
    seen.com.velocity_m_s.x = 1.0f + (in_step < 4 ? -0.05f : 0.05f);
    for (int side = 0; side < 2; side++) {
        const bool stands = (side == (int)SADDLE_LEFT) == left_stands;
        seen.foot[side].cop_m.x = stands ? stance_x : swing_x;
        seen.foot[side].contact = stands || in_step == 0;
    }
    return seen;
}

static void tick(const saddle_measurement_t *seen)
{
    input.measurement = *seen;
    memset(&output, 0xA5, sizeof output);
    TEST_ASSERT_EQUAL_INT(SADDLE_OK, saddle_tick(&context, &input, &output));
    input.time_us += tick_us;
}

static void tick_until(int from, int to)
{
    for (int k = from; k < to; k++) {
        const saddle_measurement_t seen = striding(k);
        tick(&seen);
    }
}

static void assert_level(saddle_level_t level, saddle_reason_t reason)
{
    TEST_ASSERT_EQUAL_UINT8(reason, output.verdict.reason);
    TEST_ASSERT_EQUAL_UINT8(level, output.verdict.level);
}

/* ---- the margin ---------------------------------------------------------------------------- */

static void jolt(saddle_measurement_t *seen)
{
    seen->com.height_m += random_in(&seed, -0.02f, 0.02f);
    seen->com.velocity_m_s.x += random_in(&seed, -0.3f, 0.3f);
    seen->com.velocity_m_s.y += random_in(&seed, -0.3f, 0.3f);
    for (int side = 0; side < 2; side++) {
        seen->foot[side].cop_m.x += random_in(&seed, -0.2f, 0.2f);
        seen->foot[side].cop_m.y += random_in(&seed, -0.05f, 0.05f);
    }
}

static void test_margin_of_random_walks_is_that_of_the_equations(void)
{
    const uint32_t ticks_us[] = {80000u, 20000u, 50000u, 160000u};
    for (size_t rate = 0; rate < COUNT_OF(ticks_us); rate++) {
        twin_t twin = twin_start();
        double least = 1.0;
        setUp();
        tick_us = ticks_us[rate];
        for (int k = 0; k < MANY(4000); k++) {
            saddle_measurement_t seen = striding(k);
            jolt(&seen);
            tick(&seen);
            const double dt_s = k == 0 ? 0.0 : 1e-6 * tick_us;
            const double expected = twin_margin_of(&twin, &seen, dt_s);
            TEST_ASSERT_TRUE(output.verdict.margin_known);
            TEST_ASSERT_DOUBLE_WITHIN(2e-5, expected, output.verdict.margin);
            TEST_ASSERT_DOUBLE_WITHIN(2e-5, sqrt(twin.square), output.walk.ripple);
            TEST_ASSERT_DOUBLE_WITHIN(2e-5, twin.vx, output.walk.velocity_m_s.x);
            TEST_ASSERT_DOUBLE_WITHIN(2e-5, twin.vy, output.walk.velocity_m_s.y);
            TEST_ASSERT_DOUBLE_WITHIN(2e-5, twin.height, output.walk.height_m);
            least = fmin(least, expected);
        }
        TEST_ASSERT_TRUE(least < 0.1); /* the walk is no easy one */
    }
}

/* Offsets of a standing CoM, in its height of 1 m: 0.336 is tolerated (ripple 0.035), and 0.02 more by
 * feet that are 0.2 m apart. */
static void test_level_and_reason_follow_the_margin(void)
{
    const struct {
        saddle_vec2_t com_m;
        saddle_level_t level;
        saddle_reason_t reason;
    } table[] = {
        {{0.0f, 0.0f}, SADDLE_LEVEL_STABLE, SADDLE_REASON_NONE},
        {{0.255f, 0.0f}, SADDLE_LEVEL_STABLE, SADDLE_REASON_NONE},
        {{0.257f, 0.0f}, SADDLE_LEVEL_CAUTION, SADDLE_REASON_FORWARD},
        {{-0.257f, 0.0f}, SADDLE_LEVEL_CAUTION, SADDLE_REASON_BACKWARD},
        {{0.0f, 0.213f}, SADDLE_LEVEL_STABLE, SADDLE_REASON_NONE},
        {{0.0f, 0.214f}, SADDLE_LEVEL_CAUTION, SADDLE_REASON_LEFT},
        {{0.0f, -0.214f}, SADDLE_LEVEL_CAUTION, SADDLE_REASON_RIGHT},
        {{0.355f, 0.0f}, SADDLE_LEVEL_CAUTION, SADDLE_REASON_FORWARD},
        {{0.357f, 0.0f}, SADDLE_LEVEL_UNSTABLE, SADDLE_REASON_FORWARD},
        {{-0.357f, 0.0f}, SADDLE_LEVEL_UNSTABLE, SADDLE_REASON_BACKWARD},
        {{0.0f, 0.298f}, SADDLE_LEVEL_UNSTABLE, SADDLE_REASON_LEFT},
        {{0.0f, -0.298f}, SADDLE_LEVEL_UNSTABLE, SADDLE_REASON_RIGHT},
    };
    for (size_t i = 0; i < COUNT_OF(table); i++) {
        saddle_measurement_t seen = standing();
        setUp();
        for (int side = 0; side < 2; side++) {
            seen.foot[side].cop_m.x -= table[i].com_m.x;
            seen.foot[side].cop_m.y -= table[i].com_m.y;
        }
        tick(&seen);
        assert_level(table[i].level, table[i].reason);
    }
}

static void test_sinking_com_is_evidence(void)
{
    saddle_measurement_t seen = standing();
    tick(&seen);
    const float before = output.verdict.margin;
    seen.com.height_m -= 0.048f; /* 0.6 m/s */
    tick(&seen);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, (double)before - 0.45 * 0.6 / sqrt(GRAVITY),
                              output.verdict.margin);
    assert_level(SADDLE_LEVEL_STABLE, SADDLE_REASON_NONE);
    seen.com.height_m += 0.048f; /* rising is none */
    tick(&seen);
    TEST_ASSERT_TRUE(output.verdict.margin > before - 1e-4f);
}

/* Straight down over the feet from standing, at a share of gravity: announced while the CoM is above
 * three quarters of its height, but where the legs still carry two thirds of the weight. */
static void test_collapse_over_the_feet_is_announced(void)
{
    const double accelerations[] = {9.8, 6.0, 4.0};
    for (size_t i = 0; i < COUNT_OF(accelerations); i++) {
        double announced_at_m = 0.0;
        setUp();
        tick_us = 20000u;
        for (int k = 0; k < 60 && announced_at_m <= 0.0; k++) {
            saddle_measurement_t seen = standing();
            const double t = 0.02 * (double)(k > 20 ? k - 20 : 0);
            seen.com.height_m = (float)(1.0 - 0.5 * accelerations[i] * t * t);
            seen.com.velocity_m_s.x = 0.001f * (float)k;
            tick(&seen);
            if (output.verdict.level == (uint8_t)SADDLE_LEVEL_UNSTABLE) {
                announced_at_m = (double)seen.com.height_m;
            }
        }
        TEST_ASSERT_TRUE(announced_at_m > (i < 2u ? 0.75 : 0.6));
        TEST_ASSERT_EQUAL_UINT8(SADDLE_REASON_SINKING, output.verdict.reason);
    }
}

/* Sitting down in 0.6 s takes 0.8 m/s at most. Heights that come every 160 ms sink no faster. */
static void test_sitting_down_is_not_a_collapse_even_with_a_slow_sensor(void)
{
    const int held_ticks[] = {1, 4, 8, 12};
    for (size_t i = 0; i < COUNT_OF(held_ticks); i++) {
        setUp();
        tick_us = 20000u;
        for (int k = 0; k < 100; k++) {
            const double t = 0.02 * (double)(k / held_ticks[i] * held_ticks[i]) - 0.6;
            const double share = fmin(fmax(t / 0.6, 0.0), 1.0);
            saddle_measurement_t seen = standing();
            seen.com.height_m = (float)(0.97 - 0.145 * (1.0 - cos(PI * share)));
            seen.com.velocity_m_s.x = 0.001f * (float)k;
            seen.foot[SADDLE_LEFT].cop_m.x = seen.foot[SADDLE_RIGHT].cop_m.x = 1e-4f * (float)k;
            tick(&seen);
            TEST_ASSERT_TRUE(output.verdict.margin > 0.15f);
        }
    }
}

/* A foot that is lost in between takes nothing from what is known of the CoM. */
static void test_sinking_is_known_without_a_foot(void)
{
    for (int lost = 0; lost < 2; lost++) {
        setUp();
        tick_us = 20000u;
        for (int k = 0; k < 20; k++) {
            saddle_measurement_t seen = standing();
            seen.com.height_m = 1.0f - 0.02f * (float)k;
            if (lost != 0 && k % 2 == 0 && k > 0) {
                seen.foot[SADDLE_LEFT].age_us = SADDLE_AGE_NEVER_US;
            }
            tick(&seen);
        }
        TEST_ASSERT_DOUBLE_WITHIN(0.1, 6.0 * (0.36 - 1.0 / sqrt(GRAVITY * 0.9)),
                                  output.verdict.margin);
    }
}

/* Who lies on the ground has fallen: that is no missing measurement, and nothing to learn from. */
static void test_com_below_the_knees_is_unstable_once_it_was_seen_above(void)
{
    saddle_measurement_t seen = standing();
    tick(&seen);
    for (int k = 0; k < 30; k++) {
        seen.com.height_m = 0.3f + 0.0001f * (float)k;
        tick(&seen);
        TEST_ASSERT_BITS_HIGH(SADDLE_FAULT_COM_LOW, output.faults);
        assert_level(SADDLE_LEVEL_UNSTABLE, SADDLE_REASON_SINKING);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.0, output.walk.height_m);
    setUp();
    tick(&seen); /* from the first tick it may be the sensor's offset */
    assert_level(SADDLE_LEVEL_UNKNOWN, SADDLE_REASON_INPUT);
}

/* Nobody knows how fast the CoM sank while it was not measured. */
static void test_height_before_a_gap_does_not_count_for_sinking(void)
{
    saddle_measurement_t seen = standing();
    tick(&seen);
    saddle_measurement_t lost = seen;
    lost.com.age_us = SADDLE_AGE_NEVER_US;
    tick(&lost);
    assert_level(SADDLE_LEVEL_UNKNOWN, SADDLE_REASON_INPUT);
    seen.com.height_m -= 0.2f;
    tick(&seen);
    assert_level(SADDLE_LEVEL_STABLE, SADDLE_REASON_NONE);
    input.time_us += 1000000u;
    seen.com.height_m += 0.1f;
    tick(&seen);
    seen.com.height_m -= 0.1f;
    input.time_us += 1000000u;
    tick(&seen);
    assert_level(SADDLE_LEVEL_STABLE, SADDLE_REASON_NONE);
}

/* ---- the walk that is learned --------------------------------------------------------------- */

static void test_steady_walk_is_learned(void)
{
    tick_until(0, 200);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.56, output.walk.step_time_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.56, output.walk.step_length_m);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.20, output.walk.step_width_m);
    TEST_ASSERT_DOUBLE_WITHIN(0.03, 1.0, output.walk.velocity_m_s.x);
    TEST_ASSERT_DOUBLE_WITHIN(5e-3, 0.997, output.walk.height_m);
    TEST_ASSERT_TRUE(output.walk.ripple > 0.01f && output.walk.ripple < 0.04f);
    TEST_ASSERT_TRUE(output.walk.step_margin > 0.2f && output.walk.step_margin < 0.42f);
}

/* A walker of even speed tolerates more: 2.4 of the ripple, between the two bounds. */
/* Its length is not known where the other foot was not measured. */
static void test_step_without_a_length_is_not_learned(void)
{
    const float margin = 0.1f;
    const saddle_step_tracker_t steps = {
        .struck = true, .v_comp_known = true, .half_step_m = 0.3f, .step_time_s = 0.6f};
    saddle_learning_t learning = {.lowest_margin = margin};
    saddle_learning_step(&learning, &steps, margin);
    ASSERT_SAME_FLOAT(0.0f, learning.walk.step_length_m);
    ASSERT_SAME_FLOAT(0.0f, learning.walk.step_time_s);
}

static void test_tolerance_is_the_walkers_own(void)
{
    const float starts[] = {0.005f, 0.035f, 0.06f, 0.2f};
    const double tolerated[] = {0.42 - 2.4 * 0.005, 0.42 - 2.4 * 0.035, 0.42 - 2.4 * 0.06, 0.25};
    for (size_t i = 0; i < COUNT_OF(starts); i++) {
        const saddle_measurement_t seen = standing();
        setUp();
        config.learn_ripple_start = starts[i];
        saddle_init(&context, &config);
        tick(&seen);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, tolerated[i] + 0.02, output.verdict.margin);
    }
}

/* The push must not teach its own measure: in the second after it the ripple grows by a quarter at
 * most. */
static void test_tolerance_is_not_learned_from_a_push(void)
{
    tick_until(0, 100);
    const float ripple = output.walk.ripple;
    for (int k = 100; k < 112; k++) {
        saddle_measurement_t seen = striding(k);
        seen.com.velocity_m_s.x += 0.8f;
        seen.foot[SADDLE_LEFT].cop_m.x -= 0.04f * (float)(k - 99);
        seen.foot[SADDLE_RIGHT].cop_m.x -= 0.04f * (float)(k - 99);
        tick(&seen);
    }
    TEST_ASSERT_TRUE(output.walk.ripple < 1.25f * ripple);
}

/* Caution begins at half of what the steady steps keep: whoever always comes near 0 is not warned of
 * each step, and whoever never does is warned early. */
static void test_caution_band_is_the_walkers_own(void)
{
    saddle_learning_t learning;
    saddle_learning_init(&learning, model_of(&config));
    const float usual[] = {0.0f, 0.8f, 0.5f, 0.2f, 0.1f, 0.05f, 0.01f};
    const double band[] = {0.1, 0.25, 0.25, 0.1, 0.05, 0.025, 0.025};
    for (size_t i = 0; i < COUNT_OF(usual); i++) {
        learning.walk.step_margin = usual[i];
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, band[i],
                                  saddle_caution_below(model_of(&config), &learning, 0.0f));
    }
}

/* A stumble lengthens a step and its speed: neither becomes the walk. */
static void test_walking_speed_does_not_follow_a_fall(void)
{
    tick_until(0, 106);
    const float usual_m_s = output.scores.v_comp_m_s;
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 1.0, usual_m_s);
    for (int k = 106; k < 127; k++) {
        saddle_measurement_t seen = striding(k);
        seen.com.velocity_m_s.x += 0.6f;
        for (int side = 0; side < 2; side++) {
            seen.foot[side].cop_m.x -= 0.3f;
        }
        tick(&seen);
        const double most_m_s = 0.1 * (double)((k - 99) / 7) + 0.05; /* a step */
        TEST_ASSERT_DOUBLE_WITHIN(most_m_s, (double)usual_m_s, output.scores.v_comp_m_s);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-2, 0.56, output.walk.step_length_m);
}

/* Nor a stumble within a step that is over before the heel strike. */
static void test_walking_speed_does_not_follow_a_stumble_within_a_step(void)
{
    tick_until(0, 106);
    const float usual_m_s = output.scores.v_comp_m_s;
    for (int k = 106; k < 113; k++) {
        saddle_measurement_t seen = striding(k);
        const bool stumbles = k > 106 && k < 110;
        seen.com.velocity_m_s.x += stumbles ? 1.5f : 0.0f;
        for (int side = 0; side < 2; side++) {
            seen.foot[side].cop_m.x -= stumbles ? 0.2f : 0.0f;
        }
        tick(&seen);
        TEST_ASSERT_DOUBLE_WITHIN(0.12, (double)usual_m_s, output.scores.v_comp_m_s);
    }
}

static void test_slow_ticks_and_equal_times_keep_the_learned_walk_valid(void)
{
    saddle_measurement_t seen = standing();
    tick(&seen);
    for (int k = 0; k < 100; k++) {
        input.time_us -= 80000u; /* the same time again */
        seen.com.height_m += 0.0001f;
        tick(&seen);
        assert_level(SADDLE_LEVEL_STABLE, SADDLE_REASON_NONE);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.0, output.walk.height_m);
    }
}

/* ---- no silence ----------------------------------------------------------------------------- */

static void test_falling_backward_without_a_walk_is_unstable(void)
{
    saddle_measurement_t seen = standing();
    bool alarmed = false;
    for (int k = 0; k < 12; k++) {
        for (int side = 0; side < 2; side++) {
            seen.foot[side].cop_m.x = 0.004f * (float)(k * k);
        }
        seen.com.velocity_m_s.x = -0.1f * (float)k;
        seen.com.height_m -= 0.004f * (float)k;
        tick(&seen);
        TEST_ASSERT_TRUE(output.verdict.level != (uint8_t)SADDLE_LEVEL_UNKNOWN);
        alarmed = output.verdict.level == (uint8_t)SADDLE_LEVEL_UNSTABLE;
    }
    TEST_ASSERT_TRUE(alarmed);
    TEST_ASSERT_EQUAL_UINT8(SADDLE_REASON_BACKWARD, output.verdict.reason);
}

/* A cross-over step in the midst of an alarm, and a jump: the level goes on. */
static void test_crossed_feet_and_flight_are_evidence_once_a_level_holds(void)
{
    tick_until(0, 50);
    for (int k = 50; k < 70; k++) {
        saddle_measurement_t seen = striding(k);
        seen.foot[SADDLE_LEFT].cop_m.y = -0.35f;
        seen.foot[SADDLE_RIGHT].cop_m.y = -0.05f;
        seen.foot[SADDLE_LEFT].contact = seen.foot[SADDLE_RIGHT].contact = false;
        tick(&seen);
        TEST_ASSERT_BITS_HIGH(SADDLE_FAULT_FEET_CROSSED, output.faults);
        TEST_ASSERT_TRUE(output.verdict.margin_known);
        TEST_ASSERT_TRUE(output.verdict.level != (uint8_t)SADDLE_LEVEL_UNKNOWN);
    }
    TEST_ASSERT_BITS_HIGH(SADDLE_FAULT_AIRBORNE, output.faults);
}

/* A tick that is lost in the midst of a cross-over step silences nothing but itself. */
static void test_crossed_feet_stay_evidence_over_a_lost_tick_and_a_gap(void)
{
    const bool gaps[] = {false, true};
    for (size_t i = 0; i < COUNT_OF(gaps); i++) {
        setUp();
        tick_until(0, 50);
        for (int k = 50; k < 60; k++) {
            saddle_measurement_t seen = striding(k);
            seen.foot[SADDLE_LEFT].cop_m.y = -0.35f;
            seen.com.age_us = !gaps[i] && k == 53 ? SADDLE_AGE_NEVER_US : 0u;
            input.time_us += gaps[i] && k == 53 ? 300000u : 0u;
            tick(&seen);
            TEST_ASSERT_EQUAL(gaps[i] || k != 53, output.verdict.margin_known);
        }
        TEST_ASSERT_TRUE(output.verdict.level != (uint8_t)SADDLE_LEVEL_UNKNOWN);
    }
}

/* From the first tick on crossed feet are sides that were swapped. */
static void test_feet_crossed_from_the_beginning_are_not_a_measurement(void)
{
    saddle_measurement_t seen = standing();
    seen.foot[SADDLE_LEFT].cop_m.y = -0.1f;
    seen.foot[SADDLE_RIGHT].cop_m.y = 0.1f;
    for (int k = 0; k < 20; k++) {
        seen.com.velocity_m_s.x += 0.001f;
        seen.foot[SADDLE_LEFT].cop_m.x += 0.001f;
        seen.foot[SADDLE_RIGHT].cop_m.x += 0.001f;
        tick(&seen);
        assert_level(SADDLE_LEVEL_UNKNOWN, SADDLE_REASON_INPUT);
    }
}

static void test_one_leg_and_feet_together_have_a_level(void)
{
    saddle_measurement_t seen = standing();
    seen.foot[SADDLE_RIGHT].contact = false;
    tick(&seen);
    assert_level(SADDLE_LEVEL_STABLE, SADDLE_REASON_NONE);
    seen.foot[SADDLE_LEFT].cop_m = seen.foot[SADDLE_RIGHT].cop_m = (saddle_vec2_t){0.0f, 0.0f};
    tick(&seen);
    TEST_ASSERT_BITS_HIGH(SADDLE_FAULT_FEET_TOGETHER, output.faults);
    assert_level(SADDLE_LEVEL_STABLE, SADDLE_REASON_NONE);
}

static void test_missing_inputs_are_unknown_at_once(void)
{
    for (int which = 0; which < 3; which++) {
        setUp();
        tick_until(0, 20);
        saddle_measurement_t seen = striding(20);
        (which == 0 ? &seen.com.age_us : &seen.foot[which - 1].age_us)[0] = SADDLE_AGE_NEVER_US;
        tick(&seen);
        TEST_ASSERT_FALSE(output.verdict.margin_known);
        assert_level(SADDLE_LEVEL_UNKNOWN, SADDLE_REASON_INPUT);
        seen = striding(21);
        tick(&seen);
        assert_level(SADDLE_LEVEL_STABLE, SADDLE_REASON_NONE);
    }
}

/* ---- who is led ----------------------------------------------------------------------------- */

static void test_plan_adds_the_reserve_of_the_next_step(void)
{
    saddle_learning_t learning;
    saddle_learning_init(&learning, model_of(&config));
    learning.walk.height_m = 2.0f;
    const float margins[] = {-9.0f, -0.5f, 0.1f, 9.0f};
    const double parts[] = {-0.5, -0.25, 0.05, 0.2};
    for (size_t i = 0; i < COUNT_OF(margins); i++) {
        for (size_t j = 0; j < COUNT_OF(margins); j++) {
            saddle_verdict_t verdict = {.ebos_com_m = margins[j]};
            verdict.recovery.margin_m = margins[i];
            TEST_ASSERT_DOUBLE_WITHIN(1e-6, 2.0 * (parts[i] + parts[j]) + 0.45,
                                      saddle_plan_margin(model_of(&config), &learning, &verdict));
        }
    }
}

static void test_reason_of_an_insufficient_step(void)
{
    const saddle_departure_t departure = {.offset = {0.1f, 0.2f}, .sink = 0.3f};
    TEST_ASSERT_EQUAL_INT(SADDLE_REASON_NO_STEP, saddle_driver(&departure, -0.31f));
    TEST_ASSERT_EQUAL_INT(SADDLE_REASON_SINKING, saddle_driver(&departure, -0.29f));
}

static saddle_measurement_t measured_plan(const saddle_plan_t *plan)
{
    saddle_measurement_t seen = standing();
    seen.com.height_m = plan->com_m.z;
    seen.com.velocity_m_s.x = plan->com_velocity_m_s.x;
    seen.com.velocity_m_s.y = plan->com_velocity_m_s.y;
    for (int side = 0; side < 2; side++) {
        seen.foot[side].cop_m.x = plan->foot_m[side].x - plan->com_m.x;
        seen.foot[side].cop_m.y = plan->foot_m[side].y - plan->com_m.y;
        seen.foot[side].contact = side == (int)plan->support || plan->foot_m[side].z < 0.002f;
    }
    return seen;
}

/* Whoever walks on the other foot than the plan has is compared with no step of the plan. */
static void test_walk_out_of_step_with_the_plan_is_not_a_fall(void)
{
    static saddle_context_t other;
    saddle_input_t walked = {.command = {SADDLE_COMMAND_WALK, 1.2f, 0.17f, 0.0f}};
    walked.measurement = saddle_no_measurement();
    saddle_output_t planned;
    saddle_init(&other, &config);
    saddle_join(&other, &walked.command);
    for (; walked.time_us < 560000u; walked.time_us += 80000u) { /* about a step ahead */
        saddle_tick(&other, &walked, &planned);
    }
    input.command = walked.command;
    saddle_join(&context, &input.command);
    for (int k = 0; k < 200; k++) {
        saddle_tick(&other, &walked, &planned);
        walked.time_us += 80000u;
        const saddle_measurement_t seen = measured_plan(&planned.plan);
        tick(&seen);
        TEST_ASSERT_TRUE(output.verdict.level != (uint8_t)SADDLE_LEVEL_UNSTABLE);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_margin_of_random_walks_is_that_of_the_equations);
    RUN_TEST(test_level_and_reason_follow_the_margin);
    RUN_TEST(test_sinking_com_is_evidence);
    RUN_TEST(test_collapse_over_the_feet_is_announced);
    RUN_TEST(test_sitting_down_is_not_a_collapse_even_with_a_slow_sensor);
    RUN_TEST(test_sinking_is_known_without_a_foot);
    RUN_TEST(test_com_below_the_knees_is_unstable_once_it_was_seen_above);
    RUN_TEST(test_height_before_a_gap_does_not_count_for_sinking);
    RUN_TEST(test_steady_walk_is_learned);
    RUN_TEST(test_step_without_a_length_is_not_learned);
    RUN_TEST(test_tolerance_is_the_walkers_own);
    RUN_TEST(test_tolerance_is_not_learned_from_a_push);
    RUN_TEST(test_caution_band_is_the_walkers_own);
    RUN_TEST(test_walking_speed_does_not_follow_a_fall);
    RUN_TEST(test_walking_speed_does_not_follow_a_stumble_within_a_step);
    RUN_TEST(test_slow_ticks_and_equal_times_keep_the_learned_walk_valid);
    RUN_TEST(test_falling_backward_without_a_walk_is_unstable);
    RUN_TEST(test_crossed_feet_and_flight_are_evidence_once_a_level_holds);
    RUN_TEST(test_crossed_feet_stay_evidence_over_a_lost_tick_and_a_gap);
    RUN_TEST(test_feet_crossed_from_the_beginning_are_not_a_measurement);
    RUN_TEST(test_one_leg_and_feet_together_have_a_level);
    RUN_TEST(test_missing_inputs_are_unknown_at_once);
    RUN_TEST(test_plan_adds_the_reserve_of_the_next_step);
    RUN_TEST(test_reason_of_an_insufficient_step);
    RUN_TEST(test_walk_out_of_step_with_the_plan_is_not_a_fall);
    return UNITY_END();
}
