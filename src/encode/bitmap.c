/* encode/bitmap.c - the bit-map encoding: one bit for every voxel (section
 * 3.2.2, figure 5).
 *
 * The rows of a slice follow each other without a gap. Voxel n of the slice is
 * bit n mod 8, counted from the lowest, of byte n / 8. The slice's last byte is
 * padded with zeros. */
#include "encode/encode.h"

static snow_status bitmap_begin_slice(snow_sparse *s) {
    return snow_sparse_grow_ea(s, (size_t)((s->columns * s->rows + 7) / 8));
}

/* A word is added to 9 bytes, some of which may be beyond the end of EA: there
 * it is 0. */
static snow_status bitmap_add_row(snow_sparse *s, const uint64_t *mask) {
    size_t bit = (size_t)s->row * (size_t)s->columns;
    unsigned char *at = s->ea + s->pa[s->filled].ea + bit / 8;
    int by = (int)(bit % 8);
    for (size_t w = 0; w < snow_mask_words(s); w++, at += 8) {
        snow_store_word(at, snow_load_word(at) | mask[w] << by);
        at[8] |= (unsigned char)(mask[w] >> 56 >> (8 - by));
    }
    return SNOW_STATUS_OK;
}

#define CHUNK 56 /* bits that every load provides */

static size_t bitmap_next_row(snow_walk *walk, snow_span *spans) {
    size_t columns = (size_t)walk->sparse->columns, count = 0;
    size_t first = (size_t)walk->row * columns;
    for (size_t column = 0; column < columns; column += CHUNK) {
        size_t left = columns - column, some = left < CHUNK ? left : CHUNK;
        /* Bits first .. first + count - 1, count <= CHUNK. Reads up to 8 bytes
         * beyond the byte of the first. */
        const uint64_t load_bits =
            snow_load_word(walk->slice + (first + column) / 8) >>
                (first + column) % 8 &
            ((UINT64_C(1) << some) - 1);
        count =
            snow_span_append_mask(spans, count, (uint32_t)column, load_bits);
    }
    return count;
}

const snow_scheme snow_scheme_bitmap = {bitmap_begin_slice, bitmap_add_row,
                                        NULL, bitmap_next_row};
