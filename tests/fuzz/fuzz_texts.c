/** Any characters on a serial line, any datagram, any page of flash: what is accepted is a frame,
 *  and written again it is the same. */
#include "fuzz.h"

#include <datagram.h>
#include <settings.h>
#include <slcan.h>

static void serial_line(fuzz_bytes_t *bytes)
{
    saddle_slcan_reader_t reader = {.length = 0};
    saddle_can_frame_t frame, again;
    char line[SADDLE_SLCAN_LINE];
    while (bytes->left > 0u) {
        if (saddle_slcan_read(&reader, (char)fuzz_byte(bytes), &frame) != SADDLE_SLCAN_FRAME) {
            continue;
        }
        REQUIRE(frame.id <= 0x7FFu && frame.length <= SADDLE_WIRE_LENGTH);
        const size_t length = saddle_slcan_write(&frame, line);
        saddle_slcan_reader_t second = {.length = 0};
        saddle_slcan_event_t event = SADDLE_SLCAN_NOTHING;
        for (size_t i = 0; i < length; ++i) {
            event = saddle_slcan_read(&second, line[i], &again);
        }
        REQUIRE(event == SADDLE_SLCAN_FRAME && again.id == frame.id);
        REQUIRE(again.length == frame.length && memcmp(again.data, frame.data, frame.length) == 0);
    }
}

static void datagram(const fuzz_bytes_t *bytes)
{
    saddle_bus_frame_t frame, again;
    uint8_t written[SADDLE_DATAGRAM_MAX];
    memset(&frame, 0, sizeof frame);
    if (!saddle_datagram_decode(bytes->at, bytes->left, &frame)) {
        return;
    }
    REQUIRE(frame.length <= 8u);
    if (frame.id <= 0x7FFu) {
        memset(&again, 0, sizeof again);
        REQUIRE(saddle_datagram_decode(written, saddle_datagram_encode(&frame, written), &again));
        REQUIRE(again.id == frame.id && again.length == frame.length);
        REQUIRE(memcmp(again.data, frame.data, frame.length) == 0);
    }
}

static void settings(fuzz_bytes_t *bytes)
{
    uint32_t page[256];
    saddle_settings_t settings = {.config = saddle_config_default(1.79f, 63.3f)};
    fuzz_take(bytes, page, sizeof page);
    page[SADDLE_SETTINGS_CRC] ^= saddle_settings_crc(page); /* fits where the input has a 0 */
    const bool fits = saddle_settings_read(page, &settings);
    REQUIRE(fits == (page[SADDLE_SETTINGS_CRC] == saddle_settings_crc(page)));
    static saddle_context_t context;
    const bool accepted = saddle_init(&context, &settings.config) == SADDLE_OK;
    REQUIRE(accepted == (saddle_config_check(&settings.config) == NULL));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_bytes_t bytes = {data, size};
    switch (fuzz_byte(&bytes) % 3u) {
    case 0: serial_line(&bytes); break;
    case 1: datagram(&bytes); break;
    default: settings(&bytes); break;
    }
    return 0;
}
