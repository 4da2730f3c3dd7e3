/**
 * CAN frames as UDP multicast datagrams, for machines whose kernel has no CAN. The datagrams are
 * python-can's (`udp_multicast`, see datagram.h). On the loopback interface, with hop limit 0, they
 * need no route and never leave the machine, nor are datagrams of other machines received. If another
 * interface is named, that one is used, with hop limit 1. The functions are those of bus.h.
 */
#ifndef SADDLEWALK_HOST_BUS_UDP_H
#define SADDLEWALK_HOST_BUS_UDP_H

#include "bus_types.h"

/** Open bus->channel: GROUP:PORT or GROUP:PORT@INTERFACE, with an IPv4 multicast group. */
bool saddle_bus_udp_open(saddle_bus_t *bus);

/** False: errno says why. */
bool saddle_bus_udp_send(const saddle_bus_t *bus, const saddle_bus_frame_t *frame);

saddle_bus_received_t saddle_bus_udp_receive(const saddle_bus_t *bus, saddle_bus_frame_t *frame);

#endif
