#include "lcm_port.h"

#include "lcm_commands.h"
#include "lcm_messages.h"
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/** Without LCM's long messages on standard error: the caller prints one line. */
static lcm_t *create_silently(const char *url)
{
    const int saved = dup(STDERR_FILENO);
    const int null_device = open("/dev/null", O_WRONLY);
    const bool silenced = saved >= 0 && null_device >= 0 && dup2(null_device, STDERR_FILENO) >= 0;
    lcm_t *lcm = lcm_create(url);
    if (silenced) {
        dup2(saved, STDERR_FILENO);
    }
    close(null_device);
    close(saved);
    return lcm;
}

/** liblcm's default is `ttl=0`. */
static const char *reach_of(const char *url)
{
    const char *hops = strstr(url, "ttl=");
    if (!saddle_lcm_commands_possible(url)) {
        return "";
    }
    return hops != NULL && strtol(hops + 4, NULL, 10) > 0 ? ", which leaves this machine"
                                                          : " on this machine";
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

static void note_sent(saddle_lcm_port_t *port, bool sent)
{
    port->not_sent += !sent;
    saddle_link_set(&port->link, sent ? SADDLE_LINK_UP : SADDLE_LINK_DOWN, "LCM",
                    "a message cannot be sent, probably because there is no multicast route");
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
    size = saddle_lcm_encode_turn(input, bytes);
    publish(port, "SADDLEWALK_TURN", bytes, size);
    size = saddle_lcm_encode_feet(input, bytes);
    publish(port, "SADDLEWALK_FEET", bytes, size);
    for (int part = 0; part < SADDLE_LCM_OUTPUTS; ++part) {
        size = saddle_lcm_encode_output((saddle_lcm_output_t)part, output, health->utime_us, bytes);
        publish(port, saddle_lcm_channel((saddle_lcm_output_t)part), bytes, size);
    }
    note_sent(port, saddlewalk_status_t_publish(port->lcm, "SADDLEWALK_STATUS", status) == 0);
    note_sent(port, saddlewalk_health_t_publish(port->lcm, "SADDLEWALK_HEALTH", health) == 0);
}

void saddle_lcm_publish_joints(saddle_lcm_port_t *port, const saddle_sensors_t *sensors,
                               const saddle_estimate_t *estimate,
                               const saddle_joint_commands_t *commands)
{
    if (port->lcm == NULL) {
        return;
    }
    uint8_t bytes[SADDLE_LCM_MESSAGE_MAX];
    int size = saddle_lcm_encode_sensors(sensors, estimate, bytes);
    publish(port, "SADDLEWALK_SENSORS", bytes, size);
    size = saddle_lcm_encode_joints(commands, (int64_t)sensors->time_us, bytes);
    publish(port, "SADDLEWALK_JOINTS", bytes, size);
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
