/* encode/transpose.c - transposes tiles, for all voxel sizes and instruction
 * sets. */
#include "encode/transpose.h"

#include <string.h>

/* For any machine, and for values too wide to gain from vectors: in squares
 * that the compiler unrolls. */
#define SQUARE 8

#define TRANSPOSE_PLAIN(size, type)                                           \
    static void transpose_##size##_plain(                                     \
        const unsigned char *in, size_t stride, unsigned char *out,           \
        size_t pitch, const unsigned char *next) {                            \
        (void)next;                                                           \
        for (size_t n = 0; n < SNOW_TILE_BYTES / sizeof(type); n += SQUARE)   \
            for (size_t u = 0; u < SNOW_TILE_LINES; u++)                      \
                for (size_t k = n; k < n + SQUARE; k++)                       \
                    memcpy(out + k * pitch + u * sizeof(type),                \
                           in + u * stride + k * sizeof(type), sizeof(type)); \
    }

TRANSPOSE_PLAIN(1, uint8_t)
TRANSPOSE_PLAIN(2, uint16_t)
TRANSPOSE_PLAIN(4, uint32_t)
TRANSPOSE_PLAIN(8, uint64_t)

#if SNOW_HAS_AVX
#include "simd/vec_avx2.h"
#include "simd/vec_avx512.h"

#define SELECT_AVX2
#include "simd/select.h"

typedef __m256i wide_avx2;

SNOW_AVX2_INLINE wide_avx2 wide_load_avx2(const unsigned char *at) {
    return _mm256_loadu_si256((const __m256i *)(const void *)at);
}

SNOW_AVX2_INLINE void wide_spread_avx2(wide_avx2 vector, unsigned char *out,
                                       size_t step) {
    _mm_storeu_si128((__m128i *)(void *)out, _mm256_castsi256_si128(vector));
    _mm_storeu_si128((__m128i *)(void *)(out + step),
                     _mm256_extracti128_si256(vector, 1));
}

#define WIDE_BYTES 32
#define TILE_SIZE 1
#define TILE(word) NAME(word##_1)
#define TILE_LOW _mm256_unpacklo_epi8
#define TILE_HIGH _mm256_unpackhi_epi8
#include "encode/transpose.tmpl.h"
#define TILE_SIZE 2
#define TILE(word) NAME(word##_2)
#define TILE_LOW _mm256_unpacklo_epi16
#define TILE_HIGH _mm256_unpackhi_epi16
#include "encode/transpose.tmpl.h"
#undef WIDE_BYTES

#define SELECT_AVX512
#include "simd/select.h"

typedef __m512i wide_avx512;

SNOW_AVX512_INLINE wide_avx512 wide_load_avx512(const unsigned char *at) {
    return _mm512_loadu_si512(at);
}

SNOW_AVX512_INLINE void wide_spread_avx512(wide_avx512 vector,
                                           unsigned char *out, size_t step) {
    _mm_storeu_si128((__m128i *)(void *)out, _mm512_castsi512_si128(vector));
    _mm_storeu_si128((__m128i *)(void *)(out + step),
                     _mm512_extracti32x4_epi32(vector, 1));
    _mm_storeu_si128((__m128i *)(void *)(out + 2 * step),
                     _mm512_extracti32x4_epi32(vector, 2));
    _mm_storeu_si128((__m128i *)(void *)(out + 3 * step),
                     _mm512_extracti32x4_epi32(vector, 3));
}

#define WIDE_BYTES 64
#define TILE_SIZE 1
#define TILE(word) NAME(word##_1)
#define TILE_LOW _mm512_unpacklo_epi8
#define TILE_HIGH _mm512_unpackhi_epi8
#include "encode/transpose.tmpl.h"
#define TILE_SIZE 2
#define TILE(word) NAME(word##_2)
#define TILE_LOW _mm512_unpacklo_epi16
#define TILE_HIGH _mm512_unpackhi_epi16
#include "encode/transpose.tmpl.h"
#undef WIDE_BYTES
#endif

snow_transpose_fn *snow_transpose_of(size_t size, snow_isa isa) {
#if SNOW_HAS_AVX
    if (size <= 2 && isa == SNOW_ISA_AVX512)
        return size == 1 ? transpose_1_avx512 : transpose_2_avx512;
    if (size <= 2 && isa == SNOW_ISA_AVX2)
        return size == 1 ? transpose_1_avx2 : transpose_2_avx2;
#endif
    (void)isa;
    switch (size) {
    case 1:
        return transpose_1_plain;
    case 2:
        return transpose_2_plain;
    case 4:
        return transpose_4_plain;
    default:
        return transpose_8_plain;
    }
}
