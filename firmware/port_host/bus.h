/**
 * CAN as the host sees it: SocketCAN or UDP multicast, on loopback unless told otherwise. Knows
 * neither the core nor what the frames mean. Nothing here blocks, and a node never hears its own
 * frames. A frame that finds no room is dropped, for the next tick brings a newer one; a link that
 * is lost is announced once and opened anew by saddle_bus_maintain().
 */
#ifndef SADDLEWALK_HOST_BUS_H
#define SADDLEWALK_HOST_BUS_H

#include "link.h"
#include <netinet/in.h>
#include <stdbool.h>
#include <stdint.h>

/** A classic data frame has an 11-bit identifier. Any other kind arrives with a higher one. */
typedef struct {
    uint32_t id;
    uint8_t length; /**< at most 8 */
    uint8_t data[8];
    uint32_t waited_us; /**< received: since it came */
} saddle_bus_frame_t;

/** saddle_bus_receive() returns one of the first three; the others are between it and the kinds. */
typedef enum {
    SADDLE_BUS_EMPTY,     /**< nothing waits */
    SADDLE_BUS_FRAME,
    SADDLE_BUS_JUNK,      /**< something that was no CAN frame was taken from the bus */
    SADDLE_BUS_FAILED,    /**< errno says why */
    SADDLE_BUS_OFF,       /**< the controller has left the bus */
    SADDLE_BUS_RESTARTED  /**< it is on the bus again */
} saddle_bus_received_t;

typedef enum { SADDLE_BUS_SOCKETCAN = 0, SADDLE_BUS_UDP = 1 } saddle_bus_kind_t;

typedef struct {
    saddle_bus_kind_t kind;
    int receive_fd;            /**< becomes readable when something waits */
    int send_fd;               /**< the same one on SocketCAN */
    struct sockaddr_in group;  /**< UDP: where frames are sent */
    struct sockaddr_in own;    /**< UDP: where they come from, to know our own again */
    char channel[64];          /**< SocketCAN: INTERFACE; UDP: GROUP:PORT or GROUP:PORT@INTERFACE */
    char description[200];     /**< what was chosen and why, or why it could not be opened */
    saddle_link_t link;
    uint32_t sent;
    uint32_t no_room;          /**< dropped, for the queue was full */
    uint32_t no_link;          /**< dropped, for the link was lost */
} saddle_bus_t;

/**
 * Open a bus. spec: `auto` (SocketCAN vcan0 if it is up, else `udp`), `socketcan:INTERFACE`, `udp`,
 * `udp:GROUP:PORT`, or `udp:GROUP:PORT@INTERFACE` to leave this machine by that interface. False:
 * not opened, and bus->description says in one line what is wrong and what would be right.
 */
bool saddle_bus_open(saddle_bus_t *bus, const char *spec);

/** Send or drop, and count which. */
void saddle_bus_send(saddle_bus_t *bus, const saddle_bus_frame_t *frame);

/** Take what came next. frame is written only with SADDLE_BUS_FRAME. */
saddle_bus_received_t saddle_bus_receive(saddle_bus_t *bus, saddle_bus_frame_t *frame);

/** Try to bring back a link that is down. For every tick. */
void saddle_bus_maintain(saddle_bus_t *bus);

void saddle_bus_close(saddle_bus_t *bus);

/** Whether there is a network interface of that name and it is up. */
bool saddle_interface_is_up(const char *name);

#endif
