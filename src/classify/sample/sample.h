/* classify/sample/sample.h - classification at splat time: a table turns codes
 * from IA into samples. */
#ifndef SNOW_CLASSIFY_SAMPLE_SAMPLE_H
#define SNOW_CLASSIFY_SAMPLE_SAMPLE_H

#include "classify/codes.h"
#include "classify/gradient_opacity.h"
#include "classify/shading/normals.h"
#include "simd/isa.h"

/* The largest width of a window, and how far beyond the last voxel of IA codes
 * and normals are read (but not used). */
#define SNOW_WINDOW_MOST 63
#define SNOW_SAMPLE_MARGIN 64

#define SNOW_SAMPLE_ROWS \
    64 /* windows at most: a mask of rows is one 64-bit word */
#define SNOW_SAMPLES_MOST (SNOW_SAMPLE_ROWS * (SNOW_WINDOW_MOST + 1))

/* Scratch memory for the voxels of some windows, in sequence. */
typedef struct snow_sample_room {
    uint16_t codes[SNOW_SAMPLES_MOST + 64], normals[SNOW_SAMPLES_MOST + 64];
    uint32_t entries[SNOW_SAMPLES_MOST + 64]; /* of the palette */
    float factors[SNOW_SAMPLES_MOST + 64], whites[SNOW_SAMPLES_MOST + 64];
    float samples[4 * (SNOW_SAMPLES_MOST + 64)];
    /* With a gradient opacity: */
    uint16_t gradient_factors[SNOW_SAMPLES_MOST + 64];
    float opacities[SNOW_SAMPLES_MOST + 64];
} snow_sample_room;

/* Windows of `count` places for which samples are made: premultiplied, 2 or 4
 * floats each. Where the row's bits have a 1 (lowest first) the sample is that
 * of the next voxel of IA; elsewhere it is zero. The palette is that of
 * classify/codes.h, with zeros before it; the entry before `gloss` must be a
 * number. Shaded, the palette holds straight colours, `normals` the voxels'
 * normals and `gloss` the shading table; unshaded, the palette is premultiplied
 * and both are NULL.
 *
 * With a gradient opacity `gradient_factors` are the voxels' factors. The
 * palette then holds straight colours and opacities of the reference length,
 * shaded or not; they are corrected here for `exponent` reference lengths. */
typedef struct snow_sample_job {
    uint64_t held; /* rows that have a voxel: bit i; other rows are skipped, and
                      the fields below are unused for them */
    int count;
    const uint64_t *bits;
    const unsigned char *const *codes; /* codes of each row, of which */
    const uint16_t *const *normals;    /* this many lie before the window: */
    const uint32_t *before;
    const float *palette;
    const snow_gloss *gloss;
    snow_sample_room *room;
    float *samples; /* row i's begin at i * window; SNOW_SAMPLE_BEYOND floats
                       beyond the last row are written, and also rows without a
                       voxel */
    size_t window;  /* floats */
    const uint16_t *const *gradient_factors; /* NULL: no gradient opacity */
    float exponent;
} snow_sample_job;

#define SNOW_SAMPLE_BEYOND 16

typedef void snow_sample_fn(const snow_sample_job *job);

snow_sample_fn *snow_sample_of(snow_isa isa, int code_bytes, int channels,
                               bool shaded, bool with_gradient_opacity);

#endif
