/* splat/reached.h - which windows of a slice hold a voxel of a sparse matrix: a
 * bit for each place of a window of taps x taps voxels.
 *
 * A place counts from the window's first voxel, and `taps` before the grid is
 * place 0: window i .. i + taps - 1 has place i + taps. */
#ifndef SNOW_REACHED_H
#define SNOW_REACHED_H

#include "encode/windows.h"

typedef struct snow_reached {
    int taps[2];       /* along u and v */
    int64_t places[2]; /* columns + taps + 1, rows + taps + 1 */
    int64_t slices;
    size_t words;    /* of a row of places */
    uint64_t *bits;  /* [slice][row of places][word] */
    size_t capacity; /* bytes */
} snow_reached;

/* Fills the map from bands, on threads; the record begins as zeros.  Errors:
 * SNOW_NO_MEMORY.  Free with snow_release(context, reached->bits). */
snow_status snow_reached_make(const snow_bands *bands, const int taps[2],
                              const snow_window_fns *windows, int threads,
                              snow_reached *reached);

/* Whether the window at a place, which is one of the slice's, holds a voxel. */
static inline bool snow_reached_at(const snow_reached *r, int64_t slice,
                                   int64_t u, int64_t v) {
    size_t row = (size_t)(slice * r->places[1] + v);
    return r->bits[row * r->words + (size_t)u / 64] >> (u % 64) & 1;
}

/* The first slice that rays can meet something in, for rays that all run alike:
 * one that has place (a, b) on slice 0 has (a + k slope[0], b + k slope[1]) on
 * slice k.  Cells are those of whole places on slice 0:
 *
 *   slice k      . . # # .        moved by -floor(k slope)
 *   slice 1    . # # . .     --->   cell   0  1  2  3
 *   slice 0  . . . . .              first  .  1  1  k                       */
typedef struct snow_first {
    int64_t low[2]; /* the place of cell 0; may be below 0 */
    int64_t cells[2];
    int32_t
        *slices; /* how many slices a ray passes before; -1: it meets none */
    uint64_t *found;                 /* room for a row of bits of each thread */
    size_t capacity, found_capacity; /* bytes */
} snow_first;

/* Fills `first`, which begins as zeros, for rays that come from slice 0
 * (`rising`) or from the last one.  Errors: SNOW_NO_MEMORY.  Free with
 * snow_release of `slices` and `found`. */
snow_status snow_first_make(snow_context *context, const snow_reached *reached,
                            const double slope[2], bool rising, int threads,
                            snow_first *first);

/* How many slices the ray of place (a, b) on slice 0 passes before one that it
 * may meet something in; -1: there is none. */
static inline int32_t snow_first_of(const snow_first *first, double a,
                                    double b) {
    double u = a - (double)first->low[0], v = b - (double)first->low[1];
    if (!(u >= 0 && v >= 0 && u < (double)first->cells[0] &&
          v < (double)first->cells[1]))
        return -1;
    return first->slices[(int64_t)v * first->cells[0] + (int64_t)u];
}

#endif
