/** The configuration for the wearer, in a page of flash that is written separately from the
 *  program: the same image serves all wearers. */
#ifndef SADDLEWALK_MCU_SETTINGS_H
#define SADDLEWALK_MCU_SETTINGS_H

#include <saddlewalk/saddlewalk.h>

/** The page, in words: saddle_settings_crc(); 1 for lockstep, else 0; saddle_ankle_t; then as
 *  floats all fields of saddle_config_field(), in its order. */
enum {
    SADDLE_SETTINGS_CRC = 0,
    SADDLE_SETTINGS_LOCKSTEP = 1,
    SADDLE_SETTINGS_ANKLE = 2,
    SADDLE_SETTINGS_FIELDS = 3
};

/** CRC-32, zlib's, over the names of the fields, each with its '\0', and the words after the first:
 *  so it protects the values and their order. */
uint32_t saddle_settings_crc(const uint32_t *page);

/** Read a page. False: it is damaged, was never written, or holds other fields, and nothing is
 *  changed. saddle_init() checks the values. */
bool saddle_settings_read(const uint32_t *page, saddle_config_t *config, bool *lockstep);

/** Fill a page of SADDLE_SETTINGS_FIELDS words and one for each field, to be written to flash: what a
 *  wearer's walk has taught, for one. */
void saddle_settings_write(uint32_t *page, const saddle_config_t *config, bool lockstep);

#endif
