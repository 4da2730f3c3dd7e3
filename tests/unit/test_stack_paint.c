/** How deep a stack was ever used. */
#include <stack_paint.h>

#include <unity.h>

#define WORDS 16

static uint32_t stack[WORDS];

void setUp(void)
{
    for (int i = 0; i < WORDS; ++i) {
        stack[i] = 0;
    }
}

void tearDown(void) {}

static void test_what_lost_its_paint_was_used(void)
{
    saddle_stack_paint(stack, stack + WORDS - 3); /* three words are in use */
    TEST_ASSERT_EQUAL_UINT32(3 * sizeof stack[0], saddle_stack_used(stack, stack + WORDS));
    stack[8] = 1; /* what is called later may leave gaps that it never wrote */
    stack[5] = 0;
    TEST_ASSERT_EQUAL_UINT32(11 * sizeof stack[0], saddle_stack_used(stack, stack + WORDS));
    TEST_ASSERT_EQUAL_UINT32(0, stack[WORDS - 3]);
}

static void test_a_stack_may_be_used_up_or_not_at_all(void)
{
    TEST_ASSERT_EQUAL_UINT32(sizeof stack, saddle_stack_used(stack, stack + WORDS));
    saddle_stack_paint(stack, stack + WORDS);
    TEST_ASSERT_EQUAL_UINT32(0, saddle_stack_used(stack, stack + WORDS));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_what_lost_its_paint_was_used);
    RUN_TEST(test_a_stack_may_be_used_up_or_not_at_all);
    return UNITY_END();
}
