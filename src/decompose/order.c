/* decompose/order.c - see order.h.
 *
 * A ray meets two boxes that are separated along an axis in the order in which
 * it runs along that axis. If two axes disagree no ray meets both boxes; if all
 * agree some rays may. This relation is sorted topologically. Boxes of a grid,
 * of a k-d tree and of slabs have no cycles; three boxes around a corner may
 * have one. */
#include "decompose/order.h"

#include <string.h>

/* 1 if rays run from `a` to `b` along an axis on which they are separated, with
 * `a` lower; -1 from `b` to `a`; 0 if none does. */
static int runs_upward(const snow_viewer *viewer, int axis, int64_t a_end,
                       int64_t b_first) {
    if (!viewer->perspective)
        return (viewer->along[axis] > 0) - (viewer->along[axis] < 0);
    /* A ray from an eye between the two meets only one of them. */
    if (viewer->eye[axis] <= (double)a_end - 0.5)
        return 1;
    return viewer->eye[axis] >= (double)b_first - 0.5 ? -1 : 0;
}

/* The same with the boxes in either order; 2 if they are not separated. */
static int before_along(const snow_box *a, const snow_box *b,
                        const snow_viewer *viewer, int axis) {
    int64_t a_end = a->first[axis] + a->count[axis];
    int64_t b_end = b->first[axis] + b->count[axis];
    if (a_end <= b->first[axis])
        return runs_upward(viewer, axis, a_end, b->first[axis]);
    if (b_end <= a->first[axis])
        return -runs_upward(viewer, axis, b_end, a->first[axis]);
    return 2;
}

/* 1 if every ray that meets both boxes meets `a` first, -1 if `b` first, 0 if
 * no ray meets both. The boxes are disjoint; they extend half a voxel to all
 * sides. */
static int box_before(const snow_box *a, const snow_box *b,
                      const snow_viewer *viewer) {
    int found = 2;
    for (int axis = 0; axis < 3; axis++) {
        int here = before_along(a, b, viewer, axis);
        if (here == 2)
            continue;
        if (here == 0 || (found != 2 && found != here))
            return 0;
        found = here;
    }
    return found == 2 ? 0 : found;
}

static bool is_empty(const snow_box *box) {
    return !box->count[0] || !box->count[1] || !box->count[2];
}

/* Counts for each box the boxes before it; false if two overlap. */
static bool count_before(const snow_box *boxes, int count,
                         const snow_viewer *viewer, int *before) {
    for (int a = 0; a < count; a++)
        for (int b = a + 1; b < count; b++) {
            if (is_empty(&boxes[a]) || is_empty(&boxes[b]))
                continue;
            snow_box shared;
            if (snow_box_intersect(&boxes[a], &boxes[b], &shared))
                return false;
            int order = box_before(&boxes[a], &boxes[b], viewer);
            before[b] += order > 0;
            before[a] += order < 0;
        }
    return true;
}

/* Removes boxes with no box before them, the lowest number first; returns their
 * number. Each is compared with all others once: count^2 steps. */
static int take_boxes(const snow_box *boxes, int count,
                      const snow_viewer *viewer, int *before, int *order) {
    int taken = 0, ready = 0;
    for (int n = 0; n < count; n++)
        if (!is_empty(&boxes[n]) && before[n] == 0)
            order[ready++] = n;
    for (; taken < ready; taken++) {
        const snow_box *box = &boxes[order[taken]];
        for (int n = 0; n < count; n++)
            if (n != order[taken] && !is_empty(&boxes[n]) &&
                box_before(box, &boxes[n], viewer) > 0 && --before[n] == 0)
                order[ready++] = n;
    }
    for (int n = 0; n < count; n++)
        if (is_empty(&boxes[n]))
            order[ready++] = n;
    return ready;
}

snow_status snow_order_boxes(snow_context *context, const snow_box *boxes,
                             int count, const snow_viewer *viewer, int *order) {
    int *work = NULL;
    SNOW_TRY(
        snow_reserve(context, &work, 0, (uint64_t)count, 2 * sizeof *work));
    int *before = work, *found = work + count;
    memset(work, 0, (size_t)count * 2 * sizeof *work);
    snow_status status = SNOW_STATUS_OK;
    if (!count_before(boxes, count, viewer, before))
        status = snow_fail(context, SNOW_STATUS_BAD_USAGE,
                           "parts of the volume overlap: every voxel must "
                           "belong to one processor only");
    else if (take_boxes(boxes, count, viewer, before, found) < count)
        status = snow_fail(context, SNOW_STATUS_BAD_USAGE,
                           "parts of the volume have no order from front to "
                           "back: they occlude each other in a cycle; "
                           "partition it into slabs, a grid or a k-d tree");
    if (status == SNOW_STATUS_OK)
        memcpy(order, found, (size_t)count * sizeof *order);
    snow_release(context, work);
    return status;
}
