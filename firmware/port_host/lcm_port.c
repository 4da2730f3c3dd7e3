#include "lcm_port.h"
#include "lcm_messages.h"

#include "clock.h"
#include <arpa/inet.h>
#include <fcntl.h>
#include <saddlewalk_command_t.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/** LCM explains at length on standard error why it cannot start; the caller does so in one line. */
static lcm_t *create_silently(const char *url)
{
    const int standard_error = dup(STDERR_FILENO);
    const int nowhere = open("/dev/null", O_WRONLY);
    dup2(nowhere, STDERR_FILENO);
    lcm_t *lcm = lcm_create(url);
    dup2(standard_error, STDERR_FILENO);
    close(nowhere);
    close(standard_error);
    return lcm;
}

/** Whether the kernel's closest route to a multicast group leads to this machine itself. */
static bool is_routed_to_loopback(uint32_t group)
{
    char line[256], interface_name[16];
    unsigned destination, mask, closest = 0;
    bool found = false, loopback = false;
    FILE *routes = fopen("/proc/net/route", "r");
    while (routes != NULL && fgets(line, sizeof line, routes) != NULL) {
        if (sscanf(line, "%15s %x %*x %*x %*d %*d %*d %x", interface_name, &destination, &mask) ==
                3 && (group & mask) == destination && (!found || ntohl(mask) > ntohl(closest))) {
            found = true;
            closest = mask;
            loopback = strcmp(interface_name, "lo") == 0;
        }
    }
    if (routes != NULL) {
        fclose(routes);
    }
    return loopback;
}

/** With the default URL nothing leaves the machine, but a group that is routed to a network is
 *  heard from there too: LCM has no option for the interface. */
static const char *reach_of(const char *url)
{
    static const char udpm[] = "udpm://";
    char group[INET_ADDRSTRLEN] = "";
    struct in_addr address;
    if (strncmp(url, udpm, sizeof udpm - 1) != 0) {
        return "";
    }
    const char *hops = strstr(url, "ttl=");
    if (hops != NULL && strtol(hops + 4, NULL, 10) > 0) {
        return ", which leaves this machine: anyone on that network may speak";
    }
    (void)sscanf(url + sizeof udpm - 1, "%15[0-9.]", group);
    return inet_pton(AF_INET, group, &address) == 1 && is_routed_to_loopback(address.s_addr)
               ? " on loopback"
               : ", which does not leave this machine, but hears others: "
                 "`ip route add 224.0.0.0/4 dev lo` keeps them out";
}

bool saddle_lcm_open(saddle_lcm_port_t *port, const char *url)
{
    *port = (saddle_lcm_port_t){.lcm = create_silently(url)};
    if (port->lcm != NULL) {
        port->link.state = SADDLE_LINK_UP;
        snprintf(port->description, sizeof port->description, "%.60s%s", url, reach_of(url));
    }
    return port->lcm != NULL;
}

/** The generated handler drops what it cannot decode unseen; this one lets it be counted. */
static void take_command(const lcm_recv_buf_t *received, const char *channel, void *user)
{
    const saddle_lcm_port_t *port = user;
    const int size = (int)received->data_size;
    saddlewalk_command_t message;
    const uint32_t waited_us = saddle_since_us(received->recv_utime);
    (void)channel;
    if (saddlewalk_command_t_decode(received->data, 0, size, &message) != size) {
        port->on_command(port->user, NULL, waited_us);
        return;
    }
    const saddle_command_t command = {.mode = (uint8_t)message.mode,
                                      .speed_m_s = message.speed_m_s,
                                      .heel_strike_rad = message.heel_strike_rad};
    port->on_command(port->user, &command, waited_us);
}

void saddle_lcm_subscribe(saddle_lcm_port_t *port, saddle_lcm_command_fn *on_command, void *user)
{
    if (port->lcm != NULL) {
        port->on_command = on_command;
        port->user = user;
        lcm_subscribe(port->lcm, "SADDLEWALK_COMMAND", take_command, port);
    }
}

int saddle_lcm_fd(const saddle_lcm_port_t *port)
{
    return port->on_command != NULL ? lcm_get_fileno(port->lcm) : -1;
}

void saddle_lcm_receive(saddle_lcm_port_t *port, int limit)
{
    while (port->on_command != NULL && limit-- > 0 && lcm_handle_timeout(port->lcm, 0) > 0) {
    }
}

static void note_sent(saddle_lcm_port_t *port, bool sent)
{
    port->not_sent += !sent;
    saddle_link_set(&port->link, sent ? SADDLE_LINK_UP : SADDLE_LINK_DOWN, "LCM",
                    "a message cannot be sent, most often for want of a multicast route");
}

static void publish(saddle_lcm_port_t *port, const char *channel, const uint8_t *bytes, int size)
{
    note_sent(port, lcm_publish(port->lcm, channel, bytes, (unsigned int)size) == 0);
}

void saddle_lcm_publish(saddle_lcm_port_t *port, const saddle_input_t *input,
                        const saddle_output_t *output, const saddlewalk_status_t *status,
                        const saddlewalk_health_t *health)
{
    if (port->lcm == NULL) {
        return;
    }
    uint8_t bytes[SADDLE_LCM_MESSAGE_MAX];
    int size = saddle_lcm_encode_input(input, health->tick, bytes);
    publish(port, "SADDLEWALK_INPUT", bytes, size);
    for (int part = 0; part < SADDLE_LCM_OUTPUTS; ++part) {
        size = saddle_lcm_encode_output((saddle_lcm_output_t)part, output, health->utime_us, bytes);
        publish(port, saddle_lcm_channel((saddle_lcm_output_t)part), bytes, size);
    }
    note_sent(port, saddlewalk_status_t_publish(port->lcm, "SADDLEWALK_STATUS", status) == 0);
    note_sent(port, saddlewalk_health_t_publish(port->lcm, "SADDLEWALK_HEALTH", health) == 0);
}

void saddle_lcm_publish_config(saddle_lcm_port_t *port, const saddle_config_t *config,
                               uint64_t time_us, bool lockstep)
{
    if (port->lcm == NULL) {
        return;
    }
    uint8_t bytes[SADDLE_LCM_MESSAGE_MAX];
    const int size = saddle_lcm_encode_config(config, time_us, lockstep, bytes);
    publish(port, "SADDLEWALK_CONFIG", bytes, size);
}

void saddle_lcm_close(saddle_lcm_port_t *port)
{
    if (port->lcm != NULL) {
        lcm_destroy(port->lcm);
    }
}
