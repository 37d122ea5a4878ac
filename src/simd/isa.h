/* simd/isa.h - which instruction set the kernels of a picture use.
 *
 * A kernel is one template, instantiated once for each level in one file that
 * needs no special compiler flags; a record of function pointers holds the
 * instances and is picked by level:
 *
 *   scalar   plain C in vectors of 4 floats, which the compiler carries to
 *            SSE2 or NEON: the twin that runs anywhere
 *   avx2     AVX2 and FMA, 8 floats (2013 and later)
 *   avx512   AVX-512 F, BW, VL, DQ, VBMI and VBMI2, 16 floats (2019 and later)
 *
 * avx2 and avx512 round alike, so their pictures have the same bits; scalar
 * multiplies and adds in two roundings. */
#ifndef SNOW_ISA_H
#define SNOW_ISA_H

#include "base/base.h"

#include <snowglass/render.h>

#if defined(__x86_64__)
#define SNOW_HAS_AVX 1
#else
#define SNOW_HAS_AVX 0
#endif

/* Whether this machine runs a level; AUTO and SCALAR always. */
bool snow_isa_runs(snow_isa isa);

/* The level that AUTO stands for here; any other level is itself. */
snow_isa snow_isa_resolve(snow_isa isa);

#endif
