/**
 * CAN as the host sees it: SocketCAN or UDP multicast on loopback. Knows neither the core nor what
 * the frames mean. Nothing here blocks, and a node never hears its own frames.
 */
#ifndef SADDLEWALK_HOST_BUS_H
#define SADDLEWALK_HOST_BUS_H

#include <netinet/in.h>
#include <stdbool.h>
#include <stdint.h>

/** A classic data frame has an 11-bit identifier. Any other kind arrives with a higher one. */
typedef struct {
    uint32_t id;
    uint8_t length; /**< at most 8 */
    uint8_t data[8];
} saddle_bus_frame_t;

typedef enum {
    SADDLE_BUS_EMPTY, /**< nothing waits */
    SADDLE_BUS_FRAME,
    SADDLE_BUS_JUNK   /**< something that was no CAN frame was taken from the bus */
} saddle_bus_received_t;

typedef enum { SADDLE_BUS_SOCKETCAN = 0, SADDLE_BUS_UDP = 1 } saddle_bus_kind_t;

typedef struct {
    saddle_bus_kind_t kind;
    int receive_fd;            /**< becomes readable when something waits */
    int send_fd;               /**< the same one on SocketCAN */
    struct sockaddr_in group;  /**< UDP: where frames are sent */
    struct sockaddr_in own;    /**< UDP: where they come from, to know our own again */
    char description[160];     /**< what was chosen and why, or why it could not be opened */
} saddle_bus_t;

/**
 * Open a bus. spec: `auto` (SocketCAN vcan0 if it is up, else `udp`), `socketcan:INTERFACE`, `udp`
 * or `udp:GROUP:PORT`. False: not opened, and bus->description says in one line what is wrong and
 * what would be right.
 */
bool saddle_bus_open(saddle_bus_t *bus, const char *spec);

/** False if the frame was dropped: no room, or the interface went down. */
bool saddle_bus_send(const saddle_bus_t *bus, const saddle_bus_frame_t *frame);

/** Take what came next. frame is written only with SADDLE_BUS_FRAME. */
saddle_bus_received_t saddle_bus_receive(const saddle_bus_t *bus, saddle_bus_frame_t *frame);

void saddle_bus_close(saddle_bus_t *bus);

#endif
