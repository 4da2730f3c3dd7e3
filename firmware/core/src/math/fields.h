/** Configuration fields and their ranges. */
#ifndef SADDLEWALK_FIELDS_H
#define SADDLEWALK_FIELDS_H

#include <saddlewalk/types.h>

/** Name of the first of `count` fields whose value in `object` is out of its range, or NULL. */
const char *saddle_bad_field(const saddle_config_field_t *fields, size_t count, const void *object);

#endif
