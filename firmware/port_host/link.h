/** Whether a transport carries anything now. A change is announced once. */
#ifndef SADDLEWALK_HOST_LINK_H
#define SADDLEWALK_HOST_LINK_H

#include <stdint.h>

/** As in status_t. */
typedef enum {
    SADDLE_LINK_UNUSED = 0,
    SADDLE_LINK_UP = 1,
    SADDLE_LINK_DOWN = 2,   /**< the interface or the route is gone; retried every tick */
    SADDLE_LINK_BUS_OFF = 3 /**< the CAN controller has left the bus after too many errors */
} saddle_link_state_t;

typedef struct {
    saddle_link_state_t state;
    uint32_t losses; /**< number of times that it went down */
} saddle_link_t;

/** what: the transport, such as `CAN vcan0`; why: the reason, or NULL when it is up. */
void saddle_link_set(saddle_link_t *link, saddle_link_state_t state, const char *what,
                     const char *why);

#endif
