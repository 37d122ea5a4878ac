/* encode/masks.c - see masks.h: plain loops, which process a mask a byte at a
 * time, and AVX-512, which compresses. */
#include "encode/masks.h"

/* clang-format off */
const uint64_t snow_places_of_byte[256] = {
    0x0, 0x0, 0x1, 0x100, 0x2, 0x200, 0x201, 0x20100, 0x3, 0x300, 0x301,
    0x30100, 0x302, 0x30200, 0x30201, 0x3020100, 0x4, 0x400, 0x401, 0x40100,
    0x402, 0x40200, 0x40201, 0x4020100, 0x403, 0x40300, 0x40301, 0x4030100,
    0x40302, 0x4030200, 0x4030201, 0x403020100, 0x5, 0x500, 0x501, 0x50100,
    0x502, 0x50200, 0x50201, 0x5020100, 0x503, 0x50300, 0x50301, 0x5030100,
    0x50302, 0x5030200, 0x5030201, 0x503020100, 0x504, 0x50400, 0x50401,
    0x5040100, 0x50402, 0x5040200, 0x5040201, 0x504020100, 0x50403, 0x5040300,
    0x5040301, 0x504030100, 0x5040302, 0x504030200, 0x504030201, 0x50403020100,
    0x6, 0x600, 0x601, 0x60100, 0x602, 0x60200, 0x60201, 0x6020100, 0x603,
    0x60300, 0x60301, 0x6030100, 0x60302, 0x6030200, 0x6030201, 0x603020100,
    0x604, 0x60400, 0x60401, 0x6040100, 0x60402, 0x6040200, 0x6040201,
    0x604020100, 0x60403, 0x6040300, 0x6040301, 0x604030100, 0x6040302,
    0x604030200, 0x604030201, 0x60403020100, 0x605, 0x60500, 0x60501, 0x6050100,
    0x60502, 0x6050200, 0x6050201, 0x605020100, 0x60503, 0x6050300, 0x6050301,
    0x605030100, 0x6050302, 0x605030200, 0x605030201, 0x60503020100, 0x60504,
    0x6050400, 0x6050401, 0x605040100, 0x6050402, 0x605040200, 0x605040201,
    0x60504020100, 0x6050403, 0x605040300, 0x605040301, 0x60504030100,
    0x605040302, 0x60504030200, 0x60504030201, 0x6050403020100, 0x7, 0x700,
    0x701, 0x70100, 0x702, 0x70200, 0x70201, 0x7020100, 0x703, 0x70300, 0x70301,
    0x7030100, 0x70302, 0x7030200, 0x7030201, 0x703020100, 0x704, 0x70400,
    0x70401, 0x7040100, 0x70402, 0x7040200, 0x7040201, 0x704020100, 0x70403,
    0x7040300, 0x7040301, 0x704030100, 0x7040302, 0x704030200, 0x704030201,
    0x70403020100, 0x705, 0x70500, 0x70501, 0x7050100, 0x70502, 0x7050200,
    0x7050201, 0x705020100, 0x70503, 0x7050300, 0x7050301, 0x705030100,
    0x7050302, 0x705030200, 0x705030201, 0x70503020100, 0x70504, 0x7050400,
    0x7050401, 0x705040100, 0x7050402, 0x705040200, 0x705040201, 0x70504020100,
    0x7050403, 0x705040300, 0x705040301, 0x70504030100, 0x705040302,
    0x70504030200, 0x70504030201, 0x7050403020100, 0x706, 0x70600, 0x70601,
    0x7060100, 0x70602, 0x7060200, 0x7060201, 0x706020100, 0x70603, 0x7060300,
    0x7060301, 0x706030100, 0x7060302, 0x706030200, 0x706030201, 0x70603020100,
    0x70604, 0x7060400, 0x7060401, 0x706040100, 0x7060402, 0x706040200,
    0x706040201, 0x70604020100, 0x7060403, 0x706040300, 0x706040301,
    0x70604030100, 0x706040302, 0x70604030200, 0x70604030201, 0x7060403020100,
    0x70605, 0x7060500, 0x7060501, 0x706050100, 0x7060502, 0x706050200,
    0x706050201, 0x70605020100, 0x7060503, 0x706050300, 0x706050301,
    0x70605030100, 0x706050302, 0x70605030200, 0x70605030201, 0x7060503020100,
    0x7060504, 0x706050400, 0x706050401, 0x70605040100, 0x706050402,
    0x70605040200, 0x70605040201, 0x7060504020100, 0x706050403, 0x70605040300,
    0x70605040301, 0x7060504030100, 0x70605040302, 0x7060504030200,
    0x7060504030201, 0x706050403020100,
};
/* clang-format on */

static unsigned char *places_scalar(const uint64_t *masks, size_t words,
                                    unsigned base, unsigned char *out) {
    for (size_t w = 0; w < words; w++, base += 64) {
        uint64_t mask = masks[w];
        if (!mask)
            continue;
        uint64_t ends = snow_counts_of_bytes(mask);
        for (unsigned n = 0; n < 8; n++) {
            uint64_t places = snow_places_of_byte[mask >> 8 * n & 255];
            /* Each of the eight bytes is advanced by base + 8 n, modulo 256. */
            uint64_t add =
                UINT64_C(0x0101010101010101) * ((base + 8 * n) & 255);
            uint64_t low = UINT64_C(0x7f7f7f7f7f7f7f7f);
            uint64_t moved = (places + (add & low)) ^ (add & ~low);
            snow_store_word(out + (n ? ends >> 8 * (n - 1) & 255 : 0), moved);
        }
        out += ends >> 56;
    }
    return out;
}

static size_t count_words_scalar(const uint64_t *masks, size_t words) {
    size_t full = 0;
    for (size_t w = 0; w < words; w++)
        full += masks[w] != 0;
    return full;
}

static unsigned char *pack_words_scalar(const uint64_t *masks, size_t words,
                                        unsigned char *summary,
                                        unsigned char *out) {
    for (size_t first = 0; first < words; first += 8) {
        size_t end = words - first < 8 ? words : first + 8;
        unsigned bits = 0;
        for (size_t w = first; w < end; w++) {
            unsigned full = masks[w] != 0;
            snow_store_word(out, masks[w]);
            out += 8 * full;
            bits |= full << (w - first);
        }
        summary[first / 8] = (unsigned char)bits;
    }
    return out;
}

#define SELECT_SCALAR
#include "simd/select.h"

#include "encode/masks.tmpl.h"
#if SNOW_HAS_AVX
#define SELECT_AVX2
#include "simd/select.h"

#include "encode/masks.tmpl.h"

SNOW_AVX512_TARGET static unsigned char *places_avx512(const uint64_t *masks,
                                                       size_t words,
                                                       unsigned base,
                                                       unsigned char *out) {
    static const unsigned char numbers[64] = {
        0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13, 14, 15,
        16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31,
        32, 33, 34, 35, 36, 37, 38, 39, 40, 41, 42, 43, 44, 45, 46, 47,
        48, 49, 50, 51, 52, 53, 54, 55, 56, 57, 58, 59, 60, 61, 62, 63};
    __m512i places = _mm512_add_epi8(_mm512_loadu_si512(numbers),
                                     _mm512_set1_epi8((char)base));
    for (size_t w = 0; w < words; w++) {
        _mm512_storeu_si512(out, _mm512_maskz_compress_epi8(masks[w], places));
        out += __builtin_popcountll(masks[w]);
        places = _mm512_add_epi8(places, _mm512_set1_epi8(64));
    }
    return out;
}
/* Up to eight words from `w` on; zeros beyond the last. */
SNOW_AVX512_INLINE __m512i load_words(const uint64_t *masks, size_t w,
                                      size_t words) {
    unsigned some = words - w < 8 ? (1u << (words - w)) - 1 : 255;
    return _mm512_maskz_loadu_epi64((__mmask8)some, masks + w);
}

SNOW_AVX512_TARGET static size_t count_words_avx512(const uint64_t *masks,
                                                    size_t words) {
    size_t full = 0;
    for (size_t w = 0; w < words; w += 8) {
        __m512i eight = load_words(masks, w, words);
        full +=
            (size_t)__builtin_popcount(_mm512_test_epi64_mask(eight, eight));
    }
    return full;
}

SNOW_AVX512_TARGET static unsigned char *
pack_words_avx512(const uint64_t *masks, size_t words, unsigned char *summary,
                  unsigned char *out) {
    for (size_t w = 0; w < words; w += 8) {
        __m512i eight = load_words(masks, w, words);
        __mmask8 full = _mm512_test_epi64_mask(eight, eight);
        _mm512_storeu_si512(out, _mm512_maskz_compress_epi64(full, eight));
        out += 8 * __builtin_popcount(full);
        summary[w / 8] = full;
    }
    return out;
}
#endif

const snow_mask_loops *snow_mask_loops_of(snow_isa isa) {
    static const snow_mask_loops scalar = {places_scalar, count_words_scalar,
                                           pack_words_scalar,
                                           count_bits_scalar};
#if SNOW_HAS_AVX
    static const snow_mask_loops avx512 = {places_avx512, count_words_avx512,
                                           pack_words_avx512, count_bits_avx2};
    static const snow_mask_loops avx2 = {places_scalar, count_words_scalar,
                                         pack_words_scalar, count_bits_avx2};
    if (isa == SNOW_ISA_AVX512)
        return &avx512;
    if (isa == SNOW_ISA_AVX2)
        return &avx2;
#endif
    (void)isa;
    return &scalar;
}
