/** CAN frames as text, and texts that are none. */
#include <slcan.h>

#include <string.h>
#include <unity.h>

static saddle_slcan_reader_t reader;
static saddle_can_frame_t frame;

void setUp(void)
{
    memset(&reader, 0, sizeof reader);
    memset(&frame, 0xA5, sizeof frame);
}

void tearDown(void) {}

/** What the last character makes of a line; the others make nothing. */
static saddle_slcan_event_t read(const char *text)
{
    saddle_slcan_event_t event = SADDLE_SLCAN_NOTHING;
    for (; *text != '\0'; ++text) {
        TEST_ASSERT_EQUAL_INT(SADDLE_SLCAN_NOTHING, event);
        event = saddle_slcan_read(&reader, *text, &frame);
    }
    return event;
}

static void test_a_frame_is_read(void)
{
    static const uint8_t data[] = {0x01, 0x23, 0x45, 0x67, 0x89, 0xAB, 0xCD, 0xEF};
    TEST_ASSERT_EQUAL_INT(SADDLE_SLCAN_FRAME, read("t7fF80123456789aBcDEf\r"));
    TEST_ASSERT_EQUAL_HEX16(0x7FF, frame.id);
    TEST_ASSERT_EQUAL_UINT8(8, frame.length);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(data, frame.data, 8);
    TEST_ASSERT_EQUAL_INT(SADDLE_SLCAN_FRAME, read("t0000\r"));
    TEST_ASSERT_EQUAL_HEX16(0, frame.id);
    TEST_ASSERT_EQUAL_UINT8(0, frame.length);
}

static void test_written_frames_read_back(void)
{
    char line[SADDLE_SLCAN_LINE + 1] = {0};
    const saddle_can_frame_t written = {.id = 0x140, .length = 3, .data = {0xFE, 0x00, 0x9A}};
    TEST_ASSERT_EQUAL_size_t(12, saddle_slcan_write(&written, line));
    TEST_ASSERT_EQUAL_STRING("t1403FE009A\r", line);
    TEST_ASSERT_EQUAL_INT(SADDLE_SLCAN_FRAME, read(line));
    TEST_ASSERT_EQUAL_HEX16(0x140, frame.id);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(written.data, frame.data, 3);
    const saddle_can_frame_t longest = {.id = 0x7FF, .length = 8};
    TEST_ASSERT_EQUAL_size_t(SADDLE_SLCAN_LINE, saddle_slcan_write(&longest, line));
}

static void test_other_lines_are_not_frames_and_do_not_affect_the_next(void)
{
    static const char *const lines[] = {
        "t\r",          "t10\r",
        "t1002FF\r",    "t1001FFF\r",
        "t10\r",        "t1009001122334455667788\r",
        "t8000\r",      "tG000\r",
        "t100 \r",      "t1001G0\r",
        "t1001g0\r",    "t1001 0\r",
        "T000001000\r", "r1000\r",
        "x\r",          "t10080011223344556677FFFFFFFFFFFFFFFFFFFFFFFFFF\r",
    };
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; ++i) {
        setUp();
        TEST_ASSERT_EQUAL_INT_MESSAGE(SADDLE_SLCAN_MALFORMED, read(lines[i]), lines[i]);
        TEST_ASSERT_EQUAL_HEX16(0xA5A5, frame.id);
        TEST_ASSERT_EQUAL_INT(SADDLE_SLCAN_FRAME, read("t1001FF\r"));
    }
}

static void test_the_channel_is_opened_and_closed(void)
{
    TEST_ASSERT_EQUAL_INT(SADDLE_SLCAN_NOTHING, read("\r"));
    TEST_ASSERT_EQUAL_INT(SADDLE_SLCAN_NOTHING, read("S6\r"));
    TEST_ASSERT_EQUAL_INT(SADDLE_SLCAN_NOTHING, read("O\r"));
    TEST_ASSERT_EQUAL_INT(SADDLE_SLCAN_CLOSE, read("C\r"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_frame_is_read);
    RUN_TEST(test_written_frames_read_back);
    RUN_TEST(test_other_lines_are_not_frames_and_do_not_affect_the_next);
    RUN_TEST(test_the_channel_is_opened_and_closed);
    return UNITY_END();
}
