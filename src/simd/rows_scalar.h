/* simd/rows_scalar.h - rows of 32 numbers of 16 bits, for any machine.
 * simd/rows.h describes the operations. */
#ifndef SNOW_ROWS_SCALAR_H
#define SNOW_ROWS_SCALAR_H

#include "simd/vec_scalar.h"

/* For each byte of a mask: the bytes of the numbers that it keeps, and where
 * kept ones come from. */
extern const uint8_t snow_rows_compress[256][16], snow_rows_expand[256][16];

typedef int16_t snow_scalar_eighth __attribute__((vector_size(16)));
typedef struct snow_scalar_row {
    snow_scalar_eighth part[4];
} snow_scalar_row;

static inline snow_scalar_row snow_scalar_row_load(const int16_t *p) {
    snow_scalar_row a;
    memcpy(&a, p, sizeof a);
    return a;
}

static inline void snow_scalar_row_store(int16_t *p, snow_scalar_row a) {
    memcpy(p, &a, sizeof a);
}

static inline snow_scalar_row snow_scalar_row_set1(int16_t x) {
    snow_scalar_eighth all = {x, x, x, x, x, x, x, x};
    return (snow_scalar_row){{all, all, all, all}};
}

static inline snow_scalar_row snow_scalar_row_bytes(const uint8_t *p) {
    int16_t x[32];
    for (int n = 0; n < 32; n++)
        x[n] = p[n];
    return snow_scalar_row_load(x);
}

static inline uint64_t snow_scalar_bytes_outside(const uint8_t *p,
                                                 uint8_t first, uint8_t width) {
    uint64_t bits = 0;
    for (int n = 0; n < 64; n++)
        bits |= (uint64_t)((uint8_t)(p[n] - first) > width) << n;
    return bits;
}

/* An operation on each number of two rows. */
#define SNOW_SCALAR_ROW_OF(name, each)                                        \
    static inline snow_scalar_row snow_scalar_row_##name(snow_scalar_row a,   \
                                                         snow_scalar_row b) { \
        int16_t x[32], y[32];                                                 \
        memcpy(x, &a, sizeof x);                                              \
        memcpy(y, &b, sizeof y);                                              \
        for (int n = 0; n < 32; n++)                                          \
            x[n] = (int16_t)(each);                                           \
        return snow_scalar_row_load(x);                                       \
    }

static inline int snow_scalar_saturate(int x) {
    return x < INT16_MIN ? INT16_MIN : x > INT16_MAX ? INT16_MAX : x;
}

SNOW_SCALAR_ROW_OF(adds, snow_scalar_saturate(x[n] + y[n]))
SNOW_SCALAR_ROW_OF(subs, snow_scalar_saturate(x[n] - y[n]))
SNOW_SCALAR_ROW_OF(mulhrs, (x[n] * y[n] + 0x4000) >> 15)
SNOW_SCALAR_ROW_OF(avg, (x[n] + y[n] + 1) >> 1)

/* The same on parts x and y of eight, unsigned. */
typedef uint16_t snow_scalar_words __attribute__((vector_size(16)));
#define SNOW_SCALAR_PARTS_OF(name, type, by, each)                          \
    static inline snow_scalar_row snow_scalar_row_##name(snow_scalar_row a, \
                                                         type by) {         \
        for (int n = 0; n < 4; n++) {                                       \
            snow_scalar_words x = (snow_scalar_words)a.part[n];             \
            a.part[n] = (snow_scalar_eighth)(each);                         \
        }                                                                   \
        return a;                                                           \
    }
#define Y ((snow_scalar_words)b.part[n])
#define WHERE(condition) ((snow_scalar_words)(condition))
#define OF(name, each) SNOW_SCALAR_PARTS_OF(name, snow_scalar_row, b, each)
OF(add, x + Y)
OF(mul, x *Y)
OF(and, x &Y)
OF(or, x | Y)
OF(min, Y ^ ((x ^ Y) & WHERE(a.part[n] < b.part[n])))
OF(max, Y ^ ((x ^ Y) & WHERE(a.part[n] > b.part[n])))
SNOW_SCALAR_PARTS_OF(srl, int, bits, x >> bits)
SNOW_SCALAR_PARTS_OF(sll, int, bits, x << bits)
#undef OF
#undef WHERE
#undef Y

static inline uint32_t snow_scalar_row_gt(snow_scalar_row a,
                                          snow_scalar_row b) {
    uint32_t mask = 0;
    for (int part = 0; part < 4; part++)
        for (int n = 0; n < 8; n++)
            mask |= (uint32_t)(a.part[part][n] > b.part[part][n])
                    << (8 * part + n);
    return mask;
}

static inline snow_scalar_row
snow_scalar_row_choose(uint32_t mask, snow_scalar_row a, snow_scalar_row b) {
    int16_t x[32], y[32];
    memcpy(x, &a, sizeof x);
    memcpy(y, &b, sizeof y);
    for (int n = 0; n < 32; n++)
        x[n] = mask >> n & 1 ? x[n] : y[n];
    return snow_scalar_row_load(x);
}

static inline void snow_scalar_row_compress(int16_t *p, snow_scalar_row a,
                                            uint32_t mask) {
    int16_t x[32];
    memcpy(x, &a, sizeof x);
    for (; mask; mask &= mask - 1)
        *p++ = x[__builtin_ctz(mask)];
}

static inline snow_scalar_row snow_scalar_row_expand(const int16_t *p,
                                                     uint32_t mask) {
    int16_t x[32] = {0};
    for (; mask; mask &= mask - 1)
        x[__builtin_ctz(mask)] = *p++;
    return snow_scalar_row_load(x);
}

static inline void snow_scalar_row_gather(const uint64_t *table,
                                          snow_scalar_row index,
                                          snow_scalar_row out[4]) {
    uint16_t at[32];
    int16_t words[4][32];
    memcpy(at, &index, sizeof at);
    for (int n = 0; n < 32; n++)
        for (int c = 0; c < 4; c++)
            words[c][n] = (int16_t)(uint16_t)(table[at[n]] >> 16 * c);
    for (int c = 0; c < 4; c++)
        out[c] = snow_scalar_row_load(words[c]);
}

static inline void snow_scalar_row_pairs(const int16_t *p, const int16_t *at,
                                         int span, snow_scalar_row out[2]) {
    int16_t numbers[2][32];
    (void)span;
    for (int n = 0; n < 32; n++) {
        numbers[0][n] = p[at[n]];
        numbers[1][n] = p[at[n] + 1];
    }
    out[0] = snow_scalar_row_load(numbers[0]);
    out[1] = snow_scalar_row_load(numbers[1]);
}

static inline uint32_t snow_scalar_pick_bits(uint32_t bits, uint32_t select) {
    uint32_t picked = 0;
    for (int n = 0; select; select &= select - 1)
        picked |= (bits >> __builtin_ctz(select) & 1) << n++;
    return picked;
}

/* Masks of 32 rows of 32 bits. */
static inline void snow_scalar_rows_window(const uint32_t *low,
                                           const uint32_t *high, int shift,
                                           uint32_t *out) {
    for (int n = 0; n < 32; n++)
        out[n] |= low[n] >> shift | high[n] << 1 << (31 - shift);
}

static inline uint32_t snow_scalar_rows_and(uint32_t *a, const uint32_t *b,
                                            uint32_t columns) {
    uint32_t any = 0;
    for (int n = 0; n < 32; n++) {
        a[n] &= b[n] & columns;
        any |= (uint32_t)(a[n] != 0) << n;
    }
    return any;
}

/* Floats of numbers, and back. */
static inline snow_scalar_vec snow_scalar_row_floats(const int16_t *p) {
    return (snow_scalar_vec){p[0], p[1], p[2], p[3]};
}

static inline void snow_scalar_row_round(int16_t *p, snow_scalar_vec v) {
    for (int n = 0; n < 4; n++) {
        /* To the nearest, halves to the even one. */
        float near = v[n] + 12582912.0F;
        int32_t bits;
        memcpy(&bits, &near, sizeof bits);
        p[n] = (int16_t)snow_scalar_saturate(bits - 0x4B400000);
    }
}

/* The same of whole rows. */
static inline void snow_scalar_row_widen(snow_scalar_row a,
                                         snow_scalar_vec out[8]) {
    int16_t numbers[32];
    snow_scalar_row_store(numbers, a);
    for (int n = 0; n < 8; n++)
        out[n] = snow_scalar_row_floats(numbers + 4 * n);
}

static inline snow_scalar_row
snow_scalar_row_narrow(const snow_scalar_vec v[8]) {
    int16_t numbers[32];
    for (int n = 0; n < 8; n++)
        snow_scalar_row_round(numbers + 4 * n, v[n]);
    return snow_scalar_row_load(numbers);
}

/* 1 / sqrt(v) from an integer's guess and two of Newton's steps. */
static inline snow_scalar_vec snow_scalar_row_rsqrt(snow_scalar_vec v) {
    snow_scalar_vec half = v * 0.5F, y;
    typedef uint32_t words __attribute__((vector_size(16)));
    words bits;
    memcpy(&bits, &v, sizeof bits);
    bits = 0x5f375a86u - (bits >> 1);
    memcpy(&y, &bits, sizeof y);
    y = y * (1.5F - half * y * y);
    return y * (1.5F - half * y * y);
}

/* v, turned round where `by` is below 0; and 1 where v is above 0, else 0. */
static inline snow_scalar_vec snow_scalar_row_turn(snow_scalar_vec v,
                                                   snow_scalar_vec by) {
    return (snow_scalar_vec)((snow_scalar_mask)v ^
                             ((snow_scalar_mask)by & INT32_MIN));
}

#endif
