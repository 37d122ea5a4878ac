/* simd/rows_avx512.h - rows of 32 numbers of 16 bits, for AVX-512.
 * simd/rows.h describes the operations. */
#ifndef SNOW_ROWS_AVX512_H
#define SNOW_ROWS_AVX512_H

#include "simd/vec_avx512.h"

typedef __m512i snow_avx512_row;

SNOW_AVX512_INLINE snow_avx512_row snow_avx512_row_load(const int16_t *p) {
    return _mm512_loadu_si512(p);
}

SNOW_AVX512_INLINE void snow_avx512_row_store(int16_t *p, snow_avx512_row a) {
    _mm512_storeu_si512(p, a);
}

SNOW_AVX512_INLINE snow_avx512_row snow_avx512_row_set1(int16_t x) {
    return _mm512_set1_epi16(x);
}

SNOW_AVX512_INLINE snow_avx512_row snow_avx512_row_bytes(const uint8_t *p) {
    return _mm512_cvtepu8_epi16(
        _mm256_loadu_si256((const __m256i *)(const void *)p));
}

SNOW_AVX512_INLINE uint64_t snow_avx512_bytes_outside(const uint8_t *p,
                                                      uint8_t first,
                                                      uint8_t width) {
    __m512i from =
        _mm512_sub_epi8(_mm512_loadu_si512(p), _mm512_set1_epi8((char)first));
    return _mm512_cmpgt_epu8_mask(from, _mm512_set1_epi8((char)width));
}

/* An operation on each number of two rows. */
#define SNOW_AVX512_ROW_OF(name, of)                           \
    SNOW_AVX512_INLINE snow_avx512_row snow_avx512_row_##name( \
        snow_avx512_row a, snow_avx512_row b) {                \
        return of(a, b);                                       \
    }

SNOW_AVX512_ROW_OF(add, _mm512_add_epi16)
SNOW_AVX512_ROW_OF(adds, _mm512_adds_epi16)
SNOW_AVX512_ROW_OF(subs, _mm512_subs_epi16)
SNOW_AVX512_ROW_OF(mul, _mm512_mullo_epi16)
SNOW_AVX512_ROW_OF(mulhrs, _mm512_mulhrs_epi16)
SNOW_AVX512_ROW_OF(min, _mm512_min_epi16)
SNOW_AVX512_ROW_OF(max, _mm512_max_epi16)
SNOW_AVX512_ROW_OF(and, _mm512_and_si512)
SNOW_AVX512_ROW_OF(or, _mm512_or_si512)

SNOW_AVX512_INLINE snow_avx512_row snow_avx512_row_avg(snow_avx512_row a,
                                                       snow_avx512_row b) {
    __m512i sign = _mm512_set1_epi16(INT16_MIN);
    return _mm512_xor_si512(sign, _mm512_avg_epu16(_mm512_xor_si512(a, sign),
                                                   _mm512_xor_si512(b, sign)));
}

SNOW_AVX512_INLINE snow_avx512_row snow_avx512_row_srl(snow_avx512_row a,
                                                       int bits) {
    return _mm512_srl_epi16(a, _mm_cvtsi32_si128(bits));
}

SNOW_AVX512_INLINE snow_avx512_row snow_avx512_row_sll(snow_avx512_row a,
                                                       int bits) {
    return _mm512_sll_epi16(a, _mm_cvtsi32_si128(bits));
}

SNOW_AVX512_INLINE uint32_t snow_avx512_row_gt(snow_avx512_row a,
                                               snow_avx512_row b) {
    return _mm512_cmpgt_epi16_mask(a, b);
}

SNOW_AVX512_INLINE snow_avx512_row snow_avx512_row_choose(uint32_t mask,
                                                          snow_avx512_row a,
                                                          snow_avx512_row b) {
    return _mm512_mask_blend_epi16(mask, b, a);
}

/* The numbers 0 to 31. */
SNOW_AVX512_INLINE snow_avx512_row snow_avx512_row_count(void) {
    return _mm512_set_epi16(31, 30, 29, 28, 27, 26, 25, 24, 23, 22, 21, 20, 19,
                            18, 17, 16, 15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5,
                            4, 3, 2, 1, 0);
}

/* By a permutation, which the compiler makes once for a mask: compressing and
 * expanding each row are five times as slow on some machines, and compressing
 * to memory on more. */
SNOW_AVX512_INLINE void snow_avx512_row_compress(int16_t *p, snow_avx512_row a,
                                                 uint32_t mask) {
    _mm512_storeu_si512(
        p, _mm512_permutexvar_epi16(
               _mm512_maskz_compress_epi16(mask, snow_avx512_row_count()), a));
}

SNOW_AVX512_INLINE snow_avx512_row snow_avx512_row_expand(const int16_t *p,
                                                          uint32_t mask) {
    return _mm512_maskz_permutexvar_epi16(
        mask, _mm512_maskz_expand_epi16(mask, snow_avx512_row_count()),
        _mm512_loadu_si512(p));
}

/* Entries of indices 0, 1, 8, 9, 16, 17, 24 and 25, whose words are groups of
 * two, word by word.  Loads are faster than a gather. */
SNOW_AVX512_INLINE __m512i snow_avx512_entries(const uint64_t *table,
                                               const uint16_t *at) {
    const __m512i order = _mm512_broadcast_i32x4(
        _mm_set_epi8(15, 14, 7, 6, 13, 12, 5, 4, 11, 10, 3, 2, 9, 8, 1, 0));
    const double *from = (const double *)(const void *)table;
    __m128d z[4];
    for (int n = 0; n < 4; n++)
        z[n] =
            _mm_loadh_pd(_mm_load_sd(from + at[8 * n]), from + at[8 * n + 1]);
    return _mm512_shuffle_epi8(
        _mm512_castpd_si512(_mm512_insertf64x4(
            _mm512_castpd256_pd512(_mm256_set_m128d(z[1], z[0])),
            _mm256_set_m128d(z[3], z[2]), 1)),
        order);
}

SNOW_AVX512_INLINE void snow_avx512_row_gather(const uint64_t *table,
                                               snow_avx512_row index,
                                               snow_avx512_row out[4]) {
    uint16_t at[32];
    memcpy(at, &index, sizeof at);
    __m512i z0 = snow_avx512_entries(table, at);
    __m512i z1 = snow_avx512_entries(table, at + 2);
    __m512i z2 = snow_avx512_entries(table, at + 4);
    __m512i z3 = snow_avx512_entries(table, at + 6);
    __m512i a = _mm512_unpacklo_epi32(z0, z1),
            b = _mm512_unpackhi_epi32(z0, z1);
    __m512i c = _mm512_unpacklo_epi32(z2, z3),
            d = _mm512_unpackhi_epi32(z2, z3);
    out[0] = _mm512_unpacklo_epi64(a, c);
    out[1] = _mm512_unpackhi_epi64(a, c);
    out[2] = _mm512_unpacklo_epi64(b, d);
    out[3] = _mm512_unpackhi_epi64(b, d);
}

/* Windows of 64 numbers, which two registers hold. */
SNOW_AVX512_INLINE void snow_avx512_row_pairs(const int16_t *p,
                                              const int16_t *at, int span,
                                              snow_avx512_row out[2]) {
    __m512i left = _mm512_loadu_si512(at);
    __m512i right = _mm512_add_epi16(left, _mm512_set1_epi16(1));
    __m512i low = _mm512_loadu_si512(p), high = _mm512_loadu_si512(p + 32);
    out[0] = _mm512_permutex2var_epi16(low, left, high);
    out[1] = _mm512_permutex2var_epi16(low, right, high);
    for (int first = 64; first < span; first += 64) {
        __m512i from = _mm512_set1_epi16((int16_t)(first - 1));
        low = _mm512_loadu_si512(p + first);
        high = _mm512_loadu_si512(p + first + 32);
        out[0] =
            _mm512_mask_mov_epi16(out[0], _mm512_cmpgt_epi16_mask(left, from),
                                  _mm512_permutex2var_epi16(low, left, high));
        out[1] =
            _mm512_mask_mov_epi16(out[1], _mm512_cmpgt_epi16_mask(right, from),
                                  _mm512_permutex2var_epi16(low, right, high));
    }
}

SNOW_AVX512_INLINE uint32_t snow_avx512_pick_bits(uint32_t bits,
                                                  uint32_t select) {
    return _pext_u32(bits, select);
}

SNOW_AVX512_INLINE void snow_avx512_rows_window(const uint32_t *low,
                                                const uint32_t *high, int shift,
                                                uint32_t *out) {
    __m128i right = _mm_cvtsi32_si128(shift),
            left = _mm_cvtsi32_si128(32 - shift);
    for (int n = 0; n < 32; n += 16) {
        __m512i window = _mm512_or_si512(
            _mm512_srl_epi32(_mm512_loadu_si512(low + n), right),
            _mm512_sll_epi32(_mm512_loadu_si512(high + n), left));
        _mm512_storeu_si512(
            out + n, _mm512_or_si512(_mm512_loadu_si512(out + n), window));
    }
}

SNOW_AVX512_INLINE uint32_t snow_avx512_rows_and(uint32_t *a, const uint32_t *b,
                                                 uint32_t columns) {
    __m512i all = _mm512_set1_epi32((int)columns);
    uint32_t any = 0;
    for (int n = 0; n < 32; n += 16) {
        __m512i both =
            _mm512_and_si512(_mm512_and_si512(_mm512_loadu_si512(a + n), all),
                             _mm512_loadu_si512(b + n));
        _mm512_storeu_si512(a + n, both);
        any |= (uint32_t)_mm512_test_epi32_mask(both, both) << n;
    }
    return any;
}

SNOW_AVX512_INLINE snow_avx512_vec snow_avx512_row_floats(const int16_t *p) {
    return _mm512_cvtepi32_ps(_mm512_cvtepi16_epi32(
        _mm256_loadu_si256((const __m256i *)(const void *)p)));
}

SNOW_AVX512_INLINE void snow_avx512_row_round(int16_t *p, snow_avx512_vec v) {
    _mm256_storeu_si256((__m256i *)(void *)p,
                        _mm512_cvtsepi32_epi16(_mm512_cvtps_epi32(v)));
}

SNOW_AVX512_INLINE void snow_avx512_row_widen(snow_avx512_row a,
                                              snow_avx512_vec out[2]) {
    out[0] =
        _mm512_cvtepi32_ps(_mm512_srai_epi32(_mm512_unpacklo_epi16(a, a), 16));
    out[1] =
        _mm512_cvtepi32_ps(_mm512_srai_epi32(_mm512_unpackhi_epi16(a, a), 16));
}

SNOW_AVX512_INLINE snow_avx512_row
snow_avx512_row_narrow(const snow_avx512_vec v[2]) {
    return _mm512_packs_epi32(_mm512_cvtps_epi32(v[0]),
                              _mm512_cvtps_epi32(v[1]));
}

SNOW_AVX512_INLINE snow_avx512_vec snow_avx512_row_rsqrt(snow_avx512_vec v) {
    const __m512 more = _mm512_set1_ps(1.5F);
    __m512 half = _mm512_mul_ps(v, _mm512_set1_ps(0.5F));
    __m512 y = _mm512_castsi512_ps(
        _mm512_sub_epi32(_mm512_set1_epi32(0x5f375a86),
                         _mm512_srli_epi32(_mm512_castps_si512(v), 1)));
    for (int n = 0; n < 2; n++)
        y = _mm512_mul_ps(
            y, _mm512_sub_ps(more, _mm512_mul_ps(_mm512_mul_ps(half, y), y)));
    return y;
}

SNOW_AVX512_INLINE snow_avx512_vec snow_avx512_row_turn(snow_avx512_vec v,
                                                        snow_avx512_vec by) {
    return _mm512_xor_ps(v, _mm512_and_ps(by, _mm512_set1_ps(-0.0F)));
}

#endif
