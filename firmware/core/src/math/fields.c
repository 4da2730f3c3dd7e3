#include "math/fields.h"

#include "math/elementary.h"

const char *saddle_bad_field(const saddle_config_field_t *fields, size_t count, const void *object)
{
    for (size_t i = 0; i < count; i++) {
        const void *place = (const char *)object + fields[i].offset;
        if (!saddle_in_range(*(const float *)place, fields[i].min, fields[i].max)) {
            return fields[i].name;
        }
    }
    return NULL;
}
