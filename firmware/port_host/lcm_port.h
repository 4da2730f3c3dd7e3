/** What the host publishes on LCM: the tick's output and health. Commands: see lcm_commands.h. */
#ifndef SADDLEWALK_HOST_LCM_PORT_H
#define SADDLEWALK_HOST_LCM_PORT_H

#include "link.h"
#include <lcm/lcm.h>
#include <saddlewalk/joint_command.h>
#include <saddlewalk/saddlewalk.h>
#include <saddlewalk_health_t.h>
#include <saddlewalk_status_t.h>

/** All zero: no LCM, and every call does nothing. */
typedef struct {
    lcm_t *lcm;
    saddle_link_t link;
    uint64_t not_sent;     /**< messages that LCM did not take */
    char description[200]; /**< the URL and how far it reaches */
} saddle_lcm_port_t;

/** False: LCM cannot use the URL, probably because there is no multicast route. A route that is
 *  lost later is announced, and used again when it is back. */
bool saddle_lcm_open(saddle_lcm_port_t *port, const char *url);

/** SADDLEWALK_INPUT, _TURN, _FEET, _PLAN, _SCORES, _VERDICT, _BALANCE, _BOS, _WAY, _STATUS and, last,
 *  _HEALTH, all with the utime_us of the input and health's tick. */
void saddle_lcm_publish(saddle_lcm_port_t *port, const saddle_input_t *input,
                        const saddle_output_t *output, const saddlewalk_status_t *status,
                        const saddlewalk_health_t *health);

/** SADDLEWALK_SENSORS and _JOINTS, with the time of the sensors. */
void saddle_lcm_publish_joints(saddle_lcm_port_t *port, const saddle_sensors_t *sensors,
                               const saddle_estimate_t *estimate,
                               const saddle_joint_commands_t *commands);

/** SADDLEWALK_CONFIG. */
void saddle_lcm_publish_config(saddle_lcm_port_t *port, const saddle_config_t *config,
                               uint64_t time_us, bool lockstep);

void saddle_lcm_close(saddle_lcm_port_t *port);

#endif
