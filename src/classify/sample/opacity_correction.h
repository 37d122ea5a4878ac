/* classify/sample/opacity_correction.h - classification at splat time in
 * perspective: each voxel has its own ray, and so its own opacity (model, point
 * 6).
 *
 * a' = 1 - (1 - a)^e = 1 - 2^(e log2(1 - a)): the palette holds the logarithm
 * (snow_palette_make_clear). Along a row e is the root of a polynomial of
 * degree 2, since the length of a ray through a slice is that of a vector which
 * is linear there. Nothing is quantised, so there are no seams: the relative
 * error of opacities is less than 1e-5. */
#ifndef SNOW_CLASSIFY_SAMPLE_OPACITY_CORRECTION_H
#define SNOW_CLASSIFY_SAMPLE_OPACITY_CORRECTION_H

#include "classify/codes.h"
#include "classify/sample/sample.h"
#include "classify/shading/normals.h"
#include "simd/isa.h"

/* As snow_sample_fn, with a palette of snow_palette_make_clear. The exponent at
 * position x is the root of square[0] + square[1] x + square[2] x^2. `gloss`
 * and `normals` may be NULL. `samples` has room for 16 more. With a gradient
 * opacity `gradient_factors` are the voxels' factors, and the palette is a
 * straight one of the reference length; otherwise it is NULL. */
typedef void snow_ray_sample_fn(const void *codes, const uint16_t *normals,
                                const uint16_t *gradient_factors, uint64_t bits,
                                int count, const float *palette,
                                const snow_gloss *gloss, const float square[3],
                                float *samples);

snow_ray_sample_fn *snow_ray_sample_of(snow_isa isa, int code_bytes,
                                       int channels, bool shaded,
                                       bool with_gradient_opacity);

#endif
