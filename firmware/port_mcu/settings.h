/** The configuration for the wearer, in a page of flash that is written separately from the
 *  program: the same image serves all wearers. */
#ifndef SADDLEWALK_MCU_SETTINGS_H
#define SADDLEWALK_MCU_SETTINGS_H

#include "joint_loop.h"

/** The page, in words: saddle_settings_crc(); 1 for lockstep, else 0; saddle_ankle_t; passes of the
 *  joints in a tick, 0 for none; then as floats all fields of saddle_config_field(), and of the parts of
 *  saddle_joint_loop_part(), each in its order. */
enum {
    SADDLE_SETTINGS_CRC = 0,
    SADDLE_SETTINGS_LOCKSTEP = 1,
    SADDLE_SETTINGS_ANKLE = 2,
    SADDLE_SETTINGS_PASSES = 3,
    SADDLE_SETTINGS_FIELDS = 4
};

typedef struct {
    saddle_config_t config;
    saddle_joint_loop_config_t joints;
    bool lockstep;
} saddle_settings_t;

/** CRC-32, zlib's, over the names of the fields, each with its '\0', and the words after the first:
 *  so it protects the values and their order. */
uint32_t saddle_settings_crc(const uint32_t *page);

/** Read a page. False: it is damaged, was never written, or holds other fields, and nothing is
 *  changed. saddle_controller_init() and saddle_controller_drive_joints() check the values. */
bool saddle_settings_read(const uint32_t *page, saddle_settings_t *settings);

/** Fill a page of SADDLE_SETTINGS_FIELDS words and one for each field, to be written to flash: what a
 *  wearer's walk has taught, for one. */
void saddle_settings_write(uint32_t *page, const saddle_settings_t *settings);

#endif
