/* encode/blocks_avx2.h - blocks of 64 codes for encode/rows.tmpl.h, with AVX2.
 * Vectors compare; codes are packed eight at a time, by a shuffle with the
 * positions of the set bits. */
#ifndef SNOW_BLOCKS_AVX2_H
#define SNOW_BLOCKS_AVX2_H

#include "encode/blocks_scalar.h"
#include "encode/masks.h"
#include "simd/vec_avx2.h"

SNOW_AVX2_INLINE __m256i load_256(const void *at) {
    return _mm256_loadu_si256((const __m256i *)at);
}

SNOW_AVX2_INLINE void store_256(void *at, __m256i vector) {
    _mm256_storeu_si256((__m256i *)at, vector);
}

typedef struct block_8_avx2 {
    __m256i part[2];
} block_8_avx2;

SNOW_AVX2_INLINE block_8_avx2 load_8_avx2(const uint8_t *voxels, uint8_t bias) {
    __m256i add = _mm256_set1_epi8((char)bias);
    return (block_8_avx2){{_mm256_add_epi8(load_256(voxels), add),
                           _mm256_add_epi8(load_256(voxels + 32), add)}};
}

/* Bytes of -1 where first <= code <= first + width. */
SNOW_AVX2_INLINE __m256i inside_8(__m256i codes, __m256i first, __m256i width) {
    __m256i above = _mm256_sub_epi8(codes, first);
    return _mm256_cmpeq_epi8(_mm256_min_epu8(above, width), above);
}

SNOW_AVX2_INLINE uint64_t within_8_avx2(block_8_avx2 block, uint8_t first,
                                        uint8_t last) {
    __m256i begin = _mm256_set1_epi8((char)first);
    __m256i width = _mm256_set1_epi8((char)(last - first));
    uint32_t low =
        (uint32_t)_mm256_movemask_epi8(inside_8(block.part[0], begin, width));
    uint32_t high =
        (uint32_t)_mm256_movemask_epi8(inside_8(block.part[1], begin, width));
    return low | (uint64_t)high << 32;
}

/* Start of group n of eight, from snow_counts_of_bytes. */
SNOW_AVX2_INLINE size_t begin_of(uint64_t counts, int n) {
    return n ? counts >> 8 * (n - 1) & 255 : 0;
}

SNOW_AVX2_INLINE void pack_8_avx2(block_8_avx2 block, uint64_t mask,
                                  uint8_t *out) {
    unsigned char codes[64];
    if (!mask)
        return;
    store_256(codes, block.part[0]);
    store_256(codes + 32, block.part[1]);
    uint64_t counts = snow_counts_of_bytes(mask);
    for (int n = 0; n < 8; n++) {
        const void *params = &snow_places_of_byte[mask >> 8 * n & 255];
        __m128i eight = _mm_loadl_epi64((const __m128i *)(codes + 8 * n));
        eight = _mm_shuffle_epi8(eight, _mm_loadl_epi64(params));
        _mm_storel_epi64((__m128i *)(out + begin_of(counts, n)), eight);
    }
}

SNOW_AVX2_INLINE uint64_t bits_8_avx2(block_8_avx2 block,
                                      const unsigned char *keep) {
    block_8_scalar codes;
    store_256(codes.codes, block.part[0]);
    store_256(codes.codes + 32, block.part[1]);
    return bits_8_scalar(codes, keep);
}

typedef struct block_16_avx2 {
    __m256i part[4];
} block_16_avx2;

SNOW_AVX2_INLINE block_16_avx2 load_16_avx2(const uint16_t *voxels,
                                            uint16_t bias) {
    __m256i add = _mm256_set1_epi16((short)bias);
    block_16_avx2 block;
    for (int n = 0; n < 4; n++)
        block.part[n] = _mm256_add_epi16(load_256(voxels + 16 * n), add);
    return block;
}

SNOW_AVX2_INLINE __m256i inside_16(__m256i codes, __m256i first,
                                   __m256i width) {
    __m256i above = _mm256_sub_epi16(codes, first);
    return _mm256_cmpeq_epi16(_mm256_min_epu16(above, width), above);
}

/* 32 codes: two vectors of 16-bit values become one of bytes, and packing swaps
 * the middle quarters. */
SNOW_AVX2_INLINE uint64_t bits_of_half(__m256i low, __m256i high, __m256i first,
                                       __m256i width) {
    __m256i bytes = _mm256_packs_epi16(inside_16(low, first, width),
                                       inside_16(high, first, width));
    bytes = _mm256_permute4x64_epi64(bytes, 0xD8);
    return (uint32_t)_mm256_movemask_epi8(bytes);
}

SNOW_AVX2_INLINE uint64_t within_16_avx2(block_16_avx2 block, uint16_t first,
                                         uint16_t last) {
    __m256i begin = _mm256_set1_epi16((short)first);
    __m256i width = _mm256_set1_epi16((short)(last - first));
    return bits_of_half(block.part[0], block.part[1], begin, width) |
           bits_of_half(block.part[2], block.part[3], begin, width) << 32;
}

SNOW_AVX2_INLINE void pack_16_avx2(block_16_avx2 block, uint64_t mask,
                                   uint16_t *out) {
    uint16_t codes[64];
    if (!mask)
        return;
    for (int n = 0; n < 4; n++)
        store_256(codes + 16 * n, block.part[n]);
    uint64_t counts = snow_counts_of_bytes(mask);
    for (int n = 0; n < 8; n++) {
        const void *places = &snow_places_of_byte[mask >> 8 * n & 255];
        /* Word k is bytes 2 k and 2 k + 1. */
        __m128i params = _mm_loadl_epi64(places);
        params = _mm_add_epi8(params, params);
        params =
            _mm_unpacklo_epi8(params, _mm_add_epi8(params, _mm_set1_epi8(1)));
        __m128i eight = _mm_loadu_si128((const __m128i *)(codes + 8 * n));
        eight = _mm_shuffle_epi8(eight, params);
        _mm_storeu_si128((__m128i *)(out + begin_of(counts, n)), eight);
    }
}

SNOW_AVX2_INLINE uint64_t bits_16_avx2(block_16_avx2 block,
                                       const unsigned char *keep) {
    block_16_scalar codes;
    for (int n = 0; n < 4; n++)
        store_256(codes.codes + 16 * n, block.part[n]);
    return bits_16_scalar(codes, keep);
}

#endif
