#include "bus.h"

#include "bus_socketcan.h"
#include "bus_udp.h"
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define DEFAULT_INTERFACE "vcan0"
#define DEFAULT_GROUP "239.74.163.2:43113"

static bool open_channel(saddle_bus_t *bus, saddle_bus_kind_t kind, const char *channel)
{
    *bus = (saddle_bus_t){.kind = kind, .receive_fd = -1, .send_fd = -1};
    if (strlen(channel) >= sizeof bus->channel) {
        snprintf(bus->description, sizeof bus->description, "give a shorter name");
        return false;
    }
    memcpy(bus->channel, channel, strlen(channel));
    const bool opened =
        kind == SADDLE_BUS_UDP ? saddle_bus_udp_open(bus) : saddle_bus_socketcan_open(bus);
    if (opened) {
        bus->link.state = SADDLE_LINK_UP;
    } else {
        saddle_bus_close(bus);
    }
    return opened;
}

static bool open_auto(saddle_bus_t *bus)
{
    if (open_channel(bus, SADDLE_BUS_SOCKETCAN, DEFAULT_INTERFACE)) {
        snprintf(bus->description, sizeof bus->description,
                 "SocketCAN " DEFAULT_INTERFACE " (auto: the interface is up)");
        return true;
    }
    char why[sizeof bus->description];
    memcpy(why, bus->description, sizeof why);
    if (!open_channel(bus, SADDLE_BUS_UDP, DEFAULT_GROUP)) {
        return false;
    }
    snprintf(bus->description, sizeof bus->description,
             "UDP " DEFAULT_GROUP " on loopback (auto: %.90s)", why);
    return true;
}

bool saddle_bus_open(saddle_bus_t *bus, const char *spec)
{
    static const char socketcan[] = "socketcan:", udp[] = "udp:";
    if (strcmp(spec, "auto") == 0) {
        return open_auto(bus);
    }
    if (strcmp(spec, "udp") == 0) {
        return open_channel(bus, SADDLE_BUS_UDP, DEFAULT_GROUP);
    }
    if (strncmp(spec, udp, sizeof udp - 1) == 0) {
        return open_channel(bus, SADDLE_BUS_UDP, spec + sizeof udp - 1);
    }
    if (strncmp(spec, socketcan, sizeof socketcan - 1) == 0) {
        return open_channel(bus, SADDLE_BUS_SOCKETCAN, spec + sizeof socketcan - 1);
    }
    snprintf(bus->description, sizeof bus->description,
             "give auto, socketcan:INTERFACE, udp, udp:GROUP:PORT or udp:GROUP:PORT@INTERFACE");
    return false;
}

static void set_link(saddle_bus_t *bus, saddle_link_state_t state, const char *why)
{
    char name[sizeof bus->channel + 16];
    snprintf(name, sizeof name, "CAN %s%s", bus->kind == SADDLE_BUS_UDP ? "over UDP " : "",
             bus->channel);
    saddle_link_set(&bus->link, state, name, why);
}

static bool is_passing(int error)
{
    return error == EAGAIN || error == EWOULDBLOCK || error == ENOBUFS || error == EINTR;
}

void saddle_bus_send(saddle_bus_t *bus, const saddle_bus_frame_t *frame)
{
    if (bus->link.state == SADDLE_LINK_DOWN) {
        ++bus->no_link;
        return;
    }
    const bool sent = bus->kind == SADDLE_BUS_UDP ? saddle_bus_udp_send(bus, frame)
                                                  : saddle_bus_socketcan_send(bus, frame);
    const int error = errno;
    if (sent) {
        ++bus->sent;
    } else if (is_passing(error)) {
        ++bus->no_room;
    } else {
        ++bus->no_link;
        set_link(bus, SADDLE_LINK_DOWN, strerror(error));
    }
}

/** Handle events of the link, as opposed to frames. */
static void note_link(saddle_bus_t *bus, saddle_bus_received_t received, int error)
{
    if (received == SADDLE_BUS_OFF) {
        set_link(bus, SADDLE_LINK_BUS_OFF,
                 "bus-off; only `ip link set CHANNEL type can restart-ms 100` makes it restart");
    } else if (received == SADDLE_BUS_RESTARTED) {
        set_link(bus, SADDLE_LINK_UP, NULL);
    } else if (received == SADDLE_BUS_FAILED && !is_passing(error)) {
        set_link(bus, SADDLE_LINK_DOWN, strerror(error));
    }
}

saddle_bus_received_t saddle_bus_receive(saddle_bus_t *bus, saddle_bus_frame_t *frame)
{
    for (;;) {
        const saddle_bus_received_t received = bus->kind == SADDLE_BUS_UDP
                                                   ? saddle_bus_udp_receive(bus, frame)
                                                   : saddle_bus_socketcan_receive(bus, frame);
        switch (received) {
        case SADDLE_BUS_OFF:
        case SADDLE_BUS_RESTARTED: note_link(bus, received, 0); break;
        case SADDLE_BUS_FAILED: note_link(bus, received, errno); return SADDLE_BUS_EMPTY;
        default: return received;
        }
    }
}

/** Replaces the old bus once it is open: an interface that came back may be a new one. */
void saddle_bus_maintain(saddle_bus_t *bus)
{
    saddle_bus_t fresh;
    if (bus->link.state != SADDLE_LINK_DOWN || !open_channel(&fresh, bus->kind, bus->channel)) {
        return;
    }
    saddle_bus_close(bus);
    bus->receive_fd = fresh.receive_fd;
    bus->send_fd = fresh.send_fd;
    bus->own = fresh.own;
    set_link(bus, SADDLE_LINK_UP, NULL);
}

void saddle_bus_close(saddle_bus_t *bus)
{
    if (bus->receive_fd >= 0) {
        close(bus->receive_fd);
    }
    if (bus->send_fd >= 0 && bus->send_fd != bus->receive_fd) {
        close(bus->send_fd);
    }
    bus->receive_fd = bus->send_fd = -1;
}
