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

/** The configuration, and then the parts of the joints'. */
#define PARTS (1u + SADDLE_JOINT_PARTS)

/** With its offset in saddle_settings_t. */
static saddle_joint_part_t part_of(size_t index)
{
    if (index == 0u) {
        return (saddle_joint_part_t){"config", saddle_config_field,
                                     offsetof(saddle_settings_t, config)};
    }
    saddle_joint_part_t part = saddle_joint_part(index - 1u);
    part.offset += offsetof(saddle_settings_t, joints);
    return part;
}

uint32_t saddle_settings_crc(const uint32_t *page)
{
    const saddle_config_field_t *field;
    uint32_t crc = UINT32_MAX;
    size_t words = SADDLE_SETTINGS_FIELDS - SADDLE_SETTINGS_LOCKSTEP;
    for (size_t part = 0; part < PARTS; ++part) {
        for (size_t i = 0; (field = part_of(part).field(i)) != NULL; ++i) {
            crc = crc_of(crc, field->name, strlen(field->name) + 1u);
            ++words;
        }
    }
    return ~crc_of(crc, &page[SADDLE_SETTINGS_LOCKSTEP], words * sizeof page[0]);
}

bool saddle_settings_read(const uint32_t *page, saddle_settings_t *settings)
{
    const saddle_config_field_t *field;
    const uint32_t *word = &page[SADDLE_SETTINGS_FIELDS];
    if (page[SADDLE_SETTINGS_CRC] != saddle_settings_crc(page)) {
        return false;
    }
    settings->lockstep = page[SADDLE_SETTINGS_LOCKSTEP] == 1u;
    settings->config.ankle = (saddle_ankle_t)page[SADDLE_SETTINGS_ANKLE];
    settings->joints.passes = page[SADDLE_SETTINGS_PASSES];
    for (size_t index = 0; index < PARTS; ++index) {
        const saddle_joint_part_t part = part_of(index);
        for (size_t i = 0; (field = part.field(i)) != NULL; ++i, ++word) {
            memcpy((char *)settings + part.offset + field->offset, word, sizeof(float));
        }
    }
    return true;
}

void saddle_settings_write(uint32_t *page, const saddle_settings_t *settings)
{
    const saddle_config_field_t *field;
    uint32_t *word = &page[SADDLE_SETTINGS_FIELDS];
    page[SADDLE_SETTINGS_LOCKSTEP] = settings->lockstep ? 1u : 0u;
    page[SADDLE_SETTINGS_ANKLE] = (uint32_t)settings->config.ankle;
    page[SADDLE_SETTINGS_PASSES] = settings->joints.passes;
    for (size_t index = 0; index < PARTS; ++index) {
        const saddle_joint_part_t part = part_of(index);
        for (size_t i = 0; (field = part.field(i)) != NULL; ++i, ++word) {
            memcpy(word, (const char *)settings + part.offset + field->offset, sizeof(float));
        }
    }
    page[SADDLE_SETTINGS_CRC] = saddle_settings_crc(page);
}
