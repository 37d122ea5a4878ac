/* splat/taps.h - the paper's footprint tables, one image axis at a time.
 *
 * For each voxel along a grid axis that lies along an image axis: which pixels
 * it reaches, and with what weights.  The product of two such runs is the
 * K x K table of a voxel at its sub-pixel position. */
#ifndef SNOW_TAPS_H
#define SNOW_TAPS_H

#include "splat/kernel.h"

typedef struct snow_taps {
    int32_t *first; /* per voxel: its first pixel */
    int32_t *count; /* per voxel: number of pixels; 0 when it is out of view */
    uint32_t *offset; /* per voxel: where its weights begin */
    float *weights;
    double origin; /* pixel position of voxel 0 that they are made for */
    size_t first_capacity, count_capacity, offset_capacity, weights_capacity;
} snow_taps;

/* Room for `voxels` voxels before `pixels` pixels, in the memory that is there
 * where it suffices; the record begins as zeros.  Errors: SNOW_NO_MEMORY.
 * Free with snow_taps_fini. */
snow_status snow_taps_make(snow_context *context, const snow_taper *taper,
                           int64_t voxels, int pixels, snow_taps *taps);
void snow_taps_fini(snow_context *context, snow_taps *taps);

/* Tabulates weights for voxels at origin + n * step pixels, unless that is
 * what the table holds already. */
void snow_taps_place(snow_taps *taps, const snow_taper *taper, int64_t voxels,
                     int pixels, double origin, double step);

/* The first pixel whose centre is at `from` or beyond, within an axis of
 * `pixels` pixels; `pixels` when there is none.  Called for every row of every
 * footprint, so it rounds by a cast: ceil() is a call without SSE4.1. */
static inline int snow_first_pixel(double from, int pixels) {
    double place = from - 0.5;
    if (!(place > 0))
        return 0;
    if (place > pixels)
        return pixels;
    int below = (int)place;
    return below + ((double)below < place);
}

/* The last pixel whose centre is at `to` or before; -1 when there is none. */
static inline int snow_last_pixel(double to, int pixels) {
    double place = to - 0.5;
    if (!(place >= 0))
        return -1;
    return place < pixels ? (int)place : pixels - 1;
}

#endif
