/* classify/classify_u8.c - finds the kept voxels of 8-bit rows, 64 at a time. A
 * table of 256 bytes fits into four registers, and two permutations read it. */
#include "classify/classify_u8.h"
#include "simd/isa.h"

#if SNOW_HAS_AVX
#include "simd/vec_avx512.h"

#define BYTES 64

/* One bit per voxel: is it kept? */
SNOW_AVX512_INLINE uint64_t look_up(const __m512i table[4], __m512i index) {
    __m512i low = _mm512_permutex2var_epi8(table[0], index, table[1]);
    __m512i high = _mm512_permutex2var_epi8(table[2], index, table[3]);
    __mmask64 upper = _mm512_movepi8_mask(index);
    __m512i keep = _mm512_mask_blend_epi8(upper, low, high);
    return _mm512_test_epi8_mask(keep, keep);
}

/* Appends the positions of set bits; the lowest bit stands for `column`. */
SNOW_AVX512_INLINE size_t append(uint64_t bits, int64_t column,
                                 uint32_t *kept) {
    size_t count = 0;
    __m512i places = _mm512_add_epi32(
        _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15),
        _mm512_set1_epi32((int)column));
    for (; bits; bits >>= 16) {
        __mmask16 some = (__mmask16)bits;
        _mm512_mask_compressstoreu_epi32(kept + count, some, places);
        count += (size_t)__builtin_popcount(some);
        places = _mm512_add_epi32(places, _mm512_set1_epi32(16));
    }
    return count;
}

static SNOW_AVX512_TARGET size_t classify_u8_avx512(const unsigned char *keep,
                                                    const void *voxels,
                                                    unsigned char lowest,
                                                    int64_t columns,
                                                    uint32_t *kept) {
    const unsigned char *voxel = voxels;
    const __m512i base = _mm512_set1_epi8((char)lowest);
    size_t count = 0;
    __m512i table[4];
    for (int n = 0; n < 4; n++)
        table[n] = _mm512_loadu_si512(keep + n * BYTES);
    for (int64_t i = 0; i < columns; i += BYTES) {
        int64_t left = columns - i;
        __mmask64 valid = left < BYTES ? (UINT64_C(1) << left) - 1 : UINT64_MAX;
        __m512i value = _mm512_maskz_loadu_epi8(valid, voxel + i);
        uint64_t bits = look_up(table, _mm512_sub_epi8(value, base)) & valid;
        count += append(bits, i, kept + count);
    }
    return count;
}

snow_classify_u8_fn *snow_classify_u8_pick(snow_isa isa) {
    return isa == SNOW_ISA_AVX512 ? classify_u8_avx512 : NULL;
}
#else
snow_classify_u8_fn *snow_classify_u8_pick(snow_isa isa) {
    (void)isa;
    return NULL;
}
#endif
