/** When lost inputs stop the walk, and when it may go on. */
#include "core_test.h"

#include "sense/safe_state.h"

static const float DT_S = 0.08f;

static saddle_config_t config;
static saddle_safe_state_t state;

void setUp(void)
{
    config = paper_config();
    config.com_max_age_s = 0.24f;
    config.resume_time_s = 1.0f;
    memset(&state, 0, sizeof state);
}

void tearDown(void) {}

static bool update_of(uint32_t faults, bool unstable)
{
    const saddle_safe_inputs_t inputs = {faults, unstable, false};
    return saddle_safe_state_update(&state, model_of(&config), &inputs, DT_S);
}

static bool update_under_a_stand(uint32_t faults)
{
    const saddle_safe_inputs_t inputs = {faults, false, true};
    return saddle_safe_state_update(&state, model_of(&config), &inputs, DT_S);
}

static bool update(uint32_t faults)
{
    return update_of(faults, false);
}

static const uint32_t LOST[] = {SADDLE_FAULT_COMMAND_STALE, SADDLE_FAULT_COM_STALE,
                                SADDLE_FAULT_COM_FROZEN,    SADDLE_FAULT_LEFT_STALE,
                                SADDLE_FAULT_LEFT_FROZEN,   SADDLE_FAULT_RIGHT_STALE,
                                SADDLE_FAULT_RIGHT_FROZEN};

static const uint32_t UNUSABLE[] = {SADDLE_FAULT_COM_RANGE, SADDLE_FAULT_LEFT_RANGE,
                                    SADDLE_FAULT_RIGHT_RANGE, SADDLE_FAULT_AIRBORNE,
                                    SADDLE_FAULT_FEET_CROSSED};

static void test_good_inputs_never_stop(void)
{
    for (int tick = 0; tick < 1000; tick++) {
        TEST_ASSERT_FALSE(update(0));
    }
}

static void test_input_that_is_stale_or_frozen_stops_in_the_same_tick(void)
{
    for (size_t i = 0; i < COUNT_OF(LOST); i++) {
        setUp();
        update(0);
        TEST_ASSERT_TRUE(update(LOST[i]));
    }
}

static void test_recording_goes_on_whatever_is_missing(void)
{
    config.lost_inputs_stop = 0.0f;
    for (size_t i = 0; i < COUNT_OF(LOST); i++) {
        update(0);
        TEST_ASSERT_FALSE(update(LOST[i]));
    }
}

/* A number out of range for a tick or two may be a glitch: three ticks are 0.24 s. */
static void test_measurement_that_is_unusable_stops_once_it_has_been_for_com_max_age(void)
{
    for (size_t i = 0; i < COUNT_OF(UNUSABLE); i++) {
        setUp();
        update(0);
        for (int tick = 1; tick <= 6; tick++) {
            TEST_ASSERT_EQUAL(tick > 3, update(UNUSABLE[i]));
        }
    }
}

static void test_glitches_do_not_add_up(void)
{
    for (int tick = 0; tick < 100; tick++) {
        TEST_ASSERT_FALSE(update(tick % 4 == 0 ? 0u : (uint32_t)SADDLE_FAULT_COM_RANGE));
    }
}

/* One fault after the other: it is the time without any usable measurement that counts. */
static void test_alternating_unusable_inputs_count_as_continuous(void)
{
    update(0);
    for (int tick = 1; tick <= 6; tick++) {
        TEST_ASSERT_EQUAL(tick > 3, update(UNUSABLE[(size_t)tick % COUNT_OF(UNUSABLE)]));
    }
}

/* What says nothing about the inputs' being there stops nothing. */
static void test_other_faults_do_not_stop(void)
{
    const uint32_t others[] = {SADDLE_FAULT_COMMAND, SADDLE_FAULT_FEET_TOGETHER,
                               SADDLE_FAULT_SPEED_INFEASIBLE};
    for (size_t i = 0; i < COUNT_OF(others); i++) {
        update(0);
        for (int tick = 0; tick < 20; tick++) {
            TEST_ASSERT_FALSE(update(others[i]));
        }
    }
}

/* Good for 12 ticks, 0.96 s, is not yet 1 s; 13 ticks are. */
static void test_walk_resumes_after_valid_inputs_for_resume_time(void)
{
    update(0);
    update(SADDLE_FAULT_COM_STALE);
    for (int tick = 1; tick <= 20; tick++) {
        TEST_ASSERT_EQUAL(tick < 13, update(0));
    }
}

static void test_resume_time_restarts_with_every_fault(void)
{
    const uint32_t again[] = {SADDLE_FAULT_LEFT_STALE, SADDLE_FAULT_COM_RANGE,
                              SADDLE_FAULT_COMMAND_STALE};
    for (size_t i = 0; i < COUNT_OF(again); i++) {
        setUp();
        update(0);
        update(SADDLE_FAULT_COM_STALE);
        for (int tick = 0; tick < 12; tick++) {
            TEST_ASSERT_TRUE(update(0));
        }
        TEST_ASSERT_TRUE(update(again[i]));
        for (int tick = 1; tick <= 13; tick++) {
            TEST_ASSERT_EQUAL(tick < 13, update(0));
        }
    }
}

static void test_without_a_resume_time_the_first_valid_tick_resumes(void)
{
    config.resume_time_s = 0.0f;
    update(0);
    TEST_ASSERT_TRUE(update(SADDLE_FAULT_RIGHT_STALE));
    TEST_ASSERT_FALSE(update(0));
}

/* Whoever commands sends the same walk again and again: only a stand shows that somebody decided. */
static void test_walk_that_waits_for_a_command_goes_on_after_a_stand(void)
{
    config.resume_by_command = 1.0f;
    update_under_a_stand(0); /* one of before does not count */
    update(SADDLE_FAULT_COM_STALE);
    for (int tick = 0; tick < 100; tick++) {
        TEST_ASSERT_TRUE(update(0));
    }
    TEST_ASSERT_FALSE(update_under_a_stand(0));
    TEST_ASSERT_FALSE(update(0));
    TEST_ASSERT_TRUE(update(SADDLE_FAULT_COM_STALE));
    TEST_ASSERT_TRUE(update_under_a_stand(0));
    for (int tick = 1; tick < 13; tick++) { /* and all has been good for resume_time_s */
        TEST_ASSERT_EQUAL(tick < 12, update(0));
    }
}

static void test_stand_that_is_stale_was_not_commanded(void)
{
    config.resume_by_command = 1.0f;
    update(0);
    update(SADDLE_FAULT_COM_STALE);
    TEST_ASSERT_TRUE(update_under_a_stand(SADDLE_FAULT_COMMAND_STALE));
    for (int tick = 0; tick < 100; tick++) {
        TEST_ASSERT_TRUE(update(0));
    }
}

/* A planner alone, as in a simulation: nothing was ever measured, so nothing is missed. */
static void test_measurements_that_never_came_are_not_needed(void)
{
    const uint32_t never =
        SADDLE_FAULT_COM_STALE | SADDLE_FAULT_LEFT_STALE | SADDLE_FAULT_RIGHT_STALE;
    for (int tick = 0; tick < 100; tick++) {
        TEST_ASSERT_FALSE(update(never));
    }
    update(0); /* from now on they are */
    TEST_ASSERT_TRUE(update(SADDLE_FAULT_LEFT_STALE));
}

/* But a command is: without one nobody steers. */
/* A sensor that is dead from the first tick is as lost as one that dies later. */
static void test_measurement_of_which_a_part_never_came_stops(void)
{
    static const uint32_t parts[] = {SADDLE_FAULT_COM_STALE, SADDLE_FAULT_LEFT_STALE,
                                     SADDLE_FAULT_RIGHT_STALE,
                                     SADDLE_FAULT_COM_STALE | SADDLE_FAULT_LEFT_STALE};
    for (size_t i = 0; i < COUNT_OF(parts); i++) {
        setUp();
        TEST_ASSERT_TRUE(update(parts[i]));
    }
    setUp();
    for (int tick = 0; tick < 5; tick++) { /* out of range from the first tick: 0.24 s */
        TEST_ASSERT_EQUAL(tick >= 3, update(SADDLE_FAULT_LEFT_RANGE));
    }
}

static void test_long_gap_between_the_ticks_stops(void)
{
    config.step_time_max_s = 4.0f;
    saddle_safe_state_gap(&state, model_of(&config), 10.0f);
    TEST_ASSERT_FALSE(update(0)); /* no measurement had ever come */
    saddle_safe_state_gap(&state, model_of(&config), 3.9f);
    TEST_ASSERT_FALSE(update(0));
    saddle_safe_state_gap(&state, model_of(&config), 4.1f);
    for (int tick = 1; tick <= 14; tick++) { /* 13 ticks are 1.04 s */
        TEST_ASSERT_EQUAL(tick < 13, update(0));
    }
}

static void test_stale_command_stops_a_planner_alone_too(void)
{
    const uint32_t never =
        SADDLE_FAULT_COM_STALE | SADDLE_FAULT_LEFT_STALE | SADDLE_FAULT_RIGHT_STALE;
    update(never);
    TEST_ASSERT_TRUE(update(never | (uint32_t)SADDLE_FAULT_COMMAND_STALE));
    for (int tick = 1; tick <= 20; tick++) {
        TEST_ASSERT_EQUAL(tick < 13, update(never));
    }
}

/* One second is 13 ticks. */
static void test_walk_goes_on_a_second_after_a_wearer_was_last_unstable(void)
{
    update(0);
    update((uint32_t)SADDLE_FAULT_COM_STALE);
    for (int tick = 0; tick < 100; tick++) {
        TEST_ASSERT_TRUE(update_of(0, true));
    }
    for (int tick = 1; tick <= 20; tick++) {
        TEST_ASSERT_EQUAL(tick < 13, update(0));
    }
}

static void test_instability_alone_stops_nothing(void)
{
    update(0);
    TEST_ASSERT_FALSE(update_of(0, true));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_good_inputs_never_stop);
    RUN_TEST(test_input_that_is_stale_or_frozen_stops_in_the_same_tick);
    RUN_TEST(test_recording_goes_on_whatever_is_missing);
    RUN_TEST(test_measurement_that_is_unusable_stops_once_it_has_been_for_com_max_age);
    RUN_TEST(test_glitches_do_not_add_up);
    RUN_TEST(test_alternating_unusable_inputs_count_as_continuous);
    RUN_TEST(test_other_faults_do_not_stop);
    RUN_TEST(test_walk_resumes_after_valid_inputs_for_resume_time);
    RUN_TEST(test_resume_time_restarts_with_every_fault);
    RUN_TEST(test_without_a_resume_time_the_first_valid_tick_resumes);
    RUN_TEST(test_walk_that_waits_for_a_command_goes_on_after_a_stand);
    RUN_TEST(test_stand_that_is_stale_was_not_commanded);
    RUN_TEST(test_measurements_that_never_came_are_not_needed);
    RUN_TEST(test_measurement_of_which_a_part_never_came_stops);
    RUN_TEST(test_long_gap_between_the_ticks_stops);
    RUN_TEST(test_stale_command_stops_a_planner_alone_too);
    RUN_TEST(test_walk_goes_on_a_second_after_a_wearer_was_last_unstable);
    RUN_TEST(test_instability_alone_stops_nothing);
    return UNITY_END();
}
