/* encode/rle.c - run-length encoding (section 3.2.3, figure 6).
 *
 * A slice is one string of voxels, its rows end to end. EA holds the lengths of
 * its runs, a byte each. Uninteresting and interesting runs alternate,
 * beginning with an uninteresting one (perhaps of length 0). A run above 255 is
 * split by a run of length 0 of the other kind: 300 is 255 0 45. */
#include "encode/encode.h"

#define LONGEST 255

/* Ends the current run and writes it. */
static snow_status write_run(snow_sparse *s) {
    size_t at = s->ea_bytes, bytes = 1 + 2 * (size_t)(s->run / LONGEST);
    if (s->run && s->run % LONGEST == 0)
        bytes -= 2;
    SNOW_TRY(snow_sparse_grow_ea(s, bytes));
    for (; s->run > LONGEST; s->run -= LONGEST, at += 2)
        s->ea[at] = LONGEST; /* the 0 behind it is already there */
    s->ea[at] = (unsigned char)s->run;
    s->run = 0;
    s->run_interesting = !s->run_interesting;
    return SNOW_STATUS_OK;
}

/* Extends the current run by voxels of the same kind, or begins the next. */
static snow_status add_voxels(snow_sparse *s, bool interesting,
                              uint64_t voxels) {
    if (voxels && interesting != s->run_interesting)
        SNOW_TRY(write_run(s));
    s->run += voxels;
    return SNOW_STATUS_OK;
}

static snow_status rle_begin_slice(snow_sparse *s) {
    s->run = 0;
    s->run_interesting = false;
    return SNOW_STATUS_OK;
}

/* The kind of voxel changes at each bit that differs from the one before. */
static snow_status rle_add_row(snow_sparse *s, const uint64_t *mask) {
    uint64_t columns = (uint64_t)s->columns, before = 0, begun = 0;
    bool interesting = false;
    for (size_t w = 0; w < snow_mask_words(s); w++) {
        uint64_t changes = mask[w] ^ (mask[w] << 1 | before);
        before = mask[w] >> 63;
        for (; changes; changes &= changes - 1) {
            uint64_t column = 64 * w + (uint64_t)__builtin_ctzll(changes);
            if (column == columns)
                break;
            SNOW_TRY(add_voxels(s, interesting, column - begun));
            interesting = !interesting;
            begun = column;
        }
    }
    return add_voxels(s, interesting, columns - begun);
}

static size_t rle_next_row(snow_walk *walk, snow_span *spans) {
    uint32_t columns = (uint32_t)walk->sparse->columns;
    size_t count = 0;
    /* walk->run is the rest of the last run of the row before. */
    for (uint32_t column = 0; column < columns;) {
        /* Goes to the run of the next voxel; a slice's first is uninteresting.
         */
        while (!walk->run) {
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

const snow_scheme snow_scheme_rle = {rle_begin_slice, rle_add_row, write_run,
                                     rle_next_row};
