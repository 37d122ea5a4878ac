/* encode/rle.c - run-length encoding (section 3.2.3, figure 6).
 *
 * A slice is one string of voxels, its rows end to end. EA holds the lengths of
 * its runs, a byte each. Uninteresting and interesting runs alternate,
 * beginning with an uninteresting one (perhaps of length 0). A run above 255 is
 * split by a run of length 0 of the other kind: 300 is 255 0 45.
 *
 * A band's slice begins with a summary: a bit for each row, set if the row
 * holds voxels. The runs of those rows follow, separately for each row: they
 * begin with an uninteresting run and end with the row's last column.
 *
 *   | 0 1 1 0 ... | 12 30 214 | 0 5 251 | ...     256 columns
 *      summary      row 1       row 2 */
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

static snow_status rle_add_row(snow_sparse *s, const uint32_t *columns,
                               size_t count) {
    uint64_t at = 0; /* first column not yet written */
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

/* Goes to the run that holds the next voxel; a slice's first is uninteresting.
 */
static void find_run(snow_walk *walk) {
    while (!walk->run) {
        walk->run_interesting = walk->started && !walk->run_interesting;
        walk->started = true;
        walk->run = *walk->ea++;
    }
}

static size_t rle_next_row(snow_walk *walk, snow_span *spans) {
    uint32_t columns = (uint32_t)walk->sparse->columns;
    size_t count = 0;
    /* walk->run is the rest of the last run of the row before. */
    for (uint32_t column = 0; column < columns;) {
        find_run(walk);
        uint32_t left = columns - column;
        uint32_t take = walk->run < left ? walk->run : left;
        if (walk->run_interesting)
            count = snow_span_append(spans, count, column, take);
        walk->run -= take;
        column += take;
    }
    return count;
}

/* --- slices of a band ----------------------------------------------------- */

static size_t summary_bytes(const snow_sparse *s) {
    return ((size_t)s->rows + 7) / 8;
}

/* The most bytes that the runs of a slice take: apart from the ends of rows,
 * each run belongs to an interesting voxel; the splits come on top. */
static size_t most_bytes(const snow_sparse *s, size_t voxels) {
    size_t splits = 2 * ((size_t)s->columns / LONGEST) + 1;
    return 2 * voxels + (size_t)s->rows * splits;
}

static unsigned char *put_run(unsigned char *at, size_t length) {
    for (; length > LONGEST; length -= LONGEST) {
        *at++ = LONGEST;
        *at++ = 0;
    }
    *at++ = (unsigned char)length;
    return at;
}

/* Writes a row. A run ends with each bit that differs from the one before, and
 * with the row. */
static unsigned char *put_row(const snow_sparse *s, const uint64_t *masks,
                              unsigned char *at) {
    size_t columns = (size_t)s->columns, begun = 0;
    uint64_t before = 0;
    for (size_t w = 0; w < snow_mask_words(s); w++) {
        uint64_t changes = masks[w] ^ (masks[w] << 1 | before);
        before = masks[w] >> 63;
        for (; changes; changes &= changes - 1) {
            size_t column = 64 * w + (size_t)__builtin_ctzll(changes);
            if (column == columns)
                break;
            at = put_run(at, column - begun);
            begun = column;
        }
    }
    return put_run(at, columns - begun);
}

static snow_status rle_add_masks(snow_sparse *s, const uint64_t *masks,
                                 size_t voxels) {
    size_t words = snow_mask_words(s), summary = summary_bytes(s);
    unsigned char *at;
    SNOW_TRY(snow_sparse_open_ea(s, summary + most_bytes(s, voxels), &at));
    unsigned char *end = at + summary;
    memset(at, 0, summary);
    for (int64_t row = 0; row < s->rows; row++, masks += words)
        if (snow_any_set(masks, words)) {
            at[row / 8] |= (unsigned char)(1u << row % 8);
            end = put_row(s, masks, end);
        }
    snow_sparse_close_ea(s, end);
    return SNOW_STATUS_OK;
}

static bool row_is_full(const snow_walk *walk, int64_t row) {
    return walk->slice[row / 8] >> row % 8 & 1;
}

/* walk->ea points to the runs of the next row that holds voxels. */
static size_t rows_next_row(snow_walk *walk, snow_span *spans) {
    if (!row_is_full(walk, walk->row))
        return 0;
    uint32_t columns = (uint32_t)walk->sparse->columns, column = 0;
    const unsigned char *at = walk->ea;
    size_t count = 0;
    for (;;) {
        column += *at++;
        if (column == columns)
            break;
        uint32_t run = *at++;
        if (run)
            count = snow_span_append(spans, count, column, run);
        column += run;
        if (column == columns)
            break;
    }
    walk->ea = at;
    return count;
}

static void rle_begin_walk(snow_walk *walk) {
    walk->next_row = rle_next_row;
    if (walk->sparse->band) {
        walk->next_row = rows_next_row;
        walk->ea = walk->slice + summary_bytes(walk->sparse);
    }
}

const snow_scheme snow_scheme_rle = {
    rle_begin_slice, rle_add_row, rle_end_slice, rle_add_masks, rle_begin_walk};
