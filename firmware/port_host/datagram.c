#include "datagram.h"

#include <string.h>

/** Bits above the identifier, as SocketCAN has them. */
#define EXTENDED_FRAME 0x80000000u
#define REMOTE_FRAME 0x40000000u
#define ERROR_FRAME 0x20000000u
#define IDENTIFIER_MAX 0x1FFFFFFFu

/** MessagePack type bytes. */
enum {
    POSITIVE_FIXINT_MAX = 0x7F,
    FIXMAP = 0x80,
    FIXSTR = 0xA0,
    NIL = 0xC0,
    FALSE_ = 0xC2,
    TRUE_ = 0xC3,
    BIN8 = 0xC4,
    FLOAT32 = 0xCA,
    FLOAT64 = 0xCB,
    UINT8_ = 0xCC,
    UINT16_ = 0xCD,
    UINT32_ = 0xCE,
    UINT64_ = 0xCF,
    STR8 = 0xD9
};

typedef struct {
    uint8_t *bytes;
    size_t size;
} writer_t;

static void put_byte(writer_t *writer, uint8_t byte)
{
    writer->bytes[writer->size++] = byte;
}

static void put_bytes(writer_t *writer, const void *bytes, size_t size)
{
    memcpy(writer->bytes + writer->size, bytes, size);
    writer->size += size;
}

static void put_key(writer_t *writer, const char *key)
{
    const size_t length = strlen(key);
    put_byte(writer, (uint8_t)(FIXSTR | length));
    put_bytes(writer, key, length);
}

static void put_false(writer_t *writer, const char *key)
{
    put_key(writer, key);
    put_byte(writer, FALSE_);
}

size_t saddle_datagram_encode(const saddle_bus_frame_t *frame,
                              uint8_t datagram[SADDLE_DATAGRAM_MAX])
{
    static const uint8_t zero_seconds[8] = {0}; /* the receiver uses its own clock */
    writer_t writer = {.bytes = datagram};
    put_byte(&writer, FIXMAP | 11);
    put_key(&writer, "timestamp");
    put_byte(&writer, FLOAT64);
    put_bytes(&writer, zero_seconds, sizeof zero_seconds);
    put_key(&writer, "arbitration_id");
    put_byte(&writer, UINT16_);
    put_byte(&writer, (uint8_t)(frame->id >> 8));
    put_byte(&writer, (uint8_t)frame->id);
    put_false(&writer, "is_extended_id");
    put_false(&writer, "is_remote_frame");
    put_false(&writer, "is_error_frame");
    put_key(&writer, "channel");
    put_byte(&writer, NIL);
    put_key(&writer, "dlc");
    put_byte(&writer, frame->length);
    put_key(&writer, "data");
    put_byte(&writer, BIN8);
    put_byte(&writer, frame->length);
    put_bytes(&writer, frame->data, frame->length);
    put_false(&writer, "is_fd");
    put_false(&writer, "bitrate_switch");
    put_false(&writer, "error_state_indicator");
    return writer.size;
}

/** Reads past the end give zeros and set `bad`, so one check at the end is enough. */
typedef struct {
    const uint8_t *next, *end;
    bool bad;
} reader_t;

typedef enum { VALUE_NIL, VALUE_NUMBER, VALUE_FLOAT, VALUE_BYTES } value_kind_t;

typedef struct {
    value_kind_t kind;
    uint64_t number; /**< an integer or a truth value; the size of bytes */
    const uint8_t *bytes;
} value_t;

static uint64_t take_number(reader_t *reader, size_t size)
{
    uint64_t number = 0;
    if ((size_t)(reader->end - reader->next) < size) {
        reader->bad = true;
        return 0;
    }
    for (size_t i = 0; i < size; ++i) {
        number = number << 8 | *reader->next++;
    }
    return number;
}

static value_t take_bytes(reader_t *reader, uint64_t size)
{
    const value_t value = {.kind = VALUE_BYTES, .number = size, .bytes = reader->next};
    if ((uint64_t)(reader->end - reader->next) < size) {
        reader->bad = true;
        return (value_t){.kind = VALUE_NIL};
    }
    reader->next += size;
    return value;
}

static value_t number_value(uint64_t number)
{
    return (value_t){.kind = VALUE_NUMBER, .number = number};
}

static value_t take_value(reader_t *reader)
{
    const uint8_t type = (uint8_t)take_number(reader, 1);
    if (type <= POSITIVE_FIXINT_MAX) {
        return number_value(type);
    }
    if ((type & 0xE0) == FIXSTR) {
        return take_bytes(reader, type & 0x1Fu);
    }
    switch (type) {
    case NIL: return (value_t){.kind = VALUE_NIL};
    case FALSE_: return number_value(0);
    case TRUE_: return number_value(1);
    case BIN8:
    case STR8: return take_bytes(reader, take_number(reader, 1));
    case UINT8_: return number_value(take_number(reader, 1));
    case UINT16_: return number_value(take_number(reader, 2));
    case UINT32_: return number_value(take_number(reader, 4));
    case UINT64_: return number_value(take_number(reader, 8));
    case FLOAT32: (void)take_number(reader, 4); return (value_t){.kind = VALUE_FLOAT};
    case FLOAT64: (void)take_number(reader, 8); return (value_t){.kind = VALUE_FLOAT};
    default: reader->bad = true; return (value_t){.kind = VALUE_NIL};
    }
}

/** The map's values; a missing key keeps python-can's default. */
typedef struct {
    uint64_t identifier, is_extended, is_remote, is_error, is_fd, length;
    value_t data;
} message_t;

static bool is_key(const value_t *key, const char *name)
{
    return key->number == strlen(name) && memcmp(key->bytes, name, strlen(name)) == 0;
}

/** False for a key that python-can does not know or a value of the wrong kind. */
static bool take_entry(reader_t *reader, message_t *message)
{
    static const char *const not_used[] = {"timestamp", "channel", "bitrate_switch",
                                           "error_state_indicator"};
    const struct {
        const char *name;
        uint64_t *number;
    } numbers[] = {
        {"arbitration_id", &message->identifier},  {"dlc", &message->length},
        {"is_extended_id", &message->is_extended}, {"is_fd", &message->is_fd},
        {"is_remote_frame", &message->is_remote},  {"is_error_frame", &message->is_error}};
    const value_t key = take_value(reader);
    const value_t value = take_value(reader);
    if (reader->bad || key.kind != VALUE_BYTES) {
        return false;
    }
    if (is_key(&key, "data")) {
        message->data = value;
        return value.kind == VALUE_BYTES;
    }
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; ++i) {
        if (is_key(&key, numbers[i].name)) {
            *numbers[i].number = value.number;
            return value.kind == VALUE_NUMBER;
        }
    }
    for (size_t i = 0; i < sizeof not_used / sizeof not_used[0]; ++i) {
        if (is_key(&key, not_used[i])) {
            return true;
        }
    }
    return false;
}

static bool is_classic(const message_t *message)
{
    const uint64_t data_size = message->data.kind == VALUE_BYTES ? message->data.number : 0;
    const uint64_t expected = message->is_remote != 0 ? 0 : message->length;
    return message->is_fd == 0 && message->length <= 8 && data_size == expected &&
           message->identifier <= IDENTIFIER_MAX;
}

bool saddle_datagram_decode(const uint8_t *datagram, size_t size, saddle_bus_frame_t *frame)
{
    reader_t reader = {.next = datagram, .end = datagram + size};
    message_t message = {.is_extended = 1};
    const uint8_t map = (uint8_t)take_number(&reader, 1);
    if ((map & 0xF0) != FIXMAP) {
        return false;
    }
    for (int entries = map & 0x0F; entries > 0; --entries) {
        if (!take_entry(&reader, &message)) {
            return false;
        }
    }
    if (reader.bad || reader.next != reader.end || !is_classic(&message)) {
        return false;
    }
    *frame =
        (saddle_bus_frame_t){.id = (uint32_t)message.identifier, .length = (uint8_t)message.length};
    frame->id |= (message.is_extended != 0 ? EXTENDED_FRAME : 0) |
                 (message.is_remote != 0 ? REMOTE_FRAME : 0) |
                 (message.is_error != 0 ? ERROR_FRAME : 0);
    if (message.data.kind == VALUE_BYTES) {
        memcpy(frame->data, message.data.bytes, (size_t)message.data.number);
    }
    return true;
}
