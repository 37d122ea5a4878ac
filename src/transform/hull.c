/* transform/hull.c - see hull.h.
 *
 * A corner of the convex hull of all points is one of the convex hull of those
 * in each plane that it lies in.  So slices along one axis after another lose
 * all points but such corners, by Andrew's monotone chain (1979). */
#include "transform/hull.h"

#include <stdlib.h>
#include <string.h>

/* By z, then y, then x. */
static int compare(const void *a, const void *b) {
    const double *p = a, *q = b;
    for (int i = 2; i >= 0; i--)
        if (p[i] != q[i])
            return p[i] < q[i] ? -1 : 1;
    return 0;
}

/* Whether the way from a by b to c turns to the left, 1 or -1 times. */
static bool turns(const double a[3], const double b[3], const double c[3],
                  int side) {
    return side *
               ((b[1] - a[1]) * (c[0] - b[0]) - (b[0] - a[0]) * (c[1] - b[1])) >
           0;
}

/* Leaves the corners of sorted points of one z in their place; returns how
 * many.  `chain` has room for twice the points. */
static size_t keep_corners(double (*points)[3], size_t count,
                           double (*chain)[3]) {
    size_t kept = 0, begin = 0;
    for (int side = -1; side <= 1; side += 2) {
        begin = kept;
        for (size_t n = 0; n < count; n++) {
            while (kept >= begin + 2 &&
                   !turns(chain[kept - 2], chain[kept - 1], points[n], side))
                kept--;
            memcpy(chain[kept++], points[n], sizeof *points);
        }
    }
    /* Both chains have the first point and the last one. */
    if (--kept > begin)
        memmove(chain[begin], chain[--kept], sizeof *chain);
    memcpy(points, chain, kept * sizeof *points);
    return kept;
}

/* The same of the points of each z, from one point on. */
static snow_status keep_in_planes(snow_hull *h, size_t from) {
    size_t kept = from, end;
    SNOW_TRY(SNOW_RESERVE(h->context, h->spare, 0, 2 * (h->count - from)));
    for (size_t n = from; n < h->count; n = end) {
        for (end = n + 1;
             end < h->count && h->points[end][2] == h->points[n][2];)
            end++;
        const size_t corners = keep_corners(h->points + n, end - n, h->spare);
        memmove(h->points + kept, h->points + n, corners * sizeof *h->points);
        kept += corners;
    }
    h->count = kept;
    return SNOW_STATUS_OK;
}

snow_status snow_hull_add(snow_hull *h, const snow_extent *part,
                          uint32_t (*rows)[2]) {
    for (int64_t z = 0; z < part->count[2]; z++) {
        const size_t from = h->count, most = 2 * (size_t)part->count[1];
        SNOW_TRY(SNOW_RESERVE(h->context, h->points, from, from + most));
        for (int64_t y = 0; y < part->count[1]; y++, rows++)
            for (int end = 0; (*rows)[0] <= (*rows)[1] && end < 2; end++) {
                double *at = h->points[h->count++];
                at[0] = (double)(part->first[0] + (*rows)[end]);
                at[1] = (double)(part->first[1] + y);
                at[2] = (double)(part->first[2] + z);
            }
        SNOW_TRY(keep_in_planes(h, from));
    }
    return SNOW_STATUS_OK;
}

snow_status snow_hull_end(snow_hull *h) {
    /* Axes change places, so that each of them is z once more. */
    for (int axis = 0; axis < 3; axis++) {
        for (size_t n = 0; n < h->count; n++) {
            double *p = h->points[n], x = p[0];
            p[0] = p[1];
            p[1] = p[2];
            p[2] = x;
        }
        if (axis == 2 || h->count == 0)
            continue;
        qsort(h->points, h->count, sizeof *h->points, compare);
        SNOW_TRY(keep_in_planes(h, 0));
    }
    return SNOW_STATUS_OK;
}

void snow_hull_free(snow_hull *h) {
    snow_release(h->context, h->points);
    snow_release(h->context, h->spare);
}
