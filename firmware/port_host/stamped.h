/** Receive, with the time since the kernel's reception. */
#ifndef SADDLEWALK_HOST_STAMPED_H
#define SADDLEWALK_HOST_STAMPED_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/socket.h>
#include <sys/types.h>

/** Enable the kernel's receive timestamps. */
bool saddle_stamp(int fd);

/** As recvfrom(), without blocking. waited_us: time since reception; a process that was stopped, or
 *  a flood, leaves old data in the queue, whose age must not count from reading. */
ssize_t saddle_receive_stamped(int fd, void *bytes, size_t size, struct sockaddr *source,
                               socklen_t source_size, uint32_t *waited_us);

#endif
