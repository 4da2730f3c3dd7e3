/** Messages of the running process. */
#ifndef SADDLEWALK_HOST_ANNOUNCE_H
#define SADDLEWALK_HOST_ANNOUNCE_H

#define SADDLE_PROGRAM "saddlewalk-host"

/** Print a line on standard error, preceded by `saddlewalk-host: `. It is dropped if the
 *  reader is behind: no tick waits for it. At most 400 characters. */
#if defined __GNUC__
__attribute__((format(printf, 1, 2)))
#endif
void saddle_announce(const char *format, ...);

#endif
