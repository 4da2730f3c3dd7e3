/** The network interfaces of this machine. */
#ifndef SADDLEWALK_HOST_NETWORK_INTERFACE_H
#define SADDLEWALK_HOST_NETWORK_INTERFACE_H

#include <stdbool.h>

/** Whether an interface of that name exists and is up. */
bool saddle_interface_is_up(const char *name);

#endif
