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
typedef uint64_t snow_scalar_wide __attribute__((vector_size(16)));

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

static inline snow_scalar_vec snow_scalar_sums2(const snow_scalar_vec *v) {
    return (snow_scalar_vec){v[0][0] + v[0][2], v[0][1] + v[0][3],
                             v[1][0] + v[1][2], v[1][1] + v[1][3]};
}

static inline snow_scalar_vec snow_scalar_sums4(const snow_scalar_vec *v) {
    return *v;
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

/* By adding neighbouring groups of bits (Wilkes, Wheeler and Gill 1957). */
static inline int snow_scalar_popcount(uint64_t x) {
    x -= x >> 1 & UINT64_C(0x5555555555555555);
    x = (x & UINT64_C(0x3333333333333333)) +
        (x >> 2 & UINT64_C(0x3333333333333333));
    x = (x + (x >> 4)) & UINT64_C(0x0F0F0F0F0F0F0F0F);
    return (int)(x * UINT64_C(0x0101010101010101) >> 56);
}

static inline snow_scalar_vec snow_scalar_sqrt(snow_scalar_vec v) {
    return (snow_scalar_vec){__builtin_sqrtf(v[0]), __builtin_sqrtf(v[1]),
                             __builtin_sqrtf(v[2]), __builtin_sqrtf(v[3])};
}

static inline snow_scalar_wide snow_scalar_low_times(snow_scalar_wide a,
                                                     snow_scalar_wide b) {
    return (a & 0xFFFFFFFF) * (b & 0xFFFFFFFF);
}

static inline float snow_scalar_fraction(uint64_t place) {
    return (float)(int32_t)((uint32_t)place >> 8) * 0x1p-24f;
}

static inline snow_scalar_vec snow_scalar_fractions1(const uint64_t *p) {
    return (snow_scalar_vec){
        snow_scalar_fraction(p[0]), snow_scalar_fraction(p[1]),
        snow_scalar_fraction(p[2]), snow_scalar_fraction(p[3])};
}

static inline snow_scalar_vec snow_scalar_fractions2(const uint64_t *p) {
    float a = snow_scalar_fraction(p[0]), b = snow_scalar_fraction(p[1]);
    return (snow_scalar_vec){a, a, b, b};
}

static inline snow_scalar_vec snow_scalar_fractions4(const uint64_t *p) {
    return snow_scalar_set1(snow_scalar_fraction(*p));
}

static inline void snow_scalar_scatter4(float *p, const uint32_t *n,
                                        snow_scalar_vec v) {
    snow_scalar_store(p + (size_t)n[0] * 4, v);
}

/* Takes them as two words each, and ignores their signs. */
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
