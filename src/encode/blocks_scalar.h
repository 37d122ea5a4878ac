/* encode/blocks_scalar.h - blocks of 64 codes for encode/rows.tmpl.h, in plain
 * C. Comparisons give bytes of 0 and 1, in loops that the compiler vectorizes;
 * one multiplication turns eight such bytes into eight bits. */
#ifndef SNOW_BLOCKS_SCALAR_H
#define SNOW_BLOCKS_SCALAR_H

#include "base/base.h"

#include <string.h>

/* Bytes of 0 or 1 as bits, the first one lowest. */
static inline uint64_t bits_of_flags(const unsigned char flags[64]) {
    uint64_t mask = 0;
    for (int n = 0; n < 8; n++) {
        uint64_t eight;
        memcpy(&eight, flags + 8 * n, sizeof eight);
#if __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
        eight = __builtin_bswap64(eight);
#endif
        mask |= (eight * UINT64_C(0x0102040810204080)) >> 56 << (8 * n);
    }
    return mask;
}

/* Copies the elements of set bits, run by run, in steps of 16 bytes: reads and
 * writes up to 16 bytes beyond a run. */
static inline void copy_runs(const unsigned char *from, uint64_t mask,
                             size_t size, unsigned char *to) {
    while (mask) {
        size_t skip = (size_t)__builtin_ctzll(mask);
        uint64_t rest = ~(mask >> skip);
        size_t run = rest ? (size_t)__builtin_ctzll(rest) : 64;
        for (size_t n = 0; n < run * size; n += 16)
            memcpy(to + n, from + skip * size + n, 16);
        to += run * size;
        mask &= mask + (UINT64_C(1) << skip);
    }
}

#define BLOCK_SPARE 16 /* bytes, for copy_runs */

#define BLOCKS_SCALAR(code, suffix)                                            \
    typedef struct block_##suffix##_scalar {                                   \
        code codes[64 + BLOCK_SPARE];                                          \
    } block_##suffix##_scalar;                                                 \
                                                                               \
    static inline block_##suffix##_scalar load_##suffix##_scalar(              \
        const code *voxels, code bias) {                                       \
        block_##suffix##_scalar block;                                         \
        for (int n = 0; n < 64; n++)                                           \
            block.codes[n] = (code)(voxels[n] + bias);                         \
        memset(block.codes + 64, 0, sizeof block.codes - 64 * sizeof(code));   \
        return block;                                                          \
    }                                                                          \
                                                                               \
    static inline uint64_t within_##suffix##_scalar(                           \
        block_##suffix##_scalar block, code first, code last) {                \
        unsigned char flags[64];                                               \
        for (int n = 0; n < 64; n++)                                           \
            flags[n] = (code)(block.codes[n] - first) <= (code)(last - first); \
        return bits_of_flags(flags);                                           \
    }                                                                          \
                                                                               \
    static inline void pack_##suffix##_scalar(block_##suffix##_scalar block,   \
                                              uint64_t mask, code *out) {      \
        copy_runs((const unsigned char *)block.codes, mask, sizeof(code),      \
                  (unsigned char *)out);                                       \
    }                                                                          \
                                                                               \
    static inline uint64_t bits_##suffix##_scalar(                             \
        block_##suffix##_scalar block, const unsigned char *keep) {            \
        unsigned char flags[64];                                               \
        for (int n = 0; n < 64; n++)                                           \
            flags[n] = keep[block.codes[n]];                                   \
        return bits_of_flags(flags);                                           \
    }

BLOCKS_SCALAR(uint8_t, 8)
BLOCKS_SCALAR(uint16_t, 16)

#endif
