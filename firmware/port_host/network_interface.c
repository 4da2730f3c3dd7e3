#include "network_interface.h"

#include <net/if.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

/** Read from a list: asking for a missing interface by name makes the kernel look for a driver,
 *  which takes longer than a tick. Lines but the first two are `  NAME: ...`. */
static bool interface_exists(const char *name)
{
    char line[256];
    bool found = false;
    FILE *interfaces = fopen("/proc/self/net/dev", "r");
    if (interfaces == NULL) {
        return true;
    }
    while (!found && fgets(line, sizeof line, interfaces) != NULL) {
        const char *start = line + strspn(line, " ");
        found = strncmp(start, name, strlen(name)) == 0 && start[strlen(name)] == ':';
    }
    fclose(interfaces);
    return found;
}

bool saddle_interface_is_up(const char *name)
{
    struct ifreq request = {0};
    if (strlen(name) >= sizeof request.ifr_name || !interface_exists(name)) {
        return false;
    }
    const int fd = socket(AF_INET, SOCK_DGRAM, 0);
    memcpy(request.ifr_name, name, strlen(name));
    const bool is_up = ioctl(fd, SIOCGIFFLAGS, &request) == 0 && (request.ifr_flags & IFF_UP) != 0;
    close(fd);
    return is_up;
}
