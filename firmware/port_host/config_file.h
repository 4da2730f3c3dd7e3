/** A configuration as a file for the option --config of the host tools. */
#ifndef SADDLEWALK_HOST_CONFIG_FILE_H
#define SADDLEWALK_HOST_CONFIG_FILE_H

#include <saddlewalk/saddlewalk.h>

/** The names of the ankle models in files and options. */
extern const char *const saddle_ankle_names[SADDLE_ANKLE_COUNT];

/** Write all fields as TOML, to the bit. The file is replaced when the new one is complete. False: errno
 *  says why, and the file is as it was. */
bool saddle_config_file_write(const char *path, const saddle_config_t *config);

#endif
