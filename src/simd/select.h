/* clang-format off */
/* simd/select.h - gives a template the vector operations of one instruction
 * set. Define one of these before including; it is undefined again:
 *
 *   SELECT_SCALAR, SELECT_AVX2, SELECT_AVX512, SELECT_V128
 *
 * A template then uses
 *
 *   LANES         floats of a vector: 4, 8 or 16
 *   TARGET        attribute of each function of the template, and TARGET_ALSO,
 *                 which a file may define before (not of scalar)
 *   NAME(word)    word with the instruction set appended, as in over_avx2
 *   V(vec)        the vector type
 *   VC(word, n)   V(word2) or V(word4): n is a macro of 2 or 4 channels
 *   V(load)(p), V(store)(p, v)     any alignment
 *   V(set1)(x), V(add)(a, b), V(sub)(a, b), V(mul)(a, b)
 *   V(min)(a, b), V(max)(a, b)     b if one is NaN
 *   V(fma)(a, b, c)                a b + c; one rounding, two for scalar
 *   V(alpha2)(v), V(alpha4)(v)     the last channel of each pixel of 2 or 4
 *                                  floats, in all of its lanes
 *   V(gather4)(p, n), V(gather2)   entries n[0], n[1] ... of a table of 4 or 2
 *                                  floats each, as many as a vector holds
 *   V(load_pairs2)(p, at, left, right), V(load_pairs4)
 *                                  pixels of 2 or 4 floats at p + at[0], p +
 *                                  at[1] ..., as many as a vector holds, and
 *                                  those behind each of them; not avx512
 *   V(popcount)(x)                 bits that are set in a uint64_t
 *   V(sums4)(v), V(sums2)(v)       the sum of the pixels of each of LANES / 4
 *                                  or / 2 vectors, by halves; not sums2 of
 *                                  avx512
 *   V(sqrt)(v)                     the square root, rounded correctly
 *   V(wide)                        a type: LANES / 2 numbers of 64 bits
 *   V(low_times)(a, b)             products of their lower 32 bits
 *   V(fractions4)(p), V(fractions2), V(fractions1)
 *                                  the lower 32 bits of numbers of 64 bits at p
 *                                  as fractions of 24 bits, each 4, 2 times or
 *                                  once, as many as a vector holds; of avx512
 *                                  only the last
 *   V(scatter4)(p, n, v), V(scatter2)
 *                                  stores the pixels of v, of 4 or 2 floats,
 *                                  as entries n[0], n[1] ... of a table;
 *                                  avx512 has no scatter2, but
 *   V(next2)(p, bits)              pixels of 2 floats: the next of those at p
 *                                  where a bit is set, else zeros; may read 16
 *                                  floats beyond the last; only avx512
 *   V(compress2)(p, bits, out)     the reverse: those of a vector's pixels at p
 *                                  whose bits are set, to out; others are not
 *                                  read; returns their number; may write 16
 *                                  floats in all; only avx512
 *   V(nonzero4)(p), V(some2)(p)    of 16 pixels of 4 or 2 floats at p, a bit
 *                                  for each that holds more than 0 and -0
 *   V(list)(bits, n)               writes the indices of the bits set in a
 *                                  uint64_t, rising, to n; returns their
 *                                  number.  Writes 64 + 8 numbers at most
 *
 * simd/each_isa.h includes a template for every instruction set; no file needs
 * special compiler flags.
 */
/* clang-format on */
#include "simd/isa.h"
#include "simd/vec_scalar.h"
#if SNOW_HAS_AVX
#include "simd/vec_avx2.h"
#include "simd/vec_avx512.h"
#endif

#undef LANES
#undef TARGET
#undef NAME
#undef V
#ifndef TARGET_ALSO
#define TARGET_ALSO
#endif
#define VC(word, channels) SNOW_VC(word, channels)
#define SNOW_VC(word, channels) V(word##channels)

#if defined(SELECT_SCALAR)
#undef SELECT_SCALAR
#define LANES SNOW_SCALAR_LANES
#define TARGET SNOW_SCALAR_TARGET
#define NAME(word) word##_scalar
#define V(word) snow_scalar_##word
#elif defined(SELECT_AVX2)
#undef SELECT_AVX2
#define LANES SNOW_AVX2_LANES
#define TARGET SNOW_AVX2_TARGET TARGET_ALSO
#define NAME(word) word##_avx2
#define V(word) snow_avx2_##word
#elif defined(SELECT_AVX512)
#undef SELECT_AVX512
#define LANES SNOW_AVX512_LANES
#define TARGET SNOW_AVX512_TARGET TARGET_ALSO
#define NAME(word) word##_avx512
#define V(word) snow_avx512_##word
#elif defined(SELECT_V128)
#undef SELECT_V128
#define LANES SNOW_V128_LANES
#define TARGET SNOW_V128_TARGET
#define NAME(word) word##_v128
#define V(word) snow_v128_##word
#endif
