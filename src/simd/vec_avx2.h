/* simd/vec_avx2.h - the vector vocabulary for AVX2 with FMA.
 * simd/select.h says what the words mean. */
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

SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_load(const float *p) {
    return _mm256_loadu_ps(p);
}

SNOW_AVX2_INLINE void snow_avx2_store(float *p, snow_avx2_vec v) {
    _mm256_storeu_ps(p, v);
}

SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_set1(float x) {
    return _mm256_set1_ps(x);
}

SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_add(snow_avx2_vec a, snow_avx2_vec b) {
    return _mm256_add_ps(a, b);
}

SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_sub(snow_avx2_vec a, snow_avx2_vec b) {
    return _mm256_sub_ps(a, b);
}

SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_mul(snow_avx2_vec a, snow_avx2_vec b) {
    return _mm256_mul_ps(a, b);
}

SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_min(snow_avx2_vec a, snow_avx2_vec b) {
    return _mm256_min_ps(a, b);
}

SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_max(snow_avx2_vec a, snow_avx2_vec b) {
    return _mm256_max_ps(a, b);
}

SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_fma(snow_avx2_vec a, snow_avx2_vec b,
                                             snow_avx2_vec c) {
    return _mm256_fmadd_ps(a, b, c);
}

SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_fnma(snow_avx2_vec a, snow_avx2_vec b,
                                              snow_avx2_vec c) {
    return _mm256_fnmadd_ps(a, b, c);
}

SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_alpha2(snow_avx2_vec v) {
    return _mm256_permute_ps(v, 0xF5);
}

SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_alpha4(snow_avx2_vec v) {
    return _mm256_permute_ps(v, 0xFF);
}

SNOW_AVX2_INLINE void snow_avx2_weave2(snow_avx2_vec a, snow_avx2_vec b,
                                       float *p) {
    __m256d low = _mm256_unpacklo_pd(_mm256_castps_pd(a), _mm256_castps_pd(b));
    __m256d high = _mm256_unpackhi_pd(_mm256_castps_pd(a), _mm256_castps_pd(b));
    _mm256_storeu_ps(p,
                     _mm256_castpd_ps(_mm256_permute2f128_pd(low, high, 0x20)));
    _mm256_storeu_ps(p + 8,
                     _mm256_castpd_ps(_mm256_permute2f128_pd(low, high, 0x31)));
}

SNOW_AVX2_INLINE void snow_avx2_weave4(snow_avx2_vec a, snow_avx2_vec b,
                                       float *p) {
    _mm256_storeu_ps(p, _mm256_permute2f128_ps(a, b, 0x20));
    _mm256_storeu_ps(p + 8, _mm256_permute2f128_ps(a, b, 0x31));
}

SNOW_AVX2_INLINE snow_scalar_vec snow_avx2_fold4(snow_avx2_vec v) {
    return (snow_scalar_vec)_mm_add_ps(_mm256_castps256_ps128(v),
                                       _mm256_extractf128_ps(v, 1));
}

SNOW_AVX2_INLINE snow_scalar_vec snow_avx2_fold2(snow_avx2_vec v) {
    __m128 sum = (__m128)snow_avx2_fold4(v);
    return (snow_scalar_vec)_mm_add_ps(sum, _mm_movehl_ps(sum, sum));
}

SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_gather4(const float *p,
                                                 const uint32_t *n) {
    return _mm256_insertf128_ps(
        _mm256_castps128_ps256(_mm_loadu_ps(p + (size_t)n[0] * 4)),
        _mm_loadu_ps(p + (size_t)n[1] * 4), 1);
}

/* The pair of floats with number n[i], twice. */
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

SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_double2(const float *p,
                                                 const uint32_t *n) {
    return _mm256_castpd_ps(
        _mm256_blend_pd(snow_avx2_pair(p, n, 0), snow_avx2_pair(p, n, 1), 12));
}

SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_even(snow_avx2_vec v) {
    return _mm256_moveldup_ps(v);
}

SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_odd(snow_avx2_vec v) {
    return _mm256_movehdup_ps(v);
}

SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_with_alpha2(snow_avx2_vec a,
                                                     snow_avx2_vec b) {
    return _mm256_blend_ps(a, b, 0xAA);
}

SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_with_alpha4(snow_avx2_vec a,
                                                     snow_avx2_vec b) {
    return _mm256_blend_ps(a, b, 0x88);
}

SNOW_AVX2_INLINE void snow_avx2_expand8(const uint8_t *p, uint32_t bits,
                                        uint32_t *out) {
    for (int i = 0; i < 16; i++, bits >>= 1) {
        uint32_t here = bits & 1;
        out[i] = ((uint32_t)*p + 1) & (0 - here);
        p += here;
    }
}

SNOW_AVX2_INLINE void snow_avx2_expand16(const uint16_t *p, uint32_t bits,
                                         uint32_t *out) {
    for (int i = 0; i < 16; i++, bits >>= 1) {
        uint32_t here = bits & 1;
        out[i] = ((uint32_t)*p + 1) & (0 - here);
        p += here;
    }
}

SNOW_AVX2_INLINE int snow_avx2_popcount(uint64_t x) {
    return __builtin_popcountll(x);
}

SNOW_AVX2_INLINE int snow_avx2_any_less(snow_avx2_vec a, snow_avx2_vec b) {
    return _mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_LT_OQ)) != 0;
}

SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_sqrt(snow_avx2_vec v) {
    return _mm256_sqrt_ps(v);
}

/* k is in the last bits of the float, and shifted into the exponent. */
SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_power2(snow_avx2_vec v) {
    __m256i k = _mm256_add_epi32(_mm256_castps_si256(v), _mm256_set1_epi32(127));
    return _mm256_castsi256_ps(_mm256_slli_epi32(k, 23));
}

typedef __m256i snow_avx2_places;

SNOW_AVX2_INLINE snow_avx2_places snow_avx2_places_of(const int32_t *p) {
    return _mm256_loadu_si256((const __m256i *)(const void *)p);
}

SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_pick(const float *p,
                                              snow_avx2_places n) {
    return _mm256_permutevar8x32_ps(_mm256_loadu_ps(p), n);
}

#endif
