/** Full queues, lost interfaces and bus-off, from a transport that does as the test says. */
#include <bus.h>
#include <bus_socketcan.h>
#include <bus_udp.h>

#include <errno.h>
#include <unity.h>

static int send_error; /**< 0: frames are sent */
static int receive_error;
static saddle_bus_received_t next[4]; /**< what comes, up to the first EMPTY */
static size_t taken;
static bool can_be_opened;
static int opened;

bool saddle_bus_socketcan_open(saddle_bus_t *bus)
{
    opened += can_be_opened;
    bus->receive_fd = bus->send_fd = -1;
    return can_be_opened;
}

bool saddle_bus_socketcan_send(const saddle_bus_t *bus, const saddle_bus_frame_t *frame)
{
    (void)bus;
    (void)frame;
    errno = send_error;
    return send_error == 0;
}

saddle_bus_received_t saddle_bus_socketcan_receive(const saddle_bus_t *bus,
                                                   saddle_bus_frame_t *frame)
{
    (void)bus;
    (void)frame;
    errno = receive_error;
    return next[taken++];
}

bool saddle_bus_udp_open(saddle_bus_t *bus)
{
    (void)bus;
    return false;
}

bool saddle_bus_udp_send(const saddle_bus_t *bus, const saddle_bus_frame_t *frame)
{
    (void)bus;
    (void)frame;
    return false;
}

saddle_bus_received_t saddle_bus_udp_receive(const saddle_bus_t *bus, saddle_bus_frame_t *frame)
{
    (void)bus;
    (void)frame;
    return SADDLE_BUS_EMPTY;
}

static saddle_bus_t bus;
static saddle_bus_frame_t frame;

void setUp(void)
{
    send_error = receive_error = opened = 0;
    can_be_opened = true;
    TEST_ASSERT_TRUE(saddle_bus_open(&bus, "socketcan:can0"));
    TEST_ASSERT_EQUAL_INT(SADDLE_LINK_UP, bus.link.state);
}

void tearDown(void) {}

static void hear(saddle_bus_received_t first, saddle_bus_received_t second)
{
    taken = 0;
    next[0] = first;
    next[1] = second;
    next[2] = SADDLE_BUS_EMPTY;
}

static void expect_link(saddle_link_state_t state, uint32_t losses)
{
    TEST_ASSERT_EQUAL_INT(state, bus.link.state);
    TEST_ASSERT_EQUAL_UINT32(losses, bus.link.losses);
}

static void test_a_full_queue_drops_frames_but_is_not_a_lost_link(void)
{
    static const int full[] = {ENOBUFS, EAGAIN};
    for (size_t i = 0; i < 2; ++i) {
        send_error = full[i];
        saddle_bus_send(&bus, &frame);
    }
    send_error = 0;
    saddle_bus_send(&bus, &frame);
    TEST_ASSERT_EQUAL_UINT32(2, bus.no_room);
    TEST_ASSERT_EQUAL_UINT32(1, bus.sent);
    expect_link(SADDLE_LINK_UP, 0);
}

static void test_an_interface_that_went_down_is_opened_again(void)
{
    send_error = ENETDOWN;
    saddle_bus_send(&bus, &frame);
    expect_link(SADDLE_LINK_DOWN, 1);
    can_be_opened = false;
    saddle_bus_maintain(&bus);
    send_error = 0;
    saddle_bus_send(&bus, &frame); /* not tried: the old socket is of no use */
    expect_link(SADDLE_LINK_DOWN, 1);
    can_be_opened = true;
    saddle_bus_maintain(&bus);
    expect_link(SADDLE_LINK_UP, 1);
    saddle_bus_send(&bus, &frame);
    TEST_ASSERT_EQUAL_UINT32(2, bus.no_link);
    TEST_ASSERT_EQUAL_UINT32(1, bus.sent);
    TEST_ASSERT_EQUAL_INT(2, opened);
}

static void test_nothing_is_opened_while_the_link_is_up(void)
{
    saddle_bus_maintain(&bus);
    TEST_ASSERT_EQUAL_INT(1, opened);
}

static void test_a_failed_receive_is_a_lost_link_unless_the_queue_is_empty(void)
{
    hear(SADDLE_BUS_FAILED, SADDLE_BUS_EMPTY);
    receive_error = EAGAIN;
    TEST_ASSERT_EQUAL_INT(SADDLE_BUS_EMPTY, saddle_bus_receive(&bus, &frame));
    expect_link(SADDLE_LINK_UP, 0);
    taken = 0;
    receive_error = ENODEV;
    TEST_ASSERT_EQUAL_INT(SADDLE_BUS_EMPTY, saddle_bus_receive(&bus, &frame));
    expect_link(SADDLE_LINK_DOWN, 1);
}

static void test_bus_off_and_restart(void)
{
    hear(SADDLE_BUS_OFF, SADDLE_BUS_FRAME);
    TEST_ASSERT_EQUAL_INT(SADDLE_BUS_FRAME, saddle_bus_receive(&bus, &frame));
    expect_link(SADDLE_LINK_BUS_OFF, 1);
    saddle_bus_maintain(&bus); /* the controller restarts, the socket stays */
    TEST_ASSERT_EQUAL_INT(1, opened);
    hear(SADDLE_BUS_RESTARTED, SADDLE_BUS_EMPTY);
    TEST_ASSERT_EQUAL_INT(SADDLE_BUS_EMPTY, saddle_bus_receive(&bus, &frame));
    expect_link(SADDLE_LINK_UP, 1);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_full_queue_drops_frames_but_is_not_a_lost_link);
    RUN_TEST(test_an_interface_that_went_down_is_opened_again);
    RUN_TEST(test_nothing_is_opened_while_the_link_is_up);
    RUN_TEST(test_a_failed_receive_is_a_lost_link_unless_the_queue_is_empty);
    RUN_TEST(test_bus_off_and_restart);
    return UNITY_END();
}
