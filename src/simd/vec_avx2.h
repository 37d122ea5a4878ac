/* simd/vec_avx2.h - the vector operations for AVX2 with FMA. simd/select.h
 * describes them. */
#ifndef SNOW_VEC_AVX2_H
#define SNOW_VEC_AVX2_H

#include "simd/vec_scalar.h"

#include <immintrin.h>

#define SNOW_AVX2_LANES 8
#define SNOW_AVX2_TARGET __attribute__((target("avx2,fma,popcnt,bmi,bmi2")))
#define SNOW_AVX2_INLINE \
    static inline        \
        __attribute__((always_inline, target("avx2,fma,popcnt,bmi,bmi2")))

typedef __m256 snow_avx2_vec;
typedef __m256i snow_avx2_int;
typedef uint64_t snow_avx2_wide __attribute__((vector_size(32)));

#define V(word) snow_avx2_##word
#define M(word) _mm256_##word
#define INLINE SNOW_AVX2_INLINE
#include "simd/vec_avx.tmpl.h"

/* The lower halves of two vectors added to their upper ones. */
SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_fold(snow_avx2_vec a,
                                              snow_avx2_vec b) {
    return _mm256_add_ps(_mm256_permute2f128_ps(a, b, 0x20),
                         _mm256_permute2f128_ps(a, b, 0x31));
}

SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_sums4(const snow_avx2_vec *v) {
    return snow_avx2_fold(v[0], v[1]);
}

SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_sums2(const snow_avx2_vec *v) {
    __m256d even = _mm256_castps_pd(snow_avx2_fold(v[0], v[2]));
    __m256d odd = _mm256_castps_pd(snow_avx2_fold(v[1], v[3]));
    return _mm256_add_ps(_mm256_castpd_ps(_mm256_unpacklo_pd(even, odd)),
                         _mm256_castpd_ps(_mm256_unpackhi_pd(even, odd)));
}

SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_gather4(const float *p,
                                                 const uint32_t *n) {
    return _mm256_insertf128_ps(
        _mm256_castps128_ps256(_mm_loadu_ps(p + (size_t)n[0] * 4)),
        _mm_loadu_ps(p + (size_t)n[1] * 4), 1);
}

/* The pair of floats at index n[i], twice. */
SNOW_AVX2_INLINE __m256d snow_avx2_pair(const float *p, const uint32_t *n,
                                        int i) {
    return _mm256_broadcast_sd(
        (const double *)(const void *)(p + (size_t)n[i] * 2));
}

SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_gather2(const float *p,
                                                 const uint32_t *n) {
    __m256d low =
        _mm256_blend_pd(snow_avx2_pair(p, n, 0), snow_avx2_pair(p, n, 1), 2);
    __m256d high =
        _mm256_blend_pd(snow_avx2_pair(p, n, 2), snow_avx2_pair(p, n, 3), 8);
    return _mm256_castpd_ps(_mm256_blend_pd(low, high, 12));
}

/* Two pixels and those behind them, or two runs of four floats. */
SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_halves(const float *low,
                                                const float *high) {
    return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(low)),
                                _mm_loadu_ps(high), 1);
}

SNOW_AVX2_INLINE void snow_avx2_load_pairs2(const float *p, const int64_t *at,
                                            snow_avx2_vec *left,
                                            snow_avx2_vec *right) {
    __m256d a = _mm256_castps_pd(snow_avx2_halves(p + at[0], p + at[2]));
    __m256d b = _mm256_castps_pd(snow_avx2_halves(p + at[1], p + at[3]));
    *left = _mm256_castpd_ps(_mm256_unpacklo_pd(a, b));
    *right = _mm256_castpd_ps(_mm256_unpackhi_pd(a, b));
}

SNOW_AVX2_INLINE void snow_avx2_load_pairs4(const float *p, const int64_t *at,
                                            snow_avx2_vec *left,
                                            snow_avx2_vec *right) {
    *left = snow_avx2_halves(p + at[0], p + at[1]);
    *right = snow_avx2_halves(p + at[0] + 4, p + at[1] + 4);
}

SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_fractions1(const uint64_t *p) {
    const float *halves = (const float *)(const void *)p;
    __m256i v = _mm256_castps_si256(_mm256_shuffle_ps(
        _mm256_loadu_ps(halves), _mm256_loadu_ps(halves + 8), 0x88));
    return snow_avx2_fraction(_mm256_permute4x64_epi64(v, 0xD8));
}

SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_fractions2(const uint64_t *p) {
    __m256i v = _mm256_loadu_si256((const __m256i *)(const void *)p);
    return snow_avx2_fraction(_mm256_shuffle_epi32(v, 0xA0));
}

SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_fractions4(const uint64_t *p) {
    __m256i v = _mm256_castsi128_si256(
        _mm_loadu_si128((const __m128i *)(const void *)p));
    return snow_avx2_fraction(
        _mm256_shuffle_epi32(_mm256_permute4x64_epi64(v, 0x50), 0xA0));
}

SNOW_AVX2_INLINE void snow_avx2_scatter4(float *p, const uint32_t *n,
                                         snow_avx2_vec v) {
    _mm_storeu_ps(p + (size_t)n[0] * 4, _mm256_castps256_ps128(v));
    _mm_storeu_ps(p + (size_t)n[1] * 4, _mm256_extractf128_ps(v, 1));
}

/* Four 64-bit values: a bit for each with a set bit. */
SNOW_AVX2_INLINE unsigned snow_avx2_any_of(__m256d v) {
    const __m256i numbers = _mm256_set1_epi32(0x7fffffff);
    __m256i none =
        _mm256_cmpeq_epi64(_mm256_and_si256(_mm256_castpd_si256(v), numbers),
                           _mm256_setzero_si256());
    return (unsigned)_mm256_movemask_pd(_mm256_castsi256_pd(none)) ^ 15;
}

SNOW_AVX2_INLINE unsigned snow_avx2_nonzero4(const float *p) {
    unsigned bits = 0;
    for (int i = 0; i < 16; i += 4, p += 16) {
        __m256d a = _mm256_castps_pd(_mm256_loadu_ps(p));
        __m256d b = _mm256_castps_pd(_mm256_loadu_ps(p + 8));
        /* Halves of pixels a0 b0 a1 b1, then a0 a1 b0 b1. */
        __m256d both =
            _mm256_or_pd(_mm256_unpacklo_pd(a, b), _mm256_unpackhi_pd(a, b));
        bits |= snow_avx2_any_of(_mm256_permute4x64_pd(both, 0xD8)) << i;
    }
    return bits;
}

SNOW_AVX2_INLINE unsigned snow_avx2_some2(const float *p) {
    unsigned bits = 0;
    for (int i = 0; i < 16; i += 4)
        bits |= snow_avx2_any_of(_mm256_castps_pd(_mm256_loadu_ps(p + 2 * i)))
                << i;
    return bits;
}

/* Eight bits at a time: expanded to bytes they select from the bytes 0 to 7. */
SNOW_AVX2_INLINE int snow_avx2_list(uint64_t bits, uint32_t *n) {
    uint32_t *const begin = n;
    for (int at = 0; at < 64; at += 8, bits >>= 8) {
        uint64_t bytes =
            _pdep_u64(bits, UINT64_C(0x0101010101010101)) * UINT64_C(0xFF);
        uint64_t picked = _pext_u64(UINT64_C(0x0706050403020100), bytes);
        __m256i places =
            _mm256_cvtepu8_epi32(_mm_cvtsi64_si128((long long)picked));
        _mm256_storeu_si256((__m256i *)(void *)n,
                            _mm256_add_epi32(places, _mm256_set1_epi32(at)));
        n += __builtin_popcount((unsigned)bits & 0xFF);
    }
    return (int)(n - begin);
}

/* Two pixels of two floats. */
SNOW_AVX2_INLINE void snow_avx2_scatter_pair(float *p, const uint32_t *n,
                                             __m128 v) {
    _mm_storel_pi((__m64 *)(void *)(p + (size_t)n[0] * 2), v);
    _mm_storeh_pi((__m64 *)(void *)(p + (size_t)n[1] * 2), v);
}

SNOW_AVX2_INLINE void snow_avx2_scatter2(float *p, const uint32_t *n,
                                         snow_avx2_vec v) {
    snow_avx2_scatter_pair(p, n, _mm256_castps256_ps128(v));
    snow_avx2_scatter_pair(p, n + 2, _mm256_extractf128_ps(v, 1));
}

#endif
