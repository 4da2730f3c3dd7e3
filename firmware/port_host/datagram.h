/**
 * One CAN frame as one datagram of python-can's `udp_multicast`: a MessagePack map with the
 * attributes of a can.Message (python-can 4, can/interfaces/udp_multicast).
 */
#ifndef SADDLEWALK_HOST_DATAGRAM_H
#define SADDLEWALK_HOST_DATAGRAM_H

#include "bus_types.h"
#include <stddef.h>

/** Longest datagram accepted. python-can's are 180 bytes for a classic frame. */
#define SADDLE_DATAGRAM_MAX 512

/** Returns the size. frame is a classic data frame of at most 8 bytes. */
size_t saddle_datagram_encode(const saddle_bus_frame_t *frame,
                              uint8_t datagram[SADDLE_DATAGRAM_MAX]);

/**
 * False unless the bytes are one map, to the end, of keys that python-can knows, and describe a
 * classic frame. Keys may come in any order and numbers in any width. Extended, remote and error
 * frames get an identifier above the 11 bits, as SocketCAN marks them. Any bytes are safe.
 */
bool saddle_datagram_decode(const uint8_t *datagram, size_t size, saddle_bus_frame_t *frame);

#endif
