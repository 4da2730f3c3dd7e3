/** Who can command this process, as text. */
#ifndef SADDLEWALK_HOST_COMMANDERS_H
#define SADDLEWALK_HOST_COMMANDERS_H

#include "bus_types.h"
#include "options.h"

/** The part `commands: ...` of the first line, on standard output. */
void saddle_print_commanders(const saddle_options_t *options, const saddle_bus_t *bus);

#endif
