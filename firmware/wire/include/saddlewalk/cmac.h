/**
 * AES-128-CMAC (RFC 4493, NIST SP 800-38B): a code that only who has the key can make. Constant
 * tables, no heap, no branch on the key or the bytes. The table of 256 bytes is looked up by secret
 * values: on a processor with a data cache its timing can reveal them to another program.
 */
#ifndef SADDLEWALK_CMAC_H
#define SADDLEWALK_CMAC_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define SADDLE_CMAC_LENGTH 16u

/** A key made ready; as secret as the key. */
typedef struct {
    uint8_t round_keys[176];
    uint8_t full[SADDLE_CMAC_LENGTH];    /**< K1, for a last block that is full */
    uint8_t partial[SADDLE_CMAC_LENGTH]; /**< K2, for one that is not */
} saddle_cmac_key_t;

/** Make a key of 16 bytes ready. */
void saddle_cmac_prepare(saddle_cmac_key_t *prepared, const uint8_t key[SADDLE_CMAC_LENGTH]);

/** The code of `length` bytes, which may be 0. Time is proportional to the blocks of 16 bytes. */
void saddle_cmac(const saddle_cmac_key_t *key, const uint8_t *bytes, size_t length,
                 uint8_t code[SADDLE_CMAC_LENGTH]);

#endif
