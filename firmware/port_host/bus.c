#include "bus.h"

#include "bus_socketcan.h"
#include "bus_udp.h"
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define DEFAULT_INTERFACE "vcan0"
#define DEFAULT_GROUP "239.74.163.2:43113"

static bool open_auto(saddle_bus_t *bus)
{
    if (saddle_bus_socketcan_open(bus, DEFAULT_INTERFACE)) {
        snprintf(bus->description, sizeof bus->description,
                 "SocketCAN " DEFAULT_INTERFACE " (auto: the interface is up)");
        return true;
    }
    char why[sizeof bus->description];
    memcpy(why, bus->description, sizeof why);
    if (!saddle_bus_udp_open(bus, DEFAULT_GROUP)) {
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
        return saddle_bus_udp_open(bus, DEFAULT_GROUP);
    }
    if (strncmp(spec, udp, sizeof udp - 1) == 0) {
        return saddle_bus_udp_open(bus, spec + sizeof udp - 1);
    }
    if (strncmp(spec, socketcan, sizeof socketcan - 1) == 0) {
        return saddle_bus_socketcan_open(bus, spec + sizeof socketcan - 1);
    }
    snprintf(bus->description, sizeof bus->description,
             "give auto, socketcan:INTERFACE, udp or udp:GROUP:PORT");
    return false;
}

bool saddle_bus_send(const saddle_bus_t *bus, const saddle_bus_frame_t *frame)
{
    return bus->kind == SADDLE_BUS_UDP ? saddle_bus_udp_send(bus, frame)
                                       : saddle_bus_socketcan_send(bus, frame);
}

saddle_bus_received_t saddle_bus_receive(const saddle_bus_t *bus, saddle_bus_frame_t *frame)
{
    return bus->kind == SADDLE_BUS_UDP ? saddle_bus_udp_receive(bus, frame)
                                       : saddle_bus_socketcan_receive(bus, frame);
}

void saddle_bus_close(saddle_bus_t *bus)
{
    close(bus->receive_fd);
    if (bus->send_fd != bus->receive_fd) {
        close(bus->send_fd);
    }
}
