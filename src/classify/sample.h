/* classify/sample.h - classification at splat time: codes out of IA become
 * samples by table. */
#ifndef SNOW_SAMPLE_H
#define SNOW_SAMPLE_H

#include "classify/codes.h"
#include "classify/fade.h"
#include "classify/normals.h"
#include "simd/isa.h"

/* The most places of a window, and how far beyond the last voxel of IA codes
 * and normals are read (and not used). */
#define SNOW_WINDOW_MOST 63
#define SNOW_SAMPLE_MARGIN 64

#define SNOW_SAMPLE_ROWS                                 \
    64 /* of windows at most: a mask of rows is one word \
        */
#define SNOW_SAMPLES_MOST (SNOW_SAMPLE_ROWS * (SNOW_WINDOW_MOST + 1))

/* Memory for the voxels of some windows, one after another. */
typedef struct snow_sample_room {
    uint16_t codes[SNOW_SAMPLES_MOST + 64], normals[SNOW_SAMPLES_MOST + 64];
    uint32_t entries[SNOW_SAMPLES_MOST + 64]; /* of the palette */
    float factors[SNOW_SAMPLES_MOST + 64], whites[SNOW_SAMPLES_MOST + 64];
    float samples[4 * (SNOW_SAMPLES_MOST + 64)];
    /* With a gradient opacity: */
    uint16_t fades[SNOW_SAMPLES_MOST + 64];
    float opacities[SNOW_SAMPLES_MOST + 64];
} snow_sample_room;

/* Windows of `count` places, of which samples are to be made: premultiplied, 2
 * or 4 floats each, the next voxel of IA where the row's bits have a 1 (lowest
 * first), zeros elsewhere.  The palette is that of classify/codes.h, with its
 * zeros before it; before `gloss` lies an entry that is a number at least.
 * Shaded, the palette holds straight colours, `normals` the voxels' normals and
 * `gloss` the shading table; unshaded, the palette is premultiplied and both
 * are NULL.
 *
 * With a gradient opacity `fades` are the voxels' factors; the palette then
 * holds straight colours and opacities of the reference length, shaded or not,
 * and they become those of `exponent` reference lengths here. */
typedef struct snow_sample_job {
    uint64_t held; /* rows that have a voxel: bit i; the others are passed over,
                      as is what is told of them below */
    int count;
    const uint64_t *bits;
    const unsigned char *const *codes; /* of voxels of each row, of which */
    const uint16_t *const *normals;    /* so many lie before the window: */
    const uint32_t *before;
    const float *palette;
    const snow_gloss *gloss;
    snow_sample_room *room;
    float *samples; /* row i's begin at i * window; SNOW_SAMPLE_BEYOND floats
                       beyond the last row are written, and so are rows that
                       are not held */
    size_t window;  /* floats */
    const uint16_t *const *fades; /* faded only, as the normals */
    float exponent;
} snow_sample_job;

#define SNOW_SAMPLE_BEYOND 16

typedef void snow_sample_fn(const snow_sample_job *job);

snow_sample_fn *snow_sample_of(snow_isa isa, int code_bytes, int channels,
                               bool shaded, bool faded);

#endif
