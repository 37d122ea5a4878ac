/* classify/sample.h - classification at splat time: codes out of IA become
 * samples by table. */
#ifndef SNOW_SAMPLE_H
#define SNOW_SAMPLE_H

#include "classify/codes.h"
#include "classify/normals.h"
#include "simd/isa.h"

/* The most places of a window, and how far beyond the last voxel of IA codes
 * and normals are read (and not used). */
#define SNOW_WINDOW_MOST 63
#define SNOW_SAMPLE_MARGIN 64

/* Samples of a window of `count` places, premultiplied, 2 or 4 floats each: the
 * next voxel of IA where `bits` has a 1 (lowest first), zeros elsewhere.  The
 * palette is that of classify/codes.h, with its zeros before it; before `gloss`
 * lies an entry that is a number at least; `samples` has room for 8 more.
 * Shaded, the palette holds straight colours, `normals` the voxels' normals and
 * `gloss` the shading table; unshaded, the palette is premultiplied and both
 * are NULL. */
typedef void snow_sample_fn(const void *codes, const uint16_t *normals,
                            uint64_t bits, int count, const float *palette,
                            const snow_gloss *gloss, float *samples);

snow_sample_fn *snow_sample_of(snow_isa isa, int code_bytes, int channels,
                               bool shaded);

#endif
