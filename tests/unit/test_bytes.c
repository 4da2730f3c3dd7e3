/** Clearing and copying bytes. */
#include "core_test.h"

#include "math/bytes.h"

#define SIZE 64

/* Aligned as any object of the core; the copy begins and ends inside it. */
#define BEFORE 8

static union {
    uint64_t aligned;
    unsigned char bytes[BEFORE + SIZE + 1];
} place;

static unsigned char *const object = place.bytes;

void setUp(void)
{
    memset(&place, 0xA5, sizeof place);
}

void tearDown(void) {}

/* Nothing before and nothing behind it is touched. */
static void test_clear_sets_every_byte_and_no_other(void)
{
    for (size_t size = 0; size <= SIZE; size++) {
        setUp();
        saddle_clear(object + BEFORE, size);
        for (size_t i = 0; i < sizeof place.bytes; i++) {
            TEST_ASSERT_EQUAL_HEX8(i >= BEFORE && i < BEFORE + size ? 0x00 : 0xA5, object[i]);
        }
    }
}

static void test_copy_takes_every_byte_and_no_other(void)
{
    union {
        uint64_t aligned;
        unsigned char bytes[SIZE];
    } from;
    for (size_t i = 0; i < SIZE; i++) {
        from.bytes[i] = (unsigned char)(i + 1u);
    }
    for (size_t size = 0; size <= SIZE; size++) {
        setUp();
        saddle_copy(object + BEFORE, from.bytes, size);
        for (size_t i = 0; i < sizeof place.bytes; i++) {
            const int expected = i >= BEFORE && i < BEFORE + size ? (int)(i - BEFORE) + 1 : 0xA5;
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
