/* encode/crs.c - compressed row storage (section 3.2.1, figure 4).
 *
 * A slice in EA is two arrays, INDR then COL:
 *
 *   . a b . .      INDR  0 2 3 3      first voxel of each row, and the end,
 *   . . . c .                         counted from the slice's start in IA
 *   . . . . .      COL   1 2 3        column of each voxel
 *
 * INDR holds 32-bit numbers, COL 16-bit ones.  Rows longer than 65,536 are cut
 * into segments of that length, each with an INDR of its own, so that a column
 * within its segment always fits. */
#include "encode/encode.h"

#include <string.h>

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
    return SNOW_OK;
}

/* Keeps the next slice's INDR aligned. */
static snow_status crs_end_slice(snow_sparse *s) {
    return snow_sparse_grow_ea(s, s->ea_bytes % sizeof(uint32_t));
}

static size_t crs_next_row(snow_walk *walk, snow_span *spans) {
    const snow_sparse *s = walk->sparse;
    size_t segments = segments_of(s), first = (size_t)walk->row * segments;
    const unsigned char *col =
        walk->ea + ((size_t)s->rows * segments + 1) * sizeof(uint32_t);
    size_t count = 0;
    for (size_t segment = 0; segment < segments; segment++) {
        uint32_t begin = load_indr(walk->ea, first + segment);
        uint32_t end = load_indr(walk->ea, first + segment + 1);
        for (size_t i = begin; i < end; i++) {
            uint16_t column;
            memcpy(&column, col + i * sizeof column, sizeof column);
            count = snow_span_append(spans, count,
                                     (uint32_t)(segment * SEGMENT) + column, 1);
        }
    }
    return count;
}

const snow_scheme snow_scheme_crs = {crs_begin_slice, crs_add_row,
                                     crs_end_slice, crs_next_row};
