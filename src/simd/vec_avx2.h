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

#define V(word) snow_avx2_##word
#define M(word) _mm256_##word
#define INLINE SNOW_AVX2_INLINE
#include "simd/vec_avx.tmpl.h"

SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_deinterleave2(snow_avx2_vec a,
                                                       snow_avx2_vec b) {
    __m256d low = _mm256_unpacklo_pd(_mm256_castps_pd(a), _mm256_castps_pd(b));
    return _mm256_castpd_ps(_mm256_permute4x64_pd(low, 0xD8));
}

SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_deinterleave4(snow_avx2_vec a,
                                                       snow_avx2_vec b) {
    return _mm256_permute2f128_ps(a, b, 0x20);
}

SNOW_AVX2_INLINE void snow_avx2_interleave2(snow_avx2_vec a, snow_avx2_vec b,
                                            float *p) {
    __m256d low = _mm256_unpacklo_pd(_mm256_castps_pd(a), _mm256_castps_pd(b));
    __m256d high = _mm256_unpackhi_pd(_mm256_castps_pd(a), _mm256_castps_pd(b));
    _mm256_storeu_ps(p,
                     _mm256_castpd_ps(_mm256_permute2f128_pd(low, high, 0x20)));
    _mm256_storeu_ps(p + 8,
                     _mm256_castpd_ps(_mm256_permute2f128_pd(low, high, 0x31)));
}

SNOW_AVX2_INLINE void snow_avx2_interleave4(snow_avx2_vec a, snow_avx2_vec b,
                                            float *p) {
    _mm256_storeu_ps(p, _mm256_permute2f128_ps(a, b, 0x20));
    _mm256_storeu_ps(p + 8, _mm256_permute2f128_ps(a, b, 0x31));
}

SNOW_AVX2_INLINE snow_scalar_vec snow_avx2_hadd4(snow_avx2_vec v) {
    return (snow_scalar_vec)_mm_add_ps(_mm256_castps256_ps128(v),
                                       _mm256_extractf128_ps(v, 1));
}

SNOW_AVX2_INLINE snow_scalar_vec snow_avx2_hadd2(snow_avx2_vec v) {
    __m128 sum = (__m128)snow_avx2_hadd4(v);
    return (snow_scalar_vec)_mm_add_ps(sum, _mm_movehl_ps(sum, sum));
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

SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_with_alpha2(snow_avx2_vec a,
                                                     snow_avx2_vec b) {
    return _mm256_blend_ps(a, b, 0xAA);
}

SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_with_alpha4(snow_avx2_vec a,
                                                     snow_avx2_vec b) {
    return _mm256_blend_ps(a, b, 0x88);
}

SNOW_VEC_EXPAND(SNOW_AVX2_INLINE, avx2, 8, uint8_t)
SNOW_VEC_EXPAND(SNOW_AVX2_INLINE, avx2, 16, uint16_t)

SNOW_AVX2_INLINE unsigned snow_avx2_windows(const uint64_t *low,
                                            const uint64_t *high,
                                            unsigned shift, uint64_t within,
                                            uint64_t *out) {
    __m128i right = _mm_cvtsi32_si128((int)shift);
    __m128i left = _mm_cvtsi32_si128((int)(64 - shift)); /* 64 gives 0 */
    __m256i wanted = _mm256_set1_epi64x((long long)within);
    unsigned found = 0;
    for (int i = 0; i < 8; i += 4) {
        __m256i a =
            _mm256_loadu_si256((const __m256i *)(const void *)(low + i));
        __m256i b =
            _mm256_loadu_si256((const __m256i *)(const void *)(high + i));
        a = _mm256_or_si256(_mm256_srl_epi64(a, right),
                            _mm256_sll_epi64(b, left));
        a = _mm256_and_si256(a, wanted);
        _mm256_storeu_si256((__m256i *)(void *)(out + i), a);
        __m256i none = _mm256_cmpeq_epi64(a, _mm256_setzero_si256());
        int empty = _mm256_movemask_pd(_mm256_castsi256_pd(none));
        found |= ((unsigned)empty ^ 15) << i;
    }
    return found;
}

SNOW_AVX2_INLINE void snow_avx2_widen8(const uint8_t *p, uint32_t *out) {
    for (int i = 0; i < 16; i += 8)
        _mm256_storeu_si256((__m256i *)(void *)(out + i),
                            _mm256_cvtepu8_epi32(_mm_loadl_epi64(
                                (const __m128i *)(const void *)(p + i))));
}

SNOW_AVX2_INLINE void snow_avx2_widen16(const uint16_t *p, uint32_t *out) {
    for (int i = 0; i < 16; i += 8)
        _mm256_storeu_si256((__m256i *)(void *)(out + i),
                            _mm256_cvtepu16_epi32(_mm_loadu_si128(
                                (const __m128i *)(const void *)(p + i))));
}

SNOW_AVX2_INLINE void snow_avx2_pairs16(const uint32_t *p, const uint32_t *n,
                                        float *first, float *second) {
    for (int i = 0; i < 16; i += 8) {
        __m256i places =
            _mm256_loadu_si256((const __m256i *)(const void *)(n + i));
        __m256i pairs =
            _mm256_i32gather_epi32((const int *)(const void *)p, places, 4);
        _mm256_storeu_ps(first + i, _mm256_cvtepi32_ps(_mm256_and_si256(
                                        pairs, _mm256_set1_epi32(0xFFFF))));
        _mm256_storeu_ps(second + i,
                         _mm256_cvtepi32_ps(_mm256_srli_epi32(pairs, 16)));
    }
}

/* The next lanes of p where a byte of `bytes`, all ones or zeros, has ones. */
SNOW_AVX2_INLINE __m256 snow_avx2_next_lanes(const float *p, uint64_t bytes) {
    uint64_t lanes = _pdep_u64(UINT64_C(0x0706050403020100), bytes);
    __m256i n = _mm256_cvtepu8_epi32(_mm_cvtsi64_si128((long long)lanes));
    __m256i here = _mm256_cvtepi8_epi32(_mm_cvtsi64_si128((long long)bytes));
    return _mm256_and_ps(_mm256_permutevar8x32_ps(_mm256_loadu_ps(p), n),
                         _mm256_castsi256_ps(here));
}

SNOW_AVX2_INLINE void snow_avx2_spread2(const float *p, uint64_t bits,
                                        int count, float *out) {
    for (int at = 0; at < count; at += 4, bits >>= 4) {
        uint64_t bytes = _pdep_u64(bits, UINT64_C(0x0001000100010001)) * 0xFFFF;
        _mm256_storeu_ps(out + 2 * at, snow_avx2_next_lanes(p, bytes));
        p += 2 * __builtin_popcount((unsigned)bits & 0xF);
    }
}

SNOW_AVX2_INLINE void snow_avx2_spread4(const float *p, uint64_t bits,
                                        int count, float *out) {
    for (int at = 0; at < count; at += 2, bits >>= 2) {
        uint64_t bytes =
            _pdep_u64(bits, UINT64_C(0x0000000100000001)) * 0xFFFFFFFF;
        _mm256_storeu_ps(out + 4 * at, snow_avx2_next_lanes(p, bytes));
        p += 4 * __builtin_popcount((unsigned)bits & 3);
    }
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

SNOW_AVX2_INLINE int snow_avx2_any_less(snow_avx2_vec a, snow_avx2_vec b) {
    return _mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_LT_OQ)) != 0;
}

SNOW_AVX2_INLINE uint64_t snow_avx2_least4(snow_avx2_vec v) {
    v = _mm256_min_ps(v, _mm256_permute_ps(v, 0xB1));
    v = _mm256_min_ps(v, _mm256_permute_ps(v, 0x4E));
    __m256i whole = _mm256_cvtps_epi32(v);
    __m128i two = _mm_unpacklo_epi32(_mm256_castsi256_si128(whole),
                                     _mm256_extracti128_si256(whole, 1));
    return (uint32_t)_mm_cvtsi128_si32(
        _mm_packus_epi32(two, _mm_setzero_si128()));
}

/* Saturated subtraction gives 0 where a is not above b. */
SNOW_AVX2_INLINE unsigned snow_avx2_above16(const uint16_t *a,
                                            const uint16_t *b) {
    __m256i more =
        _mm256_subs_epu16(_mm256_loadu_si256((const __m256i *)(const void *)a),
                          _mm256_loadu_si256((const __m256i *)(const void *)b));
    __m256i none = _mm256_cmpeq_epi64(more, _mm256_setzero_si256());
    return ~(unsigned)_mm256_movemask_pd(_mm256_castsi256_pd(none)) & 15;
}

SNOW_AVX2_INLINE unsigned snow_avx2_above32(const uint16_t *a,
                                            const uint16_t *b) {
    return snow_avx2_above16(a, b) | snow_avx2_above16(a + 16, b + 16) << 4;
}

SNOW_AVX2_INLINE void snow_avx2_transpose64(const uint8_t *bytes,
                                            uint64_t *out) {
    __m256i low = _mm256_loadu_si256((const __m256i *)(const void *)bytes);
    __m256i high =
        _mm256_loadu_si256((const __m256i *)(const void *)(bytes + 32));
    for (int n = 7; n >= 0; n--) {
        out[n] = (uint32_t)_mm256_movemask_epi8(low) |
                 (uint64_t)(uint32_t)_mm256_movemask_epi8(high) << 32;
        low = _mm256_add_epi8(low, low);
        high = _mm256_add_epi8(high, high);
    }
}

/* k is in the last bits of the float, and is shifted into the exponent. */
SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_power2(snow_avx2_vec v) {
    __m256i k =
        _mm256_add_epi32(_mm256_castps_si256(v), _mm256_set1_epi32(127));
    return _mm256_castsi256_ps(_mm256_slli_epi32(k, 23));
}

typedef __m256i snow_avx2_places;

SNOW_AVX2_INLINE snow_avx2_vec snow_avx2_pick(const float *p,
                                              snow_avx2_places n) {
    return _mm256_permutevar8x32_ps(_mm256_loadu_ps(p), n);
}

SNOW_AVX2_INLINE snow_avx2_places snow_avx2_repeat2(void) {
    return _mm256_setr_epi32(0, 0, 1, 1, 2, 2, 3, 3);
}

SNOW_AVX2_INLINE snow_avx2_places snow_avx2_places2(const int32_t *first) {
    __m256i voxel = _mm256_castsi128_si256(
        _mm_loadu_si128((const __m128i *)(const void *)first));
    voxel = _mm256_sub_epi32(voxel, _mm256_set1_epi32(*first));
    voxel = _mm256_permutevar8x32_epi32(voxel, snow_avx2_repeat2());
    return _mm256_add_epi32(_mm256_slli_epi32(voxel, 1),
                            _mm256_setr_epi32(0, 1, 0, 1, 0, 1, 0, 1));
}

SNOW_AVX2_INLINE snow_avx2_places snow_avx2_repeat4(void) {
    return _mm256_setr_epi32(0, 0, 0, 0, 1, 1, 1, 1);
}

SNOW_AVX2_INLINE snow_avx2_places snow_avx2_places4(const int32_t *first) {
    __m256i voxel = _mm256_castsi128_si256(
        _mm_loadl_epi64((const __m128i *)(const void *)first));
    voxel = _mm256_sub_epi32(voxel, _mm256_set1_epi32(*first));
    voxel = _mm256_permutevar8x32_epi32(voxel, snow_avx2_repeat4());
    return _mm256_add_epi32(_mm256_slli_epi32(voxel, 2),
                            _mm256_setr_epi32(0, 1, 2, 3, 0, 1, 2, 3));
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
