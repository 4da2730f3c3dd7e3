/** What is fitted to the wearer, in a page of flash that is written apart from the program: the
 *  same image serves everybody. */
#ifndef SADDLEWALK_MCU_SETTINGS_H
#define SADDLEWALK_MCU_SETTINGS_H

#include <saddlewalk/saddlewalk.h>

/** "SDL1", little endian: the first word of a page that was written. */
#define SADDLE_SETTINGS_MAGIC 0x314C4453u

/** The page, in words: the magic; 1 for lockstep, else 0; saddle_ankle_t; then as floats all fields
 *  of saddle_config_field(), in its order. */
enum { SADDLE_SETTINGS_LOCKSTEP = 1, SADDLE_SETTINGS_ANKLE = 2, SADDLE_SETTINGS_FIELDS = 3 };

/** Read a page; without the magic nothing is changed. saddle_init() judges the values. */
void saddle_settings_read(const uint32_t *page, saddle_config_t *config, bool *lockstep);

#endif
