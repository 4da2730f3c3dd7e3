/** The firmware's health for the wire: TIMING, RECEIVED, INPUTS and HEALTH. */
#ifndef SADDLEWALK_PORT_HEALTH_H
#define SADDLEWALK_PORT_HEALTH_H

#include "inbox.h"
#include "timing.h"

saddle_wire_health_t saddle_health(const saddle_timing_t *timing, const saddle_inbox_t *inbox);

#endif
