/* simd/rows.c - byte shuffles that compress and expand 8 numbers of 16 bits by
 * a mask (simd/rows_avx2.h, simd/rows_v128.h). */
#include "simd/isa.h"

#if SNOW_HAS_AVX || SNOW_HAS_V128
#include "simd/rows.h"

/* The place of a mask's n-th set bit, as a byte of a number; 0x80: none. */
#define BIT(m, b) ((m) >> (b)&1)
/* How many bits are set below b. As an expression of the preprocessor's it
 * would be so long that compilers take seconds for it. */
#define BELOW(m, b) __builtin_popcount((m) & ((1 << (b)) - 1))
#define IS_NTH(m, n, b) (BIT(m, b) && BELOW(m, b) == (n))
#define NTH(m, n)           \
    (IS_NTH(m, n, 0)   ? 0  \
     : IS_NTH(m, n, 1) ? 2  \
     : IS_NTH(m, n, 2) ? 4  \
     : IS_NTH(m, n, 3) ? 6  \
     : IS_NTH(m, n, 4) ? 8  \
     : IS_NTH(m, n, 5) ? 10 \
     : IS_NTH(m, n, 6) ? 12 \
     : IS_NTH(m, n, 7) ? 14 \
                       : 0x80)
#define FROM(m, b) (BIT(m, b) ? 2 * BELOW(m, b) : 0x80)
#define PAIR(x) (uint8_t)(x), (uint8_t)((x) | 1)
#define COMPRESS(m)                                                      \
    {PAIR(NTH(m, 0)), PAIR(NTH(m, 1)), PAIR(NTH(m, 2)), PAIR(NTH(m, 3)), \
     PAIR(NTH(m, 4)), PAIR(NTH(m, 5)), PAIR(NTH(m, 6)), PAIR(NTH(m, 7))},
#define EXPAND(m)                                                            \
    {PAIR(FROM(m, 0)), PAIR(FROM(m, 1)), PAIR(FROM(m, 2)), PAIR(FROM(m, 3)), \
     PAIR(FROM(m, 4)), PAIR(FROM(m, 5)), PAIR(FROM(m, 6)), PAIR(FROM(m, 7))},
#define FOUR(of, m) of(m) of((m) + 1) of((m) + 2) of((m) + 3)
#define SIXTEEN(of, m) \
    FOUR(of, m) FOUR(of, (m) + 4) FOUR(of, (m) + 8) FOUR(of, (m) + 12)
#define QUARTER(of, m) \
    SIXTEEN(of, m)     \
    SIXTEEN(of, (m) + 16) SIXTEEN(of, (m) + 32) SIXTEEN(of, (m) + 48)
#define ALL(of) QUARTER(of, 0) QUARTER(of, 64) QUARTER(of, 128) QUARTER(of, 192)

_Alignas(16) const uint8_t snow_rows_compress[256][16] = {ALL(COMPRESS)};
_Alignas(16) const uint8_t snow_rows_expand[256][16] = {ALL(EXPAND)};
#endif
