/* encode/masks.h - the inner loops that write EA from the masks of a slice.
 *
 * They have no branch for each bit or word: the number of set bits is as random
 * as the data, and a mispredicted branch costs as much as ten positions. */
#ifndef SNOW_MASKS_H
#define SNOW_MASKS_H

#include "simd/isa.h"

#include <string.h>

/* All instruction sets write the same bytes. */
typedef struct snow_mask_loops {
    /* Writes the index of each bit set in `words` words, counted from `base`
     * on, modulo 256, to `out`. Returns the end of the indices; up to 64 bytes
     * beyond it may be overwritten. CRS stores these indices as columns, and
     * runs end at them. */
    unsigned char *(*places)(const uint64_t *masks, size_t words, unsigned base,
                             unsigned char *out);
    /* The number of words that are not 0. */
    size_t (*count_words)(const uint64_t *masks, size_t words);
    /* Writes the words that are not 0 to `out`, and a bit for each word to
     * `summary`. Returns the end; up to 64 bytes beyond it may be overwritten.
     */
    unsigned char *(*pack_words)(const uint64_t *masks, size_t words,
                                 unsigned char *summary, unsigned char *out);
    /* The number of bits set in some bytes. */
    size_t (*count_bits)(const unsigned char *bytes, size_t count);
} snow_mask_loops;

/* `isa` is resolved. */
const snow_mask_loops *snow_mask_loops_of(snow_isa isa);

/* For each byte, the indices of its set bits, a byte each, lowest first. */
extern const uint64_t snow_places_of_byte[256];

/* In byte n, the number of bits set in bytes 0 to n of a mask: bits are added
 * up in pairs, fours and eights, then a multiplication adds each byte to all
 * above it. */
static inline uint64_t snow_counts_of_bytes(uint64_t mask) {
    mask -= mask >> 1 & UINT64_C(0x5555555555555555);
    mask = (mask & UINT64_C(0x3333333333333333)) +
           (mask >> 2 & UINT64_C(0x3333333333333333));
    mask = (mask + (mask >> 4)) & UINT64_C(0x0f0f0f0f0f0f0f0f);
    return mask * UINT64_C(0x0101010101010101);
}

/* A 64-bit word as bytes, lowest first on every machine. */
static inline uint64_t snow_load_word(const unsigned char *at) {
    uint64_t word;
    memcpy(&word, at, sizeof word);
#if __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
    word = __builtin_bswap64(word);
#endif
    return word;
}

static inline void snow_store_word(unsigned char *at, uint64_t word) {
#if __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
    word = __builtin_bswap64(word);
#endif
    memcpy(at, &word, sizeof word);
}

#endif
