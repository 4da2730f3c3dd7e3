/** What is counted of ticks that come when they should, late, or not at all. */
#include <timing.h>

#include <unity.h>

static saddle_timing_t timing;

void setUp(void)
{
    timing = (saddle_timing_t){.ticks = 0};
}

void tearDown(void) {}

static void tick(uint64_t due_us, uint64_t begin_us, uint64_t end_us)
{
    saddle_timing_begin(&timing, due_us, begin_us);
    saddle_timing_end(&timing, due_us + 80000u, end_us);
}

static void test_period_latency_and_work(void)
{
    tick(80000, 80100, 80600);
    TEST_ASSERT_EQUAL_UINT32(0, timing.period_us);
    tick(160000, 160020, 160220);
    TEST_ASSERT_EQUAL_UINT32(79920, timing.period_us);
    TEST_ASSERT_EQUAL_UINT32(20, timing.latency_us);
    TEST_ASSERT_EQUAL_UINT32(100, timing.latency_max_us);
    TEST_ASSERT_EQUAL_UINT32(200, timing.work_us);
    TEST_ASSERT_EQUAL_UINT32(500, timing.work_max_us);
    TEST_ASSERT_EQUAL_UINT32(2, timing.ticks);
    TEST_ASSERT_EQUAL_UINT32(0, timing.late_ticks);
}

static void test_a_tick_is_late_when_it_ends_after_the_next_was_due(void)
{
    tick(0, 0, 80000);
    TEST_ASSERT_EQUAL_UINT32(0, timing.late_ticks);
    tick(80000, 80000, 160001);
    TEST_ASSERT_EQUAL_UINT32(1, timing.late_ticks);
}

static void test_every_latency_has_its_bin(void)
{
    static const struct {
        uint64_t latency_us;
        unsigned bin;
    } cases[] = {{0, 0},     {1, 0},      {2, 1},      {3, 1},      {4, 2},          {1023, 9},
                 {1024, 10}, {32768, 15}, {65535, 15}, {65536, 16}, {UINT64_MAX, 16}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        setUp();
        tick(0, cases[i].latency_us, cases[i].latency_us);
        TEST_ASSERT_EQUAL_UINT32(1, timing.latencies[cases[i].bin]);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_period_latency_and_work);
    RUN_TEST(test_a_tick_is_late_when_it_ends_after_the_next_was_due);
    RUN_TEST(test_every_latency_has_its_bin);
    return UNITY_END();
}
