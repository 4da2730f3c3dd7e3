/** What bus.h and the transports below it share: a frame, and a bus. */
#ifndef SADDLEWALK_HOST_BUS_TYPES_H
#define SADDLEWALK_HOST_BUS_TYPES_H

#include "link.h"
#include <netinet/in.h>
#include <stdbool.h>
#include <stdint.h>

/** A classic data frame has an 11-bit identifier. Any other kind arrives with a higher one. */
typedef struct {
    uint32_t id;
    uint8_t length; /**< at most 8 */
    uint8_t data[8];
    uint32_t waited_us; /**< of a received frame: time since its reception */
} saddle_bus_frame_t;

/** saddle_bus_receive() returns one of the first three; the others are between it and the kinds. */
typedef enum {
    SADDLE_BUS_EMPTY, /**< no frame is waiting */
    SADDLE_BUS_FRAME,
    SADDLE_BUS_JUNK,     /**< something other than a CAN frame was read from the bus */
    SADDLE_BUS_FAILED,   /**< errno says why */
    SADDLE_BUS_OFF,      /**< the controller has left the bus */
    SADDLE_BUS_RESTARTED /**< the controller is on the bus again */
} saddle_bus_received_t;

typedef enum { SADDLE_BUS_SOCKETCAN = 0, SADDLE_BUS_UDP = 1 } saddle_bus_kind_t;

typedef struct {
    saddle_bus_kind_t kind;
    int receive_fd;           /**< readable when a frame is waiting */
    int send_fd;              /**< the same one on SocketCAN */
    struct sockaddr_in group; /**< UDP: where frames are sent */
    bool on_loopback;         /**< UDP: does not leave this machine */
    struct sockaddr_in own;   /**< UDP: their source, to recognise our own */
    char channel[64];         /**< SocketCAN: INTERFACE; UDP: GROUP:PORT or GROUP:PORT@INTERFACE */
    char description[200];    /**< what was chosen and why, or why it could not be opened */
    saddle_link_t link;
    uint32_t sent;
    uint32_t no_room; /**< dropped: the queue was full */
    uint32_t no_link; /**< dropped: the link was down */
} saddle_bus_t;

#endif
