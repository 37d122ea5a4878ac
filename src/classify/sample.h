/* classify/sample.h - classification at splat time: codes out of IA become
 * samples by table. */
#ifndef SNOW_SAMPLE_H
#define SNOW_SAMPLE_H

#include "classify/codes.h"
#include "classify/normals.h"

/* Samples of `count` voxels in a row, premultiplied, 2 or 4 floats each.
 * Shaded, the palette holds straight colours, `normals` the voxels' normals
 * and `gloss` the shading table; unshaded, the palette is premultiplied and
 * both are NULL. */
typedef void snow_sample_fn(const void *codes, const uint16_t *normals,
                            size_t count, const float *palette,
                            const snow_gloss *gloss, float *samples);

snow_sample_fn *snow_sample_of(int code_bytes, int channels, bool shaded);

#endif
