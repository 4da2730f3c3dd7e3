#include "lcm_commands.h"

#include "stamped.h"
#include <arpa/inet.h>
#include <errno.h>
#include <linux/filter.h>
#include <linux/if_packet.h>
#include <saddlewalk_command_t.h>
#include <saddlewalk_command_turn_t.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#define SCHEME "udpm://"
#define DEFAULT_GROUP "239.255.76.67"
#define DEFAULT_PORT 7667

/** A message that is not in fragments: magic number, sequence number, channel, payload. */
#define MAGIC 0x4C433032u
#define CHANNEL "SADDLEWALK_COMMAND"
#define TURN_CHANNEL CHANNEL "_TURN"
enum {
    UDP_HEADER = 8,
    HEADER = 8,
    PAYLOAD = HEADER + sizeof CHANNEL,
    TURN_PAYLOAD = HEADER + sizeof TURN_CHANNEL,
    DATAGRAM_MAX = 256
};

/** Loopback has this index in every network namespace. */
#define LOOPBACK_INDEX 1

bool saddle_lcm_commands_possible(const char *url)
{
    return strncmp(url, SCHEME, sizeof SCHEME - 1) == 0;
}

/** `udpm://GROUP:PORT?options`, of which each part may be missing. liblcm has accepted the URL. */
static struct sockaddr_in group_of(const char *url)
{
    const char *network = url + sizeof SCHEME - 1;
    const size_t length = strcspn(network, ":/?");
    char address[INET_ADDRSTRLEN] = DEFAULT_GROUP;
    long port = DEFAULT_PORT;
    if (length > 0 && length < sizeof address) {
        memcpy(address, network, length);
        address[length] = '\0';
    }
    if (network[length] == ':') {
        port = strtol(network + length + 1, NULL, 10);
    }
    struct sockaddr_in group = {.sin_family = AF_INET, .sin_port = htons((uint16_t)port)};
    (void)inet_pton(AF_INET, address, &group.sin_addr);
    return group;
}

/**
 * Keeps messages on the channels of commands: whole, if they were sent on this machine, and without
 * their payload if they came from another one, or whole as well with `from_network`. What this
 * machine sends comes back by loopback, or as the kernel's own copy of what it sends elsewhere.
 */
static bool attach_filter(int fd, bool from_network)
{
    enum { WHOLE = 0x40000, NOTHING = 0 };
    const uint32_t foreign = from_network ? WHOLE : UDP_HEADER;
#define LOAD(size, offset) BPF_STMT(BPF_LD | (size) | BPF_ABS, (uint32_t)(offset))
#define UNLESS(value, ahead) BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, value, 0, ahead)
#define IF(value, ahead) BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, value, ahead, 0)
#define FOUR(text)                                                                      \
    ((uint32_t)(text)[0] << 24 | (uint32_t)(text)[1] << 16 | (uint32_t)(text)[2] << 8 | \
     (uint32_t)(text)[3])
    static const uint8_t channel[] = TURN_CHANNEL; /* 18 letters, which a 0 or a _ follows */
    /* clang-format off: a row for each comparison */
    struct sock_filter steps[] = {
        LOAD(BPF_W, UDP_HEADER),
        UNLESS(MAGIC, 19),
        LOAD(BPF_W, UDP_HEADER + HEADER),
        UNLESS(FOUR(channel), 17),
        LOAD(BPF_W, UDP_HEADER + HEADER + 4),
        UNLESS(FOUR(channel + 4), 15),
        LOAD(BPF_W, UDP_HEADER + HEADER + 8),
        UNLESS(FOUR(channel + 8), 13),
        LOAD(BPF_W, UDP_HEADER + HEADER + 12),
        UNLESS(FOUR(channel + 12), 11),
        LOAD(BPF_H, UDP_HEADER + HEADER + 16),
        UNLESS('N' << 8 | 'D', 9),
        LOAD(BPF_B, UDP_HEADER + HEADER + 18),
        IF('_', 1),
        UNLESS(0, 6),
        LOAD(BPF_W, SKF_AD_OFF + SKF_AD_IFINDEX),
        IF(LOOPBACK_INDEX, 3),
        LOAD(BPF_W, SKF_AD_OFF + SKF_AD_PKTTYPE),
        IF(PACKET_LOOPBACK, 1),
        BPF_STMT(BPF_RET | BPF_K, foreign),
        BPF_STMT(BPF_RET | BPF_K, WHOLE),
        BPF_STMT(BPF_RET | BPF_K, NOTHING),
    };
    /* clang-format on */
#undef LOAD
#undef UNLESS
#undef IF
#undef FOUR
    const struct sock_fprog program = {.len = sizeof steps / sizeof steps[0], .filter = steps};
    return setsockopt(fd, SOL_SOCKET, SO_ATTACH_FILTER, &program, sizeof program) == 0;
}

/** Where the kernel routes the group now, and on loopback, to which it may be routed later. */
static bool join(int fd, struct in_addr group)
{
    const struct ip_mreqn routed = {.imr_multiaddr = group};
    const struct ip_mreqn loopback = {.imr_multiaddr = group, .imr_ifindex = LOOPBACK_INDEX};
    (void)setsockopt(fd, IPPROTO_IP, IP_ADD_MEMBERSHIP, &loopback, sizeof loopback);
    return setsockopt(fd, IPPROTO_IP, IP_ADD_MEMBERSHIP, &routed, sizeof routed) == 0 ||
           errno == EADDRINUSE; /* loopback is where it is routed */
}

int saddle_lcm_commands_open(const char *url, bool from_network)
{
    const int yes = 1;
    const struct sockaddr_in group = group_of(url);
    const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (fd >= 0 && attach_filter(fd, from_network) && saddle_stamp(fd) &&
        setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes) == 0 &&
        bind(fd, (const struct sockaddr *)&group, sizeof group) == 0 && join(fd, group.sin_addr)) {
        return fd;
    }
    const int error = errno;
    close(fd);
    errno = error;
    return -1;
}

static bool decode_command(const uint8_t *bytes, int size, saddle_command_t *command)
{
    saddlewalk_command_t message;
    if (saddlewalk_command_t_decode(bytes, 0, size, &message) != size) {
        return false;
    }
    *command = (saddle_command_t){.mode = (uint8_t)message.mode,
                                  .speed_m_s = message.speed_m_s,
                                  .heel_strike_rad = message.heel_strike_rad};
    return true;
}

static bool decode_turn(const uint8_t *bytes, int size, saddle_command_t *command)
{
    saddlewalk_command_turn_t message;
    if (saddlewalk_command_turn_t_decode(bytes, 0, size, &message) != size) {
        return false;
    }
    *command = (saddle_command_t){.mode = (uint8_t)message.mode,
                                  .speed_m_s = message.speed_m_s,
                                  .heel_strike_rad = message.heel_strike_rad,
                                  .turn_rate_rad_s = message.turn_rate_rad_s};
    return true;
}

/** Of a datagram that passed the filter. */
static bool decode(const uint8_t *datagram, int size, saddle_command_t *command)
{
    if (datagram[PAYLOAD - 1] == 0) {
        return decode_command(datagram + PAYLOAD, size - PAYLOAD, command);
    }
    return size >= TURN_PAYLOAD &&
           memcmp(datagram + HEADER, TURN_CHANNEL, sizeof TURN_CHANNEL) == 0 &&
           decode_turn(datagram + TURN_PAYLOAD, size - TURN_PAYLOAD, command);
}

saddle_lcm_received_t saddle_lcm_commands_receive(int fd, saddle_lcm_arrival_t *arrival)
{
    uint8_t datagram[DATAGRAM_MAX + 1]; /* one more: a longer datagram shows as too long */
    struct sockaddr_in source;
    const ssize_t size =
        saddle_receive_stamped(fd, datagram, sizeof datagram, (struct sockaddr *)&source,
                               sizeof source, &arrival->waited_us);
    if (size < 0) {
        return SADDLE_LCM_EMPTY;
    }
    arrival->source = source.sin_addr;
    if (size < PAYLOAD) {
        return SADDLE_LCM_FOREIGN;
    }
    return decode(datagram, (int)size, &arrival->command) ? SADDLE_LCM_COMMAND : SADDLE_LCM_JUNK;
}
