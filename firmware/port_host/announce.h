/** What the running process has to say to people. */
#ifndef SADDLEWALK_HOST_ANNOUNCE_H
#define SADDLEWALK_HOST_ANNOUNCE_H

#define SADDLE_PROGRAM "saddlewalk-host"

/** One line on standard error, `saddlewalk-host: ` before it. Dropped rather than waited for if
 *  whoever reads it is behind: no tick waits for a reader. At most 400 characters are said. */
#if defined __GNUC__
__attribute__((format(printf, 1, 2)))
#endif
void saddle_announce(const char *format, ...);

#endif
