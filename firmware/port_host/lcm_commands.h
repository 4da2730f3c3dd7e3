/**
 * Commands by LCM: command_t, which goes straight on, and command_turn_t. liblcm hands over a message
 * without its sender, so they are received on a socket of their own, which reads LCM's UDP multicast
 * datagrams:
 * https://lcm-proj.github.io/lcm/content/udp-multicast-protocol.html
 * By default only commands sent on this machine are accepted. A filter in the kernel decides
 * that by the way a datagram came, not by its source address, and drops all other channels before
 * they wake this process.
 */
#ifndef SADDLEWALK_HOST_LCM_COMMANDS_H
#define SADDLEWALK_HOST_LCM_COMMANDS_H

#include <netinet/in.h>
#include <saddlewalk/saddlewalk.h>
#include <stdbool.h>
#include <stdint.h>

typedef enum {
    SADDLE_LCM_EMPTY, /**< no message is waiting */
    SADDLE_LCM_COMMAND,
    SADDLE_LCM_JUNK,   /**< on a channel of commands, but not of its type */
    SADDLE_LCM_FOREIGN /**< a command from another machine, which does not count */
} saddle_lcm_received_t;

typedef struct {
    saddle_command_t command; /**< with SADDLE_LCM_COMMAND */
    uint32_t waited_us;       /**< time since reception; 0 with SADDLE_LCM_EMPTY */
    struct in_addr source;    /**< the sender's address, as the datagram says */
} saddle_lcm_arrival_t;

/** Whether commands can come by that LCM URL: `udpm://`, and no other provider. */
bool saddle_lcm_commands_possible(const char *url);

/** Join the multicast group of a URL that passed saddle_lcm_commands_possible(). Returns a socket
 *  that is readable when a command waits; -1: errno says why not. */
int saddle_lcm_commands_open(const char *url, bool from_network);

/** Receive the next message without blocking. */
saddle_lcm_received_t saddle_lcm_commands_receive(int fd, saddle_lcm_arrival_t *arrival);

#endif
