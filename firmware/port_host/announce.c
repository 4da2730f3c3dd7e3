#include "announce.h"

#include <poll.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define LINE_MAX_BYTES 400

/** A pipe is ready when it has room for more than a line, so the write does not block. */
static void write_now(const char *line, size_t size)
{
    struct pollfd standard_error = {.fd = STDERR_FILENO, .events = POLLOUT};
    if (poll(&standard_error, 1, 0) == 1 && (standard_error.revents & POLLOUT) != 0) {
        (void)!write(STDERR_FILENO, line, size);
    }
}

void saddle_announce(const char *format, ...)
{
    char line[LINE_MAX_BYTES + 1] = SADDLE_PROGRAM ": ";
    const size_t begun = strlen(line);
    va_list values;
    va_start(values, format);
    (void)vsnprintf(line + begun, sizeof line - begun - 1, format, values);
    va_end(values);
    const size_t length = strlen(line);
    line[length] = '\n';
    write_now(line, length + 1);
}
