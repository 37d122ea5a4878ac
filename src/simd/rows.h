/* simd/rows.h - vector operations on rows of 32 numbers of 16 bits, for
 * templates that simd/select.h is included for:
 *
 *   V(row)                        the type; all instruction sets give the
 *                                 same bits
 *   V(row_load)(p), V(row_store)(p, a)     any alignment
 *   V(row_set1)(x)
 *   V(row_bytes)(p)               32 unsigned bytes at p
 *   V(row_add)(a, b), V(row_adds), V(row_subs)   the latter two saturate
 *   V(row_mul)(a, b)              the lower 16 bits
 *   V(row_mulhrs)(a, b)           (a b + 2^14) / 2^15, rounded down; not of
 *                                 -2^15 twice
 *   V(row_min)(a, b), V(row_max)  signed
 *   V(row_avg)(a, b)              (a + b + 1) / 2, rounded down
 *   V(row_and)(a, b), V(row_or)
 *   V(row_srl)(a, bits), V(row_sll)        unsigned
 *   V(row_gt)(a, b)               a bit for each number where a > b
 *   V(row_choose)(mask, a, b)     a where a bit is set, else b
 *   V(bytes_outside)(p, first, width)  a bit for each of 64 unsigned bytes at p
 *                                 that is not first .. first + width, which may
 *                                 go round beyond 255
 *   V(row_compress)(p, a, mask)   numbers whose bits are set, to p; may write
 *                                 32
 *   V(row_expand)(p, mask)        the next of the numbers at p where a bit is
 *                                 set, else 0; may read 32
 *   V(row_gather)(table, index, out)  the four words of 32 entries of 64 bits,
 *                                 lowest first; indices are unsigned
 *   V(row_pairs)(p, at, span, out)  numbers p[at[n]] and p[at[n] + 1]; `at`
 *                                 rises, and span is at[31] + 2; may read up to
 *                                 63 numbers beyond that
 *   V(pick_bits)(bits, select)    the bits that are set in `select`, packed
 *   V(rows_window)(low, high, shift, out)  ors the bits `shift` .. shift + 31
 *                                 of 32 pairs of words to 32 words; shift is
 *                                 below 32
 *   V(rows_and)(a, b, columns)    a[n] &= b[n] & columns for 32 words; a bit
 *                                 for each that is not 0
 *   V(row_floats)(p)              LANES numbers at p as floats
 *   V(row_round)(p, v)            LANES floats to the nearest numbers, which
 *                                 saturate; below 2^22
 *   V(row_widen)(a, out)          a row as 32 / LANES vectors of floats, in an
 *                                 order of their own, and back, rounded as by
 *   V(row_narrow)(v)              row_round
 *   V(row_rsqrt)(v)               1 / sqrt(v) within 5e-6, without approximate
 *                                 instructions
 *   V(row_turn)(v, by)            -v where `by` is below 0, else v
 */
#ifndef SNOW_SIMD_ROWS_H
#define SNOW_SIMD_ROWS_H

#include "simd/isa.h"
#include "simd/rows_scalar.h"
#if SNOW_HAS_AVX
#include "simd/rows_avx2.h"
#include "simd/rows_avx512.h"
#endif
#if SNOW_HAS_V128
#include "simd/rows_v128.h"
#endif

#endif
