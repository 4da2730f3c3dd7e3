/**
 * CAN as the host sees it: SocketCAN or UDP multicast, on loopback by default. Knows neither
 * the core nor the meaning of frames. Nothing here blocks, and a node never receives its own
 * frames. A frame that does not fit is dropped, since the next tick sends a newer one; a lost link
 * is announced once and reopened by saddle_bus_maintain().
 */
#ifndef SADDLEWALK_HOST_BUS_H
#define SADDLEWALK_HOST_BUS_H

#include "bus_types.h"

/**
 * Open a bus. spec: `auto` (SocketCAN vcan0 if it is up, else `udp`), `socketcan:INTERFACE`, `udp`,
 * `udp:GROUP:PORT`, or `udp:GROUP:PORT@INTERFACE` to leave this machine by that interface. False:
 * not opened, and bus->description is one line with the problem and the remedy.
 */
bool saddle_bus_open(saddle_bus_t *bus, const char *spec);

/** Send a frame, or drop and count it. */
void saddle_bus_send(saddle_bus_t *bus, const saddle_bus_frame_t *frame);

/** Receive the next frame. frame is written only with SADDLE_BUS_FRAME. */
saddle_bus_received_t saddle_bus_receive(saddle_bus_t *bus, saddle_bus_frame_t *frame);

/** Try to reopen a link that is down. Call it every tick. */
void saddle_bus_maintain(saddle_bus_t *bus);

void saddle_bus_close(saddle_bus_t *bus);

#endif
