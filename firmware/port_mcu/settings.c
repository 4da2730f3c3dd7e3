#include "settings.h"

#include <string.h>

void saddle_settings_read(const uint32_t *page, saddle_config_t *config, bool *lockstep)
{
    const saddle_config_field_t *field;
    if (page[0] != SADDLE_SETTINGS_MAGIC) {
        return;
    }
    *lockstep = page[SADDLE_SETTINGS_LOCKSTEP] == 1u;
    config->ankle = (saddle_ankle_t)page[SADDLE_SETTINGS_ANKLE];
    for (size_t i = 0; (field = saddle_config_field(i)) != NULL; ++i) {
        memcpy((char *)config + field->offset, &page[SADDLE_SETTINGS_FIELDS + i], sizeof(float));
    }
}
