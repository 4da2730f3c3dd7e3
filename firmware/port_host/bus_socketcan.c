#include "bus_socketcan.h"

#include "network_interface.h"
#include "stamped.h"
#include <errno.h>
#include <fcntl.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/** Room for frames that arrive during a tick or a short stall of the process. */
#define RECEIVE_BUFFER_BYTES (1 << 20)

static bool fail(saddle_bus_t *bus, const char *reason)
{
    snprintf(bus->description, sizeof bus->description, "CAN interface %.16s %s", bus->channel,
             reason);
    return false;
}

static bool set_up(int fd, const char *interface_name)
{
    const int buffer = RECEIVE_BUFFER_BYTES, yes = 1;
    const can_err_mask_t errors = CAN_ERR_BUSOFF | CAN_ERR_RESTARTED;
    const struct sockaddr_can address = {.can_family = AF_CAN,
                                         .can_ifindex = (int)if_nametoindex(interface_name)};
    return setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &buffer, sizeof buffer) == 0 &&
           setsockopt(fd, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors, sizeof errors) == 0 &&
           setsockopt(fd, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &yes, sizeof yes) == 0 &&
           saddle_stamp(fd) && fcntl(fd, F_SETFL, O_NONBLOCK) == 0 &&
           bind(fd, (const struct sockaddr *)&address, sizeof address) == 0;
}

/** Check the interface first: opening or closing a CAN socket waits in the kernel while another
 *  process changes an interface, longer than a tick. */
bool saddle_bus_socketcan_open(saddle_bus_t *bus)
{
    if (!saddle_interface_is_up(bus->channel)) {
        return fail(bus, "is not there or not up, or this kernel has no CAN");
    }
    const int fd = bus->receive_fd = bus->send_fd = socket(PF_CAN, SOCK_RAW, CAN_RAW);
    if (fd < 0 || !set_up(fd, bus->channel)) {
        return fail(bus, strerror(errno));
    }
    snprintf(bus->description, sizeof bus->description, "SocketCAN %.16s", bus->channel);
    return true;
}

bool saddle_bus_socketcan_send(const saddle_bus_t *bus, const saddle_bus_frame_t *frame)
{
    struct can_frame raw = {.can_id = frame->id, .can_dlc = frame->length};
    memcpy(raw.data, frame->data, frame->length);
    return write(bus->send_fd, &raw, sizeof raw) == (ssize_t)sizeof raw;
}

/** The kernel marks extended, remote and error frames in bits of the identifier above the 11. A
 *  CAN FD frame, which is longer, is counted as junk. */
saddle_bus_received_t saddle_bus_socketcan_receive(const saddle_bus_t *bus,
                                                   saddle_bus_frame_t *frame)
{
    struct canfd_frame raw; /* begins as a can_frame */
    const ssize_t size =
        saddle_receive_stamped(bus->receive_fd, &raw, sizeof raw, NULL, 0, &frame->waited_us);
    if (size < 0) {
        return SADDLE_BUS_FAILED;
    }
    if (size != (ssize_t)CAN_MTU || raw.len > sizeof frame->data) {
        return SADDLE_BUS_JUNK;
    }
    if ((raw.can_id & CAN_ERR_FLAG) != 0) {
        return (raw.can_id & CAN_ERR_RESTARTED) != 0 ? SADDLE_BUS_RESTARTED : SADDLE_BUS_OFF;
    }
    frame->id = raw.can_id;
    frame->length = raw.len;
    memcpy(frame->data, raw.data, sizeof frame->data);
    return SADDLE_BUS_FRAME;
}
