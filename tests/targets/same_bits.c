/* One hash of everything that the core and the wire compute, printed: the same on every target.
 * tests/targets/same_bits.txt is what it must print. */
#include "../unit/output_fields.h"
#include "elementary.h"
#include "sequences.h"

#include <stdio.h>
#include <string.h>

#define TICKS 100000u
#define COUNT_OF(array) (sizeof(array) / sizeof((array)[0]))

typedef struct {
    uint64_t bits;
} hash_t;

static const hash_t EMPTY = {0xCBF29CE484222325u};

/* FNV-1a's step with a whole word, and the high half folded down. */
static void add(hash_t *hash, uint64_t value)
{
    hash->bits = (hash->bits ^ value) * 0x100000001B3u;
    hash->bits ^= hash->bits >> 32;
}

/* An integer of any size and byte order, or the bits of a float. */
static uint64_t value_at(const void *place, size_t size)
{
    uint8_t byte;
    uint32_t word;
    uint64_t longword;
    switch (size) {
    case sizeof byte: memcpy(&byte, place, size); return byte;
    case sizeof word: memcpy(&word, place, size); return word;
    default: memcpy(&longword, place, sizeof longword); return longword;
    }
}

static void add_output(hash_t *hash, const saddle_output_t *output)
{
    for (size_t i = 0; i < COUNT_OF(FIELDS); i++) {
        const size_t size = FIELDS[i].kind == FLOATS ? sizeof(float) : FIELDS[i].size;
        for (size_t k = 0; k < FIELDS[i].size; k += size) {
            add(hash, value_at((const char *)output + FIELDS[i].offset + k, size));
        }
    }
}

static void add_frames(hash_t *hash, const saddle_frame_t *frames, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        add(hash, frames[i].id);
        for (size_t k = 0; k < SADDLE_WIRE_LENGTH; k++) {
            add(hash, frames[i].data[k]);
        }
    }
}

static void print(const char *name, hash_t hash)
{
    printf("%s %08lx%08lx\n", name, (unsigned long)(hash.bits >> 32),
           (unsigned long)(hash.bits & 0xFFFFFFFFu));
}

/* ---- what is hashed ------------------------------------------------------------------------ */

/* Every 65,537th float: all exponents, NaN and infinity among them. */
static hash_t math(void)
{
    hash_t hash = EMPTY;
    for (uint32_t i = 0; i < 65535u; i++) {
        const uint32_t bits = i * 65537u;
        float x;
        memcpy(&x, &bits, sizeof x);
        for (size_t k = 0; k < ELEMENTARY_COUNT; k++) {
            const float y = ELEMENTARY[k](x);
            add(&hash, value_at(&y, sizeof y));
        }
    }
    return hash;
}

/* The golden runs' walks: joined, 40 ticks, every plan scored. */
static hash_t golden(void)
{
    static const float speeds[] = {0.7f, 1.0f, 1.2f, 1.6f};
    static const float angles[] = {0.0872664626f, 0.174532925f, 0.261799388f};
    static saddle_context_t context;
    static saddle_output_t output;
    const saddle_config_t config = saddle_config_default(1.79f, 63.3f);
    hash_t hash = EMPTY;
    for (size_t run = 0; run < COUNT_OF(speeds) * COUNT_OF(angles); run++) {
        saddle_input_t input = {
            .command = {SADDLE_COMMAND_WALK, speeds[run / 3u], angles[run % 3u], 0.0f},
            .measurement = saddle_no_measurement(),
        };
        (void)saddle_init(&context, &config);
        (void)saddle_join(&context, &input.command);
        for (; input.time_us < 3200000u; input.time_us += 80000u) {
            (void)saddle_tick(&context, &input, &output);
            (void)saddle_score_plan(&context, &output.plan, &output.scores);
            add_output(&hash, &output);
        }
    }
    return hash;
}

static hash_t ticks(sequence_kind_t kind, hash_t *frames)
{
    static sequence_t sequence;
    hash_t hash = EMPTY;
    sequence_begin(&sequence, kind);
    while (sequence.ticks < TICKS) {
        sequence_tick(&sequence);
        add_output(&hash, &sequence.output);
        add_frames(frames, sequence.frames, SADDLE_WIRE_OUTPUT_FRAMES);
    }
    add(&hash, sequence.random); /* the inputs themselves */
    return hash;
}

int main(void)
{
    static const char *const names[] = {"valid", "absurd", "not_finite", "turning"};
    hash_t frames = EMPTY;
    print("math", math());
    print("golden", golden());
    for (int kind = 0; kind < (int)SEQUENCE_COUNT; kind++) {
        print(names[kind], ticks((sequence_kind_t)kind, &frames));
    }
    print("frames", frames);
    return 0;
}
