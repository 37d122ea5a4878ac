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
 * column within its segment always fits. */
#include "encode/encode.h"

#define SEGMENT 65536
#define SEGMENT_WORDS (SEGMENT / 64)

static size_t segments_of(const snow_sparse *s) {
    return (size_t)((s->columns + SEGMENT - 1) / SEGMENT);
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

static snow_status crs_add_row(snow_sparse *s, const uint64_t *mask) {
    size_t words = snow_mask_words(s), segments = segments_of(s);
    size_t at = s->ea_bytes, count = 0;
    for (size_t w = 0; w < words; w++)
        count += (size_t)__builtin_popcountll(mask[w]);
    SNOW_TRY(snow_sparse_grow_ea(s, count * sizeof(uint16_t)));
    unsigned char *col = s->ea + at, *slice = s->ea + s->pa[s->filled].ea;
    unsigned char *indr = slice + (size_t)s->row * segments * sizeof(uint32_t);
    uint32_t voxels = load_indr(indr, 0);
    for (size_t w = 0; w < words; w++) {
        for (uint64_t left = mask[w]; left; left &= left - 1) {
            uint16_t column = (uint16_t)(64 * (w % SEGMENT_WORDS) +
                                         (size_t)__builtin_ctzll(left));
            memcpy(col, &column, sizeof column);
            col += sizeof column;
            voxels++;
        }
        if (w % SEGMENT_WORDS == SEGMENT_WORDS - 1 || w == words - 1)
            memcpy(indr + (w / SEGMENT_WORDS + 1) * sizeof voxels, &voxels,
                   sizeof voxels);
    }
    return SNOW_STATUS_OK;
}

/* Keeps the next slice's INDR aligned. */
static snow_status crs_end_slice(snow_sparse *s) {
    return snow_sparse_grow_ea(s, s->ea_bytes % sizeof(uint32_t));
}

static size_t crs_next_row(snow_walk *walk, snow_span *spans) {
    const snow_sparse *s = walk->sparse;
    size_t segments = segments_of(s), first = (size_t)walk->row * segments;
    /* COL of the slice at `ea`. */
    const unsigned char *col =
        walk->slice + ((size_t)s->rows * segments_of(s) + 1) * sizeof(uint32_t);
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

const snow_scheme snow_scheme_crs = {crs_begin_slice, crs_add_row,
                                     crs_end_slice, crs_next_row};
