/* encode/bitmap.c - one bit for every voxel (section 3.2.2, figure 5).
 *
 * The rows of a slice follow each other without a gap; voxel n of the slice is
 * bit n mod 8, counted from the lowest, of byte n / 8.  The slice's last byte
 * is filled up with zeros. */
#include "encode/encode.h"

#include <string.h>

static snow_status bitmap_begin_slice(snow_sparse *s) {
    return snow_sparse_grow_ea(s, (size_t)((s->columns * s->rows + 7) / 8));
}

static snow_status bitmap_add_row(snow_sparse *s, const uint32_t *columns,
                                  size_t count) {
    unsigned char *bits = s->ea + s->pa[s->filled].ea;
    size_t first = (size_t)s->row * (size_t)s->columns;
    for (size_t i = 0; i < count; i++) {
        size_t bit = first + columns[i];
        bits[bit / 8] |= (unsigned char)(1u << bit % 8);
    }
    return SNOW_OK;
}

static snow_status bitmap_end_slice(snow_sparse *s) {
    (void)s;
    return SNOW_OK;
}

/* Bits n .. n + 55 at least, in the low end of a word.  Reads up to 8 bytes
 * beyond the one that holds bit n. */
static uint64_t load_bits(const unsigned char *bits, size_t n) {
    uint64_t word;
    memcpy(&word, bits + n / 8, sizeof word);
#if __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
    word = __builtin_bswap64(word);
#endif
    return word >> n % 8;
}

#define CHUNK 56 /* bits that one load always gives */

static size_t bitmap_next_row(snow_walk *walk, snow_span *spans) {
    uint32_t columns = (uint32_t)walk->sparse->columns;
    size_t first = (size_t)walk->row * columns, count = 0;
    for (uint32_t column = 0; column < columns; column += CHUNK) {
        uint32_t valid = columns - column < CHUNK ? columns - column : CHUNK;
        uint64_t word =
            load_bits(walk->ea, first + column) & ((UINT64_C(1) << valid) - 1);
        while (word) {
            int skip = __builtin_ctzll(word);
            int run = __builtin_ctzll(~(word >> skip));
            count = snow_span_append(spans, count, column + (uint32_t)skip,
                                     (uint32_t)run);
            word &= ~(((UINT64_C(1) << run) - 1) << skip);
        }
    }
    return count;
}

const snow_scheme snow_scheme_bitmap = {bitmap_begin_slice, bitmap_add_row,
                                        bitmap_end_slice, bitmap_next_row};
