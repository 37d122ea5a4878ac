/* classify/rays.h - classification at splat time in perspective: each voxel has
 * its own ray, and so its own opacity (model, point 6).
 *
 * a' = 1 - (1 - a)^e = 1 - 2^(e log2(1 - a)): the palette holds the logarithm
 * (snow_palette_make_clear), and e is the root of a polynomial of degree 2
 * along a row, for a ray's length through a slice is that of a vector which is
 * linear there.  Nothing is rounded to levels, so that there are no seams:
 * opacities are off by less than 1e-5 of themselves. */
#ifndef SNOW_RAYS_H
#define SNOW_RAYS_H

#include "classify/codes.h"
#include "classify/normals.h"
#include "classify/sample.h"
#include "simd/isa.h"

/* As snow_sample_fn, with a palette of snow_palette_make_clear; the exponent of
 * place x is the root of square[0] + square[1] x + square[2] x^2.  `gloss` and
 * `normals` may be NULL.  `samples` has room for 16 more.  With a gradient
 * opacity `fades` are the voxels' factors, and the palette is a straight one of
 * the reference length; else NULL. */
typedef void snow_ray_sample_fn(const void *codes, const uint16_t *normals,
                                const uint16_t *fades, uint64_t bits, int count,
                                const float *palette, const snow_gloss *gloss,
                                const float square[3], float *samples);

snow_ray_sample_fn *snow_ray_sample_of(snow_isa isa, int code_bytes,
                                       int channels, bool shaded, bool faded);

#endif
