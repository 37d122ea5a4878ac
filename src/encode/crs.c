/* encode/crs.c - compressed row storage (section 3.2.1, figure 4).
 *
 * A slice in EA is two arrays, INDR then COL:
 *
 *   . a b . .      INDR  0 2 3 3      first voxel of each row, and the end,
 *   . . . c .                         counted from the slice's start in IA
 *   . . . . .      COL   1 2 3        column of each voxel
 *
 * INDR holds 32-bit numbers, COL 16-bit ones.  Rows longer than 65,536 are
 * divided into segments of that length, each with its own INDR entry, so that a
 * column within its segment always fits.
 *
 * A band's slice is divided more finely into cells, 256 columns of one row
 * each, row by row. A summary has a bit for each cell, set if the cell holds
 * voxels. These cells follow: a byte for the number of voxels, less one, and a
 * byte for the column of each within the cell. The sum of the numbers before a
 * cell replaces INDR.
 *
 *   | 0 1 0 0  1 0 ... | 2 | 17 18 90 | 0 | 255 | ...
 *      summary          cell 1: three  cell 4: one */
#include "encode/encode.h"

#define SEGMENT 65536

static size_t segments_of(const snow_sparse *s) {
    return (size_t)((s->columns + SEGMENT - 1) / SEGMENT);
}

static void store_indr(unsigned char *ea, size_t index, uint32_t value) {
    memcpy(ea + index * sizeof value, &value, sizeof value);
}

/* INDR[index] of the slice at `ea`. */
static uint32_t load_indr(const unsigned char *ea, size_t index) {
    uint32_t value;
    memcpy(&value, ea + index * sizeof value, sizeof value);
    return value;
}

static snow_status crs_begin_slice(snow_sparse *s) {
    size_t entries = (size_t)s->rows * segments_of(s) + 1;
    return snow_sparse_grow_ea(s, entries * sizeof(uint32_t));
}

static snow_status crs_add_row(snow_sparse *s, const uint32_t *columns,
                               size_t count) {
    size_t segments = segments_of(s), at = s->ea_bytes;
    SNOW_TRY(snow_sparse_grow_ea(s, count * sizeof(uint16_t)));
    unsigned char *slice = s->ea + s->pa[s->filled].ea;
    unsigned char *indr = slice + (size_t)s->row * segments * sizeof(uint32_t);
    uint32_t voxels = load_indr(indr, 0);
    size_t segment = 0;
    for (size_t i = 0; i < count; i++) {
        uint16_t column = (uint16_t)(columns[i] % SEGMENT);
        memcpy(s->ea + at + i * sizeof column, &column, sizeof column);
        while (segment < columns[i] / SEGMENT)
            store_indr(indr, ++segment, voxels);
        voxels++;
    }
    while (segment < segments)
        store_indr(indr, ++segment, voxels);
    return SNOW_STATUS_OK;
}

/* Keeps the next slice's INDR aligned. */
static snow_status crs_end_slice(snow_sparse *s) {
    return snow_sparse_grow_ea(s, s->ea_bytes % sizeof(uint32_t));
}

/* COL of the slice at `ea`. */
static const unsigned char *col_of(const snow_sparse *s,
                                   const unsigned char *ea) {
    return ea + ((size_t)s->rows * segments_of(s) + 1) * sizeof(uint32_t);
}

static size_t crs_next_row(snow_walk *walk, snow_span *spans) {
    const snow_sparse *s = walk->sparse;
    size_t segments = segments_of(s), first = (size_t)walk->row * segments;
    const unsigned char *col = col_of(s, walk->slice);
    size_t count = 0;
    for (size_t segment = 0; segment < segments; segment++) {
        uint32_t begin = load_indr(walk->slice, first + segment);
        uint32_t end = load_indr(walk->slice, first + segment + 1);
        for (size_t i = begin; i < end; i++) {
            uint16_t column;
            memcpy(&column, col + i * sizeof column, sizeof column);
            count = snow_span_append(spans, count,
                                     (uint32_t)(segment * SEGMENT) + column, 1);
        }
    }
    return count;
}

/* --- slices of a band ----------------------------------------------------- */

#define CELL 256
#define CELL_WORDS (CELL / 64)

/* The number of cells of a row. */
static size_t cells_of(const snow_sparse *s) {
    return ((size_t)s->columns + CELL - 1) / CELL;
}

static size_t summary_bytes(const snow_sparse *s) {
    return (cells_of(s) * (size_t)s->rows + 7) / 8;
}

/* Writes a row of cells; the first is bit `cell` of the summary. */
static unsigned char *write_row(const snow_sparse *s, const uint64_t *masks,
                                unsigned char *summary, size_t cell,
                                unsigned char *at) {
    size_t words = snow_mask_words(s);
    for (size_t w = 0; w < words; w += CELL_WORDS, cell++) {
        size_t some = words - w < CELL_WORDS ? words - w : CELL_WORDS;
        if (!snow_any_set(masks + w, some))
            continue;
        unsigned char *count = at++;
        for (size_t n = 0; n < some; n++)
            for (uint64_t mask = masks[w + n]; mask; mask &= mask - 1)
                *at++ = (unsigned char)(64 * n + (size_t)__builtin_ctzll(mask));
        *count = (unsigned char)(at - count - 2);
        summary[cell / 8] |= (unsigned char)(1u << cell % 8);
    }
    return at;
}

static snow_status crs_add_masks(snow_sparse *s, const uint64_t *masks,
                                 size_t voxels) {
    size_t cells = cells_of(s), words = snow_mask_words(s);
    size_t summary = summary_bytes(s), full = cells * (size_t)s->rows;
    unsigned char *at;
    SNOW_TRY(snow_sparse_open_ea(
        s, summary + voxels + (full < voxels ? full : voxels), &at));
    unsigned char *end = at + summary;
    memset(at, 0, summary);
    for (int64_t row = 0; row < s->rows; row++, masks += words)
        end = write_row(s, masks, at, (size_t)row * cells, end);
    snow_sparse_close_ea(s, end);
    return SNOW_STATUS_OK;
}

static bool cell_is_full(const snow_walk *walk, size_t cell) {
    return walk->slice[cell / 8] >> cell % 8 & 1;
}

/* walk->ea points to the next cell that holds voxels. */
static size_t cells_next_row(snow_walk *walk, snow_span *spans) {
    size_t cells = cells_of(walk->sparse), count = 0;
    const unsigned char *at = walk->ea;
    for (size_t n = 0; n < cells; n++) {
        if (!cell_is_full(walk, (size_t)walk->row * cells + n))
            continue;
        for (size_t left = (size_t)*at++ + 1; left; left--)
            count =
                snow_span_append(spans, count, (uint32_t)(n * CELL) + *at++, 1);
    }
    walk->ea = at;
    return count;
}

static void crs_begin_walk(snow_walk *walk) {
    walk->next_row = crs_next_row;
    if (walk->sparse->band) {
        walk->next_row = cells_next_row;
        walk->ea = walk->slice + summary_bytes(walk->sparse);
    }
}

const snow_scheme snow_scheme_crs = {
    crs_begin_slice, crs_add_row, crs_end_slice, crs_add_masks, crs_begin_walk};
