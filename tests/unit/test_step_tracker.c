/** How steps are followed: heel strikes, v_CoMp, half steps, the stance foot, standing. */
#include "core_test.h"

#include "sense/step_tracker.h"

static const float DT_S = 0.08f;

static saddle_config_t config;
static saddle_step_tracker_t tracker;
static saddle_measurement_t measured;

/* Both feet down, the left one 0.6 m ahead and 0.11 m left of the right one. */
void setUp(void)
{
    config = paper_config();
    config.step_time_max_s = 4.0f;
    memset(&tracker, 0, sizeof tracker);
    measured = (saddle_measurement_t){
        .com = {.height_m = 1.0f, .velocity_m_s = {1.1f, 0.05f}},
        .foot = {{.cop_m = {0.35f, 0.06f}, .contact = true},
                 {.cop_m = {-0.25f, -0.05f}, .contact = true}},
    };
}

void tearDown(void) {}

static void track_for(float dt_s, uint32_t faults)
{
    saddle_track_steps(&tracker, model_of(&config), &measured, faults, dt_s);
}

static void track(void)
{
    track_for(DT_S, 0);
}

/* Two ticks in the air, and down. */
static void strike_with(saddle_side_t side)
{
    measured.foot[side].contact = false;
    track();
    track();
    measured.foot[side].contact = true;
    track();
}

/* ---- heel strikes -------------------------------------------------------------------------- */

static void test_contact_from_the_start_is_not_a_heel_strike(void)
{
    for (int tick = 0; tick < 5; tick++) {
        track();
    }
    TEST_ASSERT_FALSE(tracker.half_step_known);
    TEST_ASSERT_FALSE(tracker.step_open);
}

/* 0.12 s and less: 1 ms ticks, as a fast contact sensor gives them. */
static void test_flickering_contact_is_not_a_heel_strike(void)
{
    const struct {
        int airborne_ms;
        bool strike;
    } table[] = {{1, false}, {10, false}, {119, false}, {121, true}, {400, true}};
    for (size_t i = 0; i < COUNT_OF(table); i++) {
        setUp();
        track();
        measured.foot[SADDLE_LEFT].contact = false;
        for (int ms = 0; ms < table[i].airborne_ms; ms++) {
            track_for(1e-3f, 0);
        }
        measured.foot[SADDLE_LEFT].contact = true;
        track_for(1e-3f, 0);
        TEST_ASSERT_EQUAL(table[i].strike, tracker.half_step_known);
    }
}

/* Twenty short losses in a row are not one long one. */
static void test_losses_of_contact_do_not_add_up(void)
{
    track();
    for (int tick = 0; tick < 40; tick++) {
        measured.foot[SADDLE_LEFT].contact = tick % 2 == 1;
        track();
    }
    TEST_ASSERT_FALSE(tracker.half_step_known);
}

/* A flicker as the foot lands does not open another step: the half step and speed stay. */
static void test_flicker_after_a_landing_leaves_the_step(void)
{
    track();
    strike_with(SADDLE_LEFT);
    strike_with(SADDLE_RIGHT);
    const saddle_step_tracker_t before = tracker;
    measured.com.velocity_m_s.x = 0.2f;
    measured.foot[SADDLE_RIGHT].contact = false;
    track();
    measured.foot[SADDLE_RIGHT].contact = true;
    track();
    ASSERT_SAME_FLOAT(before.v_comp_m_s, tracker.v_comp_m_s);
    ASSERT_SAME_FLOAT(before.half_step_m, tracker.half_step_m);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.16, tracker.step_duration_s);
}

/* ---- half step and width ------------------------------------------------------------------- */

static void test_half_step_is_half_of_what_the_landed_foot_is_ahead(void)
{
    track();
    strike_with(SADDLE_LEFT);
    TEST_ASSERT_TRUE(tracker.half_step_known);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.3, tracker.half_step_m);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.11, tracker.step_width_m);
}

/* The right foot lands 0.6 m behind the left one: a step backwards, or after a very long one. */
static void test_half_step_is_negative_for_a_foot_that_lands_behind(void)
{
    track();
    strike_with(SADDLE_RIGHT);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, -0.3, tracker.half_step_m);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.11, tracker.step_width_m);
    measured.foot[SADDLE_RIGHT].cop_m = (saddle_vec2_t){0.55f, 0.10f};
    strike_with(SADDLE_RIGHT);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.1, tracker.half_step_m);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, -0.04, tracker.step_width_m); /* crossed */
}

static void test_half_step_is_that_of_the_last_heel_strike(void)
{
    track();
    strike_with(SADDLE_LEFT);
    measured.foot[SADDLE_LEFT].cop_m.x = 0.1f; /* the body moves on, the half step stays */
    measured.foot[SADDLE_RIGHT].cop_m.x = -0.4f;
    track();
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.3, tracker.half_step_m);
    measured.foot[SADDLE_RIGHT].cop_m.x = 0.3f;
    strike_with(SADDLE_RIGHT);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 0.1, tracker.half_step_m);
}

static void test_half_step_needs_both_feet(void)
{
    const uint32_t faults[] = {SADDLE_FAULT_RIGHT_STALE, SADDLE_FAULT_RIGHT_RANGE,
                               SADDLE_FAULT_RIGHT_FROZEN};
    for (size_t i = 0; i < COUNT_OF(faults); i++) {
        setUp();
        measured.foot[SADDLE_LEFT].contact = false;
        track_for(DT_S, faults[i]);
        track_for(DT_S, faults[i]);
        measured.foot[SADDLE_LEFT].contact = true;
        track_for(DT_S, faults[i]);
        TEST_ASSERT_FALSE(tracker.half_step_known);
        TEST_ASSERT_TRUE(tracker.step_open); /* it was a heel strike all the same */
    }
}

static void test_strike_during_an_outage_is_seen_when_the_foot_is_back(void)
{
    measured.foot[SADDLE_LEFT].contact = false;
    track();
    track();
    measured.foot[SADDLE_LEFT].contact = true;
    track_for(DT_S, SADDLE_FAULT_LEFT_STALE);
    TEST_ASSERT_FALSE(tracker.half_step_known);
    track();
    TEST_ASSERT_TRUE(tracker.half_step_known);
}

/* ---- v_CoMp -------------------------------------------------------------------------------- */

static void test_v_comp_is_the_mean_from_one_heel_strike_to_the_next(void)
{
    track();
    strike_with(SADDLE_LEFT); /* opens the first step at 1.1 m/s */
    TEST_ASSERT_FALSE(tracker.v_comp_known);
    measured.foot[SADDLE_RIGHT].contact = false;
    const float speeds[] = {1.2f, 1.4f, 1.0f, 0.9f};
    for (size_t i = 0; i < COUNT_OF(speeds); i++) {
        measured.com.velocity_m_s.x = speeds[i];
        track();
        TEST_ASSERT_FALSE(tracker.v_comp_known);
    }
    measured.foot[SADDLE_RIGHT].contact = true;
    measured.com.velocity_m_s.x = 1.3f;
    track();
    /* Trapezoids: (1.1/2 + 1.2 + 1.4 + 1.0 + 0.9 + 1.3/2) / 5. */
    TEST_ASSERT_TRUE(tracker.v_comp_known);
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 1.14, tracker.v_comp_m_s);
    measured.com.velocity_m_s.x = 0.5f;
    measured.foot[SADDLE_LEFT].contact = false;
    track();
    track();
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 1.14, tracker.v_comp_m_s);
    measured.foot[SADDLE_LEFT].contact = true;
    track(); /* the second step: (1.3/2 + 0.5 + 0.5 + 0.5/2) / 3, nothing left from the first */
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 1.9 / 3.0, tracker.v_comp_m_s);
}

/* Ticks of any length: each trapezoid counts by its own time. */
static void test_v_comp_weighs_each_tick_by_its_time(void)
{
    track();
    strike_with(SADDLE_LEFT); /* at 1.1 m/s */
    measured.foot[SADDLE_RIGHT].contact = false;
    const float speeds[] = {1.5f, 0.7f, 1.0f};
    const float times[] = {0.02f, 0.2f, 0.05f};
    double way = 0.0;
    double last = 1.1;
    for (size_t i = 0; i < COUNT_OF(speeds); i++) {
        measured.com.velocity_m_s.x = speeds[i];
        measured.foot[SADDLE_RIGHT].contact = i == 2u;
        track_for(times[i], 0);
        way += 0.5 * ((double)speeds[i] + last) * (double)times[i];
        last = (double)speeds[i];
    }
    TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, way / 0.27, tracker.v_comp_m_s);
}

/* Steps of 0.613 s at a speed that rises evenly, in ticks of 80 ms: the contact says when within the
 * tick each heel struck. 1 ms and 1 mm/s: what a sum of a hundred float products may be off. */
static void test_step_time_and_v_comp_are_exact_within_the_tick(void)
{
    const double step_s = 0.613;
    int strikes = 0;
    for (int tick = 0; tick < 100; tick++) {
        const double time_s = 0.08 * tick;
        const int steps = (int)(time_s / step_s);
        const double into_s = time_s - steps * step_s;
        measured.com.velocity_m_s.x = (float)(0.5 + 0.1 * time_s);
        for (int side = 0; side < 2; side++) {
            const bool landed_last = steps % 2 == side;
            measured.foot[side].contact = landed_last || into_s < 0.1;
            measured.foot[side].since_us =
                landed_last ? (uint32_t)(1e6 * into_s) : (uint32_t)(1e6 * (into_s + step_s));
        }
        track();
        if (tracker.struck && ++strikes > 1) {
            const double mean_m_s = 0.5 + 0.1 * (steps - 0.5) * step_s;
            TEST_ASSERT_FLOAT_WITHIN(1e-3f, (float)step_s, tracker.step_time_s);
            TEST_ASSERT_FLOAT_WITHIN(1e-3f, (float)mean_m_s, tracker.v_comp_m_s);
            TEST_ASSERT_FLOAT_WITHIN(1e-3f, (float)into_s, tracker.since_strike_s);
        }
    }
    TEST_ASSERT_EQUAL_INT(12, strikes);
}

/* From 1 to 2 m/s in a tick, and the heel struck at half of it: 1.5 m/s. */
static void test_velocity_at_a_strike_within_the_tick_is_between_the_measured_ones(void)
{
    measured.com.velocity_m_s.x = 1.0f;
    track();
    strike_with(SADDLE_LEFT);
    measured.foot[SADDLE_RIGHT].contact = false;
    track();
    track();
    measured.foot[SADDLE_RIGHT].contact = true;
    measured.foot[SADDLE_RIGHT].since_us = 40000u;
    measured.com.velocity_m_s.x = 2.0f;
    track();
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, (0.16f * 1.0f + 0.04f * 1.25f) / 0.2f, tracker.v_comp_m_s);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.04f * 1.75f, tracker.step_distance_m);
}

/* A sensor that claims more: the strike was in this tick, or the last would have seen it. */
static void test_strike_is_no_longer_ago_than_the_last_tick(void)
{
    track();
    measured.foot[SADDLE_LEFT].since_us = UINT32_MAX;
    strike_with(SADDLE_LEFT);
    TEST_ASSERT_EQUAL_FLOAT(DT_S, tracker.since_strike_s);
    TEST_ASSERT_EQUAL_FLOAT(DT_S, tracker.step_duration_s);
}

static void test_step_with_a_gap_in_the_velocity_gives_no_v_comp(void)
{
    const uint32_t faults[] = {SADDLE_FAULT_COM_STALE, SADDLE_FAULT_COM_RANGE,
                               SADDLE_FAULT_COM_FROZEN};
    for (size_t i = 0; i < COUNT_OF(faults); i++) {
        setUp();
        strike_with(SADDLE_LEFT);
        track_for(DT_S, faults[i]);
        strike_with(SADDLE_RIGHT);
        TEST_ASSERT_FALSE(tracker.v_comp_known);
        strike_with(SADDLE_LEFT); /* the next whole step does */
        TEST_ASSERT_TRUE(tracker.v_comp_known);
        TEST_ASSERT_DOUBLE_WITHIN(FLOAT_TOLERANCE, 1.1, tracker.v_comp_m_s);
    }
}

static void strike_without(saddle_side_t side, uint32_t faults)
{
    measured.foot[side].contact = false;
    track();
    track();
    measured.foot[side].contact = true;
    track_for(DT_S, faults);
}

static void test_step_that_begins_without_a_velocity_gives_no_v_comp(void)
{
    strike_without(SADDLE_LEFT, SADDLE_FAULT_COM_STALE);
    strike_with(SADDLE_RIGHT);
    TEST_ASSERT_FALSE(tracker.v_comp_known);
}

static void test_step_over_a_gap_between_the_ticks_gives_no_v_comp(void)
{
    strike_with(SADDLE_LEFT);
    saddle_track_gap(&tracker, 0.3f);
    strike_with(SADDLE_RIGHT);
    TEST_ASSERT_FALSE(tracker.v_comp_known);
    strike_with(SADDLE_LEFT);
    TEST_ASSERT_TRUE(tracker.v_comp_known);
}

/* A step that could not be measured is the last one all the same: what was before it is old. */
static void test_unmeasured_strike_clears_the_last_step(void)
{
    strike_with(SADDLE_LEFT);
    strike_with(SADDLE_RIGHT);
    strike_without(SADDLE_LEFT, SADDLE_FAULT_COM_STALE);
    TEST_ASSERT_FALSE(tracker.v_comp_known);
    TEST_ASSERT_TRUE(tracker.half_step_known);
    strike_without(SADDLE_RIGHT, SADDLE_FAULT_LEFT_STALE);
    TEST_ASSERT_FALSE(tracker.half_step_known);
}

/* Both feet land at one instant: between them there is no time to take a mean over. */
static void test_strikes_of_one_instant_give_no_v_comp(void)
{
    measured.foot[SADDLE_LEFT].contact = false;
    measured.foot[SADDLE_RIGHT].contact = false;
    track();
    track();
    measured.foot[SADDLE_LEFT].contact = true;
    track();
    measured.foot[SADDLE_RIGHT].contact = true;
    track_for(0.0f, 0);
    TEST_ASSERT_TRUE(tracker.struck);
    TEST_ASSERT_FALSE(tracker.v_comp_known);
}

/* ---- forgetting ---------------------------------------------------------------------------- */

static void test_last_step_is_forgotten_after_step_time_max(void)
{
    config.step_time_max_s = 1.0f;
    strike_with(SADDLE_LEFT);
    strike_with(SADDLE_RIGHT);
    for (int tick = 1; tick <= 20; tick++) { /* 12 ticks are 0.96 s, 13 are 1.04 s */
        track();
        TEST_ASSERT_EQUAL(tick <= 12, tracker.v_comp_known);
        TEST_ASSERT_EQUAL(tick <= 12, tracker.half_step_known);
        TEST_ASSERT_TRUE(tracker.since_strike_s <= 1.0f);
    }
    strike_with(SADDLE_LEFT); /* ends no step: the time to it was no step */
    TEST_ASSERT_TRUE(tracker.half_step_known);
    TEST_ASSERT_FALSE(tracker.v_comp_known);
    strike_with(SADDLE_RIGHT);
    TEST_ASSERT_TRUE(tracker.v_comp_known);
}

static void test_step_is_forgotten_also_while_nothing_is_measured(void)
{
    const uint32_t all = SADDLE_FAULTS_COM | SADDLE_FAULTS_FEET;
    config.step_time_max_s = 1.0f;
    strike_with(SADDLE_LEFT);
    strike_with(SADDLE_RIGHT);
    for (int tick = 0; tick < 14; tick++) {
        track_for(DT_S, all);
    }
    TEST_ASSERT_FALSE(tracker.v_comp_known);
    TEST_ASSERT_FALSE(tracker.half_step_known);
}

/* The time between two ticks counts, however long: half a second is remembered. */
static void test_step_is_forgotten_over_a_long_gap_between_the_ticks(void)
{
    const float gaps_s[] = {0.5f, 0.7f, 600.0f}; /* after 0.24 s of ticks, and before one */
    config.step_time_max_s = 1.0f;
    for (size_t i = 0; i < COUNT_OF(gaps_s); i++) {
        strike_with(SADDLE_LEFT);
        strike_with(SADDLE_RIGHT);
        track();
        track();
        track();
        saddle_track_gap(&tracker, gaps_s[i]);
        track();
        TEST_ASSERT_EQUAL(i == 0u, tracker.v_comp_known);
        TEST_ASSERT_EQUAL(i == 0u, tracker.half_step_known);
    }
}

/* The foot was in the air before the gap and is down after it. */
static void test_heel_strike_after_a_long_gap_does_not_keep_the_speed(void)
{
    strike_with(SADDLE_LEFT);
    strike_with(SADDLE_RIGHT);
    measured.foot[SADDLE_LEFT].contact = false;
    track();
    track();
    saddle_track_gap(&tracker, 600.0f);
    measured.foot[SADDLE_LEFT].contact = true;
    track();
    TEST_ASSERT_FALSE(tracker.v_comp_known);
    TEST_ASSERT_TRUE(tracker.half_step_known); /* of this landing */
}

static void test_standing_is_detected_again_after_a_gap(void)
{
    measured.com.velocity_m_s = (saddle_vec2_t){0.0f, 0.0f};
    track();
    TEST_ASSERT_TRUE(tracker.stands);
    saddle_track_gap(&tracker, 0.3f);
    measured.com.velocity_m_s.x = 1.1f;
    track();
    TEST_ASSERT_FALSE(tracker.stands);
}

/* Each heel strike begins the time anew, also one without a known speed. */
static void test_walk_that_goes_on_is_not_forgotten(void)
{
    config.step_time_max_s = 1.0f;
    for (int step = 0; step < 20; step++) {
        strike_with(step % 2 == 0 ? SADDLE_LEFT : SADDLE_RIGHT);
        TEST_ASSERT_TRUE(tracker.half_step_known);
        TEST_ASSERT_EQUAL(step > 0, tracker.v_comp_known);
    }
}

/* ---- stance and standing ------------------------------------------------------------------- */

static void test_stance_is_the_foot_that_landed_last_or_the_only_one_down(void)
{
    track();
    TEST_ASSERT_EQUAL_UINT8(SADDLE_LEFT, tracker.stance);
    measured.foot[SADDLE_LEFT].contact = false;
    track();
    TEST_ASSERT_EQUAL_UINT8(SADDLE_RIGHT, tracker.stance);
    track();
    measured.foot[SADDLE_LEFT].contact = true;
    track(); /* landed: it is the stance foot in double support already */
    TEST_ASSERT_EQUAL_UINT8(SADDLE_LEFT, tracker.stance);
    track();
    TEST_ASSERT_EQUAL_UINT8(SADDLE_LEFT, tracker.stance);
    measured.foot[SADDLE_RIGHT].contact = false;
    track();
    TEST_ASSERT_EQUAL_UINT8(SADDLE_LEFT, tracker.stance);
    measured.foot[SADDLE_LEFT].contact = false;
    track(); /* in flight it stays */
    TEST_ASSERT_EQUAL_UINT8(SADDLE_LEFT, tracker.stance);
    measured.foot[SADDLE_RIGHT].contact = true;
    track();
    TEST_ASSERT_EQUAL_UINT8(SADDLE_RIGHT, tracker.stance);
}

static void test_standing_is_both_feet_down_and_a_slow_com(void)
{
    const struct {
        float vx, vy;
        bool left, right, stands;
    } table[] = {{0.0f, 0.0f, true, true, true},    {0.19f, 0.0f, true, true, true},
                 {0.0f, -0.19f, true, true, true},  {0.21f, 0.0f, true, true, false},
                 {0.15f, 0.15f, true, true, false}, {0.15f, -0.15f, true, true, false},
                 {-0.21f, 0.0f, true, true, false}, {0.0f, 0.0f, false, true, false},
                 {0.0f, 0.0f, true, false, false}};
    for (size_t i = 0; i < COUNT_OF(table); i++) {
        setUp();
        measured.com.velocity_m_s = (saddle_vec2_t){table[i].vx, table[i].vy};
        measured.foot[SADDLE_LEFT].contact = table[i].left;
        measured.foot[SADDLE_RIGHT].contact = table[i].right;
        track();
        TEST_ASSERT_EQUAL(table[i].stands, tracker.stands);
    }
}

static void test_standing_is_not_seen_through_a_fault(void)
{
    const uint32_t faults[] = {SADDLE_FAULT_COM_STALE, SADDLE_FAULT_LEFT_FROZEN,
                               SADDLE_FAULT_RIGHT_RANGE};
    measured.com.velocity_m_s = (saddle_vec2_t){0.0f, 0.0f};
    for (size_t i = 0; i < COUNT_OF(faults); i++) {
        track_for(DT_S, faults[i]);
        TEST_ASSERT_FALSE(tracker.stands);
    }
}

/* From standing until a step is complete; and, after a walk, once it has been forgotten. */
static void test_standing_holds_until_a_step_is_complete(void)
{
    config.step_time_max_s = 1.0f;
    measured.com.velocity_m_s = (saddle_vec2_t){0.0f, 0.0f};
    track();
    TEST_ASSERT_TRUE(tracker.stands);
    measured.com.velocity_m_s.x = 1.1f; /* a push, or the first step */
    track();
    TEST_ASSERT_TRUE(tracker.stands);
    strike_with(SADDLE_LEFT);
    TEST_ASSERT_TRUE(tracker.stands);
    strike_with(SADDLE_RIGHT);
    TEST_ASSERT_FALSE(tracker.stands);
    measured.com.velocity_m_s.x = 0.0f;
    for (int tick = 1; tick <= 13; tick++) {
        track();
        TEST_ASSERT_EQUAL(tick == 13, tracker.stands);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_contact_from_the_start_is_not_a_heel_strike);
    RUN_TEST(test_flickering_contact_is_not_a_heel_strike);
    RUN_TEST(test_losses_of_contact_do_not_add_up);
    RUN_TEST(test_flicker_after_a_landing_leaves_the_step);
    RUN_TEST(test_half_step_is_half_of_what_the_landed_foot_is_ahead);
    RUN_TEST(test_half_step_is_negative_for_a_foot_that_lands_behind);
    RUN_TEST(test_half_step_is_that_of_the_last_heel_strike);
    RUN_TEST(test_half_step_needs_both_feet);
    RUN_TEST(test_strike_during_an_outage_is_seen_when_the_foot_is_back);
    RUN_TEST(test_v_comp_is_the_mean_from_one_heel_strike_to_the_next);
    RUN_TEST(test_v_comp_weighs_each_tick_by_its_time);
    RUN_TEST(test_step_time_and_v_comp_are_exact_within_the_tick);
    RUN_TEST(test_velocity_at_a_strike_within_the_tick_is_between_the_measured_ones);
    RUN_TEST(test_strike_is_no_longer_ago_than_the_last_tick);
    RUN_TEST(test_step_with_a_gap_in_the_velocity_gives_no_v_comp);
    RUN_TEST(test_step_that_begins_without_a_velocity_gives_no_v_comp);
    RUN_TEST(test_step_over_a_gap_between_the_ticks_gives_no_v_comp);
    RUN_TEST(test_unmeasured_strike_clears_the_last_step);
    RUN_TEST(test_strikes_of_one_instant_give_no_v_comp);
    RUN_TEST(test_last_step_is_forgotten_after_step_time_max);
    RUN_TEST(test_step_is_forgotten_also_while_nothing_is_measured);
    RUN_TEST(test_step_is_forgotten_over_a_long_gap_between_the_ticks);
    RUN_TEST(test_heel_strike_after_a_long_gap_does_not_keep_the_speed);
    RUN_TEST(test_standing_is_detected_again_after_a_gap);
    RUN_TEST(test_walk_that_goes_on_is_not_forgotten);
    RUN_TEST(test_stance_is_the_foot_that_landed_last_or_the_only_one_down);
    RUN_TEST(test_standing_is_both_feet_down_and_a_slow_com);
    RUN_TEST(test_standing_is_not_seen_through_a_fault);
    RUN_TEST(test_standing_holds_until_a_step_is_complete);
    return UNITY_END();
}
