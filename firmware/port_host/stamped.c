#include "stamped.h"

#include "clock.h"
#include <string.h>
#include <time.h>

bool saddle_stamp(int fd)
{
    const int yes = 1;
    return setsockopt(fd, SOL_SOCKET, SO_TIMESTAMPNS, &yes, sizeof yes) == 0;
}

static uint32_t waited(struct msghdr *message)
{
    for (struct cmsghdr *part = CMSG_FIRSTHDR(message); part != NULL;
         part = CMSG_NXTHDR(message, part)) {
        if (part->cmsg_level == SOL_SOCKET && part->cmsg_type == SO_TIMESTAMPNS) {
            struct timespec came;
            memcpy(&came, CMSG_DATA(part), sizeof came);
            return saddle_since_us((int64_t)came.tv_sec * 1000000 + came.tv_nsec / 1000);
        }
    }
    return 0;
}

ssize_t saddle_receive_stamped(int fd, void *bytes, size_t size, struct sockaddr *source,
                               socklen_t source_size, uint32_t *waited_us)
{
    struct iovec data = {.iov_base = bytes, .iov_len = size};
    union {
        struct cmsghdr aligned;
        char bytes[CMSG_SPACE(sizeof(struct timespec))];
    } control;
    struct msghdr message = {.msg_name = source,
                             .msg_namelen = source_size,
                             .msg_iov = &data,
                             .msg_iovlen = 1,
                             .msg_control = &control,
                             .msg_controllen = sizeof control};
    const ssize_t received = recvmsg(fd, &message, MSG_DONTWAIT);
    *waited_us = received >= 0 ? waited(&message) : 0;
    return received;
}
