/** Frames between an interrupt and the loop: in order, never overwritten, the lost ones counted. */
#include <can_queue.h>

#include <string.h>
#include <unity.h>

static saddle_can_queue_t queue;

void setUp(void)
{
    memset(&queue, 0, sizeof queue);
}

void tearDown(void) {}

static bool put(uint16_t id)
{
    const saddle_can_frame_t frame = {.id = id, .received_us = id + 7u, .length = 1, .data = {3}};
    return saddle_can_queue_put(&queue, &frame);
}

static void expect(uint16_t id)
{
    saddle_can_frame_t frame;
    TEST_ASSERT_TRUE(saddle_can_queue_take(&queue, &frame));
    TEST_ASSERT_EQUAL_UINT16(id, frame.id);
    TEST_ASSERT_EQUAL_UINT64(id + 7u, frame.received_us);
    TEST_ASSERT_EQUAL_UINT8(1, frame.length);
    TEST_ASSERT_EQUAL_UINT8(3, frame.data[0]);
}

static void expect_empty(void)
{
    saddle_can_frame_t frame = {.id = 99};
    TEST_ASSERT_FALSE(saddle_can_queue_take(&queue, &frame));
    TEST_ASSERT_EQUAL_UINT16(99, frame.id);
}

static void test_frames_keep_their_order(void)
{
    expect_empty();
    for (uint16_t id = 0; id < 5 * SADDLE_CAN_QUEUE; ++id) {
        TEST_ASSERT_TRUE(put(id));
        TEST_ASSERT_TRUE(put((uint16_t)(id + 1000)));
        expect(id);
        expect((uint16_t)(id + 1000));
        expect_empty();
    }
}

static void test_a_full_queue_keeps_its_frames_and_counts_lost_ones(void)
{
    for (uint16_t id = 0; id < SADDLE_CAN_QUEUE; ++id) {
        TEST_ASSERT_TRUE(put(id));
    }
    TEST_ASSERT_FALSE(put(500));
    TEST_ASSERT_FALSE(put(501));
    TEST_ASSERT_EQUAL_UINT32(2, queue.lost);
    expect(0);
    TEST_ASSERT_TRUE(put(502));
    for (uint16_t id = 1; id < SADDLE_CAN_QUEUE; ++id) {
        expect(id);
    }
    expect(502);
    expect_empty();
    TEST_ASSERT_EQUAL_UINT32(2, queue.lost);
}

static void test_the_counts_may_wrap(void)
{
    queue.put = queue.taken = UINT32_MAX - 2u;
    for (uint16_t id = 0; id < SADDLE_CAN_QUEUE; ++id) {
        TEST_ASSERT_TRUE(put(id));
    }
    TEST_ASSERT_FALSE(put(500));
    for (uint16_t id = 0; id < SADDLE_CAN_QUEUE; ++id) {
        expect(id);
    }
    expect_empty();
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_frames_keep_their_order);
    RUN_TEST(test_a_full_queue_keeps_its_frames_and_counts_lost_ones);
    RUN_TEST(test_the_counts_may_wrap);
    return UNITY_END();
}
