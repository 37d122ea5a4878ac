/* combine/pixels_avx512.h - the loops of pixels.h by compression and expansion:
 * 4 pixels of 4 floats at a time, or 8 of 2.  Both are 8 numbers of 64 bits;
 * `doubled` tells the bits of these for those of pixels. */
#ifndef SNOW_PIXELS_AVX512_H
#define SNOW_PIXELS_AVX512_H

#include "simd/vec_avx512.h"

/* Pixels of a vector. */
#define PER_VECTOR(channels) (16 / (channels))

SNOW_AVX512_INLINE __mmask8 doubled_avx512(uint64_t bits, int channels) {
    return (__mmask8)(channels == 2 ? bits
                                    : _pdep_u32((unsigned)bits, 0x55) * 3);
}

SNOW_AVX512_INLINE uint64_t look_avx512(const float *pixels, int count,
                                        int channels) {
    const __m512i numbers = _mm512_set1_epi32(0x7fffffff); /* all but -0 */
    const int floats = count * channels;
    uint64_t bits = 0;
    for (int at = 0, pixel = 0; at < floats;
         at += 16, pixel += PER_VECTOR(channels)) {
        int left = floats - at;
        __mmask16 there = (__mmask16)(left < 16 ? (1u << left) - 1 : 0xffffu);
        __m512i v = _mm512_maskz_loadu_epi32(there, pixels + at);
        uint32_t any = _mm512_test_epi32_mask(v, numbers);
        any |= any >> 1;
        if (channels == 4)
            any |= any >> 2;
        bits |= (uint64_t)_pext_u32(any, channels == 2 ? 0x5555 : 0x1111)
                << pixel;
    }
    return bits;
}

SNOW_AVX512_INLINE float *pack_avx512(float *out, const float *pixels,
                                      uint64_t bits, int channels) {
    const int each = PER_VECTOR(channels);
    for (; bits; bits >>= each, pixels += 16) {
        const uint64_t some = bits & ((1u << each) - 1);
        __mmask8 mask = doubled_avx512(some, channels);
        __m512d v = _mm512_maskz_loadu_pd(mask, pixels);
        _mm512_storeu_pd(out, _mm512_maskz_compress_pd(mask, v));
        out += _mm_popcnt_u64(some) * channels;
    }
    return out;
}

SNOW_AVX512_INLINE const float *lay_avx512(float *tile, const float *packed,
                                           uint64_t bits, int channels) {
    const int each = PER_VECTOR(channels);
    const __m512 one = _mm512_set1_ps(1);
    for (; bits; bits >>= each, tile += 16) {
        const uint64_t some = bits & ((1u << each) - 1);
        __mmask8 mask = doubled_avx512(some, channels);
        __m512 back = _mm512_castpd_ps(
            _mm512_maskz_expand_pd(mask, _mm512_loadu_pd(packed)));
        __m512 front = _mm512_loadu_ps(tile);
        __m512 opacity = channels == 2 ? _mm512_permute_ps(front, 0xF5)
                                       : _mm512_permute_ps(front, 0xFF);
        __m512 left = _mm512_sub_ps(one, opacity);
        _mm512_storeu_ps(tile, _mm512_add_ps(front, _mm512_mul_ps(left, back)));
        packed += _mm_popcnt_u64(some) * channels;
    }
    return packed;
}

#define LOOPS_AVX512(channels)                                      \
    static SNOW_AVX512_TARGET uint64_t look_##channels##_avx512(    \
        const float *pixels, int count) {                           \
        return look_avx512(pixels, count, channels);                \
    }                                                               \
    static SNOW_AVX512_TARGET float *pack_##channels##_avx512(      \
        float *out, const float *pixels, uint64_t bits) {           \
        return pack_avx512(out, pixels, bits, channels);            \
    }                                                               \
    static SNOW_AVX512_TARGET const float *lay_##channels##_avx512( \
        float *tile, const float *packed, uint64_t bits) {          \
        return lay_avx512(tile, packed, bits, channels);            \
    }                                                               \
    static const snow_pixel_loops loops_##channels##_avx512 = {     \
        look_##channels##_avx512, pack_##channels##_avx512,         \
        lay_##channels##_avx512};

LOOPS_AVX512(2)
LOOPS_AVX512(4)

#endif
