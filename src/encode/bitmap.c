/* encode/bitmap.c - the bit-map encoding: one bit for every voxel (section
 * 3.2.2, figure 5).
 *
 * The rows of a slice follow each other without a gap. Voxel n of the slice is
 * bit n mod 8, counted from the lowest, of byte n / 8. The slice's last byte is
 * padded with zeros.
 *
 * A band's slice has one of two forms, whichever takes fewer bytes; its size
 * shows which.
 *
 *   plain   as above, except that each row begins at a byte:
 *
 *           | row 0 . . . . . . 0 0 | row 1 . . . . . . 0 0 | row 2 ...
 *
 *   words   every row is divided into words of 64 voxels (the last one padded
 *           with zeros); a summary has a bit for each word, row by row, set if
 *           the word is not zero, and the words that are not zero follow:
 *
 *           | 0 0 1 0  0 0 0 0  0 1 1 0 ... | word 2 | word 9 | word 10 | ...
 *              row 0      row 1     row 2 */
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
    return SNOW_STATUS_OK;
}

static snow_status bitmap_end_slice(snow_sparse *s) {
    (void)s;
    return SNOW_STATUS_OK;
}

/* Bits n .. n + 55 at least, in the low end of a word. Reads up to 8 bytes
 * beyond the byte of bit n. */
static uint64_t load_bits(const unsigned char *bits, size_t n) {
    return snow_load_word(bits + n / 8) >> n % 8;
}

#define CHUNK 56 /* bits that every load provides */

/* Bits first .. first + count - 1, count <= CHUNK. */
static uint64_t some_bits(const unsigned char *bits, size_t first,
                          size_t count) {
    return load_bits(bits, first) & ((UINT64_C(1) << count) - 1);
}

static size_t lesser(size_t a, size_t b) {
    return a < b ? a : b;
}

/* --- whole slices --------------------------------------------------------- */

static size_t bitmap_next_row(snow_walk *walk, snow_span *spans) {
    size_t columns = (size_t)walk->sparse->columns, count = 0;
    size_t first = (size_t)walk->row * columns;
    for (size_t column = 0; column < columns; column += CHUNK)
        count =
            snow_span_append_mask(spans, count, (uint32_t)column,
                                  some_bits(walk->slice, first + column,
                                            lesser(columns - column, CHUNK)));
    return count;
}

/* --- slices of a band ----------------------------------------------------- */

/* Bytes of a row in the plain form. */
static size_t row_bytes(const snow_sparse *s) {
    return ((size_t)s->columns + 7) / 8;
}

static size_t plain_bytes(const snow_sparse *s) {
    return row_bytes(s) * (size_t)s->rows;
}

static size_t summary_bytes(const snow_sparse *s) {
    return (snow_mask_words(s) * (size_t)s->rows + 7) / 8;
}

/* A row's last word extends into the next row, which then overwrites it. */
static void write_plain(const snow_sparse *s, const uint64_t *masks,
                        unsigned char *at) {
    size_t words = snow_mask_words(s);
#if __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
    if (s->columns % 64 == 0) {
        memcpy(at, masks, plain_bytes(s));
        return;
    }
#endif
    for (int64_t row = 0; row < s->rows; row++, at += row_bytes(s))
        for (size_t w = 0; w < words; w++)
            snow_store_word(at + 8 * w, *masks++);
}

static size_t count_full(const uint64_t *masks, size_t words) {
    size_t full = 0;
    for (size_t w = 0; w < words; w++)
        full += masks[w] != 0;
    return full;
}

/* The form of words; returns its end, 8 bytes beyond which are overwritten.
 * There is no branch for each word, for it would be mispredicted. */
static unsigned char *write_words(const uint64_t *masks, size_t words,
                                  unsigned char *summary, unsigned char *out) {
    for (size_t w = 0; w < words; w++) {
        unsigned full = masks[w] != 0;
        unsigned bits = w % 8 ? summary[w / 8] : 0;
        summary[w / 8] = (unsigned char)(bits | full << w % 8);
        snow_store_word(out, masks[w]);
        out += 8 * full;
    }
    return out;
}

static snow_status bitmap_add_masks(snow_sparse *s, const uint64_t *masks,
                                    size_t voxels) {
    (void)voxels;
    size_t count = snow_mask_words(s) * (size_t)s->rows;
    size_t summary = summary_bytes(s), plain = plain_bytes(s);
    size_t full = count_full(masks, count);
    unsigned char *at;
    SNOW_TRY(snow_sparse_open_ea(s, plain, &at));
    if (summary + 8 * full < plain) {
        at = write_words(masks, count, at, at + summary);
    } else {
        write_plain(s, masks, at);
        at += plain;
    }
    snow_sparse_close_ea(s, at);
    return SNOW_STATUS_OK;
}

static size_t plain_next_row(snow_walk *walk, snow_span *spans) {
    size_t columns = (size_t)walk->sparse->columns, count = 0;
    const unsigned char *row =
        walk->slice + (size_t)walk->row * row_bytes(walk->sparse);
    size_t column = 0;
    for (; column + 64 <= columns; column += 64)
        count = snow_span_append_mask(spans, count, (uint32_t)column,
                                      snow_load_word(row + column / 8));
    if (column < columns) {
        uint64_t valid = (UINT64_C(1) << (columns - column)) - 1;
        count = snow_span_append_mask(spans, count, (uint32_t)column,
                                      snow_load_word(row + column / 8) & valid);
    }
    return count;
}

/* walk->ea points to the next stored word. */
static size_t words_next_row(snow_walk *walk, snow_span *spans) {
    size_t words = snow_mask_words(walk->sparse), count = 0;
    size_t first = (size_t)walk->row * words;
    for (size_t w = 0; w < words; w += CHUNK) {
        uint64_t summary =
            some_bits(walk->slice, first + w, lesser(words - w, CHUNK));
        for (; summary; summary &= summary - 1, walk->ea += 8) {
            size_t word = w + (size_t)__builtin_ctzll(summary);
            count = snow_span_append_mask(spans, count, (uint32_t)(64 * word),
                                          snow_load_word(walk->ea));
        }
    }
    return count;
}

static void bitmap_begin_walk(snow_walk *walk) {
    const snow_sparse *s = walk->sparse;
    if (!s->band) {
        walk->next_row = bitmap_next_row;
    } else if (walk->slice_bytes == plain_bytes(s)) {
        walk->next_row = plain_next_row;
    } else {
        walk->next_row = words_next_row;
        walk->ea = walk->slice + summary_bytes(s);
    }
}

const snow_scheme snow_scheme_bitmap = {bitmap_begin_slice, bitmap_add_row,
                                        bitmap_end_slice, bitmap_add_masks,
                                        bitmap_begin_walk};
