#include "config_file.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#define PATH_MAX_LENGTH 4096

const char *const saddle_ankle_names[SADDLE_ANKLE_COUNT] = {
    [SADDLE_ANKLE_ERF] = "erf",
    [SADDLE_ANKLE_RIGID] = "rigid",
    [SADDLE_ANKLE_CYCLOID] = "cycloid",
};

static bool print_fields(FILE *file, const saddle_config_t *config)
{
    const saddle_config_field_t *field;
    bool good = true;
    for (size_t i = 0; good && (field = saddle_config_field(i)) != NULL; ++i) {
        float value;
        memcpy(&value, (const char *)config + field->offset, sizeof value);
        good = fprintf(file, "%s = %#.9g\n", field->name, (double)value) > 0;
    }
    return good && fprintf(file, "ankle = \"%s\"\n", saddle_ankle_names[config->ankle]) > 0;
}

bool saddle_config_file_write(const char *path, const saddle_config_t *config)
{
    char beside[PATH_MAX_LENGTH];
    if (snprintf(beside, sizeof beside, "%s.new", path) >= (int)sizeof beside) {
        errno = ENAMETOOLONG;
        return false;
    }
    FILE *file = fopen(beside, "w");
    if (file == NULL) {
        return false;
    }
    const bool printed = print_fields(file, config);
    const bool closed = fclose(file) == 0;
    return printed && closed && rename(beside, path) == 0;
}
