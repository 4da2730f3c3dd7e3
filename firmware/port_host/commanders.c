#include "commanders.h"

#include <stdio.h>

/** Any user: neither loopback nor a CAN socket needs privileges. */
#define THIS_MACHINE "any program on this machine"
#define NETWORK "anyone on the network"

static void print_by_can(const saddle_bus_t *bus)
{
    if (bus->kind == SADDLE_BUS_SOCKETCAN) {
        printf("any node on the bus %s", bus->channel);
    } else {
        printf("%s (CAN over UDP)", bus->on_loopback ? THIS_MACHINE : NETWORK);
    }
}

static void print_by_anyone(const saddle_options_t *options, const saddle_bus_t *bus)
{
    const bool can = options->command_from != SADDLE_SOURCE_LCM;
    const bool lcm =
        options->command_from != SADDLE_SOURCE_CAN && saddle_options_lcm_commands(options);
    if (can && lcm && bus->on_loopback && !options->lcm_from_network) {
        printf(THIS_MACHINE " (CAN over UDP, LCM)");
        return;
    }
    if (can) {
        print_by_can(bus);
    }
    if (lcm) {
        printf("%s%s (LCM)", can ? ", " : "", options->lcm_from_network ? NETWORK : THIS_MACHINE);
    }
}

void saddle_print_commanders(const saddle_options_t *options, const saddle_bus_t *bus)
{
    printf("commands: ");
    if (options->command_key != NULL) {
        printf("by CAN, authenticated with the key in %s", options->command_key);
        return;
    }
    print_by_anyone(options, bus);
    printf("; --command-key FILE to authenticate");
}
