/* splat/footprint/table.h - the paper's footprint tables, one image axis at a
 * time.
 *
 * For each voxel along a grid axis that is parallel to an image axis: the
 * pixels that it reaches, and their weights.  The product of two such runs is
 * the K x K table of a voxel at its sub-pixel position. */
#ifndef SNOW_SPLAT_FOOTPRINT_TABLE_H
#define SNOW_SPLAT_FOOTPRINT_TABLE_H

#include "splat/kernel.h"

typedef struct snow_footprint_table {
    int32_t *first; /* per voxel: its first pixel */
    int32_t *count; /* per voxel: number of pixels; 0 when it is out of view */
    uint32_t *offset; /* per voxel: start of its weights */
    float *weights;
    double origin; /* pixel position of voxel 0 for these weights */
} snow_footprint_table;

/* Reserves memory for `voxels` voxels before `pixels` pixels, or reuses it
 * where it suffices; the record begins as zeros. Errors: SNOW_STATUS_NO_MEMORY.
 * Free with snow_footprint_table_fini. */
snow_status snow_footprint_table_make(snow_context *context,
                                      const snow_scaled_kernel *scaled_kernel,
                                      int64_t voxels, int pixels,
                                      snow_footprint_table *taps);
void snow_footprint_table_fini(snow_context *context,
                               snow_footprint_table *taps);

/* Tabulates weights for voxels at origin + n * step pixels, unless the table
 * holds these already. */
void snow_footprint_table_place(snow_footprint_table *taps,
                                const snow_scaled_kernel *scaled_kernel,
                                int64_t voxels, int pixels, double origin,
                                double step);

/* The first pixel whose centre is at `from` or beyond, within an axis of
 * `pixels` pixels; `pixels` if there is none. Called for every row of every
 * footprint, so it rounds by a cast: without SSE4.1 ceil() is a call. */
static inline int snow_first_pixel(double from, int pixels) {
    double place = from - 0.5;
    if (!(place > 0))
        return 0;
    if (place > pixels)
        return pixels;
    int below = (int)place;
    return below + ((double)below < place);
}

/* The last pixel whose centre is at `to` or before; -1 if there is none. */
static inline int snow_last_pixel(double to, int pixels) {
    double place = to - 0.5;
    if (!(place >= 0))
        return -1;
    return place < pixels ? (int)place : pixels - 1;
}

#endif
