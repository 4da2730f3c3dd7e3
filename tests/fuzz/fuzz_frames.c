/** Any frames into an inbox with and without codes, any results out: exactly one count moves, no
 *  number is read that is not finite but NaN, and what is sent is accepted. */
#include "fuzz.h"

#include <health.h>
#include <math.h>

static uint32_t counted(const saddle_wire_receiver_t *receiver)
{
    return receiver->accepted + receiver->malformed + receiver->bad_crc + receiver->bad_version +
           receiver->bad_counter + receiver->bad_code;
}

static void require_numbers_or_nan(const saddle_input_t *input)
{
    REQUIRE(!isinf(input->command.speed_m_s) && !isinf(input->command.heel_strike_rad));
    REQUIRE(!isinf(input->measurement.com.height_m));
    REQUIRE(saddle_command_usable(&input->command));
}

/** A frame of ours half of the time: its CRC fits. */
static void receive(saddle_inbox_t *inbox, fuzz_bytes_t *bytes)
{
    uint8_t covered[2 + SADDLE_WIRE_LENGTH - 1];
    uint8_t data[SADDLE_WIRE_LENGTH];
    const uint8_t how = fuzz_byte(bytes);
    uint32_t id = (how & 1) != 0 ? fuzz_word(bytes) : 0x100u + (how >> 4);
    fuzz_take(bytes, data, sizeof data);
    if ((how & 2) != 0) {
        covered[0] = (uint8_t)id;
        covered[1] = (uint8_t)(id >> 8);
        memcpy(covered + 2, data + 1, SADDLE_WIRE_LENGTH - 1);
        data[0] = saddle_wire_crc(covered, sizeof covered);
    }
    const uint32_t before = counted(&inbox->receiver);
    saddle_inbox_take_frame(inbox, id, data, (how & 4) != 0 ? fuzz_byte(bytes) : sizeof data,
                            fuzz_word(bytes));
    REQUIRE(counted(&inbox->receiver) == before + 1u);
    require_numbers_or_nan(saddle_inbox_read(inbox, fuzz_word(bytes)));
}

static void send(saddle_inbox_t *inbox, fuzz_bytes_t *bytes)
{
    saddle_output_t output;
    saddle_timing_t timing;
    saddle_frame_t frames[SADDLE_WIRE_OUTPUT_FRAMES];
    fuzz_take(bytes, &output, sizeof output);
    fuzz_take(bytes, &timing, sizeof timing);
    output.plan.valid = (fuzz_byte(bytes) & 1) != 0;
    output.scores.can_stop = output.scores.paper_stable = output.scores.bos.defined = true;
    output.verdict.margin_known = output.verdict.compared = output.verdict.on_track = true;
    output.verdict.recovery.found = output.verdict.recovery.stops = true;
    const saddle_wire_health_t health = saddle_health(&timing, inbox);
    saddle_wire_encode_output(&output, &health, fuzz_byte(bytes), frames);
    for (size_t i = 0; i < SADDLE_WIRE_OUTPUT_FRAMES; ++i) {
        uint8_t covered[2 + SADDLE_WIRE_LENGTH - 1] = {(uint8_t)frames[i].id,
                                                       (uint8_t)(frames[i].id >> 8)};
        memcpy(covered + 2, frames[i].data + 1, SADDLE_WIRE_LENGTH - 1);
        REQUIRE(frames[i].data[0] == saddle_wire_crc(covered, sizeof covered));
    }
}

/** A command with a fresh code is applied, and one whose code has a wrong bit is not. */
static void command(saddle_inbox_t *inbox, fuzz_bytes_t *bytes)
{
    static const uint8_t secret[SADDLE_CMAC_LENGTH] = {1, 2, 3};
    saddle_command_t wanted = {.mode = SADDLE_COMMAND_WALK};
    saddle_frame_t command, code;
    saddle_cmac_key_t key;
    saddle_wire_receiver_t *receiver = &inbox->receiver;
    const uint32_t session = fuzz_word(bytes);
    const uint8_t flip = fuzz_byte(bytes);
    wanted.speed_m_s = fuzz_between(bytes, -3.0f, 3.0f);
    saddle_cmac_prepare(&key, secret);
    saddle_wire_require_auth(receiver, secret);
    saddle_wire_open_session(receiver, session);
    memset(receiver->alive, 0, sizeof receiver->alive);
    saddle_wire_encode_command(&wanted, fuzz_byte(bytes), &command);
    saddle_wire_encode_code(&key, session, 1, &command, &code);
    const bool forged = flip < 32u;
    if (forged) {
        code.data[4 + flip / 8u] ^= (uint8_t)(1u << flip % 8u);
        uint8_t covered[2 + SADDLE_WIRE_LENGTH - 1] = {(uint8_t)code.id, (uint8_t)(code.id >> 8)};
        memcpy(covered + 2, code.data + 1, SADDLE_WIRE_LENGTH - 1);
        code.data[0] = saddle_wire_crc(covered, sizeof covered);
    }
    REQUIRE(saddle_wire_accept(receiver, code.id, code.data, 8) == SADDLE_WIRE_COMMAND_CODE);
    REQUIRE((saddle_wire_accept(receiver, command.id, command.data, 8) == SADDLE_WIRE_COMMAND) ==
            !forged);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static saddle_inbox_t inbox;
    fuzz_bytes_t bytes = {data, size};
    saddle_inbox_init(&inbox, SADDLE_SOURCE_NONE);
    while (bytes.left > 0u) {
        switch (fuzz_byte(&bytes) % 8u) {
        case 0: send(&inbox, &bytes); break;
        case 1: command(&inbox, &bytes); break;
        default: receive(&inbox, &bytes); break;
        }
    }
    return 0;
}
