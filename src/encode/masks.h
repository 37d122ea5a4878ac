/* encode/masks.h - the inner loops of writing EA: what the schemes make of the
 * masks of a slice.
 *
 * They work without a branch for each bit or word: how many are set is as
 * random as the data, and a branch that is guessed wrongly costs as much as ten
 * places. */
#ifndef SNOW_MASKS_H
#define SNOW_MASKS_H

#include "simd/isa.h"

#include <string.h>

/* All levels write the same bytes. */
typedef struct snow_mask_loops {
    /* For each bit set in `words` words its number, counted from `base` on,
     * modulo 256, into `out`; returns the end of what counts there, beyond
     * which up to 64 bytes may be written.  CRS stores such numbers as
     * columns, and runs end at them. */
    unsigned char *(*places)(const uint64_t *masks, size_t words, unsigned base,
                             unsigned char *out);
    /* How many words are not 0. */
    size_t (*count_words)(const uint64_t *masks, size_t words);
    /* Words that are not 0 to `out`, and a bit for each of all words to
     * `summary`; returns the end, beyond which up to 64 bytes may be written.
     */
    unsigned char *(*pack_words)(const uint64_t *masks, size_t words,
                                 unsigned char *summary, unsigned char *out);
    /* How many bits of some bytes are set. */
    size_t (*count_bits)(const unsigned char *bytes, size_t count);
} snow_mask_loops;

/* `isa` is resolved. */
const snow_mask_loops *snow_mask_loops_of(snow_isa isa);

/* For each byte, the numbers of its set bits, a byte each, lowest first. */
extern const uint64_t snow_places_of_byte[256];

/* In byte n, how many bits are set in bytes 0 to n of a mask: bits are added up
 * in pairs, fours and eights, then a multiplication adds each byte to all above
 * it. */
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
