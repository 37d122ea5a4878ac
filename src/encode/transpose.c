/* encode/transpose.c - transposes tiles, for all voxel sizes and instruction
 * sets. */
#include "encode/fetch.h"

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

#define SELECT_AVX2
#include "simd/select.h"

/* 16 bytes to out, the other 16 to out + step. */
SNOW_AVX2_INLINE void wide_spread(__m256i vector, unsigned char *out,
                                  size_t step) {
    _mm_storeu_si128((__m128i *)(void *)out, _mm256_castsi256_si128(vector));
    _mm_storeu_si128((__m128i *)(void *)(out + step),
                     _mm256_extracti128_si256(vector, 1));
}

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
#endif

snow_transpose_fn *snow_transpose_of(size_t size, snow_isa isa) {
#if SNOW_HAS_AVX
    /* No faster by AVX-512. */
    if (size <= 2 && (isa == SNOW_ISA_AVX2 || isa == SNOW_ISA_AVX512))
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
