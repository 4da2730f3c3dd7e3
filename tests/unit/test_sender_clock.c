/** When a measured set was sampled, by the receiver's clock. */
#include <sender_clock.h>

#include <unity.h>

#define SET_MAX 127u
#define PERIOD_US 10000u

static saddle_sender_clock_t clock;
static uint32_t seed;

void setUp(void)
{
    clock = (saddle_sender_clock_t){.heard = false};
    seed = 1;
}

void tearDown(void) {}

static uint32_t random_below(uint32_t limit)
{
    seed = seed * 1664525u + 1013904223u;
    return (uint32_t)((uint64_t)(seed >> 8) * limit >> 24);
}

static uint32_t age_us(uint8_t number, uint64_t now_us)
{
    uint64_t sampled_us = 0;
    TEST_ASSERT_TRUE(saddle_sender_clock_sampled(&clock, number, now_us, &sampled_us));
    TEST_ASSERT_LESS_OR_EQUAL_UINT64(now_us, sampled_us);
    return (uint32_t)(now_us - sampled_us);
}

/** Sets of a sender whose clock is at 0 when ours is at 1 s; set n is sampled at n periods. */
static void bring_sets(uint32_t from, uint32_t to, uint32_t delay_us)
{
    for (uint32_t n = from; n < to; ++n) {
        saddle_sender_clock_take(&clock, n & SET_MAX, n * PERIOD_US,
                                 1000000u + n * PERIOD_US + delay_us);
    }
}

/** Received at the time of set n plus its delay. */
static uint32_t age_of_set(uint32_t n, uint32_t delay_us)
{
    return age_us(n & SET_MAX, 1000000u + n * PERIOD_US + delay_us);
}

static void test_what_comes_later_than_usual_is_that_much_older(void)
{
    bring_sets(0, 100, 3000);
    TEST_ASSERT_EQUAL_UINT32(0, age_of_set(99, 3000));
    bring_sets(100, 101, 303000);
    TEST_ASSERT_UINT32_WITHIN(2, 300000, age_of_set(100, 303000));
}

/** 200 ppm of a minute. */
static void test_a_lasting_delay_is_not_got_used_to(void)
{
    bring_sets(0, 100, 3000);
    bring_sets(100, 6100, 303000);
    TEST_ASSERT_UINT32_WITHIN(100, 300000u - 12000u, age_of_set(6099, 303000));
    bring_sets(6100, 6101, 3000);
    TEST_ASSERT_EQUAL_UINT32(0, age_of_set(6100, 3000));
}

/** An age is never too low by more than the least delay and 300 ppm of the time since an undelayed
 *  frame, and too high by no more than a rounding; 1 frame in 8 is undelayed, so within a second. */
static void expect_ages(int32_t ppm, uint32_t start_us, uint32_t least_us)
{
    for (uint64_t n = 0; n < 100000u; ++n) {
        const uint64_t true_us = 5000000u + n * PERIOD_US;
        const uint64_t passed_us = n * PERIOD_US;
        const int64_t drift_us = (int64_t)passed_us * ppm / 1000000;
        const uint32_t sent_us = start_us + (uint32_t)passed_us + (uint32_t)drift_us;
        const uint32_t extra_us = random_below(8) == 0 ? 0 : random_below(9000);
        const uint64_t received_us = true_us + least_us + extra_us;
        saddle_sender_clock_take(&clock, n & SET_MAX, sent_us, received_us);
        if (n > 100u) {
            TEST_ASSERT_INT32_WITHIN(310, (int32_t)extra_us,
                                     (int32_t)age_us(n & SET_MAX, received_us));
        }
    }
}

static void test_drift_is_followed_over_a_wrap(void)
{
    static const int32_t drifts[] = {0, 100, -100};
    for (size_t i = 0; i < sizeof drifts / sizeof drifts[0]; ++i) {
        setUp();
        expect_ages(drifts[i], UINT32_MAX - 300000000u, 2500);
    }
}

static void test_a_clock_that_jumps_ahead_is_followed_at_once(void)
{
    bring_sets(0, 100, 3000);
    saddle_sender_clock_take(&clock, 100, 70000000u, 2003000u);
    TEST_ASSERT_EQUAL_UINT32(0, age_us(100, 2003000u));
    saddle_sender_clock_take(&clock, 101, 70010000u, 2043000u);
    TEST_ASSERT_UINT32_WITHIN(4, 30000, age_us(101, 2043000u));
}

static void test_a_clock_that_is_set_back_is_followed_at_once(void)
{
    bring_sets(0, 100, 3000);
    saddle_sender_clock_take(&clock, 100, 500000u, 2003000u);
    TEST_ASSERT_EQUAL_UINT32(0, age_us(100, 2003000u));
    TEST_ASSERT_EQUAL_UINT32(0, clock.behind);
}

/** Its number tells nothing: it may be one that was held back. */
static void test_a_sender_that_restarted_is_believed_after_16_sets(void)
{
    bring_sets(0, 100, 3000);
    for (uint32_t n = 0; n < 16u; ++n) {
        const uint64_t received_us = 2003000u + n * PERIOD_US;
        saddle_sender_clock_take(&clock, (uint8_t)n, 1000u + n * PERIOD_US, received_us);
        TEST_ASSERT_EQUAL(n < 15u, age_us((uint8_t)n, received_us) > 900000u);
    }
}

/** One in 15 is undelayed, so within a second: 200 ppm of it. */
static void test_frames_out_of_order_are_as_old_as_they_are(void)
{
    bring_sets(0, 200, 0);
    for (uint32_t n = 200; n < 2000u; ++n) {
        const uint32_t back = random_below(15);
        saddle_sender_clock_take(&clock, (n - back) & SET_MAX, (n - back) * PERIOD_US,
                                 1000000u + n * PERIOD_US);
        TEST_ASSERT_UINT32_WITHIN(200, back * PERIOD_US,
                                  age_us((n - back) & SET_MAX, 1000000u + n * PERIOD_US));
    }
}

static void test_a_set_whose_time_was_lost_is_as_old_as_the_one_before_it(void)
{
    uint64_t sampled_us;
    bring_sets(0, 101, 0);
    TEST_ASSERT_EQUAL_UINT32(20000, age_of_set(102, 0));
    TEST_ASSERT_TRUE(saddle_sender_clock_sampled(&clock, 85, 2000000u, &sampled_us));
    TEST_ASSERT_FALSE(saddle_sender_clock_sampled(&clock, 84, 2000000u, &sampled_us));
    TEST_ASSERT_FALSE(saddle_sender_clock_sampled(&clock, 117, 2000000u, &sampled_us));
}

static void test_of_few_sets_the_others_are_not_known(void)
{
    uint64_t sampled_us = 1;
    saddle_sender_clock_take(&clock, 0, 0, 500u);
    TEST_ASSERT_FALSE(saddle_sender_clock_sampled(&clock, SET_MAX, 600u, &sampled_us));
    /* Sampled 10 ms before ours began to count. */
    saddle_sender_clock_take(&clock, 1, PERIOD_US, 600u);
    TEST_ASSERT_TRUE(saddle_sender_clock_sampled(&clock, 0, 600u, &sampled_us));
    TEST_ASSERT_EQUAL_UINT64(0, sampled_us);
}

static void test_silence(void)
{
    TEST_ASSERT_FALSE(saddle_sender_clock_runs(&clock, 0));
    bring_sets(0, 1, 0);
    TEST_ASSERT_TRUE(saddle_sender_clock_runs(&clock, 500000u));
    TEST_ASSERT_TRUE(saddle_sender_clock_runs(&clock, 11000000u));
    TEST_ASSERT_FALSE(saddle_sender_clock_runs(&clock, 11000001u));
    /* The sender's clock went on for half of its range: more cannot be told from a step back. */
    const uint64_t longest_us = UINT64_C(1) << 30;
    saddle_sender_clock_take(&clock, 1, (uint32_t)longest_us - 1000u, 1000000u + longest_us);
    TEST_ASSERT_UINT32_WITHIN(300000, 1000, age_us(1, 1000000u + longest_us));
    saddle_sender_clock_take(&clock, 2, 7, 2000001u + 2u * longest_us);
    TEST_ASSERT_EQUAL_UINT32(0, age_us(2, 2000001u + 2u * longest_us));
    saddle_sender_clock_forget(&clock);
    TEST_ASSERT_FALSE(saddle_sender_clock_runs(&clock, 0));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_what_comes_later_than_usual_is_that_much_older);
    RUN_TEST(test_a_lasting_delay_is_not_got_used_to);
    RUN_TEST(test_drift_is_followed_over_a_wrap);
    RUN_TEST(test_a_clock_that_jumps_ahead_is_followed_at_once);
    RUN_TEST(test_a_clock_that_is_set_back_is_followed_at_once);
    RUN_TEST(test_a_sender_that_restarted_is_believed_after_16_sets);
    RUN_TEST(test_frames_out_of_order_are_as_old_as_they_are);
    RUN_TEST(test_a_set_whose_time_was_lost_is_as_old_as_the_one_before_it);
    RUN_TEST(test_of_few_sets_the_others_are_not_known);
    RUN_TEST(test_silence);
    return UNITY_END();
}
