/* simd/lanes_neon.h - eight numbers of 16 bits by NEON, which every 64-bit ARM
 * has; simd/rows_v128.h makes rows of them. */
#ifndef SNOW_LANES_NEON_H
#define SNOW_LANES_NEON_H

#include "simd/rows_scalar.h"

#include <arm_neon.h>

#define SNOW_V128_TARGET

#define snow_lanes_adds(a, b) (snow_scalar_eighth) vqaddq_s16(a, b)
#define snow_lanes_subs(a, b) (snow_scalar_eighth) vqsubq_s16(a, b)
#define snow_lanes_mulhrs(a, b) (snow_scalar_eighth) vqrdmulhq_s16(a, b)
#define snow_lanes_avg(a, b) (snow_scalar_eighth) vrhaddq_s16(a, b)
#define snow_lanes_min(a, b) (snow_scalar_eighth) vminq_s16(a, b)
#define snow_lanes_max(a, b) (snow_scalar_eighth) vmaxq_s16(a, b)

/* A bit for each number of both where a > b. */
static inline uint32_t snow_lanes_gt(const snow_scalar_eighth a[2],
                                     const snow_scalar_eighth b[2]) {
    const uint8x16_t bits = {1, 2, 4, 8, 16, 32, 64, 128,
                             1, 2, 4, 8, 16, 32, 64, 128};
    const uint8x16_t set =
        vandq_u8(bits, vcombine_u8(vmovn_u16(vcgtq_s16(a[0], b[0])),
                                   vmovn_u16(vcgtq_s16(a[1], b[1]))));
    return (uint32_t)vaddv_u8(vget_low_u8(set)) |
           (uint32_t)vaddv_u8(vget_high_u8(set)) << 8;
}

/* Bytes `from` of a; 0 where there is none. */
static inline snow_scalar_eighth snow_lanes_shuffle(snow_scalar_eighth a,
                                                    const uint8_t *from) {
    return (snow_scalar_eighth)vqtbl1q_u8((uint8x16_t)a, vld1q_u8(from));
}

static inline void snow_lanes_widen(snow_scalar_eighth a,
                                    snow_scalar_vec out[2]) {
    out[0] = vcvtq_f32_s32(vmovl_s16(vget_low_s16(a)));
    out[1] = vcvtq_f32_s32(vmovl_high_s16(a));
}

static inline snow_scalar_eighth snow_lanes_narrow(snow_scalar_vec low,
                                                   snow_scalar_vec high) {
    return vcombine_s16(vqmovn_s32(vcvtnq_s32_f32(low)),
                        vqmovn_s32(vcvtnq_s32_f32(high)));
}

#endif
