/* simd/vec_avx512.h - the vector vocabulary for AVX-512 of 2019 (Ice Lake).
 * simd/select.h says what the words mean. */
#ifndef SNOW_VEC_AVX512_H
#define SNOW_VEC_AVX512_H

#include <immintrin.h>

#define SNOW_AVX512_LANES 16
#define SNOW_AVX512_TARGET __attribute__((target("avx2,fma,avx512f,avx512bw,avx512vl,avx512dq,avx512vbmi,avx512vbmi2")))
#define SNOW_AVX512_INLINE \
    static inline __attribute__((always_inline, target("avx2,fma,avx512f,avx512bw,avx512vl,avx512dq,avx512vbmi,avx512vbmi2")))

typedef __m512 snow_avx512_vec;

SNOW_AVX512_INLINE snow_avx512_vec snow_avx512_load(const float *p) {
    return _mm512_loadu_ps(p);
}

SNOW_AVX512_INLINE void snow_avx512_store(float *p, snow_avx512_vec v) {
    _mm512_storeu_ps(p, v);
}

SNOW_AVX512_INLINE snow_avx512_vec snow_avx512_set1(float x) {
    return _mm512_set1_ps(x);
}

SNOW_AVX512_INLINE snow_avx512_vec snow_avx512_add(snow_avx512_vec a, snow_avx512_vec b) {
    return _mm512_add_ps(a, b);
}

SNOW_AVX512_INLINE snow_avx512_vec snow_avx512_sub(snow_avx512_vec a, snow_avx512_vec b) {
    return _mm512_sub_ps(a, b);
}

SNOW_AVX512_INLINE snow_avx512_vec snow_avx512_mul(snow_avx512_vec a, snow_avx512_vec b) {
    return _mm512_mul_ps(a, b);
}

SNOW_AVX512_INLINE snow_avx512_vec snow_avx512_min(snow_avx512_vec a, snow_avx512_vec b) {
    return _mm512_min_ps(a, b);
}

SNOW_AVX512_INLINE snow_avx512_vec snow_avx512_max(snow_avx512_vec a, snow_avx512_vec b) {
    return _mm512_max_ps(a, b);
}

SNOW_AVX512_INLINE snow_avx512_vec snow_avx512_fma(snow_avx512_vec a, snow_avx512_vec b, snow_avx512_vec c) {
    return _mm512_fmadd_ps(a, b, c);
}

SNOW_AVX512_INLINE snow_avx512_vec snow_avx512_alpha2(snow_avx512_vec v) {
    return _mm512_permute_ps(v, 0xF5);
}

SNOW_AVX512_INLINE snow_avx512_vec snow_avx512_alpha4(snow_avx512_vec v) {
    return _mm512_permute_ps(v, 0xFF);
}

SNOW_AVX512_INLINE int snow_avx512_any_less(snow_avx512_vec a,
                                            snow_avx512_vec b) {
    return _mm512_cmp_ps_mask(a, b, _CMP_LT_OQ) != 0;
}

#endif
