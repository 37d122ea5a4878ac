/* encode/rle.c - run lengths (section 3.2.3, figure 6).
 *
 * A slice is one string of voxels, its rows end to end.  EA holds the lengths
 * of its runs, uninteresting and interesting in turn, beginning with an
 * uninteresting one (perhaps of length 0), a byte each.  A run above 255 is
 * split by a run of length 0 of the other kind: 300 is 255 0 45. */
#include "encode/encode.h"

#define LONGEST 255

/* Ends the growing run: writes it down. */
static snow_status write_run(snow_sparse *s) {
    size_t at = s->ea_bytes, bytes = 1 + 2 * (size_t)(s->run / LONGEST);
    if (s->run && s->run % LONGEST == 0)
        bytes -= 2;
    SNOW_TRY(snow_sparse_grow_ea(s, bytes));
    for (; s->run > LONGEST; s->run -= LONGEST, at += 2)
        s->ea[at] = LONGEST; /* the 0 behind it is there already */
    s->ea[at] = (unsigned char)s->run;
    s->run = 0;
    s->run_interesting = !s->run_interesting;
    return SNOW_OK;
}

/* Lets the current run grow by voxels of one kind, or begins the next. */
static snow_status add_voxels(snow_sparse *s, bool interesting,
                              uint64_t voxels) {
    if (voxels && interesting != s->run_interesting)
        SNOW_TRY(write_run(s));
    s->run += voxels;
    return SNOW_OK;
}

static snow_status rle_begin_slice(snow_sparse *s) {
    s->run = 0;
    s->run_interesting = false;
    return SNOW_OK;
}

static snow_status rle_add_row(snow_sparse *s, const uint32_t *columns,
                               size_t count) {
    uint64_t at = 0; /* the first column that is not yet told */
    for (size_t i = 0; i < count;) {
        size_t end = i + 1;
        while (end < count && columns[end] == columns[end - 1] + 1)
            end++;
        SNOW_TRY(add_voxels(s, false, columns[i] - at));
        SNOW_TRY(add_voxels(s, true, end - i));
        at = (uint64_t)columns[i] + (end - i);
        i = end;
    }
    return add_voxels(s, false, (uint64_t)s->columns - at);
}

static snow_status rle_end_slice(snow_sparse *s) {
    return write_run(s);
}

static size_t rle_next_row(snow_walk *walk, snow_span *spans) {
    uint32_t columns = (uint32_t)walk->sparse->columns;
    size_t count = 0;
    /* walk->run is what the row before left of its last run. */
    for (uint32_t column = 0; column < columns;) {
        while (!walk->run) {
            /* At the slice's very first byte the kind is uninteresting. */
            walk->run_interesting = walk->started && !walk->run_interesting;
            walk->started = true;
            walk->run = *walk->ea++;
        }
        uint32_t left = columns - column;
        uint32_t take = walk->run < left ? walk->run : left;
        if (walk->run_interesting)
            count = snow_span_append(spans, count, column, take);
        walk->run -= take;
        column += take;
    }
    return count;
}

const snow_scheme snow_scheme_rle = {rle_begin_slice, rle_add_row,
                                     rle_end_slice, rle_next_row};
