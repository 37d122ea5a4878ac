/* simd/lanes_wasm.h - eight numbers of 16 bits by WebAssembly's vectors of 128
 * bits (-msimd128); simd/rows_v128.h makes rows of them. */
#ifndef SNOW_LANES_WASM_H
#define SNOW_LANES_WASM_H

#include "simd/rows_scalar.h"

#include <wasm_simd128.h>

#define SNOW_V128_TARGET

#define SNOW_LANES_OF(name, of)                                                \
    static inline snow_scalar_eighth snow_lanes_##name(snow_scalar_eighth a,   \
                                                       snow_scalar_eighth b) { \
        return (snow_scalar_eighth)of((v128_t)a, (v128_t)b);                   \
    }
SNOW_LANES_OF(adds, wasm_i16x8_add_sat)
SNOW_LANES_OF(subs, wasm_i16x8_sub_sat)
SNOW_LANES_OF(mulhrs, wasm_i16x8_q15mulr_sat)
SNOW_LANES_OF(min, wasm_i16x8_min)
SNOW_LANES_OF(max, wasm_i16x8_max)
#undef SNOW_LANES_OF

static inline snow_scalar_eighth snow_lanes_avg(snow_scalar_eighth a,
                                                snow_scalar_eighth b) {
    const v128_t sign = wasm_i16x8_splat(INT16_MIN);
    return (snow_scalar_eighth)wasm_v128_xor(
        sign, wasm_u16x8_avgr(wasm_v128_xor((v128_t)a, sign),
                              wasm_v128_xor((v128_t)b, sign)));
}

/* A bit for each number of both where a > b. */
static inline uint32_t snow_lanes_gt(const snow_scalar_eighth a[2],
                                     const snow_scalar_eighth b[2]) {
    return (uint32_t)wasm_i8x16_bitmask(
        wasm_i8x16_narrow_i16x8((v128_t)(a[0] > b[0]), (v128_t)(a[1] > b[1])));
}

/* Bytes `from` of a; 0 where there is none. */
static inline snow_scalar_eighth snow_lanes_shuffle(snow_scalar_eighth a,
                                                    const uint8_t *from) {
    return (snow_scalar_eighth)wasm_i8x16_swizzle((v128_t)a,
                                                  wasm_v128_load(from));
}

/* Compilers make single numbers of an extension that is converted, so numbers
 * are shifted down instead. */
static inline snow_scalar_vec snow_wasm_floats(v128_t twice) {
    return (snow_scalar_vec)wasm_f32x4_convert_i32x4(wasm_i32x4_shr(twice, 16));
}

/* Four numbers at p, and back: row_floats and row_round. */
static inline snow_scalar_vec snow_lanes_floats(const int16_t *p) {
    const v128_t v = wasm_v128_load64_zero(p);
    return snow_wasm_floats(wasm_i16x8_shuffle(v, v, 0, 0, 1, 1, 2, 2, 3, 3));
}

static inline void snow_lanes_widen(snow_scalar_eighth a,
                                    snow_scalar_vec out[2]) {
    const v128_t v = (v128_t)a;
    out[0] = snow_wasm_floats(wasm_i16x8_shuffle(v, v, 0, 0, 1, 1, 2, 2, 3, 3));
    out[1] = snow_wasm_floats(wasm_i16x8_shuffle(v, v, 4, 4, 5, 5, 6, 6, 7, 7));
}

/* Does what row_round does. Of a sum with 1.5 2^23 the lower bits are
 * the number, which browsers find in fewer steps than by WebAssembly's
 * conversion. */
static inline v128_t snow_wasm_whole(snow_scalar_vec v) {
    return wasm_i32x4_sub((v128_t)(v + 12582912.0F),
                          wasm_i32x4_splat(0x4B400000));
}

static inline snow_scalar_eighth snow_lanes_narrow(snow_scalar_vec low,
                                                   snow_scalar_vec high) {
    return (snow_scalar_eighth)wasm_i16x8_narrow_i32x4(snow_wasm_whole(low),
                                                       snow_wasm_whole(high));
}

static inline void snow_lanes_round(int16_t *p, snow_scalar_vec v) {
    wasm_v128_store64_lane(p, (v128_t)snow_lanes_narrow(v, v), 0);
}

static inline snow_scalar_eighth snow_lanes_bytes(const uint8_t *p) {
    return (snow_scalar_eighth)wasm_u16x8_load8x8(p);
}

/* Hidden from the compiler, which would move the vector of a shift's count out
 * of a loop, and then shift numbers one by one. */
static inline uint32_t snow_wasm_hidden(uint32_t count) {
    __asm__ volatile("" : "+r"(count));
    return count;
}

/* Takes masks of 32 rows four at a time; rows.h says how. */
static inline void snow_lanes_window(const uint32_t *low, const uint32_t *high,
                                     int shift, uint32_t *out) {
    const uint32_t count = snow_wasm_hidden((uint32_t)shift);
    const v128_t right = wasm_u32x4_shr(wasm_v128_load(low), count);
    const v128_t left =
        wasm_i32x4_shl(wasm_i32x4_shl(wasm_v128_load(high), 1),
                       snow_wasm_hidden((uint32_t)(31 - shift)));
    wasm_v128_store(
        out, wasm_v128_or(wasm_v128_load(out), wasm_v128_or(right, left)));
}

static inline uint32_t snow_lanes_and(uint32_t *a, const uint32_t *b,
                                      uint32_t columns) {
    const v128_t both =
        wasm_v128_and(wasm_v128_and(wasm_v128_load(a), wasm_v128_load(b)),
                      wasm_i32x4_splat((int32_t)columns));
    wasm_v128_store(a, both);
    return 15 & ~(uint32_t)wasm_i32x4_bitmask(
                    wasm_i32x4_eq(both, wasm_i32x4_splat(0)));
}

/* Four entries of 64 bits, and their words 0 and 1, and 2 and 3, side by side;
 * by interleaving, since browsers make other shuffles of several steps. */
static inline void snow_wasm_gather4(const uint64_t *table, const uint16_t *at,
                                     v128_t out[2]) {
    v128_t e[4];
    for (int n = 0; n < 4; n++)
        e[n] = wasm_v128_load64_zero(table + at[n]);
    e[0] = wasm_i16x8_shuffle(e[0], e[2], 0, 8, 1, 9, 2, 10, 3, 11);
    e[1] = wasm_i16x8_shuffle(e[1], e[3], 0, 8, 1, 9, 2, 10, 3, 11);
    out[0] = wasm_i16x8_shuffle(e[0], e[1], 0, 8, 1, 9, 2, 10, 3, 11);
    out[1] = wasm_i16x8_shuffle(e[0], e[1], 4, 12, 5, 13, 6, 14, 7, 15);
}

/* Eight entries of a table, word by word. */
static inline void snow_lanes_gather(const uint64_t *table, const uint16_t *at,
                                     snow_scalar_eighth out[4]) {
    v128_t first[2], second[2];
    snow_wasm_gather4(table, at, first);
    snow_wasm_gather4(table, at + 4, second);
    for (int n = 0; n < 2; n++) {
        out[2 * n] =
            (snow_scalar_eighth)wasm_i64x2_shuffle(first[n], second[n], 0, 2);
        out[2 * n + 1] =
            (snow_scalar_eighth)wasm_i64x2_shuffle(first[n], second[n], 1, 3);
    }
}

#endif
