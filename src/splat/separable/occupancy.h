/* splat/separable/occupancy.h - the occupancy map: which windows of a slice
 * hold a voxel of a sparse matrix, with a bit for each place of a window of
 * taps x taps voxels.
 *
 * A place is that of the window's first voxel, and place 0 is `taps` before the
 * grid: window i .. i + taps - 1 has place i + taps. */
#ifndef SNOW_SPLAT_SEPARABLE_OCCUPANCY_H
#define SNOW_SPLAT_SEPARABLE_OCCUPANCY_H

#include "encode/decode.h"

typedef struct snow_occupancy {
    int taps[2];       /* along u and v */
    int64_t places[2]; /* columns + taps + 1, rows + taps + 1 */
    int64_t slices;
    size_t words;    /* of a row of places */
    uint64_t *bits;  /* [slice][row of places][word] */
    size_t capacity; /* bytes */
} snow_occupancy;

/* Fills the map from bands, with threads; the record begins as zeros. Errors:
 * SNOW_STATUS_NO_MEMORY. Free with snow_release(context, reached->bits). */
snow_status snow_occupancy_make(const snow_bands *bands, const int taps[2],
                                const snow_decode_fns *windows, int threads,
                                snow_occupancy *reached);

/* Whether the window at a place of the slice holds a voxel. */
static inline bool snow_occupancy_at(const snow_occupancy *r, int64_t slice,
                                     int64_t u, int64_t v) {
    size_t row = (size_t)(slice * r->places[1] + v);
    return r->bits[row * r->words + (size_t)u / 64] >> (u % 64) & 1;
}

/* The first slice in which rays can hit a voxel, for parallel rays: a ray at
 * place (a, b) on slice 0 is at (a + k slope[0], b + k slope[1]) on slice k.
 * Cells are integer places on slice 0:
 *
 *   slice k      . . # # .        moved by -floor(k slope)
 *   slice 1    . # # . .     --->   cell   0  1  2  3
 *   slice 0  . . . . .              first  .  1  1  k */
typedef struct snow_first_hit {
    int64_t low[2]; /* place of cell 0; may be negative */
    int64_t cells[2];
    int32_t *slices; /* number of slices before the first hit; -1: no hit */
    uint64_t *found; /* a row of bits for each thread */
    size_t capacity, found_capacity; /* bytes */
} snow_first_hit;

/* Fills `first`, which begins as zeros, for rays that come from slice 0
 * (`rising`) or from the last one. Errors: SNOW_STATUS_NO_MEMORY. Free with
 * snow_release of `slices` and `found`. */
snow_status snow_first_hit_make(snow_context *context,
                                const snow_occupancy *reached,
                                const double slope[2], bool rising, int threads,
                                snow_first_hit *first);

/* The number of slices that the ray of place (a, b) on slice 0 passes before
 * the first that may hold a voxel for it; -1 if there is none. */
static inline int32_t snow_first_hit_of(const snow_first_hit *first, double a,
                                        double b) {
    double u = a - (double)first->low[0], v = b - (double)first->low[1];
    if (!(u >= 0 && v >= 0 && u < (double)first->cells[0] &&
          v < (double)first->cells[1]))
        return -1;
    return first->slices[(int64_t)v * first->cells[0] + (int64_t)u];
}

#endif
