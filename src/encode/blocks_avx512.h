/* encode/blocks_avx512.h - blocks of 64 codes for encode/rows.tmpl.h, with
 * AVX-512: comparisons into mask registers, and compression (VBMI2). */
#ifndef SNOW_BLOCKS_AVX512_H
#define SNOW_BLOCKS_AVX512_H

#include "encode/blocks_scalar.h"
#include "simd/vec_avx512.h"

typedef __m512i block_8_avx512;

SNOW_AVX512_INLINE block_8_avx512 load_8_avx512(const uint8_t *voxels,
                                                uint8_t bias) {
    return _mm512_add_epi8(_mm512_loadu_si512(voxels),
                           _mm512_set1_epi8((char)bias));
}

SNOW_AVX512_INLINE uint64_t within_8_avx512(block_8_avx512 block, uint8_t first,
                                            uint8_t last) {
    return _mm512_cmple_epu8_mask(
        _mm512_sub_epi8(block, _mm512_set1_epi8((char)first)),
        _mm512_set1_epi8((char)(last - first)));
}

SNOW_AVX512_INLINE void pack_8_avx512(block_8_avx512 block, uint64_t mask,
                                      uint8_t *out) {
    _mm512_storeu_si512(out, _mm512_maskz_compress_epi8(mask, block));
}

SNOW_AVX512_INLINE uint64_t bits_8_avx512(block_8_avx512 block,
                                          const unsigned char *keep) {
    block_8_scalar codes;
    _mm512_storeu_si512(codes.codes, block);
    return bits_8_scalar(codes, keep);
}

typedef struct block_16_avx512 {
    __m512i low, high;
} block_16_avx512;

SNOW_AVX512_INLINE block_16_avx512 load_16_avx512(const uint16_t *voxels,
                                                  uint16_t bias) {
    __m512i add = _mm512_set1_epi16((short)bias);
    return (block_16_avx512){
        _mm512_add_epi16(_mm512_loadu_si512(voxels), add),
        _mm512_add_epi16(_mm512_loadu_si512(voxels + 32), add)};
}

SNOW_AVX512_INLINE uint64_t within_16_avx512(block_16_avx512 block,
                                             uint16_t first, uint16_t last) {
    __m512i begin = _mm512_set1_epi16((short)first);
    __m512i width = _mm512_set1_epi16((short)(last - first));
    uint64_t low =
        _mm512_cmple_epu16_mask(_mm512_sub_epi16(block.low, begin), width);
    uint64_t high =
        _mm512_cmple_epu16_mask(_mm512_sub_epi16(block.high, begin), width);
    return low | high << 32;
}

SNOW_AVX512_INLINE void pack_16_avx512(block_16_avx512 block, uint64_t mask,
                                       uint16_t *out) {
    __mmask32 low = (__mmask32)mask, high = (__mmask32)(mask >> 32);
    _mm512_storeu_si512(out, _mm512_maskz_compress_epi16(low, block.low));
    _mm512_storeu_si512(out + __builtin_popcount(low),
                        _mm512_maskz_compress_epi16(high, block.high));
}

SNOW_AVX512_INLINE uint64_t bits_16_avx512(block_16_avx512 block,
                                           const unsigned char *keep) {
    block_16_scalar codes;
    _mm512_storeu_si512(codes.codes, block.low);
    _mm512_storeu_si512(codes.codes + 32, block.high);
    return bits_16_scalar(codes, keep);
}

#endif
