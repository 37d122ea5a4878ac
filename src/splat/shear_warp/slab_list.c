/* splat/shear_warp/slab_list.c - which slabs of a tile have anything, by the
 * coarse masks: of eight slices first, then of each. */
#include "splat/shear_warp/scratch.h"

/* Cells of the masks that the windows of some resampled slices cover. */
typedef struct box {
    int64_t low[2], high[2];
} box;

value_list value_list_begin(const snow_value_splat *p, int first, int end,
                            const int tile[2], int32_t *slabs) {
    const snow_value_store *s = p->store;
    const int64_t zero = s->margin + 32; /* of cell 0 */
    return (value_list){
        .splat = p,
        .first = first,
        .end = end,
        .tile = tile,
        .begin = {value_tile_column(p, tile[0]) + zero,
                  value_tile_row(p, tile[1]) + zero},
        .last = {(int64_t)s->mask_words * 32 - 1, (int64_t)s->mask_rows - 1},
        .resampled = p->slabs[0],
        .slabs = slabs};
}

/* Where the phases' windows of a resampled slice begin and end, in perspective.
 */
static box cover_eye(const value_list *of, int resampled) {
    const int64_t zero = of->splat->store->margin + 32;
    box b = {{INT64_MAX, INT64_MAX}, {INT64_MIN, INT64_MIN}};
    for (int phase = of->first; phase < of->end; phase++)
        for (int axis = 0; axis < 2; axis++) {
            const snow_value_lanes *lanes = value_lanes_of(
                of->splat->rays, resampled, phase, axis, of->tile[axis]);
            int64_t low = lanes->first + lanes->at[axis] + zero;
            int64_t high = lanes->first + lanes->at[31 + axis] + zero;
            b.low[axis] = low < b.low[axis] ? low : b.low[axis];
            b.high[axis] = high > b.high[axis] ? high : b.high[axis];
        }
    return b;
}

static inline box cover(const value_list *of, int resampled) {
    const snow_value_splat *p = of->splat;
    if (p->rays)
        return cover_eye(of, resampled);
    const snow_value_place *at = p->places + resampled * p->phases;
    box b;
    for (int axis = 0; axis < 2; axis++) {
        int32_t low = at[of->first].whole[axis], high = low;
        for (int phase = of->first + 1; phase < of->end; phase++) {
            const int32_t whole = at[phase].whole[axis];
            low = whole < low ? whole : low;
            high = whole > high ? whole : high;
        }
        b.low[axis] = of->begin[axis] + low;
        b.high[axis] = of->begin[axis] + high + 31;
    }
    return b;
}

/* The windows of two resampled slices and of those between them. */
static box unite(box a, box b) {
    for (int axis = 0; axis < 2; axis++) {
        a.low[axis] = b.low[axis] < a.low[axis] ? b.low[axis] : a.low[axis];
        a.high[axis] =
            b.high[axis] > a.high[axis] ? b.high[axis] : a.high[axis];
    }
    return a;
}

/* Leaves of a box what the masks have; false: nothing. */
static inline bool fit(const value_list *of, box *b) {
    for (int axis = 0; axis < 2; axis++) {
        b->low[axis] = b->low[axis] > 0 ? b->low[axis] : 0;
        b->high[axis] =
            b->high[axis] < of->last[axis] ? b->high[axis] : of->last[axis];
    }
    return b->low[0] <= b->high[0] && b->low[1] <= b->high[1];
}

/* Whether a coarse mask has anything in a box; from each word to the next it is
 * `apart`. */
static inline bool has_any(const uint64_t *coarse, size_t apart, const box *b) {
    const size_t row = (size_t)b->low[1] / SNOW_VALUE_COARSE;
    const size_t last = (size_t)b->high[1] / SNOW_VALUE_COARSE;
    const uint64_t from = ~UINT64_C(0) << row % 64;
    const uint64_t to = ~UINT64_C(0) >> (63 - last % 64);
    uint64_t any = 0;
    for (int64_t word = b->low[0] / 32; word <= b->high[0] / 32; word++) {
        for (size_t n = row / 64; n <= last / 64; n++)
            any |= coarse[n] & (n == row / 64 ? from : ~UINT64_C(0)) &
                   (n == last / 64 ? to : ~UINT64_C(0));
        coarse += apart;
    }
    return any != 0;
}

/* A bit for each interval with cells that it does not hide, in a slice (of
 * every slice, or of each eight) and, for resampled slices between, in the next
 * one.
 */
static inline unsigned intervals_of(const value_list *of,
                                    const uint64_t *coarse, int64_t slices,
                                    int64_t slice, bool between, box b) {
    const snow_value_store *s = of->splat->store;
    const size_t apart = (size_t)slices * s->coarse_words;
    unsigned intervals = 0;
    if (!fit(of, &b))
        return 0;
    coarse += (size_t)b.low[0] / 32 * apart;
    for (int interval = 0; interval < s->interval_count; interval++) {
        for (int64_t k = slice; k <= slice + between && k < slices; k++)
            if (has_any(coarse + (size_t)k * s->coarse_words, apart, &b))
                intervals |= 1U << interval;
        coarse += s->mask_words * apart;
    }
    return intervals;
}

/* The last resampled slice of the same eight slices. */
static int last_of_eight(const snow_value_splat *p, int resampled) {
    int64_t eight = p->resampled_slices[resampled].slice / SNOW_VALUE_EIGHT;
    while (resampled < p->slabs[1] &&
           p->resampled_slices[resampled + 1].slice / SNOW_VALUE_EIGHT == eight)
        resampled++;
    return resampled;
}

/* Looks at the resampled slices of the next eight slices. */
static void look_at_eight(value_list *list) {
    const snow_value_splat *p = list->splat;
    const snow_value_store *s = p->store;
    const unsigned all = (1U << s->interval_count) - 1;
    const snow_resampled_slice *resampled =
        p->resampled_slices + list->resampled;
    const int last = last_of_eight(p, list->resampled);
    bool some =
        intervals_of(list, s->eights, s->eight_count,
                     resampled->slice / SNOW_VALUE_EIGHT,
                     resampled->between || p->resampled_slices[last].between,
                     unite(cover(list, list->resampled), cover(list, last))) !=
        0;
    for (; list->resampled <= last; list->resampled++, resampled++) {
        unsigned here = 0;
        if (some || !all)
            here =
                intervals_of(list, s->coarse, s->slices, resampled->slice,
                             resampled->between, cover(list, list->resampled));
        if (list->resampled > p->slabs[0] && (list->before | here) == all)
            list->slabs[list->count++] = list->resampled - 1;
        list->before = here;
    }
}

void value_list_find(value_list *list, int count) {
    const int *slabs = list->splat->slabs;
    while (list->count < count && list->resampled <= slabs[1] &&
           slabs[0] < slabs[1])
        look_at_eight(list);
}

int snow_value_list(const snow_value_splat *p, const int tile[2],
                    int32_t *out) {
    value_list list = value_list_begin(p, 0, p->phases, tile, out);
    value_list_find(&list, INT32_MAX);
    return list.count;
}
