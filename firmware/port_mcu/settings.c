#include "settings.h"

#include <string.h>

#define CRC_POLYNOMIAL 0xEDB88320u /* its lowest bit is the highest power */

static uint32_t crc_of(uint32_t crc, const void *bytes, size_t size)
{
    const uint8_t *byte = bytes;
    for (size_t i = 0; i < size; ++i) {
        crc ^= byte[i];
        for (int bit = 0; bit < 8; ++bit) {
            crc = crc >> 1 ^ ((crc & 1u) != 0u ? CRC_POLYNOMIAL : 0u);
        }
    }
    return crc;
}

uint32_t saddle_settings_crc(const uint32_t *page)
{
    const saddle_config_field_t *field;
    uint32_t crc = UINT32_MAX;
    size_t fields = 0;
    for (; (field = saddle_config_field(fields)) != NULL; ++fields) {
        crc = crc_of(crc, field->name, strlen(field->name) + 1u);
    }
    const size_t words = SADDLE_SETTINGS_FIELDS - SADDLE_SETTINGS_LOCKSTEP + fields;
    return ~crc_of(crc, &page[SADDLE_SETTINGS_LOCKSTEP], words * sizeof page[0]);
}

bool saddle_settings_read(const uint32_t *page, saddle_config_t *config, bool *lockstep)
{
    const saddle_config_field_t *field;
    if (page[SADDLE_SETTINGS_CRC] != saddle_settings_crc(page)) {
        return false;
    }
    *lockstep = page[SADDLE_SETTINGS_LOCKSTEP] == 1u;
    config->ankle = (saddle_ankle_t)page[SADDLE_SETTINGS_ANKLE];
    for (size_t i = 0; (field = saddle_config_field(i)) != NULL; ++i) {
        memcpy((char *)config + field->offset, &page[SADDLE_SETTINGS_FIELDS + i], sizeof(float));
    }
    return true;
}

void saddle_settings_write(uint32_t *page, const saddle_config_t *config, bool lockstep)
{
    const saddle_config_field_t *field;
    page[SADDLE_SETTINGS_LOCKSTEP] = lockstep ? 1u : 0u;
    page[SADDLE_SETTINGS_ANKLE] = (uint32_t)config->ankle;
    for (size_t i = 0; (field = saddle_config_field(i)) != NULL; ++i) {
        memcpy(&page[SADDLE_SETTINGS_FIELDS + i], (const char *)config + field->offset,
               sizeof(float));
    }
    page[SADDLE_SETTINGS_CRC] = saddle_settings_crc(page);
}
