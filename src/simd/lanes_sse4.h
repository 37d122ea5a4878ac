/* simd/lanes_sse4.h - eight numbers of 16 bits by SSE4.1, which x86 processors
 * have since 2008; simd/rows_v128.h makes rows of them. */
#ifndef SNOW_LANES_SSE4_H
#define SNOW_LANES_SSE4_H

#include "simd/rows_scalar.h"

#include <immintrin.h>

#define SNOW_V128_TARGET __attribute__((target("sse4.1,popcnt")))
#define SNOW_LANES_INLINE SNOW_V128_TARGET static inline

#define SNOW_LANES_OF(name, of)                                \
    SNOW_LANES_INLINE snow_scalar_eighth snow_lanes_##name(    \
        snow_scalar_eighth a, snow_scalar_eighth b) {          \
        return (snow_scalar_eighth)of((__m128i)a, (__m128i)b); \
    }
SNOW_LANES_OF(adds, _mm_adds_epi16)
SNOW_LANES_OF(subs, _mm_subs_epi16)
SNOW_LANES_OF(mulhrs, _mm_mulhrs_epi16)
SNOW_LANES_OF(min, _mm_min_epi16)
SNOW_LANES_OF(max, _mm_max_epi16)
#undef SNOW_LANES_OF

SNOW_LANES_INLINE snow_scalar_eighth snow_lanes_avg(snow_scalar_eighth a,
                                                    snow_scalar_eighth b) {
    const __m128i sign = _mm_set1_epi16(INT16_MIN);
    return (snow_scalar_eighth)_mm_xor_si128(
        sign, _mm_avg_epu16(_mm_xor_si128((__m128i)a, sign),
                            _mm_xor_si128((__m128i)b, sign)));
}

/* A bit for each number of both where a > b. */
SNOW_LANES_INLINE uint32_t snow_lanes_gt(const snow_scalar_eighth a[2],
                                         const snow_scalar_eighth b[2]) {
    return (uint32_t)_mm_movemask_epi8(
        _mm_packs_epi16((__m128i)(a[0] > b[0]), (__m128i)(a[1] > b[1])));
}

/* Bytes `from` of a; 0 where there is none. */
SNOW_LANES_INLINE snow_scalar_eighth snow_lanes_shuffle(snow_scalar_eighth a,
                                                        const uint8_t *from) {
    return (snow_scalar_eighth)_mm_shuffle_epi8(
        (__m128i)a, _mm_loadu_si128((const __m128i *)from));
}

/* Four numbers at p, and back: row_floats and row_round. */
SNOW_LANES_INLINE snow_scalar_vec snow_lanes_floats(const int16_t *p) {
    return (snow_scalar_vec)_mm_cvtepi32_ps(
        _mm_cvtepi16_epi32(_mm_loadl_epi64((const __m128i *)p)));
}

SNOW_LANES_INLINE void snow_lanes_widen(snow_scalar_eighth a,
                                        snow_scalar_vec out[2]) {
    const __m128i v = (__m128i)a;
    out[0] = (snow_scalar_vec)_mm_cvtepi32_ps(_mm_cvtepi16_epi32(v));
    out[1] = (snow_scalar_vec)_mm_cvtepi32_ps(
        _mm_cvtepi16_epi32(_mm_unpackhi_epi64(v, v)));
}

SNOW_LANES_INLINE snow_scalar_eighth snow_lanes_narrow(snow_scalar_vec low,
                                                       snow_scalar_vec high) {
    return (snow_scalar_eighth)_mm_packs_epi32(_mm_cvtps_epi32((__m128)low),
                                               _mm_cvtps_epi32((__m128)high));
}

SNOW_LANES_INLINE void snow_lanes_round(int16_t *p, snow_scalar_vec v) {
    _mm_storel_epi64((__m128i *)p, (__m128i)snow_lanes_narrow(v, v));
}

SNOW_LANES_INLINE snow_scalar_eighth snow_lanes_bytes(const uint8_t *p) {
    return (snow_scalar_eighth)_mm_cvtepu8_epi16(
        _mm_loadl_epi64((const __m128i *)p));
}

/* Takes masks of 32 rows four at a time; rows.h says how. */
SNOW_LANES_INLINE void snow_lanes_window(const uint32_t *low,
                                         const uint32_t *high, int shift,
                                         uint32_t *out) {
    __m128i *to = (__m128i *)out;
    const __m128i right = _mm_srl_epi32(_mm_loadu_si128((const __m128i *)low),
                                        _mm_cvtsi32_si128(shift));
    const __m128i left =
        _mm_sll_epi32(_mm_slli_epi32(_mm_loadu_si128((const __m128i *)high), 1),
                      _mm_cvtsi32_si128(31 - shift));
    _mm_storeu_si128(
        to, _mm_or_si128(_mm_loadu_si128(to), _mm_or_si128(right, left)));
}

SNOW_LANES_INLINE uint32_t snow_lanes_and(uint32_t *a, const uint32_t *b,
                                          uint32_t columns) {
    __m128i *to = (__m128i *)a;
    const __m128i both = _mm_and_si128(
        _mm_and_si128(_mm_loadu_si128(to), _mm_loadu_si128((const __m128i *)b)),
        _mm_set1_epi32((int32_t)columns));
    _mm_storeu_si128(to, both);
    return 15 & ~(uint32_t)_mm_movemask_ps(
                    (__m128)_mm_cmpeq_epi32(both, _mm_setzero_si128()));
}

/* Eight entries of a table of 64 bits, word by word. */
SNOW_LANES_INLINE void snow_lanes_gather(const uint64_t *table,
                                         const uint16_t *at,
                                         snow_scalar_eighth out[4]) {
    __m128i e[8];
    for (int n = 0; n < 8; n++)
        e[n] = _mm_loadl_epi64((const __m128i *)(table + at[n]));
    for (int n = 0; n < 8; n += 4) {
        e[n] = _mm_unpacklo_epi16(e[n], e[n + 2]);
        e[n + 1] = _mm_unpacklo_epi16(e[n + 1], e[n + 3]);
        e[n + 2] = _mm_unpacklo_epi16(e[n], e[n + 1]);
        e[n + 3] = _mm_unpackhi_epi16(e[n], e[n + 1]);
    }
    for (int n = 0; n < 2; n++) {
        out[2 * n] = (snow_scalar_eighth)_mm_unpacklo_epi64(e[2 + n], e[6 + n]);
        out[2 * n + 1] =
            (snow_scalar_eighth)_mm_unpackhi_epi64(e[2 + n], e[6 + n]);
    }
}

#endif
