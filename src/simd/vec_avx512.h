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

#define V(word) snow_avx512_##word
#define M(word) _mm512_##word
#define INLINE SNOW_AVX512_INLINE
#include "simd/vec_avx.tmpl.h"

SNOW_AVX512_INLINE snow_avx512_vec
snow_avx512_deinterleave2(snow_avx512_vec a, snow_avx512_vec b) {
    return _mm512_castpd_ps(_mm512_permutex2var_pd(
        _mm512_castps_pd(a), _mm512_setr_epi64(0, 2, 4, 6, 8, 10, 12, 14),
        _mm512_castps_pd(b)));
}

SNOW_AVX512_INLINE snow_avx512_vec
snow_avx512_deinterleave4(snow_avx512_vec a, snow_avx512_vec b) {
    return _mm512_castpd_ps(_mm512_permutex2var_pd(
        _mm512_castps_pd(a), _mm512_setr_epi64(0, 1, 4, 5, 8, 9, 12, 13),
        _mm512_castps_pd(b)));
}

SNOW_AVX512_INLINE void snow_avx512_interleave(snow_avx512_vec a,
                                               snow_avx512_vec b, __m512i low,
                                               __m512i high, float *p) {
    __m512d x = _mm512_castps_pd(a), y = _mm512_castps_pd(b);
    _mm512_storeu_ps(p, _mm512_castpd_ps(_mm512_permutex2var_pd(x, low, y)));
    _mm512_storeu_ps(p + 16,
                     _mm512_castpd_ps(_mm512_permutex2var_pd(x, high, y)));
}

SNOW_AVX512_INLINE void snow_avx512_interleave2(snow_avx512_vec a,
                                                snow_avx512_vec b, float *p) {
    snow_avx512_interleave(a, b, _mm512_setr_epi64(0, 8, 1, 9, 2, 10, 3, 11),
                           _mm512_setr_epi64(4, 12, 5, 13, 6, 14, 7, 15), p);
}

SNOW_AVX512_INLINE void snow_avx512_interleave4(snow_avx512_vec a,
                                                snow_avx512_vec b, float *p) {
    snow_avx512_interleave(a, b, _mm512_setr_epi64(0, 1, 8, 9, 2, 3, 10, 11),
                           _mm512_setr_epi64(4, 5, 12, 13, 6, 7, 14, 15), p);
}

SNOW_AVX512_INLINE snow_scalar_vec snow_avx512_hadd4(snow_avx512_vec v) {
    __m256 half =
        _mm256_add_ps(_mm512_castps512_ps256(v), _mm512_extractf32x8_ps(v, 1));
    return (snow_scalar_vec)_mm_add_ps(_mm256_castps256_ps128(half),
                                       _mm256_extractf128_ps(half, 1));
}

SNOW_AVX512_INLINE snow_scalar_vec snow_avx512_hadd2(snow_avx512_vec v) {
    __m128 sum = (__m128)snow_avx512_hadd4(v);
    return (snow_scalar_vec)_mm_add_ps(sum, _mm_movehl_ps(sum, sum));
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

SNOW_AVX512_INLINE snow_avx512_vec snow_avx512_with_alpha2(snow_avx512_vec a,
                                                           snow_avx512_vec b) {
    return _mm512_mask_blend_ps(0xAAAA, a, b);
}

SNOW_AVX512_INLINE snow_avx512_vec snow_avx512_with_alpha4(snow_avx512_vec a,
                                                           snow_avx512_vec b) {
    return _mm512_mask_blend_ps(0x8888, a, b);
}

SNOW_AVX512_INLINE void snow_avx512_expand8(const uint8_t *p, uint32_t bits,
                                            uint32_t *out) {
    __mmask16 here = (__mmask16)bits;
    __m128i codes = _mm_maskz_expand_epi8(
        here, _mm_loadu_si128((const __m128i *)(const void *)p));
    _mm512_storeu_si512(out, _mm512_maskz_add_epi32(here,
                                                    _mm512_cvtepu8_epi32(codes),
                                                    _mm512_set1_epi32(1)));
}

SNOW_AVX512_INLINE void snow_avx512_expand16(const uint16_t *p, uint32_t bits,
                                             uint32_t *out) {
    __mmask16 here = (__mmask16)bits;
    __m256i codes = _mm256_maskz_expand_epi16(
        here, _mm256_loadu_si256((const __m256i *)(const void *)p));
    _mm512_storeu_si512(
        out, _mm512_maskz_add_epi32(here, _mm512_cvtepu16_epi32(codes),
                                    _mm512_set1_epi32(1)));
}

/* Numbers where a bit is set, scaled. */
SNOW_AVX512_INLINE snow_avx512_vec snow_avx512_scale16(__m512i numbers,
                                                       __mmask16 here,
                                                       float scale,
                                                       float start) {
    __m512 scaled =
        _mm512_mul_ps(_mm512_set1_ps(scale), _mm512_cvtepi32_ps(numbers));
    return _mm512_maskz_add_ps(here, _mm512_set1_ps(start), scaled);
}

SNOW_AVX512_INLINE void snow_avx512_numbers8(const uint8_t *p, uint32_t bits,
                                             float scale, float start,
                                             float *out) {
    __mmask16 here = (__mmask16)bits;
    __m128i numbers = _mm_maskz_expand_epi8(
        here, _mm_loadu_si128((const __m128i *)(const void *)p));
    snow_avx512_store(out, snow_avx512_scale16(_mm512_cvtepu8_epi32(numbers),
                                               here, scale, start));
}

SNOW_AVX512_INLINE void snow_avx512_numbers16(const uint16_t *p, uint32_t bits,
                                              float scale, float start,
                                              float *out) {
    __mmask16 here = (__mmask16)bits;
    __m256i numbers = _mm256_maskz_expand_epi16(
        here, _mm256_loadu_si256((const __m256i *)(const void *)p));
    snow_avx512_store(out, snow_avx512_scale16(_mm512_cvtepu16_epi32(numbers),
                                               here, scale, start));
}

SNOW_AVX512_INLINE void snow_avx512_window8(const uint8_t *p, uint32_t bits,
                                            float scale, float start,
                                            snow_avx512_vec *low,
                                            snow_avx512_vec *high) {
    __m256i numbers = _mm256_maskz_expand_epi8(
        bits, _mm256_loadu_si256((const __m256i *)(const void *)p));
    *low = snow_avx512_scale16(
        _mm512_cvtepu8_epi32(_mm256_castsi256_si128(numbers)), (__mmask16)bits,
        scale, start);
    *high = snow_avx512_scale16(
        _mm512_cvtepu8_epi32(_mm256_extracti128_si256(numbers, 1)),
        (__mmask16)(bits >> 16), scale, start);
}

SNOW_AVX512_INLINE void snow_avx512_window16(const uint16_t *p, uint32_t bits,
                                             float scale, float start,
                                             snow_avx512_vec *low,
                                             snow_avx512_vec *high) {
    __m512i numbers = _mm512_maskz_expand_epi16(bits, _mm512_loadu_si512(p));
    *low = snow_avx512_scale16(
        _mm512_cvtepu16_epi32(_mm512_castsi512_si256(numbers)), (__mmask16)bits,
        scale, start);
    *high = snow_avx512_scale16(
        _mm512_cvtepu16_epi32(_mm512_extracti64x4_epi64(numbers, 1)),
        (__mmask16)(bits >> 16), scale, start);
}

#define snow_avx512_slide(a, b, n)                                  \
    _mm512_castsi512_ps(_mm512_alignr_epi32(_mm512_castps_si512(b), \
                                            _mm512_castps_si512(a), n))

SNOW_AVX512_INLINE unsigned snow_avx512_windows(const uint64_t *low,
                                                const uint64_t *high,
                                                unsigned shift, uint64_t within,
                                                uint64_t *out) {
    __m512i right = _mm512_set1_epi64((long long)shift);
    __m512i window = _mm512_shrdv_epi64(_mm512_loadu_si512(low),
                                        _mm512_loadu_si512(high), right);
    window = _mm512_and_si512(window, _mm512_set1_epi64((long long)within));
    _mm512_storeu_si512(out, window);
    return _mm512_test_epi64_mask(window, window);
}

SNOW_AVX512_INLINE void snow_avx512_widen8(const uint8_t *p, uint32_t *out) {
    _mm512_storeu_si512(out, _mm512_cvtepu8_epi32(_mm_loadu_si128(
                                 (const __m128i *)(const void *)p)));
}

SNOW_AVX512_INLINE void snow_avx512_widen16(const uint16_t *p, uint32_t *out) {
    _mm512_storeu_si512(out, _mm512_cvtepu16_epi32(_mm256_loadu_si256(
                                 (const __m256i *)(const void *)p)));
}

SNOW_AVX512_INLINE void snow_avx512_pairs16(const uint32_t *p,
                                            const uint32_t *n, float *first,
                                            float *second) {
    __m512i pairs = _mm512_i32gather_epi32(_mm512_loadu_si512(n), p, 4);
    _mm512_storeu_ps(first, _mm512_cvtepi32_ps(_mm512_and_si512(
                                pairs, _mm512_set1_epi32(0xFFFF))));
    _mm512_storeu_ps(second, _mm512_cvtepi32_ps(_mm512_srli_epi32(pairs, 16)));
}

SNOW_AVX512_INLINE void snow_avx512_spread2(const float *p, uint64_t bits,
                                            int count, float *out) {
    for (int at = 0; at < count; at += 8, bits >>= 8) {
        _mm512_storeu_pd(out + 2 * at, _mm512_maskz_expand_pd(
                                           (__mmask8)bits, _mm512_loadu_pd(p)));
        p += 2 * __builtin_popcount((unsigned)bits & 0xFF);
    }
}

SNOW_AVX512_INLINE void snow_avx512_spread4(const float *p, uint64_t bits,
                                            int count, float *out) {
    for (int at = 0; at < count; at += 4, bits >>= 4) {
        uint32_t lanes = _pdep_u32((uint32_t)bits, 0x1111) * 15;
        _mm512_storeu_ps(
            out + 4 * at,
            _mm512_maskz_expand_ps((__mmask16)lanes, _mm512_loadu_ps(p)));
        p += 4 * __builtin_popcount((unsigned)bits & 0xF);
    }
}

/* Four runs of four floats. */
SNOW_AVX512_INLINE snow_avx512_vec snow_avx512_runs(const float *p,
                                                    const int64_t *at) {
    __m512 v = _mm512_castps128_ps512(_mm_loadu_ps(p + at[0]));
    v = _mm512_insertf32x4(v, _mm_loadu_ps(p + at[1]), 1);
    v = _mm512_insertf32x4(v, _mm_loadu_ps(p + at[2]), 2);
    return _mm512_insertf32x4(v, _mm_loadu_ps(p + at[3]), 3);
}

SNOW_AVX512_INLINE void snow_avx512_load_pairs2(const float *p,
                                                const int64_t *at,
                                                snow_avx512_vec *left,
                                                snow_avx512_vec *right) {
    __m512d a = _mm512_castps_pd(snow_avx512_runs(p, at));
    __m512d b = _mm512_castps_pd(snow_avx512_runs(p, at + 4));
    const __m512i even = _mm512_setr_epi64(0, 2, 4, 6, 8, 10, 12, 14);
    const __m512i odd = _mm512_setr_epi64(1, 3, 5, 7, 9, 11, 13, 15);
    *left = _mm512_castpd_ps(_mm512_permutex2var_pd(a, even, b));
    *right = _mm512_castpd_ps(_mm512_permutex2var_pd(a, odd, b));
}

SNOW_AVX512_INLINE void snow_avx512_load_pairs4(const float *p,
                                                const int64_t *at,
                                                snow_avx512_vec *left,
                                                snow_avx512_vec *right) {
    *left = snow_avx512_runs(p, at);
    *right = snow_avx512_runs(p + 4, at);
}

SNOW_AVX512_INLINE int snow_avx512_any_less(snow_avx512_vec a,
                                            snow_avx512_vec b) {
    return _mm512_cmp_ps_mask(a, b, _CMP_LT_OQ) != 0;
}

SNOW_AVX512_INLINE uint64_t snow_avx512_least4(snow_avx512_vec v) {
    v = _mm512_min_ps(v, _mm512_permute_ps(v, 0xB1));
    v = _mm512_min_ps(v, _mm512_permute_ps(v, 0x4E));
    const __m512i fourth = _mm512_castsi128_si512(_mm_setr_epi32(0, 4, 8, 12));
    __m512i four = _mm512_permutexvar_epi32(fourth, _mm512_cvtps_epi32(v));
    return (uint64_t)_mm_cvtsi128_si64(
        _mm_packus_epi32(_mm512_castsi512_si128(four), _mm_setzero_si128()));
}

SNOW_AVX512_INLINE unsigned snow_avx512_above32(const uint16_t *a,
                                                const uint16_t *b) {
    __m512i more =
        _mm512_subs_epu16(_mm512_loadu_si512(a), _mm512_loadu_si512(b));
    return _mm512_test_epi64_mask(more, more);
}

SNOW_AVX512_INLINE void snow_avx512_transpose64(const uint8_t *bytes,
                                                uint64_t *out) {
    __m512i all = _mm512_loadu_si512(bytes);
    for (int n = 0; n < 8; n++)
        out[n] = _mm512_test_epi8_mask(all, _mm512_set1_epi8((char)(1 << n)));
}

/* k is in the last bits of the float, and is shifted into the exponent. */
SNOW_AVX512_INLINE snow_avx512_vec snow_avx512_power2(snow_avx512_vec v) {
    __m512i k =
        _mm512_add_epi32(_mm512_castps_si512(v), _mm512_set1_epi32(127));
    return _mm512_castsi512_ps(_mm512_slli_epi32(k, 23));
}

typedef __m512i snow_avx512_places;

SNOW_AVX512_INLINE snow_avx512_vec snow_avx512_pick(const float *p,
                                                    snow_avx512_places n) {
    return _mm512_permutexvar_ps(n, _mm512_loadu_ps(p));
}

SNOW_AVX512_INLINE snow_avx512_places snow_avx512_repeat2(void) {
    return _mm512_setr_epi32(0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7);
}

SNOW_AVX512_INLINE snow_avx512_places
snow_avx512_places2(const int32_t *first) {
    __m512i voxel = _mm512_castsi256_si512(
        _mm256_loadu_si256((const __m256i *)(const void *)first));
    voxel = _mm512_sub_epi32(voxel, _mm512_set1_epi32(*first));
    voxel = _mm512_permutexvar_epi32(snow_avx512_repeat2(), voxel);
    return _mm512_add_epi32(
        _mm512_slli_epi32(voxel, 1),
        _mm512_setr_epi32(0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1));
}

SNOW_AVX512_INLINE snow_avx512_places snow_avx512_repeat4(void) {
    return _mm512_setr_epi32(0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3);
}

SNOW_AVX512_INLINE snow_avx512_places
snow_avx512_places4(const int32_t *first) {
    __m512i voxel = _mm512_castsi128_si512(
        _mm_loadu_si128((const __m128i *)(const void *)first));
    voxel = _mm512_sub_epi32(voxel, _mm512_set1_epi32(*first));
    voxel = _mm512_permutexvar_epi32(snow_avx512_repeat4(), voxel);
    return _mm512_add_epi32(
        _mm512_slli_epi32(voxel, 2),
        _mm512_setr_epi32(0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3));
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
