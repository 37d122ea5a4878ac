/* splat/gather_vec.h - the vector operations that the gather form of splatting
 * needs beyond simd/select.h: integers, and blocks of voxels.
 *
 *   V(ints)          as many 32-bit integers as a vector has floats
 *   V(lanes)()       0, 1, 2 ...
 *   V(floor)(v), V(to_ints)(v) (towards 0), V(to_floats)(i)
 *   V(add_int)(i, n), V(times)(i, n), V(clamp)(i, low, high)
 *   V(place)(i, i_step, j, j_step)   i * i_step + j * j_step
 *   V(store_ints)(p, i)
 *   V(deal)(v), V(store_fours)(p, a, b, c, d)   of values made from a vector
 *                                that was dealt, the first lane's a b c d, then
 *                                the second's, and so on
 *   V(bits)(map, words, i, j)    bit i of row j, rows of `words` words, of all
 *                                lanes as a mask, the first lane lowest
 *
 * A footprint's row is gathered in blocks of 8 or 16 floats; below AVX-512, 16
 * floats are a pair of vectors. B(word) selects the type:
 *
 *   B(block)               the type
 *   B(load)(p), B(scale)(s, b), B(more)(s, b, c) is s b + c
 *   B(zero)(), B(fma)(a, b, c)
 *   B(pairs)(p)            the weights of 4 voxels, each twice (8 floats)
 *   B(fours)(p)            the weights of 2 or 4 voxels, each 4 times
 *   B(fold)(b)             the four floats that remain when halves are added
 *   B(fold_four)(b, p)     the same of b[0] to b[3], stored */
#ifndef SNOW_SPLAT_GATHER_VEC_H
#define SNOW_SPLAT_GATHER_VEC_H

#include "simd/isa.h"

#if SNOW_HAS_AVX
#define SELECT_AVX2
#include "simd/select.h"

typedef __m256i snow_avx2_ints;

#define M(word) _mm256_##word
#define INLINE SNOW_AVX2_INLINE
#define PAIRS __m256d
#define B(word) snow_b8_##word
#include "splat/gather_vec.tmpl.h"

SNOW_AVX2_INLINE __m256 snow_avx2_lanes(void) {
    return _mm256_setr_ps(0, 1, 2, 3, 4, 5, 6, 7);
}

SNOW_AVX2_INLINE __m256 snow_avx2_floor(__m256 v) {
    return _mm256_floor_ps(v);
}

SNOW_AVX2_INLINE void snow_avx2_store_ints(int32_t *p, __m256i i) {
    _mm256_storeu_si256((__m256i *)(void *)p, i);
}

/* Lane 4 l + k of the result is lane 2 k + l: transposing within halves then
 * leaves lanes 2 k and 2 k + 1 in vector k. */
SNOW_AVX2_INLINE __m256 snow_avx2_deal(__m256 v) {
    return _mm256_permutevar8x32_ps(v,
                                    _mm256_setr_epi32(0, 2, 4, 6, 1, 3, 5, 7));
}

SNOW_AVX2_INLINE unsigned snow_avx2_bits(const uint32_t *map, int words,
                                         __m256i i, __m256i j) {
    __m256i at = snow_avx2_place(_mm256_srli_epi32(i, 5), 1, j, words);
    __m256i word =
        _mm256_i32gather_epi32((const int *)(const void *)map, at, 4);
    __m256i left = _mm256_sub_epi32(_mm256_set1_epi32(31),
                                    _mm256_and_si256(i, _mm256_set1_epi32(31)));
    __m256i bit = _mm256_sllv_epi32(word, left); /* to the sign */
    return (unsigned)_mm256_movemask_ps(_mm256_castsi256_ps(bit));
}

#define SELECT_AVX512
#include "simd/select.h"

typedef __m512i snow_avx512_ints;

#define M(word) _mm512_##word
#define INLINE SNOW_AVX512_INLINE
#define PAIRS __m512d
#define B(word) snow_b16_##word
#include "splat/gather_vec.tmpl.h"

SNOW_AVX512_INLINE __m512 snow_avx512_lanes(void) {
    return _mm512_setr_ps(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
}

SNOW_AVX512_INLINE __m512 snow_avx512_floor(__m512 v) {
    return _mm512_roundscale_ps(v, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC);
}

SNOW_AVX512_INLINE void snow_avx512_store_ints(int32_t *p, __m512i i) {
    _mm512_storeu_si512(p, i);
}

/* The same for quarters: lane 4 l + k of the result is lane 4 k + l. */
SNOW_AVX512_INLINE __m512 snow_avx512_deal(__m512 v) {
    return _mm512_permutexvar_ps(
        _mm512_setr_epi32(0, 4, 8, 12, 1, 5, 9, 13, 2, 6, 10, 14, 3, 7, 11, 15),
        v);
}

SNOW_AVX512_INLINE unsigned snow_avx512_bits(const uint32_t *map, int words,
                                             __m512i i, __m512i j) {
    __m512i at = snow_avx512_place(_mm512_srli_epi32(i, 5), 1, j, words);
    __m512i word = _mm512_i32gather_epi32(at, map, 4);
    __m512i bit = _mm512_and_si512(i, _mm512_set1_epi32(31));
    return _mm512_test_epi32_mask(word,
                                  _mm512_sllv_epi32(_mm512_set1_epi32(1), bit));
}

/* --- blocks of 8 floats --------------------------------------------------- */

SNOW_AVX2_INLINE __m256 snow_b8_pairs(const float *p) {
    return _mm256_permutevar_ps(
        _mm256_broadcast_ps((const __m128 *)(const void *)p),
        _mm256_setr_epi32(0, 0, 1, 1, 2, 2, 3, 3));
}

SNOW_AVX2_INLINE __m256 snow_b8_fours(const float *p) {
    return _mm256_permutevar_ps(
        _mm256_broadcast_ps((const __m128 *)(const void *)p),
        _mm256_setr_epi32(0, 0, 0, 0, 1, 1, 1, 1));
}

SNOW_AVX2_INLINE __m128 snow_b8_fold(__m256 b) {
    return _mm_add_ps(_mm256_castps256_ps128(b), _mm256_extractf128_ps(b, 1));
}

SNOW_AVX2_INLINE __m256 snow_b8_fold_two(__m256 a, __m256 b) {
    return _mm256_add_ps(_mm256_permute2f128_ps(a, b, 0x20),
                         _mm256_permute2f128_ps(a, b, 0x31));
}

SNOW_AVX2_INLINE void snow_b8_fold_four(const __m256 b[4], float *p) {
    _mm256_storeu_ps(p, snow_b8_fold_two(b[0], b[1]));
    _mm256_storeu_ps(p + 8, snow_b8_fold_two(b[2], b[3]));
}

/* --- blocks of 16 floats, as pairs ---------------------------------------- */

typedef struct snow_p16_block {
    __m256 low, high;
} snow_p16_block;

SNOW_AVX2_INLINE snow_p16_block snow_p16_load(const float *p) {
    return (snow_p16_block){_mm256_loadu_ps(p), _mm256_loadu_ps(p + 8)};
}

SNOW_AVX2_INLINE snow_p16_block snow_p16_scale(float s, snow_p16_block b) {
    return (snow_p16_block){snow_b8_scale(s, b.low), snow_b8_scale(s, b.high)};
}

SNOW_AVX2_INLINE snow_p16_block snow_p16_more(float s, snow_p16_block b,
                                              snow_p16_block c) {
    return (snow_p16_block){snow_b8_more(s, b.low, c.low),
                            snow_b8_more(s, b.high, c.high)};
}

SNOW_AVX2_INLINE snow_p16_block snow_p16_zero(void) {
    return (snow_p16_block){_mm256_setzero_ps(), _mm256_setzero_ps()};
}

SNOW_AVX2_INLINE snow_p16_block snow_p16_fma(snow_p16_block a, snow_p16_block b,
                                             snow_p16_block c) {
    return (snow_p16_block){_mm256_fmadd_ps(a.low, b.low, c.low),
                            _mm256_fmadd_ps(a.high, b.high, c.high)};
}

SNOW_AVX2_INLINE snow_p16_block snow_p16_fours(const float *p) {
    __m256 w = _mm256_broadcast_ps((const __m128 *)(const void *)p);
    return (snow_p16_block){
        _mm256_permutevar_ps(w, _mm256_setr_epi32(0, 0, 0, 0, 1, 1, 1, 1)),
        _mm256_permutevar_ps(w, _mm256_setr_epi32(2, 2, 2, 2, 3, 3, 3, 3))};
}

SNOW_AVX2_INLINE __m128 snow_p16_fold(snow_p16_block b) {
    return snow_b8_fold(_mm256_add_ps(b.low, b.high));
}

SNOW_AVX2_INLINE void snow_p16_fold_four(const snow_p16_block b[4], float *p) {
    __m256 halves[4];
    for (int i = 0; i < 4; i++)
        halves[i] = _mm256_add_ps(b[i].low, b[i].high);
    snow_b8_fold_four(halves, p);
}

/* --- blocks of 16 floats, whole ------------------------------------------- */

SNOW_AVX512_INLINE __m512 snow_b16_fours(const float *p) {
    return _mm512_permutevar_ps(
        _mm512_broadcast_f32x4(_mm_loadu_ps(p)),
        _mm512_setr_epi32(0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3));
}

SNOW_AVX512_INLINE __m128 snow_b16_fold(__m512 b) {
    return snow_b8_fold(
        _mm256_add_ps(_mm512_castps512_ps256(b), _mm512_extractf32x8_ps(b, 1)));
}

/* Quarters 0 + 2 and 1 + 3 of each, as snow_b8_fold adds them, then these. */
SNOW_AVX512_INLINE void snow_b16_fold_four(const __m512 b[4], float *p) {
    __m512 ab = _mm512_add_ps(_mm512_shuffle_f32x4(b[0], b[1], 0x44),
                              _mm512_shuffle_f32x4(b[0], b[1], 0xee));
    __m512 cd = _mm512_add_ps(_mm512_shuffle_f32x4(b[2], b[3], 0x44),
                              _mm512_shuffle_f32x4(b[2], b[3], 0xee));
    _mm512_storeu_ps(p, _mm512_add_ps(_mm512_shuffle_f32x4(ab, cd, 0x88),
                                      _mm512_shuffle_f32x4(ab, cd, 0xdd)));
}

#endif
#endif
