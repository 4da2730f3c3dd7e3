#include <saddlewalk/cmac.h>

#define BLOCK SADDLE_CMAC_LENGTH
#define ROUNDS 10u

/** The field's polynomials: of a byte (AES), of a block (CMAC). */
#define BYTE_POLYNOMIAL 0x1Bu
#define BLOCK_POLYNOMIAL 0x87u

/** FIPS 197, figure 7. */
static const uint8_t SUBSTITUTE[256] = {
    0x63, 0x7C, 0x77, 0x7B, 0xF2, 0x6B, 0x6F, 0xC5, 0x30, 0x01, 0x67, 0x2B, 0xFE, 0xD7, 0xAB, 0x76,
    0xCA, 0x82, 0xC9, 0x7D, 0xFA, 0x59, 0x47, 0xF0, 0xAD, 0xD4, 0xA2, 0xAF, 0x9C, 0xA4, 0x72, 0xC0,
    0xB7, 0xFD, 0x93, 0x26, 0x36, 0x3F, 0xF7, 0xCC, 0x34, 0xA5, 0xE5, 0xF1, 0x71, 0xD8, 0x31, 0x15,
    0x04, 0xC7, 0x23, 0xC3, 0x18, 0x96, 0x05, 0x9A, 0x07, 0x12, 0x80, 0xE2, 0xEB, 0x27, 0xB2, 0x75,
    0x09, 0x83, 0x2C, 0x1A, 0x1B, 0x6E, 0x5A, 0xA0, 0x52, 0x3B, 0xD6, 0xB3, 0x29, 0xE3, 0x2F, 0x84,
    0x53, 0xD1, 0x00, 0xED, 0x20, 0xFC, 0xB1, 0x5B, 0x6A, 0xCB, 0xBE, 0x39, 0x4A, 0x4C, 0x58, 0xCF,
    0xD0, 0xEF, 0xAA, 0xFB, 0x43, 0x4D, 0x33, 0x85, 0x45, 0xF9, 0x02, 0x7F, 0x50, 0x3C, 0x9F, 0xA8,
    0x51, 0xA3, 0x40, 0x8F, 0x92, 0x9D, 0x38, 0xF5, 0xBC, 0xB6, 0xDA, 0x21, 0x10, 0xFF, 0xF3, 0xD2,
    0xCD, 0x0C, 0x13, 0xEC, 0x5F, 0x97, 0x44, 0x17, 0xC4, 0xA7, 0x7E, 0x3D, 0x64, 0x5D, 0x19, 0x73,
    0x60, 0x81, 0x4F, 0xDC, 0x22, 0x2A, 0x90, 0x88, 0x46, 0xEE, 0xB8, 0x14, 0xDE, 0x5E, 0x0B, 0xDB,
    0xE0, 0x32, 0x3A, 0x0A, 0x49, 0x06, 0x24, 0x5C, 0xC2, 0xD3, 0xAC, 0x62, 0x91, 0x95, 0xE4, 0x79,
    0xE7, 0xC8, 0x37, 0x6D, 0x8D, 0xD5, 0x4E, 0xA9, 0x6C, 0x56, 0xF4, 0xEA, 0x65, 0x7A, 0xAE, 0x08,
    0xBA, 0x78, 0x25, 0x2E, 0x1C, 0xA6, 0xB4, 0xC6, 0xE8, 0xDD, 0x74, 0x1F, 0x4B, 0xBD, 0x8B, 0x8A,
    0x70, 0x3E, 0xB5, 0x66, 0x48, 0x03, 0xF6, 0x0E, 0x61, 0x35, 0x57, 0xB9, 0x86, 0xC1, 0x1D, 0x9E,
    0xE1, 0xF8, 0x98, 0x11, 0x69, 0xD9, 0x8E, 0x94, 0x9B, 0x1E, 0x87, 0xE9, 0xCE, 0x55, 0x28, 0xDF,
    0x8C, 0xA1, 0x89, 0x0D, 0xBF, 0xE6, 0x42, 0x68, 0x41, 0x99, 0x2D, 0x0F, 0xB0, 0x54, 0xBB, 0x16};

/** Times x: no branch on a secret. */
static uint8_t doubled(uint8_t byte)
{
    return (uint8_t)((uint32_t)byte << 1 ^ (uint32_t)(byte >> 7) * BYTE_POLYNOMIAL);
}

static void add(uint8_t *to, const uint8_t *from)
{
    for (size_t i = 0; i < BLOCK; ++i) {
        to[i] ^= from[i];
    }
}

static void copy(uint8_t *to, const uint8_t *from)
{
    for (size_t i = 0; i < BLOCK; ++i) {
        to[i] = from[i];
    }
}

/** Each word is the one before it, substituted and rotated at the start of a round key, plus the
 *  word one round key back. */
static void expand_key(uint8_t round_keys[BLOCK * (ROUNDS + 1u)], const uint8_t *key)
{
    uint8_t constant = 1;
    copy(round_keys, key);
    for (size_t i = BLOCK; i < (size_t)BLOCK * (ROUNDS + 1u); i += 4u) {
        const bool begins = i % BLOCK == 0u;
        for (size_t k = 0; k < 4u; ++k) {
            const uint8_t before = round_keys[i - 4u + (begins ? (k + 1u) % 4u : k)];
            round_keys[i + k] = round_keys[i + k - BLOCK] ^ (begins ? SUBSTITUTE[before] : before);
        }
        if (begins) {
            round_keys[i] ^= constant;
            constant = doubled(constant);
        }
    }
}

/** The state is stored by columns; row r is rotated by r columns. */
static void substitute_and_shift(uint8_t *block)
{
    uint8_t before[BLOCK];
    copy(before, block);
    for (size_t i = 0; i < BLOCK; ++i) {
        block[i] = SUBSTITUTE[before[(i + 4u * (i % 4u)) % BLOCK]];
    }
}

static void mix_columns(uint8_t *block)
{
    for (size_t i = 0; i < BLOCK; i += 4u) {
        const uint8_t a = block[i], b = block[i + 1u], c = block[i + 2u], d = block[i + 3u];
        const uint8_t all = a ^ b ^ c ^ d;
        block[i] = a ^ all ^ doubled(a ^ b);
        block[i + 1u] = b ^ all ^ doubled(b ^ c);
        block[i + 2u] = c ^ all ^ doubled(c ^ d);
        block[i + 3u] = d ^ all ^ doubled(d ^ a);
    }
}

static void encrypt(const uint8_t *round_keys, uint8_t *block)
{
    add(block, round_keys);
    for (size_t round = 1; round < ROUNDS; ++round) {
        substitute_and_shift(block);
        mix_columns(block);
        add(block, round_keys + (size_t)BLOCK * round);
    }
    substitute_and_shift(block);
    add(block, round_keys + (size_t)BLOCK * ROUNDS);
}

/** A subkey is the one before it times x, the block taken as one number with the first byte high. */
static void double_block(uint8_t *to, const uint8_t *from)
{
    const uint32_t carry = from[0] >> 7;
    for (size_t i = 0; i + 1u < BLOCK; ++i) {
        to[i] = (uint8_t)((uint32_t)from[i] << 1 | from[i + 1u] >> 7);
    }
    to[BLOCK - 1u] = (uint8_t)((uint32_t)from[BLOCK - 1u] << 1 ^ carry * BLOCK_POLYNOMIAL);
}

void saddle_cmac_prepare(saddle_cmac_key_t *prepared, const uint8_t key[SADDLE_CMAC_LENGTH])
{
    uint8_t zero[BLOCK] = {0};
    expand_key(prepared->round_keys, key);
    encrypt(prepared->round_keys, zero);
    double_block(prepared->full, zero);
    double_block(prepared->partial, prepared->full);
}

void saddle_cmac(const saddle_cmac_key_t *key, const uint8_t *bytes, size_t length,
                 uint8_t code[SADDLE_CMAC_LENGTH])
{
    uint8_t chained[BLOCK] = {0};
    while (length > BLOCK) {
        add(chained, bytes);
        encrypt(key->round_keys, chained);
        bytes += BLOCK;
        length -= BLOCK;
    }
    for (size_t i = 0; i < BLOCK && i < length; ++i) {
        chained[i] ^= bytes[i];
    }
    if (length < BLOCK) {
        chained[length] ^= 0x80u;
    }
    add(chained, length < BLOCK ? key->partial : key->full);
    encrypt(key->round_keys, chained);
    copy(code, chained);
}
