/* splat/gather.h - splatting in gather form: each pixel sums the footprints
 * that reach it. The sum is that of scattering every footprint (model, point
 * 7), in another order.
 *
 * A row of the image is a straight line through the slice. For each pixel that
 * an interesting voxel reaches, the voxels in reach are a window of taps x taps
 * samples (splat/dense.h), and their weights are a product of two rows of the
 * kernel table (splat/kernel_table.h). No pixel is written twice, and no
 * footprint is clipped.
 *
 * Every pixel is always the same sum: its bits do not depend on the encoding,
 * on the distribution of rows among threads or on the instruction set. */
#ifndef SNOW_GATHER_H
#define SNOW_GATHER_H

#include "splat/dense.h"
#include "splat/kernel_table.h"

/* Pixels first .. end - 1 of a row of the image. */
typedef struct snow_run {
    int first, end;
} snow_run;

typedef struct snow_gatherer snow_gatherer;

/* Number of pixels in one bit mask, the first one lowest. */
#define SNOW_GATHER_CHUNK 16

/* A row of the image as a line through the slice, in places of windows: at
 * pixel x, (u + x du, v + x dv); and the pixels that can be reached at all. */
typedef struct snow_line {
    double u, v, du, dv;
    int first, end;
    const uint16_t *open; /* mask of wanted pixels, chunk by chunk */
} snow_line;

/* Window and phases of a row's pixels, in the memory of one thread: arrays of
 * the width, rounded up to 16. */
typedef struct snow_places {
    int32_t *window;        /* its first float */
    int32_t *row_u, *row_v; /* first floats of rows of the kernel tables */
    float *rest_u, *rest_v; /* fraction from there to the next row, 0 to 1 */
    float *u, *v;           /* or, for cubics, four weights for each pixel */
    uint16_t *reached;      /* chunk by chunk */
} snow_places;

/* Reserves memory for rows of `width` pixels; the record begins as zeros.
 * Errors: SNOW_STATUS_NO_MEMORY. Free with snow_release(context,
 * places->window). */
snow_status snow_places_make(snow_context *context, int width,
                             snow_places *places);

/* Gathers the reached pixels of a line into `pixels`, the row's first one, and
 * writes their runs from left to right; returns the number of runs. Other
 * pixels are not changed. */
typedef int snow_gather_fn(const snow_gatherer *gatherer,
                           const snow_dense *dense, const snow_line *line,
                           const snow_places *places, float *pixels,
                           snow_run *runs);

/* The state of one view; begins as zeros; its tables are reused. */
struct snow_gatherer {
    const snow_placement *placement;
    snow_kernel_table phases_u, phases_v;
    bool cubic; /* along both axes */
    snow_dense_shape shape;
    snow_gather_fn *gather;
};

/* Prepares the gatherer for a view; *serves is false where scattering must be
 * used: for instruction sets and kernels without these loops, and slices too
 * large for them. Errors: SNOW_STATUS_NO_MEMORY. Freed by snow_gatherer_fini.
 */
snow_status snow_gatherer_make(snow_context *context,
                               const snow_placement *placement,
                               snow_kernel kernel, int support, int channels,
                               snow_isa isa, snow_gatherer *gatherer,
                               bool *serves);
void snow_gatherer_fini(snow_context *context, snow_gatherer *gatherer);

/* Image rows that a dense slice can reach: [*top, *bottom). */
void snow_gather_rows(const snow_gatherer *gatherer, const snow_dense *dense,
                      int64_t slice, int *top, int *bottom);

/* One row of the image before one slice; as snow_gather_fn, without the pixels
 * whose bits in `open` are 0. `runs` has room for width / 2 + 1. */
int snow_gather_row(const snow_gatherer *gatherer, const snow_dense *dense,
                    int64_t slice, int y, const uint16_t *open,
                    const snow_places *places, float *pixels, snow_run *runs);

/* Clears the bits in `open` of the opaque ones among a row's pixels first ..
 * end - 1 (early termination): anything behind would change them by less than
 * 2^-22, which is within the rounding of their sums. `pixels` are those of the
 * row. */
void snow_gather_close(const float *pixels, snow_run run, int channels,
                       uint16_t *open);

#endif
