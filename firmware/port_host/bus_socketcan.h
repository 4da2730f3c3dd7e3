/** CAN frames through the kernel's SocketCAN. The functions are those of bus.h for this kind. */
#ifndef SADDLEWALK_HOST_BUS_SOCKETCAN_H
#define SADDLEWALK_HOST_BUS_SOCKETCAN_H

#include "bus_types.h"

/** Open bus->channel, the name of an interface. */
bool saddle_bus_socketcan_open(saddle_bus_t *bus);

/** False: errno says why. */
bool saddle_bus_socketcan_send(const saddle_bus_t *bus, const saddle_bus_frame_t *frame);

saddle_bus_received_t saddle_bus_socketcan_receive(const saddle_bus_t *bus,
                                                   saddle_bus_frame_t *frame);

#endif
