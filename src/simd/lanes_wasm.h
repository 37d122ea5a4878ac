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

#endif
