/* decompose/occluded.c - see occluded.h. */
#include "decompose/occluded.h"
#include "base/minmax.h"

#define BRANCHES SNOW_OCCLUDED_BRANCHES

/* Bits of a place along an axis in a key, and of a digit that is sorted by. */
#define PLACE_BITS 16
#define DIGIT_BITS 12

/* Bounds of nothing, below any voxel. */
static const double nothing = -1e300;

/* --- the curve ------------------------------------------------------------ */

/* A box's place on the curve. */
typedef struct place {
    uint64_t key;
    int box;
} place;

static void find_bounds(const snow_occluded *set, int64_t low[3],
                        int64_t high[3]) {
    for (int i = 0; i < 3; i++) {
        low[i] = INT64_MAX;
        high[i] = INT64_MIN;
    }
    for (int n = 0; n < set->count; n++) {
        const snow_box *box = &set->boxes[n];
        for (int i = 0; i < 3 && snow_box_voxels(box); i++) {
            const int64_t end = box->first[i] + box->count[i];
            low[i] = box->first[i] < low[i] ? box->first[i] : low[i];
            high[i] = end > high[i] ? end : high[i];
        }
    }
}

/* The middles of boxes that are not empty, whose number it returns. The curve
 * leads away from the viewer. */
static int find_places(const snow_occluded *set, place *places) {
    const snow_viewer *viewer = set->viewer;
    int64_t low[3], high[3];
    int full = 0;
    find_bounds(set, low, high);
    for (int n = 0; n < set->count; n++) {
        const snow_box *box = &set->boxes[n];
        if (!snow_box_voxels(box))
            continue;
        places[full] = (place){0, n};
        for (int i = 0; i < 3; i++) {
            const double size = (double)(high[i] - low[i]);
            const double middle =
                (double)(box->first[i] - low[i]) + (double)box->count[i] / 2;
            const bool falls = viewer->perspective
                                   ? viewer->eye[i] - (double)low[i] > size / 2
                                   : viewer->along[i] < 0;
            const double at = (falls ? size - middle : middle) / size;
            uint64_t bits = (uint64_t)(at * (1 << PLACE_BITS));
            bits = (bits | bits << 16) & UINT64_C(0x0000ff0000ff);
            bits = (bits | bits << 8) & UINT64_C(0x00f00f00f00f);
            bits = (bits | bits << 4) & UINT64_C(0x0c30c30c30c3);
            bits = (bits | bits << 2) & UINT64_C(0x249249249249);
            places[full].key |= bits << i; /* every third bit */
        }
        full++;
    }
    return full;
}

/* By one digit, equal ones as they were. */
static void sort_digit(const place *from, place *to, int count, int shift) {
    const uint64_t mask = (1 << DIGIT_BITS) - 1;
    int starts[1 << DIGIT_BITS] = {0};
    int sum = 0;
    for (int n = 0; n < count; n++)
        starts[from[n].key >> shift & mask]++;
    for (size_t digit = 0; digit <= mask; digit++) {
        const int here = starts[digit];
        starts[digit] = sum;
        sum += here;
    }
    for (int n = 0; n < count; n++)
        to[starts[from[n].key >> shift & mask]++] = from[n];
}

/* By radix, in an even number of steps. */
static void sort_boxes(snow_occluded *set, place *places, place *other) {
    const int full = find_places(set, places);
    for (int shift = 0; shift < 3 * PLACE_BITS; shift += 2 * DIGIT_BITS) {
        sort_digit(places, other, full, shift);
        sort_digit(other, places, full, shift + DIGIT_BITS);
    }
    for (int n = 0; n < set->count; n++)
        set->positions[n] = -1;
    for (int n = 0; n < full; n++) {
        set->positions[places[n].box] = n;
        set->boxes_at[n] = places[n].box;
    }
    set->count = full;
}

/* --- the tree ------------------------------------------------------------- */

/* Nodes of a level above so many boxes or nodes. */
static int nodes_above(int count) {
    return (count - 1) / BRANCHES + 1;
}

static snow_status make_tree(snow_occluded *set) {
    uint64_t all = 0;
    int levels = 0;
    for (int below = set->count; levels == 0 || below > 1; levels++) {
        below = nodes_above(below);
        all += (uint64_t)below;
    }
    SNOW_TRY(SNOW_RESERVE(set->context, set->all, 0, all));
    snow_occluded_node *at = set->all;
    for (int level = 0, below = set->count; level < levels; level++) {
        set->nodes[level] = at;
        at += below = nodes_above(below);
    }
    set->levels = levels;
    return SNOW_STATUS_OK;
}

snow_status snow_occluded_new(snow_context *context, const snow_box *boxes,
                              int count, const snow_viewer *viewer,
                              snow_occluded *out) {
    place *places = NULL;
    *out = (snow_occluded){
        .context = context, .boxes = boxes, .viewer = viewer, .count = count};
    SNOW_TRY(SNOW_RESERVE(context, out->positions, 0, count));
    SNOW_TRY(SNOW_RESERVE(context, out->boxes_at, 0, count));
    SNOW_TRY(SNOW_RESERVE(context, places, 0, 2 * (int64_t)count));
    sort_boxes(out, places, places + count);
    snow_release(context, places);
    return make_tree(out);
}

void snow_occluded_free(snow_occluded *set) {
    snow_release(set->context, set->all);
    snow_release(set->context, set->boxes_at);
    snow_release(set->context, set->positions);
}

/* --- bounds --------------------------------------------------------------- */

static double most(const double values[BRANCHES]) {
    double found = values[0];
    for (int i = 1; i < BRANCHES; i++)
        found = values[i] > found ? values[i] : found;
    return found;
}

/* Bounds of a node into its place in the one above; false: they were so. */
static bool lift(const snow_occluded_node *node, snow_occluded_node *above,
                 int branch) {
    bool changed = false;
    for (int axis = 0; axis < 3; axis++) {
        const double end = most(node->end[axis]);
        const double first = most(node->first[axis]);
        changed = changed || end != above->end[axis][branch] ||
                  first != above->first[axis][branch];
        above->end[axis][branch] = end;
        above->first[axis][branch] = first;
    }
    return changed;
}

/* A box into its place in the lowest level, or nothing. */
static void place_box(snow_occluded *set, int position, const snow_box *box) {
    snow_occluded_node *node = &set->nodes[0][position / BRANCHES];
    for (int axis = 0; axis < 3; axis++) {
        node->end[axis][position % BRANCHES] =
            box ? (double)(box->first[axis] + box->count[axis]) : nothing;
        node->first[axis][position % BRANCHES] =
            box ? -(double)box->first[axis] : nothing;
    }
}

static void change_box(snow_occluded *set, int position, const snow_box *box) {
    bool changed = true;
    place_box(set, position, box);
    for (int level = 1; level < set->levels && changed; level++) {
        const int node = position / BRANCHES;
        position = node;
        changed = lift(&set->nodes[level - 1][node],
                       &set->nodes[level][node / BRANCHES], node % BRANCHES);
    }
}

void snow_occluded_clear(snow_occluded *set) {
    const snow_occluded_node *end =
        set->nodes[set->levels - 1] + 1; /* the root is the last */
    for (snow_occluded_node *node = set->all; node < end; node++)
        for (int i = 0; i < 3 * BRANCHES; i++)
            node->end[i / BRANCHES][i % BRANCHES] =
                node->first[i / BRANCHES][i % BRANCHES] = nothing;
}

void snow_occluded_fill(snow_occluded *set) {
    snow_occluded_clear(set);
    for (int position = 0; position < set->count; position++)
        place_box(set, position, &set->boxes[set->boxes_at[position]]);
    for (int level = 1, below = set->count; level < set->levels; level++) {
        below = nodes_above(below);
        for (int node = 0; node < below; node++)
            lift(&set->nodes[level - 1][node],
                 &set->nodes[level][node / BRANCHES], node % BRANCHES);
    }
}

bool snow_occluded_remove(snow_occluded *set, int box) {
    const int position = set->positions[box];
    if (position < 0 ||
        !(set->nodes[0][position / BRANCHES].end[0][position % BRANCHES] >
          nothing))
        return false;
    change_box(set, position, NULL);
    return true;
}

void snow_occluded_insert(snow_occluded *set, int box) {
    change_box(set, set->positions[box], &set->boxes[box]);
}

/* --- questions ------------------------------------------------------------ */

/* Boxes that end above `end` and begin below -`first`, on all axes. */
typedef struct question {
    double end[3], first[3];
} question;

/* Branches of a node that may have an answer, as bits. */
static unsigned int answers(const snow_occluded_node *node, const question *q) {
    unsigned int bits = 0;
    double beyond[BRANCHES]; /* positive: on all axes */
    for (int i = 0; i < BRANCHES; i++) {
        const double x = SNOW_MIN(node->end[0][i] - q->end[0],
                                  node->first[0][i] - q->first[0]);
        const double y = SNOW_MIN(node->end[1][i] - q->end[1],
                                  node->first[1][i] - q->first[1]);
        const double z = SNOW_MIN(node->end[2][i] - q->end[2],
                                  node->first[2][i] - q->first[2]);
        beyond[i] = SNOW_MIN(SNOW_MIN(x, y), z);
    }
    for (int i = 0; i < BRANCHES; i++)
        bits |= (unsigned int)(beyond[i] > 0) << i;
    return bits;
}

/* Depth first; `left` are the branches not seen of the present node of each
 * level. */
static int search_tree(const snow_occluded *set, const question *q) {
    unsigned int left[SNOW_OCCLUDED_LEVELS];
    int level = set->levels - 1, node = 0;
    left[level] = answers(&set->nodes[level][0], q);
    for (;;) {
        while (!left[level]) {
            if (++level == set->levels)
                return -1;
            node /= BRANCHES;
        }
        const int branch = __builtin_ctz(left[level]);
        left[level] &= left[level] - 1;
        node = node * BRANCHES + branch;
        if (level == 0)
            return set->boxes_at[node];
        level--;
        left[level] = answers(&set->nodes[level][node], q);
    }
}

/* No box before `box` along an axis, for rays that run up or down it. */
static question beyond(const snow_viewer *viewer, const snow_box *box) {
    question q;
    for (int axis = 0; axis < 3; axis++) {
        const double first = (double)box->first[axis];
        const double end = first + (double)box->count[axis];
        const double eye = viewer->eye[axis] + 0.5, along = viewer->along[axis];
        const bool above = viewer->perspective ? first >= eye : along >= 0;
        const bool below = viewer->perspective ? end < eye : along <= 0;
        q.end[axis] = above ? first : nothing;
        q.first[axis] = below ? -end : nothing;
    }
    return q;
}

int snow_occluded_find(const snow_occluded *set, int box) {
    const question q = beyond(set->viewer, &set->boxes[box]);
    return search_tree(set, &q);
}

int snow_occluded_overlap(const snow_occluded *set, int box) {
    static const snow_viewer everywhere;
    const question q = beyond(&everywhere, &set->boxes[box]);
    return search_tree(set, &q);
}
