/* simd/lanes_wasm.h - eight numbers of 16 bits by WebAssembly's vectors of 128
 * bits (-msimd128); simd/rows_v128.h makes rows of them. */
#ifndef SNOW_LANES_WASM_H
#define SNOW_LANES_WASM_H

#include "simd/rows_scalar.h"

#include <wasm_simd128.h>

#define SNOW_LANES_OF(name, of)                                                \
    static inline snow_scalar_eighth snow_lanes_##name(snow_scalar_eighth a,   \
                                                       snow_scalar_eighth b) { \
        return (snow_scalar_eighth)of((v128_t)a, (v128_t)b);                   \
    }
SNOW_LANES_OF(adds, wasm_i16x8_add_sat)
SNOW_LANES_OF(subs, wasm_i16x8_sub_sat)
SNOW_LANES_OF(mulhrs, wasm_i16x8_q15mulr_sat)
#undef SNOW_LANES_OF

static inline snow_scalar_eighth snow_lanes_avg(snow_scalar_eighth a,
                                                snow_scalar_eighth b) {
    const v128_t sign = wasm_i16x8_splat(INT16_MIN);
    return (snow_scalar_eighth)wasm_v128_xor(
        sign, wasm_u16x8_avgr(wasm_v128_xor((v128_t)a, sign),
                              wasm_v128_xor((v128_t)b, sign)));
}

/* A bit for each number that is below 0. */
static inline uint32_t snow_lanes_bits(snow_scalar_eighth a) {
    return (uint32_t)wasm_i16x8_bitmask((v128_t)a);
}

/* Bytes `from` of a; 0 where there is none. */
static inline snow_scalar_eighth snow_lanes_shuffle(snow_scalar_eighth a,
                                                    const uint8_t *from) {
    return (snow_scalar_eighth)wasm_i8x16_swizzle((v128_t)a,
                                                  wasm_v128_load(from));
}

static inline void snow_lanes_widen(snow_scalar_eighth a,
                                    snow_scalar_vec out[2]) {
    out[0] = (snow_scalar_vec)wasm_f32x4_convert_i32x4(
        wasm_i32x4_extend_low_i16x8((v128_t)a));
    out[1] = (snow_scalar_vec)wasm_f32x4_convert_i32x4(
        wasm_i32x4_extend_high_i16x8((v128_t)a));
}

static inline snow_scalar_eighth snow_lanes_narrow(snow_scalar_vec low,
                                                   snow_scalar_vec high) {
    return (snow_scalar_eighth)wasm_i16x8_narrow_i32x4(
        wasm_i32x4_trunc_sat_f32x4(wasm_f32x4_nearest((v128_t)low)),
        wasm_i32x4_trunc_sat_f32x4(wasm_f32x4_nearest((v128_t)high)));
}

static inline snow_scalar_eighth snow_lanes_bytes(const uint8_t *p) {
    return (snow_scalar_eighth)wasm_u16x8_load8x8(p);
}

/* Of masks of 32 rows four at a time; rows.h says what. */
static inline void snow_lanes_window(const uint32_t *low, const uint32_t *high,
                                     int shift, uint32_t *out) {
    const v128_t right = wasm_u32x4_shr(wasm_v128_load(low), (uint32_t)shift);
    const v128_t left = wasm_i32x4_shl(wasm_i32x4_shl(wasm_v128_load(high), 1),
                                       (uint32_t)(31 - shift));
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

/* Four entries of 64 bits, and their words 0 and 1, and 2 and 3, side by side.
 */
static inline void snow_wasm_gather4(const uint64_t *table, const uint16_t *at,
                                     v128_t out[2]) {
    v128_t a = wasm_v128_load64_zero(table + at[0]);
    v128_t b = wasm_v128_load64_zero(table + at[1]);
    a = wasm_v128_load64_lane(table + at[2], a, 1);
    b = wasm_v128_load64_lane(table + at[3], b, 1);
    out[0] = wasm_i16x8_shuffle(a, b, 0, 8, 4, 12, 1, 9, 5, 13);
    out[1] = wasm_i16x8_shuffle(a, b, 2, 10, 6, 14, 3, 11, 7, 15);
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
