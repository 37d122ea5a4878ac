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

#endif
