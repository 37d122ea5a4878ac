/* combine/pixels.c - the loops of pixels.h without vectors but those of 4
 * floats, which compilers find; and the choice of a level.  AVX2 has nothing
 * that compresses pixels: there, too, they are moved one by one. */
#include "combine/pixels.h"

#if SNOW_HAS_AVX
#include "combine/pixels_avx512.h"
#endif

#include <string.h>

static inline uint64_t look_plain(const float *pixels, int count,
                                  int channels) {
    const uint64_t numbers = 0x7fffffff7fffffff; /* all but -0, twice */
    uint64_t bits = 0;
    for (int i = 0; i < count; i++) {
        uint64_t halves[2] = {0, 0};
        memcpy(halves, pixels + i * channels,
               (size_t)channels * sizeof *pixels);
        bits |= (uint64_t)(((halves[0] | halves[1]) & numbers) != 0) << i;
    }
    return bits;
}

static inline float *pack_plain(float *out, const float *pixels, uint64_t bits,
                                int channels) {
    const size_t bytes = (size_t)channels * sizeof *out;
    if (bits == ~(uint64_t)0) {
        memcpy(out, pixels, 64 * bytes);
        return out + 64 * channels;
    }
    for (; bits; bits &= bits - 1, out += channels)
        memcpy(out, pixels + __builtin_ctzll(bits) * channels, bytes);
    return out;
}

static inline const float *lay_plain(float *tile, const float *packed,
                                     uint64_t bits, int channels) {
    for (; bits; bits &= bits - 1, packed += channels) {
        float *front = tile + __builtin_ctzll(bits) * channels;
        float left = 1 - front[channels - 1], back[4];
        memcpy(back, packed, (size_t)channels * sizeof *back);
        for (int c = 0; c < channels; c++)
            front[c] += left * back[c];
    }
    return packed;
}

static const float *lay_most(float *tile, const float *packed, uint64_t bits) {
    for (; bits; bits &= bits - 1, packed += 2) {
        float *pixel = tile + __builtin_ctzll(bits) * 2;
        for (int c = 0; c < 2; c++)
            pixel[c] = packed[c] > pixel[c] ? packed[c] : pixel[c];
    }
    return packed;
}

static const float *lay_sum(float *tile, const float *packed, uint64_t bits) {
    for (; bits; bits &= bits - 1, packed += 2) {
        float *pixel = tile + __builtin_ctzll(bits) * 2;
        for (int c = 0; c < 2; c++)
            pixel[c] += packed[c];
    }
    return packed;
}

snow_pixel_loops snow_pixels_laying(const snow_pixel_loops *loops,
                                    snow_laying laying) {
    snow_pixel_loops other = *loops;
    if (laying == SNOW_LAY_MOST)
        other.lay = lay_most;
    else if (laying == SNOW_LAY_SUM)
        other.lay = lay_sum;
    return other;
}

#define LOOPS(channels)                                                  \
    static uint64_t look_##channels(const float *pixels, int count) {    \
        return look_plain(pixels, count, channels);                      \
    }                                                                    \
    static float *pack_##channels(float *out, const float *pixels,       \
                                  uint64_t bits) {                       \
        return pack_plain(out, pixels, bits, channels);                  \
    }                                                                    \
    static const float *lay_##channels(float *tile, const float *packed, \
                                       uint64_t bits) {                  \
        return lay_plain(tile, packed, bits, channels);                  \
    }                                                                    \
    static const snow_pixel_loops loops_##channels = {                   \
        look_##channels, pack_##channels, lay_##channels};

LOOPS(2)
LOOPS(4)

const snow_pixel_loops *snow_pixels_pick(snow_isa isa, int channels) {
#if SNOW_HAS_AVX
    if (snow_isa_resolve(isa) == SNOW_ISA_AVX512)
        return channels == 2 ? &loops_2_avx512 : &loops_4_avx512;
#endif
    (void)isa;
    return channels == 2 ? &loops_2 : &loops_4;
}
