#include "bus_udp.h"

#include "datagram.h"
#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

/** Room for a second of a loaded 1 Mbit/s bus, so that nothing is lost while a tick runs. */
#define RECEIVE_BUFFER_BYTES (1 << 20)

static bool parse(struct sockaddr_in *group, const char *text)
{
    char address[INET_ADDRSTRLEN];
    const char *colon = strchr(text, ':');
    const size_t length = colon == NULL ? 0 : (size_t)(colon - text);
    if (length == 0 || length >= sizeof address || colon[1] < '1' || colon[1] > '9') {
        return false;
    }
    memcpy(address, text, length);
    address[length] = '\0';
    char *end;
    const unsigned long port = strtoul(colon + 1, &end, 10);
    *group = (struct sockaddr_in){.sin_family = AF_INET, .sin_port = htons((uint16_t)port)};
    return *end == '\0' && port <= UINT16_MAX &&
           inet_pton(AF_INET, address, &group->sin_addr) == 1 &&
           IN_MULTICAST(ntohl(group->sin_addr.s_addr));
}

static bool set(int fd, int level, int option, const void *value, socklen_t size)
{
    return setsockopt(fd, level, option, value, size) == 0;
}

/** Bound to the group: a socket bound to any address also hears the port's other groups. */
static bool open_receiving(saddle_bus_t *bus)
{
    const int yes = 1, buffer = RECEIVE_BUFFER_BYTES;
    const struct ip_mreq membership = {.imr_multiaddr = bus->group.sin_addr,
                                       .imr_interface.s_addr = htonl(INADDR_LOOPBACK)};
    const int fd = bus->receive_fd = socket(AF_INET, SOCK_DGRAM, 0);
    return fd >= 0 && set(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes) &&
           set(fd, SOL_SOCKET, SO_RCVBUF, &buffer, sizeof buffer) &&
           bind(fd, (const struct sockaddr *)&bus->group, sizeof bus->group) == 0 &&
           set(fd, IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership) &&
           fcntl(fd, F_SETFL, O_NONBLOCK) == 0;
}

/** A second socket: its port tells our own frames from all others. */
static bool open_sending(saddle_bus_t *bus)
{
    const unsigned char hops = 0;
    const struct in_addr loopback = {.s_addr = htonl(INADDR_LOOPBACK)};
    const int fd = bus->send_fd = socket(AF_INET, SOCK_DGRAM, 0);
    socklen_t size = sizeof bus->own;
    bus->own = (struct sockaddr_in){.sin_family = AF_INET, .sin_addr = loopback};
    return fd >= 0 && set(fd, IPPROTO_IP, IP_MULTICAST_TTL, &hops, sizeof hops) &&
           set(fd, IPPROTO_IP, IP_MULTICAST_IF, &loopback, sizeof loopback) &&
           bind(fd, (const struct sockaddr *)&bus->own, size) == 0 &&
           getsockname(fd, (struct sockaddr *)&bus->own, &size) == 0 &&
           fcntl(fd, F_SETFL, O_NONBLOCK) == 0;
}

static const char *remedy(int error)
{
    return error == EADDRINUSE || error == EACCES
               ? "give another --can udp:GROUP:PORT"
               : "loopback must be up, `sudo ip link set lo up`";
}

bool saddle_bus_udp_open(saddle_bus_t *bus, const char *group_and_port)
{
    bus->kind = SADDLE_BUS_UDP;
    bus->receive_fd = bus->send_fd = -1;
    if (!parse(&bus->group, group_and_port)) {
        snprintf(bus->description, sizeof bus->description,
                 "give a multicast group and a port, such as udp:239.74.163.2:43113");
        return false;
    }
    if (!open_receiving(bus) || !open_sending(bus)) {
        snprintf(bus->description, sizeof bus->description, "UDP %.30s cannot be opened (%s): %s",
                 group_and_port, strerror(errno), remedy(errno));
        saddle_bus_close(bus);
        return false;
    }
    snprintf(bus->description, sizeof bus->description, "UDP %.30s on loopback", group_and_port);
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
    ssize_t size;
    do {
        socklen_t source_size = sizeof source;
        size = recvfrom(bus->receive_fd, datagram, sizeof datagram, 0, (struct sockaddr *)&source,
                        &source_size);
    } while (size >= 0 && is_own(bus, &source));
    if (size < 0) {
        return SADDLE_BUS_EMPTY;
    }
    return saddle_datagram_decode(datagram, (size_t)size, frame) ? SADDLE_BUS_FRAME
                                                                 : SADDLE_BUS_JUNK;
}
