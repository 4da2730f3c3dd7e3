#include "bus_udp.h"

#include "datagram.h"
#include "network_interface.h"
#include "stamped.h"
#include <arpa/inet.h>
#include <errno.h>
#include <net/if.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

/** Room for a second of a loaded 1 Mbit/s bus, so that nothing is lost while a tick runs. */
#define RECEIVE_BUFFER_BYTES (1 << 20)

#define LOOPBACK "lo"

/** Its index, and its address in the send socket's. */
typedef struct {
    const char *name;
    struct in_addr address;
    int index;
} interface_t;

static bool parse_address(struct sockaddr_in *group, const char *text, size_t length)
{
    char address[INET_ADDRSTRLEN];
    if (length == 0 || length >= sizeof address) {
        return false;
    }
    memcpy(address, text, length);
    address[length] = '\0';
    return inet_pton(AF_INET, address, &group->sin_addr) == 1 &&
           IN_MULTICAST(ntohl(group->sin_addr.s_addr));
}

/** The interface's name is what follows `@`; without one, loopback's. */
static bool parse(struct sockaddr_in *group, const char **interface_name, const char *text)
{
    *group = (struct sockaddr_in){.sin_family = AF_INET};
    const size_t length = strcspn(text, ":");
    if (!parse_address(group, text, length) || text[length] == '\0' || text[length + 1] < '1' ||
        text[length + 1] > '9') {
        return false;
    }
    char *end;
    const unsigned long port = strtoul(text + length + 1, &end, 10);
    group->sin_port = htons((uint16_t)port);
    *interface_name = *end == '@' ? end + 1 : LOOPBACK;
    return port <= UINT16_MAX && (*end == '\0' || (*end == '@' && end[1] != '\0'));
}

static bool find_interface(interface_t *interface, const char *name, int fd)
{
    struct ifreq request = {.ifr_addr.sa_family = AF_INET};
    interface->name = name;
    if (!saddle_interface_is_up(name)) {
        errno = ENETDOWN;
        return false;
    }
    memcpy(request.ifr_name, name, strlen(name));
    if (ioctl(fd, SIOCGIFADDR, &request) != 0) {
        return false;
    }
    struct sockaddr_in address;
    memcpy(&address, &request.ifr_addr, sizeof address);
    interface->address = address.sin_addr;
    interface->index = (int)if_nametoindex(name);
    return interface->index != 0;
}

static bool set(int fd, int level, int option, const void *value, socklen_t size)
{
    return setsockopt(fd, level, option, value, size) == 0;
}

/** Bound to the group: a socket bound to any address also receives the port's other groups.
 *  On that interface only: by default a group that another process joined elsewhere is received too. */
static bool open_receiving(const saddle_bus_t *bus, const interface_t *interface)
{
    const int yes = 1, no = 0, buffer = RECEIVE_BUFFER_BYTES, fd = bus->receive_fd;
    const struct ip_mreqn membership = {.imr_multiaddr = bus->group.sin_addr,
                                        .imr_ifindex = interface->index};
    return fd >= 0 && set(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes) &&
           set(fd, SOL_SOCKET, SO_RCVBUF, &buffer, sizeof buffer) && saddle_stamp(fd) &&
           set(fd, IPPROTO_IP, IP_MULTICAST_ALL, &no, sizeof no) &&
           bind(fd, (const struct sockaddr *)&bus->group, sizeof bus->group) == 0 &&
           set(fd, IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership);
}

/** A second socket: its port identifies our own frames. */
static bool open_sending(saddle_bus_t *bus, const interface_t *interface)
{
    const int hops = strcmp(interface->name, LOOPBACK) == 0 ? 0 : 1, fd = bus->send_fd;
    const struct ip_mreqn leaving = {.imr_ifindex = interface->index};
    socklen_t size = sizeof bus->own;
    bus->own = (struct sockaddr_in){.sin_family = AF_INET, .sin_addr = interface->address};
    return fd >= 0 && set(fd, IPPROTO_IP, IP_MULTICAST_TTL, &hops, sizeof hops) &&
           set(fd, IPPROTO_IP, IP_MULTICAST_IF, &leaving, sizeof leaving) &&
           bind(fd, (const struct sockaddr *)&bus->own, size) == 0 &&
           getsockname(fd, (struct sockaddr *)&bus->own, &size) == 0;
}

static bool fail(saddle_bus_t *bus, const char *interface_name)
{
    const int error = errno;
    char remedy[80] = "give another --can udp:GROUP:PORT";
    if (error != EADDRINUSE && error != EACCES) {
        snprintf(remedy, sizeof remedy, "%s must be up, `sudo ip link set %.16s up`",
                 strcmp(interface_name, LOOPBACK) == 0 ? "loopback" : "the interface",
                 interface_name);
    }
    snprintf(bus->description, sizeof bus->description, "UDP %.40s cannot be opened (%s): %s",
             bus->channel, strerror(error), remedy);
    return false;
}

static void describe(saddle_bus_t *bus, const char *interface_name)
{
    bus->on_loopback = strcmp(interface_name, LOOPBACK) == 0;
    snprintf(bus->description, sizeof bus->description, "UDP %.40s%s", bus->channel,
             bus->on_loopback ? " on loopback" : ", which leaves this machine");
}

bool saddle_bus_udp_open(saddle_bus_t *bus)
{
    const char *interface_name;
    interface_t interface;
    if (!parse(&bus->group, &interface_name, bus->channel)) {
        snprintf(bus->description, sizeof bus->description,
                 "give a multicast group and a port, such as udp:239.74.163.2:43113");
        return false;
    }
    bus->receive_fd = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK, 0);
    bus->send_fd = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK, 0);
    if (!find_interface(&interface, interface_name, bus->send_fd) ||
        !open_receiving(bus, &interface) || !open_sending(bus, &interface)) {
        return fail(bus, interface_name);
    }
    describe(bus, interface_name);
    return true;
}

bool saddle_bus_udp_send(const saddle_bus_t *bus, const saddle_bus_frame_t *frame)
{
    uint8_t datagram[SADDLE_DATAGRAM_MAX];
    const size_t size = saddle_datagram_encode(frame, datagram);
    return sendto(bus->send_fd, datagram, size, 0, (const struct sockaddr *)&bus->group,
                  sizeof bus->group) == (ssize_t)size;
}

static bool is_own(const saddle_bus_t *bus, const struct sockaddr_in *source)
{
    return source->sin_port == bus->own.sin_port &&
           source->sin_addr.s_addr == bus->own.sin_addr.s_addr;
}

saddle_bus_received_t saddle_bus_udp_receive(const saddle_bus_t *bus, saddle_bus_frame_t *frame)
{
    uint8_t datagram[SADDLE_DATAGRAM_MAX + 1]; /* one more: a longer datagram shows as too long */
    struct sockaddr_in source;
    uint32_t waited_us;
    ssize_t size;
    do {
        size = saddle_receive_stamped(bus->receive_fd, datagram, sizeof datagram,
                                      (struct sockaddr *)&source, sizeof source, &waited_us);
    } while (size >= 0 && is_own(bus, &source));
    if (size < 0) {
        return SADDLE_BUS_FAILED;
    }
    const bool decoded = saddle_datagram_decode(datagram, (size_t)size, frame);
    frame->waited_us = waited_us;
    return decoded ? SADDLE_BUS_FRAME : SADDLE_BUS_JUNK;
}
