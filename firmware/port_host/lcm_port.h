/** LCM as the host uses it: the tick's output and health go out, commands come in. */
#ifndef SADDLEWALK_HOST_LCM_PORT_H
#define SADDLEWALK_HOST_LCM_PORT_H

#include "link.h"
#include <lcm/lcm.h>
#include <saddlewalk/saddlewalk.h>
#include <saddlewalk_health_t.h>
#include <saddlewalk_status_t.h>

/** Called with each command received, and for how long it had waited; with NULL for a message that
 *  was none. */
typedef void saddle_lcm_command_fn(void *user, const saddle_command_t *command,
                                   uint32_t waited_us);

/** All zero: no LCM, and every call does nothing. */
typedef struct {
    lcm_t *lcm;
    saddle_lcm_command_fn *on_command;
    void *user;
    saddle_link_t link;
    uint64_t not_sent;     /**< messages that LCM did not take */
    char description[200]; /**< the URL and how far it reaches */
} saddle_lcm_port_t;

/** False: LCM cannot use the URL, most often for want of a multicast route. A route that is lost
 *  later is announced, and used again when it is back. */
bool saddle_lcm_open(saddle_lcm_port_t *port, const char *url);

/** Have commands given to on_command from within saddle_lcm_receive(). */
void saddle_lcm_subscribe(saddle_lcm_port_t *port, saddle_lcm_command_fn *on_command, void *user);

/** Readable when a message waits; -1 unless subscribed. */
int saddle_lcm_fd(const saddle_lcm_port_t *port);

/** Handle what waits, `limit` messages at most, without blocking. */
void saddle_lcm_receive(saddle_lcm_port_t *port, int limit);

/** SADDLEWALK_INPUT, _PLAN, _SCORES, _VERDICT, _BOS, _STATUS and, last, _HEALTH, all with the
 *  utime_us of the input and health's tick. */
void saddle_lcm_publish(saddle_lcm_port_t *port, const saddle_input_t *input,
                        const saddle_output_t *output, const saddlewalk_status_t *status,
                        const saddlewalk_health_t *health);

/** SADDLEWALK_CONFIG. */
void saddle_lcm_publish_config(saddle_lcm_port_t *port, const saddle_config_t *config,
                               uint64_t time_us, bool lockstep);

void saddle_lcm_close(saddle_lcm_port_t *port);

#endif
