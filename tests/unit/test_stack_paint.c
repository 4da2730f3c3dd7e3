/** How deep a stack was ever used. */
#include <stack_paint.h>

#include <unity.h>

#define WORDS 16
#define DEPTH 16384u /* of what is painted of this test's own stack, bytes */
#define LARGE 8192u

void setUp(void) {}

void tearDown(void) {}

static void test_used_words_lose_their_paint(void)
{
    uint32_t stack[WORDS];
    for (int i = 0; i < WORDS; ++i) {
        stack[i] = SADDLE_STACK_PAINT;
    }
    TEST_ASSERT_EQUAL_UINT32(0, saddle_stack_used(stack, stack + WORDS));
    stack[8] = 1; /* what is called later may leave gaps that it never wrote */
    stack[5] = 0;
    TEST_ASSERT_EQUAL_UINT32(11 * sizeof stack[0], saddle_stack_used(stack, stack + WORDS));
    stack[0] = 1;
    TEST_ASSERT_EQUAL_UINT32(sizeof stack, saddle_stack_used(stack, stack + WORDS));
}

static uint8_t use_much(void)
{
    volatile uint8_t bytes[LARGE];
    for (uint32_t i = 0; i < LARGE; ++i) {
        bytes[i] = (uint8_t)i;
    }
    return bytes[7];
}

static void test_the_callers_frames_are_not_painted(void)
{
    volatile uint32_t live[WORDS];
    uint32_t *const top = __builtin_frame_address(0);
    uint32_t *const lowest = top - DEPTH / sizeof *top;
    uint8_t (*volatile call)(void) = use_much;
    for (uint32_t i = 0; i < WORDS; ++i) {
        live[i] = i;
    }
    saddle_stack_paint(lowest);
    for (uint32_t i = 0; i < WORDS; ++i) {
        TEST_ASSERT_EQUAL_UINT32(i, live[i]);
    }
    TEST_ASSERT_LESS_THAN_UINT32(LARGE, saddle_stack_used(lowest, top));
    TEST_ASSERT_EQUAL_UINT8(7, call());
    TEST_ASSERT_GREATER_OR_EQUAL_UINT32(LARGE, saddle_stack_used(lowest, top));
    TEST_ASSERT_LESS_THAN_UINT32(DEPTH, saddle_stack_used(lowest, top));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_used_words_lose_their_paint);
    RUN_TEST(test_the_callers_frames_are_not_painted);
    return UNITY_END();
}
