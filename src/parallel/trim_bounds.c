/* parallel/trim_bounds.c - the boxes around what is not hidden (trim.h).
 *
 * Threads share the slices of a box.  Each widens bounds of its own, within
 * which it looks at no voxel again; what all have found does not depend on who
 * looked at what. */
#include "base/minmax.h"
#include "base/thread_pool.h"
#include "parallel/trim.h"

#include <string.h>

/* Voxels that are looked at together. */
#define BLOCK 256

/* No voxel, as the first one and as the one before the first. */
#define NOWHERE (INT64_C(1) << 60)

static const snow_bounds none = {{NOWHERE, NOWHERE, NOWHERE},
                                 {-NOWHERE, -NOWHERE, -NOWHERE}};

/* A box whose slices threads look at. */
typedef struct search {
    const snow_volume *held;
    const snow_left_out *left;
    snow_extent part;
    snow_box box;
    int threads;
    snow_bounds *found; /* by each thread */
} search;

/* The first or the last of some voxels of a row whose value is outside;
 * `count`, or -1: none is. */
static int64_t find_in_block(const search *s, int64_t at, int64_t count,
                             bool last) {
    double stored[BLOCK];
    int32_t low, high;
    const snow_left_out *left = s->left;
    if (snow_volume_extremes(s->held, at, (size_t)count, &low, &high) &&
        low >= left->low && high <= left->high)
        return last ? -1 : count;
    snow_volume_stored(s->held, at, (size_t)count, stored);
    int64_t n = last ? count - 1 : 0;
    while (n >= 0 && n < count && stored[n] >= left->low &&
           stored[n] <= left->high) /* NaN is not */
        n += last ? -1 : 1;
    return n;
}

/* The same of voxels x .. end - 1 of a row, as a place in it; NOWHERE, or
 * -NOWHERE: none is. */
static int64_t find_first(const search *s, int64_t row, int64_t x,
                          int64_t end) {
    for (; x < end; x += BLOCK) {
        const int64_t count = end - x < BLOCK ? end - x : BLOCK;
        const int64_t n = find_in_block(s, row + x, count, false);
        if (n < count)
            return x + n;
    }
    return NOWHERE;
}

static int64_t find_last(const search *s, int64_t row, int64_t x, int64_t end) {
    for (; x < end; end -= BLOCK) {
        const int64_t count = end - x < BLOCK ? end - x : BLOCK;
        const int64_t n = find_in_block(s, row + end - count, count, true);
        if (n >= 0)
            return end - count + n;
    }
    return -NOWHERE;
}

/* Widens bounds by voxels x .. end - 1 of a row.  Those within are not looked
 * at. */
static void add_row(const search *s, const int64_t at[3], int64_t end,
                    snow_bounds *b) {
    const int64_t *dims = s->held->info.dims, *stored = s->part.stored;
    const int64_t x = at[0],
                  row = ((at[2] - stored[2]) * dims[1] + at[1] - stored[1]) *
                            dims[0] -
                        stored[0];
    const bool within = at[1] >= b->first[1] && at[1] <= b->last[1] &&
                        at[2] >= b->first[2] && at[2] <= b->last[2];
    const int64_t first =
        find_first(s, row, x, within ? SNOW_MIN(b->first[0], end) : end);
    const int64_t last = find_last(
        s, row, within ? SNOW_MAX(b->last[0] + 1, x) : SNOW_MAX(first, x),
        first == NOWHERE && !within ? x : end);
    b->first[0] = SNOW_MIN(b->first[0], first);
    b->last[0] = SNOW_MAX(b->last[0], last);
    for (int i = 1; i < 3 && first != NOWHERE; i++) {
        b->first[i] = SNOW_MIN(b->first[i], at[i]);
        b->last[i] = SNOW_MAX(b->last[i], at[i]);
    }
}

static void look_at_slice(void *of, int64_t item, int worker) {
    const search *s = of;
    const int64_t *first = s->box.first, *count = s->box.count;
    snow_bounds found = s->found[worker]; /* not beside other threads' */
    for (int64_t n = 0; n < count[1]; n++)
        add_row(s, (int64_t[]){first[0], first[1] + n, first[2] + item},
                first[0] + count[0], &found);
    s->found[worker] = found;
}

/* What is held within the ring around a box: a voxel of the box that is so near
 * to one of these is kept. */
static snow_status find_bounds(search *s, const snow_box *box,
                               snow_bounds *out) {
    const snow_box whole = {
        {0, 0, 0}, {s->part.dims[0], s->part.dims[1], s->part.dims[2]}};
    snow_box held;
    *out = none;
    if (!snow_box_voxels(box))
        return SNOW_STATUS_OK;
    memcpy(held.first, s->part.first, sizeof held.first);
    memcpy(held.count, s->part.count, sizeof held.count);
    const snow_box reached = snow_box_widen(box, s->left->ring, &whole);
    if (!snow_box_intersect(&reached, &held, &s->box))
        return SNOW_STATUS_OK;
    for (int n = 0; n < s->threads; n++)
        s->found[n] = none;
    const snow_status status = snow_parallel(s->held->context, s->threads,
                                             s->box.count[2], look_at_slice, s);
    for (int n = 0; n < s->threads; n++) {
        for (int i = 0; i < 3; i++) {
            out->first[i] = SNOW_MIN(out->first[i], s->found[n].first[i]);
            out->last[i] = SNOW_MAX(out->last[i], s->found[n].last[i]);
        }
    }
    return status;
}

snow_status snow_bounds_find(const snow_volume *held, const snow_left_out *left,
                             const snow_box *boxes, int ranks, int threads,
                             snow_bounds *out) {
    search s = {.held = held, .left = left, .threads = threads};
    snow_volume_find_extent(held, &s.part);
    snow_status status = SNOW_RESERVE(held->context, s.found, 0, threads);
    for (int n = 0; n < ranks && status == SNOW_STATUS_OK; n++)
        status = find_bounds(&s, &boxes[n], &out[n]);
    snow_release(held->context, s.found);
    return status;
}

snow_box snow_box_widen(const snow_box *box, const int64_t layers[3],
                        const snow_box *within) {
    snow_box wide = *box, out = {{0, 0, 0}, {0, 0, 0}};
    for (int i = 0; i < 3; i++) {
        wide.first[i] -= layers[i];
        wide.count[i] += 2 * layers[i];
    }
    (void)snow_box_intersect(&wide, within, &out);
    return out;
}
