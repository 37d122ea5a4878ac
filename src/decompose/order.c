/* decompose/order.c - see order.h.
 *
 * Slabs, grids and k-d trees whose parts are numbered side by side, as those of
 * partition.h are, form a tree of cuts: wherever two boxes that follow one
 * another together are a box, that is a cut.
 *
 *   +---+-------+     boxes    0  1  2  3  4
 *   | 0 |   2   |     cuts     +--+  |  +--+      each in front of or behind
 *   +---+---+---+              |     +--+         the other side as a whole
 *   | 1 | 3 | 4 |              +-----+
 *   +---+---+---+
 *
 * Such cuts are found with one stack, in O(n) steps. What they leave of other
 * boxes is sorted topologically: `a` comes before `b` where no axis forbids it
 * (occluded.h). Boxes around a corner may have a cycle; so may joined ones that
 * have none by themselves, which are then sorted one by one. */
#include "decompose/order.h"

#include "decompose/occluded.h"

#include <string.h>

/* A plane between two sides: each is a box's number, or ~ the number of a cut.
 */
typedef struct cut {
    int64_t plane; /* the high side's first voxel */
    int axis, low, high;
} cut;

/* Boxes that are not empty, joined where that makes a box. */
typedef struct ordering {
    snow_context *context;
    const snow_viewer *viewer;
    const snow_box *boxes; /* all */
    int count;
    snow_box *joined;
    int *numbers; /* of those: a box's, or ~ that of its first cut */
    int sides;
    cut *cuts;
    int *stack, *order;
    int placed;
} ordering;

/* --- cuts ----------------------------------------------------------------- */

/* The only axis along which two boxes differ; -1: there are others. */
static int axis_between(const snow_box *a, const snow_box *b) {
    int axis = -1;
    for (int i = 0; i < 3; i++) {
        if (a->first[i] == b->first[i] && a->count[i] == b->count[i])
            continue;
        if (axis >= 0)
            return -1;
        axis = i;
    }
    return axis;
}

/* Makes a box of the last two, which are then one side of a cut each; false
 * where they make none. */
static bool join(ordering *o, cut *out) {
    snow_box *a = &o->joined[o->sides - 2], *b = a + 1;
    int *number = &o->numbers[o->sides - 2];
    const int axis = axis_between(a, b);
    if (axis < 0)
        return false;
    const bool rises = a->first[axis] < b->first[axis];
    const snow_box *low = rises ? a : b, *high = rises ? b : a;
    if (low->first[axis] + low->count[axis] != high->first[axis])
        return false;
    *out = (cut){high->first[axis], axis, number[!rises], number[rises]};
    a->first[axis] = low->first[axis];
    a->count[axis] += b->count[axis];
    o->sides--;
    return true;
}

static void find_cuts(ordering *o) {
    int found = 0;
    for (int n = 0; n < o->count; n++) {
        if (!snow_box_voxels(&o->boxes[n]))
            continue;
        o->joined[o->sides] = o->boxes[n];
        o->numbers[o->sides++] = n;
        while (o->sides > 1 && join(o, &o->cuts[found]))
            o->numbers[o->sides - 1] = ~found++;
    }
}

/* All boxes of a joined one. */
static void place_side(ordering *o, int at) {
    int depth = 0;
    for (;;) {
        for (; at < 0; depth++) {
            const cut *c = &o->cuts[~at];
            /* The half voxel lies before the plane, and an eye on it on the
             * lower side. */
            const bool low =
                o->viewer->perspective
                    ? o->viewer->eye[c->axis] <= (double)c->plane - 0.5
                    : o->viewer->along[c->axis] > 0;
            at = low ? c->low : c->high;
            o->stack[depth] = low ? c->high : c->low;
        }
        o->order[o->placed++] = at;
        if (!depth)
            return;
        at = o->stack[--depth];
    }
}

/* --- the rest ------------------------------------------------------------- */

/* Depth first, from the back: a box comes before all that it occludes, which
 * are found while they have no place yet. */
static void sort(snow_occluded *tree, int *stack, int *order) {
    int end = tree->count;
    snow_occluded_fill(tree);
    for (int n = tree->count - 1; n >= 0; n--) {
        int depth = 0, next = tree->boxes_at[n];
        if (!snow_occluded_remove(tree, next))
            continue;
        for (;;) {
            for (; next >= 0; next = snow_occluded_find(tree, next)) {
                snow_occluded_remove(tree, next);
                stack[depth++] = next;
            }
            order[--end] = stack[--depth];
            if (!depth)
                break;
            next = snow_occluded_find(tree, stack[depth - 1]);
        }
    }
}

/* Returns whether no box is before an earlier one. */
static bool is_sorted(snow_occluded *tree, const int *order) {
    snow_occluded_clear(tree);
    for (int n = 0; n < tree->count; n++) {
        if (snow_occluded_find(tree, order[n]) >= 0)
            return false;
        snow_occluded_insert(tree, order[n]);
    }
    return true;
}

static bool have_overlap(snow_occluded *tree, const int *order) {
    snow_occluded_fill(tree);
    for (int n = 0; n < tree->count; n++) {
        snow_occluded_remove(tree, order[n]);
        if (snow_occluded_overlap(tree, order[n]) >= 0)
            return true;
    }
    return false;
}

/* Boxes that are not empty; *sorted: they have an order. */
static snow_status search(const ordering *o, const snow_box *boxes, int count,
                          int *order, bool *sorted, bool *overlap) {
    snow_occluded tree;
    snow_status status =
        snow_occluded_new(o->context, boxes, count, o->viewer, &tree);
    if (status == SNOW_STATUS_OK) {
        sort(&tree, o->stack, order);
        *sorted = is_sorted(&tree, order);
        *overlap = !*sorted && have_overlap(&tree, order);
    }
    snow_occluded_free(&tree);
    return status;
}

/* Joined boxes, and where they have no order all boxes. */
static snow_status order_sides(ordering *o) {
    int *sides = o->stack + o->count;
    bool sorted, overlap;
    if (o->sides == 1) {
        place_side(o, o->numbers[0]);
        return SNOW_STATUS_OK;
    }
    SNOW_TRY(search(o, o->joined, o->sides, sides, &sorted, &overlap));
    for (int n = 0; n < o->sides && sorted; n++)
        place_side(o, o->numbers[sides[n]]);
    if (!sorted)
        SNOW_TRY(search(o, o->boxes, o->count, o->order, &sorted, &overlap));
    if (sorted)
        return SNOW_STATUS_OK;
    return snow_fail(
        o->context, SNOW_STATUS_BAD_USAGE,
        overlap ? "parts of the volume overlap: every voxel must belong to one "
                  "processor only"
                : "parts of the volume have no order from front to back: they "
                  "occlude each other in a cycle; partition it into slabs, a "
                  "grid or a k-d tree");
}

static snow_status take_memory(ordering *o) {
    SNOW_TRY(SNOW_RESERVE(o->context, o->joined, 0, o->count));
    SNOW_TRY(SNOW_RESERVE(o->context, o->cuts, 0, o->count));
    SNOW_TRY(SNOW_RESERVE(o->context, o->numbers, 0, o->count));
    SNOW_TRY(SNOW_RESERVE(o->context, o->order, 0, o->count));
    return SNOW_RESERVE(o->context, o->stack, 0, 2 * (int64_t)o->count);
}

static void put_empty_last(const ordering *o, int *order) {
    int at = 0;
    for (int n = 0; n < o->count; n++)
        at += snow_box_voxels(&o->boxes[n]) != 0;
    memcpy(order, o->order, (size_t)at * sizeof *order);
    for (int n = 0; n < o->count; n++)
        if (!snow_box_voxels(&o->boxes[n]))
            order[at++] = n;
}

snow_status snow_order_boxes(snow_context *context, const snow_box *boxes,
                             int count, const snow_viewer *viewer, int *order) {
    ordering o = {
        .context = context, .viewer = viewer, .boxes = boxes, .count = count};
    snow_status status = take_memory(&o);
    if (status == SNOW_STATUS_OK) {
        find_cuts(&o);
        status = o.sides ? order_sides(&o) : SNOW_STATUS_OK;
    }
    if (status == SNOW_STATUS_OK)
        put_empty_last(&o, order);
    void *const blocks[] = {o.joined, o.cuts, o.numbers, o.order, o.stack};
    for (size_t n = 0; n < sizeof blocks / sizeof *blocks; n++)
        snow_release(context, blocks[n]);
    return status;
}
