/* simd/rows_v128.h - rows of 32 numbers of 16 bits for vectors of 128 bits that
 * shuffle bytes: SSE4.1, NEON and WebAssembly.  simd/rows.h describes the
 * operations; those that compilers translate well are the scalar ones. */
#ifndef SNOW_ROWS_V128_H
#define SNOW_ROWS_V128_H

#if defined(__aarch64__)
#include "simd/lanes_neon.h"
#elif defined(__x86_64__)
#include "simd/lanes_sse4.h"
#else
#include "simd/lanes_wasm.h"
#endif

#define SNOW_V128_LANES SNOW_SCALAR_LANES
#define snow_v128_vec snow_scalar_vec
#define snow_v128_load snow_scalar_load
#define snow_v128_store snow_scalar_store
#define snow_v128_set1 snow_scalar_set1
#define snow_v128_add snow_scalar_add
#define snow_v128_sub snow_scalar_sub
#define snow_v128_mul snow_scalar_mul
#define snow_v128_min snow_scalar_min
#define snow_v128_max snow_scalar_max
#define snow_v128_sqrt snow_scalar_sqrt
#define snow_v128_row snow_scalar_row
#define snow_v128_row_load snow_scalar_row_load
#define snow_v128_row_store snow_scalar_row_store
#define snow_v128_row_set1 snow_scalar_row_set1
#define snow_v128_row_add snow_scalar_row_add
#define snow_v128_row_mul snow_scalar_row_mul
#define snow_v128_row_and snow_scalar_row_and
#define snow_v128_row_or snow_scalar_row_or
#define snow_v128_row_srl snow_scalar_row_srl
#define snow_v128_row_sll snow_scalar_row_sll
#define snow_v128_row_pairs snow_scalar_row_pairs
#define snow_v128_pick_bits snow_scalar_pick_bits
#define snow_v128_row_rsqrt snow_scalar_row_rsqrt
#define snow_v128_row_turn snow_scalar_row_turn

#define SNOW_V128_ROW_OF(name, each)                                   \
    SNOW_V128_TARGET static inline snow_v128_row snow_v128_row_##name( \
        snow_v128_row a, snow_v128_row b) {                            \
        for (int n = 0; n < 4; n++)                                    \
            a.part[n] = each;                                          \
        return a;                                                      \
    }
SNOW_V128_ROW_OF(adds, snow_lanes_adds(a.part[n], b.part[n]))
SNOW_V128_ROW_OF(subs, snow_lanes_subs(a.part[n], b.part[n]))
SNOW_V128_ROW_OF(mulhrs, snow_lanes_mulhrs(a.part[n], b.part[n]))
SNOW_V128_ROW_OF(avg, snow_lanes_avg(a.part[n], b.part[n]))
SNOW_V128_ROW_OF(min, snow_lanes_min(a.part[n], b.part[n]))
SNOW_V128_ROW_OF(max, snow_lanes_max(a.part[n], b.part[n]))

SNOW_V128_TARGET static inline uint32_t snow_v128_row_gt(snow_v128_row a,
                                                         snow_v128_row b) {
    uint32_t mask = 0;
    for (int n = 0; n < 4; n += 2)
        mask |= snow_lanes_gt(a.part + n, b.part + n) << 8 * n;
    return mask;
}

SNOW_V128_TARGET static inline snow_v128_row
snow_v128_row_choose(uint32_t mask, snow_v128_row a, snow_v128_row b) {
    const snow_scalar_eighth bits = {1, 2, 4, 8, 16, 32, 64, 128};
    for (int n = 0; n < 4; n++, mask >>= 8) {
        int16_t here = (int16_t)(mask & 255);
        snow_scalar_eighth set = ((bits & here) == bits);
        a.part[n] = (a.part[n] & set) | (b.part[n] & ~set);
    }
    return a;
}

SNOW_V128_TARGET static inline void
snow_v128_row_compress(int16_t *p, snow_v128_row a, uint32_t mask) {
    for (int n = 0; n < 4; n++, mask >>= 8) {
        snow_scalar_eighth kept =
            snow_lanes_shuffle(a.part[n], snow_rows_compress[mask & 255]);
        memcpy(p, &kept, sizeof kept);
        p += __builtin_popcount(mask & 255);
    }
}

SNOW_V128_TARGET static inline snow_v128_row
snow_v128_row_expand(const int16_t *p, uint32_t mask) {
    snow_v128_row a;
    for (int n = 0; n < 4; n++, mask >>= 8) {
        memcpy(&a.part[n], p, sizeof a.part[n]);
        a.part[n] = snow_lanes_shuffle(a.part[n], snow_rows_expand[mask & 255]);
        p += __builtin_popcount(mask & 255);
    }
    return a;
}

#if defined(__aarch64__)
#define snow_v128_row_gather snow_scalar_row_gather
#define snow_v128_row_bytes snow_scalar_row_bytes
#define snow_v128_rows_window snow_scalar_rows_window
#define snow_v128_rows_and snow_scalar_rows_and
#define snow_v128_row_floats snow_scalar_row_floats
#define snow_v128_row_round snow_scalar_row_round
#else
#define snow_v128_row_floats snow_lanes_floats
#define snow_v128_row_round snow_lanes_round

SNOW_V128_TARGET static inline snow_v128_row
snow_v128_row_bytes(const uint8_t *p) {
    snow_v128_row a;
    for (int n = 0; n < 4; n++)
        a.part[n] = snow_lanes_bytes(p + 8 * n);
    return a;
}

SNOW_V128_TARGET static inline void snow_v128_rows_window(const uint32_t *low,
                                                          const uint32_t *high,
                                                          int shift,
                                                          uint32_t *out) {
    for (int n = 0; n < 32; n += 4)
        snow_lanes_window(low + n, high + n, shift, out + n);
}

SNOW_V128_TARGET static inline uint32_t
snow_v128_rows_and(uint32_t *a, const uint32_t *b, uint32_t columns) {
    uint32_t any = 0;
    for (int n = 0; n < 32; n += 4)
        any |= snow_lanes_and(a + n, b + n, columns) << n;
    return any;
}

SNOW_V128_TARGET static inline void snow_v128_row_gather(const uint64_t *table,
                                                         snow_v128_row index,
                                                         snow_v128_row out[4]) {
    uint16_t at[32];
    memcpy(at, &index, sizeof at);
    for (int n = 0; n < 4; n++) {
        snow_scalar_eighth words[4];
        snow_lanes_gather(table, at + 8 * n, words);
        for (int c = 0; c < 4; c++)
            out[c].part[n] = words[c];
    }
}
#endif

SNOW_V128_TARGET static inline void snow_v128_row_widen(snow_v128_row a,
                                                        snow_v128_vec out[8]) {
    for (int n = 0; n < 4; n++)
        snow_lanes_widen(a.part[n], out + 2 * n);
}

SNOW_V128_TARGET static inline snow_v128_row
snow_v128_row_narrow(const snow_v128_vec v[8]) {
    snow_v128_row a;
    for (int n = 0; n < 4; n++)
        a.part[n] = snow_lanes_narrow(v[2 * n], v[2 * n + 1]);
    return a;
}

#endif
