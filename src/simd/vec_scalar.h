/* simd/vec_scalar.h - the vector operations for any machine: vectors of 4
 * floats that the compiler translates to SSE2, NEON or plain instructions.
 * simd/select.h describes them. */
#ifndef SNOW_VEC_SCALAR_H
#define SNOW_VEC_SCALAR_H

#include <stdint.h>
#include <string.h>

#define SNOW_SCALAR_LANES 4
#define SNOW_SCALAR_TARGET

typedef float snow_scalar_vec __attribute__((vector_size(16)));
typedef int snow_scalar_mask __attribute__((vector_size(16)));

static inline snow_scalar_vec snow_scalar_load(const float *p) {
    snow_scalar_vec v;
    memcpy(&v, p, sizeof v);
    return v;
}

static inline void snow_scalar_store(float *p, snow_scalar_vec v) {
    memcpy(p, &v, sizeof v);
}

static inline snow_scalar_vec snow_scalar_set1(float x) {
    return (snow_scalar_vec){x, x, x, x};
}

static inline snow_scalar_vec snow_scalar_add(snow_scalar_vec a,
                                              snow_scalar_vec b) {
    return a + b;
}

static inline snow_scalar_vec snow_scalar_sub(snow_scalar_vec a,
                                              snow_scalar_vec b) {
    return a - b;
}

static inline snow_scalar_vec snow_scalar_mul(snow_scalar_vec a,
                                              snow_scalar_vec b) {
    return a * b;
}

static inline snow_scalar_vec
snow_scalar_fma(snow_scalar_vec a, snow_scalar_vec b, snow_scalar_vec c) {
    return a * b + c;
}

static inline snow_scalar_vec
snow_scalar_fnma(snow_scalar_vec a, snow_scalar_vec b, snow_scalar_vec c) {
    return c - a * b;
}

/* Selects a's bits where the mask is set, else b's. */
static inline snow_scalar_vec snow_scalar_choose(snow_scalar_mask mask,
                                                 snow_scalar_vec a,
                                                 snow_scalar_vec b) {
    return (snow_scalar_vec)(((snow_scalar_mask)a & mask) |
                             ((snow_scalar_mask)b & ~mask));
}

static inline snow_scalar_vec snow_scalar_min(snow_scalar_vec a,
                                              snow_scalar_vec b) {
    return snow_scalar_choose((snow_scalar_mask)(a < b), a, b);
}

static inline snow_scalar_vec snow_scalar_max(snow_scalar_vec a,
                                              snow_scalar_vec b) {
    return snow_scalar_choose((snow_scalar_mask)(a > b), a, b);
}

static inline snow_scalar_vec snow_scalar_alpha2(snow_scalar_vec v) {
    return (snow_scalar_vec){v[1], v[1], v[3], v[3]};
}

static inline snow_scalar_vec snow_scalar_alpha4(snow_scalar_vec v) {
    return (snow_scalar_vec){v[3], v[3], v[3], v[3]};
}

static inline snow_scalar_vec snow_scalar_deinterleave2(snow_scalar_vec a,
                                                        snow_scalar_vec b) {
    return (snow_scalar_vec){a[0], a[1], b[0], b[1]};
}

static inline snow_scalar_vec snow_scalar_deinterleave4(snow_scalar_vec a,
                                                        snow_scalar_vec b) {
    (void)b;
    return a;
}

static inline void snow_scalar_interleave2(snow_scalar_vec a, snow_scalar_vec b,
                                           float *p) {
    snow_scalar_store(p, (snow_scalar_vec){a[0], a[1], b[0], b[1]});
    snow_scalar_store(p + 4, (snow_scalar_vec){a[2], a[3], b[2], b[3]});
}

static inline void snow_scalar_interleave4(snow_scalar_vec a, snow_scalar_vec b,
                                           float *p) {
    snow_scalar_store(p, a);
    snow_scalar_store(p + 4, b);
}

static inline snow_scalar_vec snow_scalar_hadd2(snow_scalar_vec v) {
    return (snow_scalar_vec){v[0] + v[2], v[1] + v[3], 0, 0};
}

static inline snow_scalar_vec snow_scalar_hadd4(snow_scalar_vec v) {
    return v;
}

static inline snow_scalar_vec snow_scalar_gather4(const float *p,
                                                  const uint32_t *n) {
    return snow_scalar_load(p + (size_t)n[0] * 4);
}

static inline snow_scalar_vec snow_scalar_gather2(const float *p,
                                                  const uint32_t *n) {
    const float *a = p + (size_t)n[0] * 2, *b = p + (size_t)n[1] * 2;
    return (snow_scalar_vec){a[0], a[1], b[0], b[1]};
}

static inline snow_scalar_vec snow_scalar_with_alpha2(snow_scalar_vec a,
                                                      snow_scalar_vec b) {
    return (snow_scalar_vec){a[0], b[1], a[2], b[3]};
}

static inline snow_scalar_vec snow_scalar_with_alpha4(snow_scalar_vec a,
                                                      snow_scalar_vec b) {
    return (snow_scalar_vec){a[0], a[1], a[2], b[3]};
}

/* expand8 and numbers8, or 16, of an instruction set without an expansion. */
#define SNOW_VEC_EXPAND(begin, isa, width, type)                              \
    begin void snow_##isa##_expand##width(const type *p, uint32_t bits,       \
                                          uint32_t *out) {                    \
        for (int i = 0; i < 16; i++, bits >>= 1) {                            \
            uint32_t here = bits & 1;                                         \
            out[i] = ((uint32_t)*p + 1) & (0 - here);                         \
            p += here;                                                        \
        }                                                                     \
    }                                                                         \
    begin void snow_##isa##_numbers##width(                                   \
        const type *p, uint32_t bits, float scale, float start, float *out) { \
        uint32_t numbers[16];                                                 \
        snow_##isa##_expand##width(p, bits, numbers);                         \
        for (int i = 0; i < 16; i++) {                                        \
            float number = start + scale * (float)(int32_t)(numbers[i] - 1);  \
            out[i] = numbers[i] ? number : 0;                                 \
        }                                                                     \
    }
SNOW_VEC_EXPAND(static inline, scalar, 8, uint8_t)
SNOW_VEC_EXPAND(static inline, scalar, 16, uint16_t)

/* See simd/select.h; in two steps, since a shift by 64 is undefined. */
static inline unsigned snow_scalar_windows(const uint64_t *low,
                                           const uint64_t *high, unsigned shift,
                                           uint64_t within, uint64_t *out) {
    unsigned found = 0;
    for (unsigned i = 0; i < 8; i++) {
        out[i] = (low[i] >> shift | high[i] << 1 << (63 - shift)) & within;
        found |= (unsigned)(out[i] != 0) << i;
    }
    return found;
}

static inline void snow_scalar_widen8(const uint8_t *p, uint32_t *out) {
    for (int i = 0; i < 16; i++)
        out[i] = p[i];
}

static inline void snow_scalar_widen16(const uint16_t *p, uint32_t *out) {
    for (int i = 0; i < 16; i++)
        out[i] = p[i];
}

static inline void snow_scalar_pairs16(const uint32_t *p, const uint32_t *n,
                                       float *first, float *second) {
    for (int i = 0; i < 16; i++) {
        first[i] = (float)(p[n[i]] & 0xFFFF);
        second[i] = (float)(p[n[i]] >> 16);
    }
}

static inline void snow_scalar_spread2(const float *p, uint64_t bits, int count,
                                       float *out) {
    static const float zeros[2];
    for (int i = 0; i < count; i++, bits >>= 1) {
        memcpy(out + 2 * i, bits & 1 ? p : zeros, sizeof zeros);
        p += 2 * (bits & 1);
    }
}

static inline void snow_scalar_spread4(const float *p, uint64_t bits, int count,
                                       float *out) {
    static const float zeros[4];
    for (int i = 0; i < count; i++, bits >>= 1) {
        memcpy(out + 4 * i, bits & 1 ? p : zeros, sizeof zeros);
        p += 4 * (bits & 1);
    }
}

/* By adding neighbouring groups of bits (Wilkes, Wheeler and Gill 1957). */
static inline void snow_scalar_load_pairs2(const float *p, const int64_t *at,
                                           snow_scalar_vec *left,
                                           snow_scalar_vec *right) {
    snow_scalar_vec a = snow_scalar_load(p + at[0]);
    snow_scalar_vec b = snow_scalar_load(p + at[1]);
    *left = (snow_scalar_vec){a[0], a[1], b[0], b[1]};
    *right = (snow_scalar_vec){a[2], a[3], b[2], b[3]};
}

static inline void snow_scalar_load_pairs4(const float *p, const int64_t *at,
                                           snow_scalar_vec *left,
                                           snow_scalar_vec *right) {
    *left = snow_scalar_load(p + *at);
    *right = snow_scalar_load(p + *at + 4);
}

static inline int snow_scalar_popcount(uint64_t x) {
    x -= x >> 1 & UINT64_C(0x5555555555555555);
    x = (x & UINT64_C(0x3333333333333333)) +
        (x >> 2 & UINT64_C(0x3333333333333333));
    x = (x + (x >> 4)) & UINT64_C(0x0F0F0F0F0F0F0F0F);
    return (int)(x * UINT64_C(0x0101010101010101) >> 56);
}

static inline int snow_scalar_any_less(snow_scalar_vec a, snow_scalar_vec b) {
    snow_scalar_mask less = (snow_scalar_mask)(a < b);
    return (less[0] | less[1] | less[2] | less[3]) != 0;
}

/* A sum with 1.5 * 2^23 has no fraction bits. */
static inline uint64_t snow_scalar_least4(snow_scalar_vec v) {
    float a = v[0] < v[1] ? v[0] : v[1], b = v[2] < v[3] ? v[2] : v[3];
    float least = a < b ? a : b;
    return least < 65535 ? (uint64_t)(least + 12582912.0f - 12582912.0f)
                         : 65535;
}

static inline unsigned snow_scalar_above32(const uint16_t *a,
                                           const uint16_t *b) {
    unsigned above = 0;
    for (int n = 0; n < 32; n++)
        above |= (unsigned)(a[n] > b[n]) << n / 4;
    return above;
}

static inline void snow_scalar_transpose64(const uint8_t *bytes,
                                           uint64_t *out) {
    for (int n = 0; n < 8; n++) {
        out[n] = 0;
        for (int m = 0; m < 64; m++)
            out[n] |= (uint64_t)(bytes[m] >> n & 1) << m;
    }
}

static inline snow_scalar_vec snow_scalar_sqrt(snow_scalar_vec v) {
    return (snow_scalar_vec){__builtin_sqrtf(v[0]), __builtin_sqrtf(v[1]),
                             __builtin_sqrtf(v[2]), __builtin_sqrtf(v[3])};
}

/* k is in the last bits of the float, and is shifted into the exponent. */
static inline snow_scalar_vec snow_scalar_power2(snow_scalar_vec v) {
    typedef unsigned bits __attribute__((vector_size(16)));
    return (snow_scalar_vec)(((bits)v + 127) << 23);
}

typedef struct snow_scalar_places {
    int32_t n[4];
} snow_scalar_places;

static inline snow_scalar_vec snow_scalar_pick(const float *p,
                                               snow_scalar_places lanes) {
    const int32_t *n = lanes.n;
    return (snow_scalar_vec){p[n[0]], p[n[1]], p[n[2]], p[n[3]]};
}

static inline snow_scalar_places snow_scalar_places2(const int32_t *first) {
    int32_t next = 2 * (first[1] - first[0]);
    return (snow_scalar_places){{0, 1, next, next + 1}};
}

static inline snow_scalar_places snow_scalar_places4(const int32_t *first) {
    (void)first;
    return (snow_scalar_places){{0, 1, 2, 3}};
}

static inline snow_scalar_places snow_scalar_repeat2(void) {
    return (snow_scalar_places){{0, 0, 1, 1}};
}

static inline snow_scalar_places snow_scalar_repeat4(void) {
    return (snow_scalar_places){{0, 0, 0, 0}};
}

static inline void snow_scalar_scatter4(float *p, const uint32_t *n,
                                        snow_scalar_vec v) {
    snow_scalar_store(p + (size_t)n[0] * 4, v);
}

/* As two words each, ignoring their signs. */
static inline unsigned snow_scalar_nonzero4(const float *p) {
    const uint64_t numbers = 0x7fffffff7fffffff;
    unsigned bits = 0;
    for (int i = 0; i < 16; i++) {
        uint64_t halves[2];
        memcpy(halves, p + 4 * i, sizeof halves);
        bits |= (unsigned)(((halves[0] | halves[1]) & numbers) != 0) << i;
    }
    return bits;
}

static inline unsigned snow_scalar_some2(const float *p) {
    const uint64_t numbers = 0x7fffffff7fffffff;
    unsigned bits = 0;
    for (int i = 0; i < 16; i++) {
        uint64_t both;
        memcpy(&both, p + 2 * i, sizeof both);
        bits |= (unsigned)((both & numbers) != 0) << i;
    }
    return bits;
}

static inline int snow_scalar_list(uint64_t bits, uint32_t *n) {
    int count = 0;
    for (; bits; bits &= bits - 1)
        n[count++] = (uint32_t)__builtin_ctzll(bits);
    return count;
}

static inline void snow_scalar_scatter2(float *p, const uint32_t *n,
                                        snow_scalar_vec v) {
    memcpy(p + (size_t)n[0] * 2, &v, 8);
    memcpy(p + (size_t)n[1] * 2, (const char *)&v + 8, 8);
}

#endif
