/* simd/rows_avx2.h - rows of 32 numbers of 16 bits, for AVX2: two vectors of
 * 16.  simd/rows.h describes the operations. */
#ifndef SNOW_ROWS_AVX2_H
#define SNOW_ROWS_AVX2_H

#include "simd/rows_scalar.h"
#include "simd/vec_avx2.h"

typedef struct snow_avx2_row {
    __m256i low, high;
} snow_avx2_row;

SNOW_AVX2_INLINE snow_avx2_row snow_avx2_row_load(const int16_t *p) {
    const __m256i *at = (const __m256i *)(const void *)p;
    return (snow_avx2_row){_mm256_loadu_si256(at), _mm256_loadu_si256(at + 1)};
}

SNOW_AVX2_INLINE void snow_avx2_row_store(int16_t *p, snow_avx2_row a) {
    __m256i *at = (__m256i *)(void *)p;
    _mm256_storeu_si256(at, a.low);
    _mm256_storeu_si256(at + 1, a.high);
}

SNOW_AVX2_INLINE snow_avx2_row snow_avx2_row_set1(int16_t x) {
    return (snow_avx2_row){_mm256_set1_epi16(x), _mm256_set1_epi16(x)};
}

SNOW_AVX2_INLINE snow_avx2_row snow_avx2_row_bytes(const uint8_t *p) {
    const __m128i *at = (const __m128i *)(const void *)p;
    return (snow_avx2_row){_mm256_cvtepu8_epi16(_mm_loadu_si128(at)),
                           _mm256_cvtepu8_epi16(_mm_loadu_si128(at + 1))};
}

SNOW_AVX2_INLINE uint64_t snow_avx2_bytes_outside(const uint8_t *p,
                                                  uint8_t first,
                                                  uint8_t width) {
    const __m256i *at = (const __m256i *)(const void *)p;
    const __m256i most = _mm256_set1_epi8((char)width);
    uint64_t inside = 0;
    for (int n = 0; n < 2; n++) {
        __m256i from = _mm256_sub_epi8(_mm256_loadu_si256(at + n),
                                       _mm256_set1_epi8((char)first));
        __m256i equal = _mm256_cmpeq_epi8(_mm256_max_epu8(from, most), most);
        inside |= (uint64_t)(uint32_t)_mm256_movemask_epi8(equal) << 32 * n;
    }
    return ~inside;
}

/* An operation on each number of two rows. */
#define SNOW_AVX2_ROW_OF(name, of)                                         \
    SNOW_AVX2_INLINE snow_avx2_row snow_avx2_row_##name(snow_avx2_row a,   \
                                                        snow_avx2_row b) { \
        return (snow_avx2_row){of(a.low, b.low), of(a.high, b.high)};      \
    }

SNOW_AVX2_ROW_OF(add, _mm256_add_epi16)
SNOW_AVX2_ROW_OF(adds, _mm256_adds_epi16)
SNOW_AVX2_ROW_OF(subs, _mm256_subs_epi16)
SNOW_AVX2_ROW_OF(mul, _mm256_mullo_epi16)
SNOW_AVX2_ROW_OF(mulhrs, _mm256_mulhrs_epi16)
SNOW_AVX2_ROW_OF(min, _mm256_min_epi16)
SNOW_AVX2_ROW_OF(max, _mm256_max_epi16)
SNOW_AVX2_ROW_OF(and, _mm256_and_si256)
SNOW_AVX2_ROW_OF(or, _mm256_or_si256)

SNOW_AVX2_INLINE __m256i snow_avx2_mean(__m256i a, __m256i b) {
    __m256i sign = _mm256_set1_epi16(INT16_MIN);
    return _mm256_xor_si256(sign, _mm256_avg_epu16(_mm256_xor_si256(a, sign),
                                                   _mm256_xor_si256(b, sign)));
}

SNOW_AVX2_ROW_OF(avg, snow_avx2_mean)

SNOW_AVX2_INLINE snow_avx2_row snow_avx2_row_srl(snow_avx2_row a, int bits) {
    __m128i by = _mm_cvtsi32_si128(bits);
    return (snow_avx2_row){_mm256_srl_epi16(a.low, by),
                           _mm256_srl_epi16(a.high, by)};
}

SNOW_AVX2_INLINE snow_avx2_row snow_avx2_row_sll(snow_avx2_row a, int bits) {
    __m128i by = _mm_cvtsi32_si128(bits);
    return (snow_avx2_row){_mm256_sll_epi16(a.low, by),
                           _mm256_sll_epi16(a.high, by)};
}

SNOW_AVX2_INLINE uint32_t snow_avx2_row_gt(snow_avx2_row a, snow_avx2_row b) {
    __m256i both = _mm256_packs_epi16(_mm256_cmpgt_epi16(a.low, b.low),
                                      _mm256_cmpgt_epi16(a.high, b.high));
    return (uint32_t)_mm256_movemask_epi8(_mm256_permute4x64_epi64(both, 0xD8));
}

/* All ones in each of 16 numbers whose bit is set. */
SNOW_AVX2_INLINE __m256i snow_avx2_lanes(uint32_t mask) {
    const __m256i bits =
        _mm256_set_epi16(INT16_MIN, 0x4000, 0x2000, 0x1000, 0x800, 0x400, 0x200,
                         0x100, 0x80, 0x40, 0x20, 0x10, 8, 4, 2, 1);
    __m256i all = _mm256_set1_epi16((int16_t)(uint16_t)mask);
    return _mm256_cmpeq_epi16(_mm256_and_si256(all, bits), bits);
}

SNOW_AVX2_INLINE snow_avx2_row snow_avx2_row_choose(uint32_t mask,
                                                    snow_avx2_row a,
                                                    snow_avx2_row b) {
    return (snow_avx2_row){
        _mm256_blendv_epi8(b.low, a.low, snow_avx2_lanes(mask)),
        _mm256_blendv_epi8(b.high, a.high, snow_avx2_lanes(mask >> 16))};
}

SNOW_AVX2_INLINE __m128i snow_avx2_bytes(const uint8_t table[16]) {
    return _mm_load_si128((const __m128i *)(const void *)table);
}

SNOW_AVX2_INLINE void snow_avx2_row_compress(int16_t *p, snow_avx2_row a,
                                             uint32_t mask) {
    const __m128i part[4] = {
        _mm256_castsi256_si128(a.low), _mm256_extracti128_si256(a.low, 1),
        _mm256_castsi256_si128(a.high), _mm256_extracti128_si256(a.high, 1)};
    for (int n = 0; n < 4; n++, mask >>= 8) {
        uint32_t here = mask & 255;
        _mm_storeu_si128(
            (__m128i *)(void *)p,
            _mm_shuffle_epi8(part[n],
                             snow_avx2_bytes(snow_rows_compress[here])));
        p += __builtin_popcount(here);
    }
}

SNOW_AVX2_INLINE snow_avx2_row snow_avx2_row_expand(const int16_t *p,
                                                    uint32_t mask) {
    __m128i part[4];
    for (int n = 0; n < 4; n++, mask >>= 8) {
        uint32_t here = mask & 255;
        part[n] =
            _mm_shuffle_epi8(_mm_loadu_si128((const __m128i *)(const void *)p),
                             snow_avx2_bytes(snow_rows_expand[here]));
        p += __builtin_popcount(here);
    }
    return (snow_avx2_row){_mm256_set_m128i(part[1], part[0]),
                           _mm256_set_m128i(part[3], part[2])};
}

/* Entries of indices 0, 1, 8 and 9, whose words are groups of two, word by
 * word.  Loads are faster than a gather. */
SNOW_AVX2_INLINE __m256i snow_avx2_entries(const uint64_t *table,
                                           const uint16_t *at) {
    const __m256i order =
        _mm256_set_epi8(15, 14, 7, 6, 13, 12, 5, 4, 11, 10, 3, 2, 9, 8, 1, 0,
                        15, 14, 7, 6, 13, 12, 5, 4, 11, 10, 3, 2, 9, 8, 1, 0);
    const double *from = (const double *)(const void *)table;
    const __m128d low = _mm_loadh_pd(_mm_load_sd(from + at[0]), from + at[1]);
    const __m128d high = _mm_loadh_pd(_mm_load_sd(from + at[8]), from + at[9]);
    return _mm256_shuffle_epi8(_mm256_castpd_si256(_mm256_set_m128d(high, low)),
                               order);
}

/* 16 entries, whose indices are in one vector. */
SNOW_AVX2_INLINE void snow_avx2_half(const uint64_t *table, __m256i index,
                                     __m256i out[4]) {
    uint16_t at[16];
    memcpy(at, &index, sizeof at);
    __m256i z0 = snow_avx2_entries(table, at);
    __m256i z1 = snow_avx2_entries(table, at + 2);
    __m256i z2 = snow_avx2_entries(table, at + 4);
    __m256i z3 = snow_avx2_entries(table, at + 6);
    __m256i a = _mm256_unpacklo_epi32(z0, z1),
            b = _mm256_unpackhi_epi32(z0, z1);
    __m256i c = _mm256_unpacklo_epi32(z2, z3),
            d = _mm256_unpackhi_epi32(z2, z3);
    out[0] = _mm256_unpacklo_epi64(a, c);
    out[1] = _mm256_unpackhi_epi64(a, c);
    out[2] = _mm256_unpacklo_epi64(b, d);
    out[3] = _mm256_unpackhi_epi64(b, d);
}

SNOW_AVX2_INLINE void snow_avx2_row_gather(const uint64_t *table,
                                           snow_avx2_row index,
                                           snow_avx2_row out[4]) {
    __m256i low[4], high[4];
    snow_avx2_half(table, index.low, low);
    snow_avx2_half(table, index.high, high);
    for (int n = 0; n < 4; n++)
        out[n] = (snow_avx2_row){low[n], high[n]};
}

/* 16 pairs: those of two gathers, whose halves are 8 numbers each. */
SNOW_AVX2_INLINE void snow_avx2_half_pairs(const int16_t *p, const int16_t *at,
                                           __m256i out[2]) {
    const __m128i *index = (const __m128i *)(const void *)at;
    const int *base = (const int *)(const void *)p;
    __m256i a = _mm256_i32gather_epi32(
        base, _mm256_cvtepi16_epi32(_mm_loadu_si128(index)), 2);
    __m256i b = _mm256_i32gather_epi32(
        base, _mm256_cvtepi16_epi32(_mm_loadu_si128(index + 1)), 2);
    __m256i left =
        _mm256_packs_epi32(_mm256_srai_epi32(_mm256_slli_epi32(a, 16), 16),
                           _mm256_srai_epi32(_mm256_slli_epi32(b, 16), 16));
    __m256i right =
        _mm256_packs_epi32(_mm256_srai_epi32(a, 16), _mm256_srai_epi32(b, 16));
    out[0] = _mm256_permute4x64_epi64(left, 0xD8);
    out[1] = _mm256_permute4x64_epi64(right, 0xD8);
}

SNOW_AVX2_INLINE void snow_avx2_row_pairs(const int16_t *p, const int16_t *at,
                                          int span, snow_avx2_row out[2]) {
    __m256i low[2], high[2];
    (void)span;
    snow_avx2_half_pairs(p, at, low);
    snow_avx2_half_pairs(p, at + 16, high);
    out[0] = (snow_avx2_row){low[0], high[0]};
    out[1] = (snow_avx2_row){low[1], high[1]};
}

SNOW_AVX2_INLINE uint32_t snow_avx2_pick_bits(uint32_t bits, uint32_t select) {
    return _pext_u32(bits, select);
}

SNOW_AVX2_INLINE void snow_avx2_rows_window(const uint32_t *low,
                                            const uint32_t *high, int shift,
                                            uint32_t *out) {
    __m128i right = _mm_cvtsi32_si128(shift),
            left = _mm_cvtsi32_si128(32 - shift);
    for (int n = 0; n < 32; n += 8) {
        __m256i *at = (__m256i *)(void *)(out + n);
        __m256i window = _mm256_or_si256(
            _mm256_srl_epi32(
                _mm256_loadu_si256((const __m256i *)(const void *)(low + n)),
                right),
            _mm256_sll_epi32(
                _mm256_loadu_si256((const __m256i *)(const void *)(high + n)),
                left));
        _mm256_storeu_si256(at,
                            _mm256_or_si256(_mm256_loadu_si256(at), window));
    }
}

SNOW_AVX2_INLINE uint32_t snow_avx2_rows_and(uint32_t *a, const uint32_t *b,
                                             uint32_t columns) {
    __m256i all = _mm256_set1_epi32((int)columns);
    uint32_t none = 0;
    for (int n = 0; n < 32; n += 8) {
        __m256i *at = (__m256i *)(void *)(a + n);
        __m256i both = _mm256_and_si256(
            _mm256_and_si256(_mm256_loadu_si256(at), all),
            _mm256_loadu_si256((const __m256i *)(const void *)(b + n)));
        _mm256_storeu_si256(at, both);
        none |= (uint32_t)_mm256_movemask_ps(_mm256_castsi256_ps(
                    _mm256_cmpeq_epi32(both, _mm256_setzero_si256())))
                << n;
    }
    return ~none;
}

SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_row_floats(const int16_t *p) {
    return _mm256_cvtepi32_ps(_mm256_cvtepi16_epi32(
        _mm_loadu_si128((const __m128i *)(const void *)p)));
}

SNOW_AVX2_INLINE void snow_avx2_row_round(int16_t *p, snow_avx2_vec v) {
    __m256i whole = _mm256_cvtps_epi32(v);
    _mm_storeu_si128((__m128i *)(void *)p,
                     _mm_packs_epi32(_mm256_castsi256_si128(whole),
                                     _mm256_extracti128_si256(whole, 1)));
}

SNOW_AVX2_INLINE void snow_avx2_half_widen(__m256i a, snow_avx2_vec out[2]) {
    out[0] =
        _mm256_cvtepi32_ps(_mm256_srai_epi32(_mm256_unpacklo_epi16(a, a), 16));
    out[1] =
        _mm256_cvtepi32_ps(_mm256_srai_epi32(_mm256_unpackhi_epi16(a, a), 16));
}

SNOW_AVX2_INLINE void snow_avx2_row_widen(snow_avx2_row a,
                                          snow_avx2_vec out[4]) {
    snow_avx2_half_widen(a.low, out);
    snow_avx2_half_widen(a.high, out + 2);
}

SNOW_AVX2_INLINE snow_avx2_row snow_avx2_row_narrow(const snow_avx2_vec v[4]) {
    return (snow_avx2_row){
        _mm256_packs_epi32(_mm256_cvtps_epi32(v[0]), _mm256_cvtps_epi32(v[1])),
        _mm256_packs_epi32(_mm256_cvtps_epi32(v[2]), _mm256_cvtps_epi32(v[3]))};
}

SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_row_rsqrt(snow_avx2_vec v) {
    const __m256 more = _mm256_set1_ps(1.5F);
    __m256 half = _mm256_mul_ps(v, _mm256_set1_ps(0.5F));
    __m256 y = _mm256_castsi256_ps(
        _mm256_sub_epi32(_mm256_set1_epi32(0x5f375a86),
                         _mm256_srli_epi32(_mm256_castps_si256(v), 1)));
    for (int n = 0; n < 2; n++)
        y = _mm256_mul_ps(
            y, _mm256_sub_ps(more, _mm256_mul_ps(_mm256_mul_ps(half, y), y)));
    return y;
}

SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_row_turn(snow_avx2_vec v,
                                                  snow_avx2_vec by) {
    return _mm256_xor_ps(v, _mm256_and_ps(by, _mm256_set1_ps(-0.0F)));
}

#endif
