/* simd/isa.h - the instruction set of a picture's kernels.
 *
 * A kernel is one template, instantiated once for each instruction set in one
 * file that needs no special compiler flags. A record of function pointers
 * holds the instances:
 *
 *   scalar   plain C in vectors of 4 floats, which the compiler translates to
 *            SSE2 or NEON; runs on any machine
 *   sse4     the same, but shear-warp's tiles by SSE4.1 (2008 and later)
 *   neon     the same by NEON (64-bit ARM)
 *   wasm     the same by WebAssembly's vectors (-msimd128)
 *   avx2     AVX2 and FMA, 8 floats (2013 and later)
 *   avx512   AVX-512 F, BW, VL, DQ, VBMI and VBMI2, 16 floats (2019 and later)
 *
 * avx2 and avx512 round alike, so their pictures have the same bits; the others
 * round after both multiplication and addition. */
#ifndef SNOW_ISA_H
#define SNOW_ISA_H

#include "base/base.h"

#include <snowglass/render.h>

#if defined(__x86_64__)
#define SNOW_HAS_AVX 1
#else
#define SNOW_HAS_AVX 0
#endif

/* The shear-warp's tiles alone: compilers translate the rest well. */
#if SNOW_HAS_AVX || defined(__aarch64__) || defined(__wasm_simd128__)
#define SNOW_HAS_V128 1
#else
#define SNOW_HAS_V128 0
#endif

/* What the thread sanitizer does not look at. For loops that hold no atomics:
 * it calls a function for each vector that they load or store. */
#if defined(__SANITIZE_THREAD__)
#define SNOW_UNWATCHED __attribute__((no_sanitize("thread")))
#else
#define SNOW_UNWATCHED
#endif

/* `name` with the suffix of an instruction set, which was resolved. */
#if SNOW_HAS_AVX
#define SNOW_OF_ISA(isa, name)                \
    ((isa) == SNOW_ISA_AVX512 ? name##_avx512 \
     : (isa) == SNOW_ISA_AVX2 ? name##_avx2   \
                              : name##_scalar)
#else
#define SNOW_OF_ISA(isa, name) ((void)(isa), name##_scalar)
#endif

/* Returns whether this machine has an instruction set; AUTO and SCALAR
 * always. */
bool snow_isa_runs(snow_isa isa);

/* The instruction set that AUTO means here; others are returned unchanged. */
snow_isa snow_isa_resolve(snow_isa isa);

/* The fastest one whose pictures have the same bits as those of scalar. */
snow_isa snow_isa_same(void);

#endif
