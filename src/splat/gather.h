/* splat/gather.h - splatting in gather form: each pixel sums the footprints
 * that reach it, which is what throwing every footprint sums (model, point 7),
 * in another order.
 *
 * A row of the image is a straight line through the slice.  At each pixel that
 * an interesting voxel reaches, the voxels in reach are a window of taps x taps
 * samples (splat/dense.h), and their weights a product of two rows of phases
 * (splat/phases.h): no pixel is written twice, and no footprint is clipped.
 *
 * Every pixel is the same sum whoever asks for it: bits depend neither on the
 * encoding nor on how rows are dealt out to threads; nor on the level. */
#ifndef SNOW_GATHER_H
#define SNOW_GATHER_H

#include "splat/dense.h"
#include "splat/phases.h"

/* Pixels first .. end - 1 of a row of the image. */
typedef struct snow_run {
    int first, end;
} snow_run;

typedef struct snow_gatherer snow_gatherer;

/* Pixels that are told as bits of one number, the first one lowest. */
#define SNOW_GATHER_CHUNK 16

/* A row of the image as a line through the slice, in places of windows: at
 * pixel x, (u + x du, v + x dv); and the pixels that can be reached at all. */
typedef struct snow_line {
    double u, v, du, dv;
    int first, end;
    const uint16_t *open; /* pixels that are wanted, chunk by chunk */
} snow_line;

/* Where the pixels of a row look, in the memory of one thread: arrays of
 * the width, rounded up to 16. */
typedef struct snow_places {
    int32_t *window;        /* its first float */
    int32_t *row_u, *row_v; /* first floats of rows of the phase tables */
    float *rest_u, *rest_v; /* from there to the next row, 0 to 1 */
    float *u, *v; /* or, where these are cubics, four weights for each pixel */
    uint16_t *reached; /* chunk by chunk */
    size_t capacity;   /* of the memory, which begins at `window` */
} snow_places;

/* Makes room for rows of `width` pixels; the record begins as zeros.  Errors:
 * SNOW_NO_MEMORY.  Free with snow_release(context, places->window). */
snow_status snow_places_make(snow_context *context, int width,
                             snow_places *places);

/* Gathers the reached pixels of a line into `pixels`, the row's first one, and
 * tells them as runs from left to right; returns their number.  The others are
 * not touched. */
typedef int snow_gather_fn(const snow_gatherer *gatherer,
                           const snow_dense *dense, const snow_line *line,
                           const snow_places *places, float *pixels,
                           snow_run *runs);

/* All that one view needs; begins as zeros, and keeps its tables. */
struct snow_gatherer {
    const snow_placement *placement;
    snow_phases phases_u, phases_v;
    bool cubic; /* along both axes */
    snow_dense_shape shape;
    snow_gather_fn *gather;
};

/* Readies the gatherer for a view; *serves is false where throwing has to do:
 * levels and kernels without these loops, and slices beyond their numbers.
 * Errors: SNOW_NO_MEMORY.  Free with snow_gatherer_fini. */
snow_status snow_gatherer_make(snow_context *context,
                               const snow_placement *placement,
                               snow_kernel kernel, int support, int channels,
                               snow_isa isa, snow_gatherer *gatherer,
                               bool *serves);
void snow_gatherer_fini(snow_context *context, snow_gatherer *gatherer);

/* Image rows that a spread-out slice can reach: [*top, *bottom). */
void snow_gather_rows(const snow_gatherer *gatherer, const snow_dense *dense,
                      int64_t slice, int *top, int *bottom);

/* One row of the image before one slice; as snow_gather_fn, less the pixels
 * whose bits in `open` are 0.  `runs` has room for width / 2 + 1. */
int snow_gather_row(const snow_gatherer *gatherer, const snow_dense *dense,
                    int64_t slice, int y, const uint16_t *open,
                    const snow_places *places, float *pixels, snow_run *runs);

/* Takes the opaque ones of a row's pixels first .. end - 1 out of `open`: what
 * lies behind them would change them by less than 2^-22, which is within the
 * rounding of their sums.  `pixels` are those of the row. */
void snow_gather_close(const float *pixels, snow_run run, int channels,
                       uint16_t *open);

#endif
