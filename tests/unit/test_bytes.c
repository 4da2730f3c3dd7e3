/** Clearing and copying bytes. */
#include "core_test.h"

#include "math/bytes.h"

#define SIZE 64

static unsigned char object[SIZE + 2];

void setUp(void)
{
    memset(object, 0xA5, sizeof object);
}

void tearDown(void) {}

/* Nothing before and nothing behind it is touched. */
static void test_clear_sets_every_byte_and_no_other(void)
{
    for (size_t size = 0; size <= SIZE; size++) {
        setUp();
        saddle_clear(object + 1, size);
        for (size_t i = 0; i < sizeof object; i++) {
            TEST_ASSERT_EQUAL_HEX8(i >= 1u && i <= size ? 0x00 : 0xA5, object[i]);
        }
    }
}

static void test_copy_takes_every_byte_and_no_other(void)
{
    unsigned char from[SIZE];
    for (size_t i = 0; i < SIZE; i++) {
        from[i] = (unsigned char)(i + 1u);
    }
    for (size_t size = 0; size <= SIZE; size++) {
        setUp();
        saddle_copy(object + 1, from, size);
        for (size_t i = 0; i < sizeof object; i++) {
            const int expected = i >= 1u && i <= size ? (int)i : 0xA5;
            TEST_ASSERT_EQUAL_HEX8(expected, object[i]);
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_clear_sets_every_byte_and_no_other);
    RUN_TEST(test_copy_takes_every_byte_and_no_other);
    return UNITY_END();
}
