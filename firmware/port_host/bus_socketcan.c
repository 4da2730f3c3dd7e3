#include "bus_socketcan.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

static bool fail(saddle_bus_t *bus, const char *interface_name, const char *reason)
{
    if (bus->receive_fd >= 0) {
        close(bus->receive_fd);
    }
    snprintf(bus->description, sizeof bus->description, "CAN interface %.16s %s", interface_name,
             reason);
    return false;
}

/** Its index, 0 if there is no such interface, or it is not up. */
static unsigned index_if_up(int fd, const char *interface_name)
{
    struct ifreq request = {0};
    if (strlen(interface_name) >= sizeof request.ifr_name) {
        return 0;
    }
    memcpy(request.ifr_name, interface_name, strlen(interface_name));
    if (ioctl(fd, SIOCGIFFLAGS, &request) != 0 || (request.ifr_flags & IFF_UP) == 0) {
        return 0;
    }
    return if_nametoindex(interface_name);
}

/** Ours are classic frames; others' CAN FD frames are asked for so that they are counted. */
static bool hear_fd_frames(int fd)
{
    const int yes = 1;
    return setsockopt(fd, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &yes, sizeof yes) == 0;
}

bool saddle_bus_socketcan_open(saddle_bus_t *bus, const char *interface_name)
{
    bus->kind = SADDLE_BUS_SOCKETCAN;
    bus->receive_fd = socket(PF_CAN, SOCK_RAW, CAN_RAW);
    bus->send_fd = bus->receive_fd;
    if (bus->receive_fd < 0) {
        return fail(bus, interface_name, "cannot be used: this kernel has no CAN");
    }
    struct sockaddr_can address = {.can_family = AF_CAN};
    address.can_ifindex = (int)index_if_up(bus->receive_fd, interface_name);
    if (address.can_ifindex == 0) {
        return fail(bus, interface_name, "is not there or not up");
    }
    if (!hear_fd_frames(bus->receive_fd) ||
        bind(bus->receive_fd, (const struct sockaddr *)&address, sizeof address) != 0 ||
        fcntl(bus->receive_fd, F_SETFL, O_NONBLOCK) != 0) {
        return fail(bus, interface_name, strerror(errno));
    }
    snprintf(bus->description, sizeof bus->description, "SocketCAN %.16s", interface_name);
    return true;
}

bool saddle_bus_socketcan_send(const saddle_bus_t *bus, const saddle_bus_frame_t *frame)
{
    struct can_frame raw = {.can_id = frame->id, .can_dlc = frame->length};
    memcpy(raw.data, frame->data, frame->length);
    return write(bus->send_fd, &raw, sizeof raw) == (ssize_t)sizeof raw;
}

/** The kernel marks extended, remote and error frames in bits of the identifier above the 11. A
 *  CAN FD frame tells itself by its size. */
saddle_bus_received_t saddle_bus_socketcan_receive(const saddle_bus_t *bus,
                                                   saddle_bus_frame_t *frame)
{
    struct canfd_frame raw;
    const ssize_t size = read(bus->receive_fd, &raw, sizeof raw);
    if (size < 0) {
        return SADDLE_BUS_EMPTY;
    }
    if (size != CAN_MTU || raw.len > sizeof frame->data) {
        return SADDLE_BUS_JUNK;
    }
    frame->id = raw.can_id;
    frame->length = raw.len;
    memcpy(frame->data, raw.data, sizeof frame->data);
    return SADDLE_BUS_FRAME;
}
