#include "slcan.h"

#define ID_DIGITS 3u
#define ID_MAX 0x7FFu
#define HEADER (1u + ID_DIGITS + 1u) /* tIIIL */

/** 16 if it is not a digit. */
static uint32_t value_of(char digit)
{
    if (digit >= '0' && digit <= '9') {
        return (uint32_t)(digit - '0');
    }
    if (digit >= 'A' && digit <= 'F') {
        return (uint32_t)(digit - 'A') + 10u;
    }
    if (digit >= 'a' && digit <= 'f') {
        return (uint32_t)(digit - 'a') + 10u;
    }
    return 16u;
}

static bool read_number(const char *digits, size_t count, uint32_t *number)
{
    *number = 0;
    for (size_t i = 0; i < count; ++i) {
        const uint32_t value = value_of(digits[i]);
        if (value > 15u) {
            return false;
        }
        *number = *number << 4 | value;
    }
    return true;
}

static bool read_frame(const char *line, size_t length, saddle_can_frame_t *frame)
{
    uint32_t id;
    uint32_t bytes;
    if (!read_number(line + 1, ID_DIGITS, &id) || id > ID_MAX ||
        !read_number(line + 1 + ID_DIGITS, 1, &bytes) || bytes > SADDLE_WIRE_LENGTH ||
        length != HEADER + 2u * bytes) {
        return false;
    }
    saddle_can_frame_t read = {.id = (uint16_t)id, .length = (uint8_t)bytes};
    for (size_t i = 0; i < bytes; ++i) {
        uint32_t byte;
        if (!read_number(line + HEADER + 2u * i, 2, &byte)) {
            return false;
        }
        read.data[i] = (uint8_t)byte;
    }
    *frame = read;
    return true;
}

static saddle_slcan_event_t read_line(const char *line, size_t length, saddle_can_frame_t *frame)
{
    if (length == 0u) {
        return SADDLE_SLCAN_NOTHING;
    }
    switch (line[0]) {
    case 't': return read_frame(line, length, frame) ? SADDLE_SLCAN_FRAME : SADDLE_SLCAN_MALFORMED;
    case 'C': return SADDLE_SLCAN_CLOSE;
    case 'O': /* and S: the line has one speed and is always open */
    case 'S': return SADDLE_SLCAN_NOTHING;
    default: return SADDLE_SLCAN_MALFORMED;
    }
}

saddle_slcan_event_t saddle_slcan_read(saddle_slcan_reader_t *reader, char character,
                                       saddle_can_frame_t *frame)
{
    if (character != '\r') {
        if (reader->length < SADDLE_SLCAN_LINE) {
            reader->line[reader->length] = character;
            ++reader->length;
        }
        return SADDLE_SLCAN_NOTHING;
    }
    const size_t length = reader->length;
    reader->length = 0;
    return read_line(reader->line, length, frame);
}

static char *write_number(char *digits, size_t count, uint32_t number)
{
    for (size_t i = 0; i < count; ++i) {
        digits[i] = "0123456789ABCDEF"[number >> 4 * (count - 1u - i) & 15u];
    }
    return digits + count;
}

size_t saddle_slcan_write(const saddle_can_frame_t *frame, char line[SADDLE_SLCAN_LINE])
{
    char *end = line;
    *end++ = 't';
    end = write_number(end, ID_DIGITS, frame->id);
    end = write_number(end, 1, frame->length);
    for (size_t i = 0; i < frame->length; ++i) {
        end = write_number(end, 2, frame->data[i]);
    }
    *end++ = '\r';
    return (size_t)(end - line);
}
