/* simd/vec_avx512.h - the vector operations for AVX-512 of 2019 (Ice Lake).
 * simd/select.h describes them. */
#ifndef SNOW_VEC_AVX512_H
#define SNOW_VEC_AVX512_H

#include "simd/vec_scalar.h"

#include <immintrin.h>

#define SNOW_AVX512_LANES 16
#define SNOW_AVX512_TARGET                                             \
    __attribute__((target("avx2,fma,popcnt,bmi,bmi2,avx512f,avx512bw," \
                          "avx512vl,avx512dq,avx512vbmi,avx512vbmi2")))
#define SNOW_AVX512_INLINE                                                 \
    static inline __attribute__((                                          \
        always_inline, target("avx2,fma,popcnt,bmi,bmi2,avx512f,avx512bw," \
                              "avx512vl,avx512dq,avx512vbmi,avx512vbmi2")))

typedef __m512 snow_avx512_vec;
typedef __m512i snow_avx512_int;
typedef uint64_t snow_avx512_wide __attribute__((vector_size(64)));

#define V(word) snow_avx512_##word
#define M(word) _mm512_##word
#define INLINE SNOW_AVX512_INLINE
#include "simd/vec_avx.tmpl.h"

/* Adds the quarters i and j of each of two vectors to those behind them. */
#define SNOW_AVX512_FOLD(a, b, first, second)        \
    _mm512_add_ps(_mm512_shuffle_f32x4(a, b, first), \
                  _mm512_shuffle_f32x4(a, b, second))

SNOW_AVX512_INLINE snow_avx512_vec snow_avx512_sums4(const snow_avx512_vec *v) {
    __m512 a = SNOW_AVX512_FOLD(v[0], v[1], 0x44, 0xEE);
    __m512 b = SNOW_AVX512_FOLD(v[2], v[3], 0x44, 0xEE);
    return SNOW_AVX512_FOLD(a, b, 0x88, 0xDD);
}

/* Inserts the 16 bytes of an entry at a position. */
#define SNOW_AVX512_FOUR(v, place, p, n) \
    _mm512_insertf32x4(v, _mm_loadu_ps((p) + 4 * (size_t)(n)), place)

SNOW_AVX512_INLINE snow_avx512_vec snow_avx512_gather4(const float *p,
                                                       const uint32_t *n) {
    __m512 v = _mm512_castps128_ps512(_mm_loadu_ps(p + 4 * (size_t)n[0]));
    v = SNOW_AVX512_FOUR(v, 1, p, n[1]);
    v = SNOW_AVX512_FOUR(v, 2, p, n[2]);
    return SNOW_AVX512_FOUR(v, 3, p, n[3]);
}

SNOW_AVX512_INLINE snow_avx512_vec snow_avx512_gather2(const float *p,
                                                       const uint32_t *n) {
    __m256i places = _mm256_loadu_si256((const __m256i *)(const void *)n);
    return _mm512_castpd_ps(_mm512_i32gather_pd(places, p, 8));
}

SNOW_AVX512_INLINE snow_avx512_vec snow_avx512_fractions1(const uint64_t *p) {
    const __m512i even = _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18,
                                           20, 22, 24, 26, 28, 30);
    return snow_avx512_fraction(_mm512_permutex2var_epi32(
        _mm512_loadu_si512(p), even, _mm512_loadu_si512(p + 8)));
}

SNOW_AVX512_INLINE void snow_avx512_scatter4(float *p, const uint32_t *n,
                                             snow_avx512_vec v) {
    _mm_storeu_ps(p + (size_t)n[0] * 4, _mm512_castps512_ps128(v));
    _mm_storeu_ps(p + (size_t)n[1] * 4, _mm512_extractf32x4_ps(v, 1));
    _mm_storeu_ps(p + (size_t)n[2] * 4, _mm512_extractf32x4_ps(v, 2));
    _mm_storeu_ps(p + (size_t)n[3] * 4, _mm512_extractf32x4_ps(v, 3));
}

/* A bit for each of eight 64-bit values that is not 0, ignoring signs. */
SNOW_AVX512_INLINE unsigned snow_avx512_any_of(__m512i v) {
    return _mm512_test_epi64_mask(v, _mm512_set1_epi32(0x7fffffff));
}

/* Eight pixels: halves in the order a0 b0 a1 b1 ..., then reordered. */
SNOW_AVX512_INLINE unsigned snow_avx512_some_of_8(const float *p) {
    const __m512i order = _mm512_setr_epi64(0, 2, 4, 6, 1, 3, 5, 7);
    __m512i a = _mm512_loadu_si512(p), b = _mm512_loadu_si512(p + 16);
    __m512i both = _mm512_or_si512(_mm512_unpacklo_epi64(a, b),
                                   _mm512_unpackhi_epi64(a, b));
    return snow_avx512_any_of(_mm512_permutexvar_epi64(order, both));
}

SNOW_AVX512_INLINE unsigned snow_avx512_nonzero4(const float *p) {
    return snow_avx512_some_of_8(p) | snow_avx512_some_of_8(p + 32) << 8;
}

SNOW_AVX512_INLINE unsigned snow_avx512_some2(const float *p) {
    return snow_avx512_any_of(_mm512_loadu_si512(p)) |
           snow_avx512_any_of(_mm512_loadu_si512(p + 16)) << 8;
}

SNOW_AVX512_INLINE int snow_avx512_list(uint64_t bits, uint32_t *n) {
    const __m512i row = _mm512_set_epi8(
        63, 62, 61, 60, 59, 58, 57, 56, 55, 54, 53, 52, 51, 50, 49, 48, 47, 46,
        45, 44, 43, 42, 41, 40, 39, 38, 37, 36, 35, 34, 33, 32, 31, 30, 29, 28,
        27, 26, 25, 24, 23, 22, 21, 20, 19, 18, 17, 16, 15, 14, 13, 12, 11, 10,
        9, 8, 7, 6, 5, 4, 3, 2, 1, 0);
    const __m512i places = _mm512_maskz_compress_epi8(bits, row);
    const int count = __builtin_popcountll(bits);
    _mm512_storeu_si512(n,
                        _mm512_cvtepu8_epi32(_mm512_castsi512_si128(places)));
    if (count > 16)
        _mm512_storeu_si512(
            n + 16, _mm512_cvtepu8_epi32(_mm512_extracti32x4_epi32(places, 1)));
    if (count > 32) {
        _mm512_storeu_si512(
            n + 32, _mm512_cvtepu8_epi32(_mm512_extracti32x4_epi32(places, 2)));
        _mm512_storeu_si512(
            n + 48, _mm512_cvtepu8_epi32(_mm512_extracti32x4_epi32(places, 3)));
    }
    return count;
}

SNOW_AVX512_INLINE snow_avx512_vec snow_avx512_next2(const float *p,
                                                     unsigned bits) {
    return _mm512_castpd_ps(
        _mm512_maskz_expand_pd((__mmask8)bits, _mm512_loadu_pd(p)));
}

SNOW_AVX512_INLINE int snow_avx512_compress2(const float *p, unsigned bits,
                                             float *out) {
    const __mmask8 here = (__mmask8)bits;
    __m512d v = _mm512_maskz_loadu_pd(here, p);
    _mm512_storeu_pd(out, _mm512_maskz_compress_pd(here, v));
    return __builtin_popcount(bits);
}

#endif
