/* encode/shear_warp/active.c - the voxels that visible slabs need.
 *
 * A slab between slices k and k + 1 is visible where the cells of its resampled
 * slices are not wholly within one transparent interval.  Its samples read the
 * voxels of these cells, which lie up to `reach` apart, of the slices in front
 * and behind, and one more around them for gradients.  So a voxel belongs to
 * the active voxels and their neighbours if, for every interval, there is such
 * a cell around it: in slices k - 2 .. k + 2, columns and rows -2 - reach .. 1
 * + reach from its own. */
#include "encode/shear_warp/encode.h"

#include <string.h>

#define AROUND 2 /* slices */

static size_t tall_bytes(const snow_value_store *s) {
    return snow_align((SNOW_VALUE_BAND + 2 * (size_t)s->reach + 3) *
                      sizeof(uint32_t));
}

/* Masks of a band of rows, a line of words each, and one word more. */
static size_t masks_bytes(const snow_value_store *s) {
    return snow_align(SNOW_VALUE_BAND * (snow_value_words(s) + 2) *
                      sizeof(uint32_t));
}

static size_t words64(const snow_value_store *s) {
    return ((size_t)s->columns + 63) / 64;
}

static size_t ea_bytes(const snow_value_store *s) {
    return snow_align(SNOW_VALUE_BAND * words64(s) * sizeof(uint64_t));
}

static size_t line_bytes(const snow_value_store *s) {
    return snow_align((32 * snow_value_words(s) + 64) * sizeof(int16_t));
}

size_t snow_value_active_bytes(const snow_value_store *store,
                               const snow_value_store_params *params) {
    return tall_bytes(store) + 3 * masks_bytes(store) + ea_bytes(store) +
           line_bytes(store) + snow_value_lines_bytes(params, SNOW_VALUE_BAND);
}

/* What a band works on. */
typedef struct active_scratch {
    uint32_t *tall;                 /* a column of words */
    uint32_t *high, *wide, *active; /* [row][word] */
    uint64_t *ea;
    int16_t *line;
    void *lines;
} active_scratch;

static active_scratch room_of(const snow_value_store *s, void *scratch) {
    unsigned char *at = scratch;
    active_scratch own_scratch = {.tall = (uint32_t *)(void *)at};
    at += tall_bytes(s);
    own_scratch.high = (uint32_t *)(void *)at;
    own_scratch.wide = (uint32_t *)(void *)(at + masks_bytes(s));
    own_scratch.active = (uint32_t *)(void *)(at + 2 * masks_bytes(s));
    at += 3 * masks_bytes(s);
    own_scratch.ea = (uint64_t *)(void *)at;
    own_scratch.line = (int16_t *)(void *)(at + ea_bytes(s));
    own_scratch.lines = at + ea_bytes(s) + line_bytes(s);
    return own_scratch;
}

/* Cells of an interval around each row, of all slices near. */
static void gather_rows(const snow_value_store *s, int interval, int64_t slice,
                        int64_t first, int64_t rows, active_scratch *scratch) {
    size_t words = snow_value_words(s),
           high = (size_t)rows + 2 * (size_t)s->reach + 3;
    size_t top = (size_t)(first - 2 - s->reach + s->margin + SNOW_VALUE_ROWS);
    int64_t low = slice < AROUND ? 0 : slice - AROUND;
    int64_t end = slice + AROUND < s->slices ? slice + AROUND : s->slices - 1;
    for (size_t w = 0; w < words; w++) {
        memset(scratch->tall, 0, high * sizeof *scratch->tall);
        for (int64_t k = low; k <= end; k++) {
            const uint32_t *from = s->masks +
                                   snow_value_mask_at(s, interval, k) +
                                   (w + 1) * s->mask_rows + top;
            for (size_t n = 0; n < high; n++)
                scratch->tall[n] |= from[n];
        }
        for (int64_t row = 0; row < rows; row++) {
            uint32_t any = 0;
            for (int n = 0; n < 2 * s->reach + 4; n++)
                any |= scratch->tall[row + n];
            scratch->high[(size_t)row * (words + 2) + w + 1] = any;
        }
    }
}

/* Bit v of `out`: any of bits v - 2 - reach .. v + 1 + reach of `in`, which has
 * a word of zeros before and behind it. */
static void widen_mask(const uint32_t *in, size_t words, int reach,
                       uint32_t *out) {
    memset(out, 0, words * sizeof *out);
    for (int by = -2 - reach; by <= 1 + reach; by++) {
        int bits = by < 0 ? -by : by;
        for (size_t w = 0; w < words; w++) {
            uint64_t pair = by < 0 ? (uint64_t)in[w + 1] << 32 | in[w]
                                   : (uint64_t)in[w + 2] << 32 | in[w + 1];
            out[w] |= by < 0 ? (uint32_t)(pair >> (32 - bits))
                             : (uint32_t)(pair >> bits);
        }
    }
}

/* The active voxels and their neighbours of some rows of a slice, of voxels
 * from column 0 on. */
static void find_active(const snow_value_store *s, int64_t slice, int64_t first,
                        int64_t rows, active_scratch *scratch) {
    size_t words = snow_value_words(s), line = words + 2;
    memset(scratch->active, 0xff, masks_bytes(s));
    for (int interval = 0; interval < s->interval_count; interval++) {
        gather_rows(s, interval, slice, first, rows, scratch);
        for (int64_t row = 0; row < rows; row++) {
            uint32_t *high = scratch->high + (size_t)row * line;
            uint32_t *active = scratch->active + (size_t)row * line;
            high[0] = high[words + 1] = 0;
            widen_mask(high, words, s->reach, scratch->wide);
            for (size_t w = 0; w < words; w++)
                active[w] &= scratch->wide[w];
        }
    }
    size_t columns = (size_t)s->columns, own = (columns + 31) / 32;
    for (int64_t row = 0; row < rows; row++) {
        uint32_t *active = scratch->active + (size_t)row * line;
        active[words] = active[words + 1] = 0;
        for (size_t w = 0; w < own; w++)
            active[w] =
                (uint32_t)((active[w] | (uint64_t)active[w + 1] << 32) >>
                           s->margin);
        if (columns % 32)
            active[own - 1] &= ~UINT32_C(0) >> (32 - columns % 32);
        memset(active + own, 0, (line - own) * sizeof *active);
    }
}

/* Appends a slice to the band. */
static snow_status encode_slice(snow_value_store *s, snow_sparse *band,
                                const snow_value_loops *loops,
                                snow_value_lines *lines, int64_t slice,
                                active_scratch *scratch) {
    size_t line = snow_value_words(s) + 2, own = ((size_t)s->columns + 31) / 32;
    size_t begin = band->ia_voxels, wide = words64(s);
    SNOW_TRY(SNOW_RESERVE(s->context, band->quantized, begin,
                          begin + (size_t)(s->columns * lines->rows) + 32));
    int16_t *first = band->quantized + begin, *to = first;
    find_active(s, slice, lines->first, lines->rows, scratch);
    for (int64_t row = 0; row < lines->rows; row++) {
        const uint32_t *active = scratch->active + (size_t)row * line;
        uint32_t any = 0;
        for (size_t w = 0; w < wide; w++) {
            scratch->ea[(size_t)row * wide + w] =
                active[2 * w] | (uint64_t)active[2 * w + 1] << 32;
            any |= active[2 * w] | active[2 * w + 1];
        }
        if (!any)
            continue;
        snow_value_lines_read(lines, lines->first + row, scratch->line);
        to = loops->pack(scratch->line + s->margin, active, own, to);
    }
    band->ia_voxels += (size_t)(to - first);
    return snow_sparse_add_masks(band, scratch->ea, (size_t)(to - first));
}

snow_status snow_value_active_band(snow_value_store *s,
                                   const snow_value_store_params *params,
                                   int64_t number, int worker, void *scratch) {
    snow_sparse *band = &s->bands[number];
    int64_t first = number * SNOW_VALUE_BAND, rows = s->rows - first;
    active_scratch own_scratch = room_of(s, scratch);
    snow_value_lines lines;
    rows = rows < SNOW_VALUE_BAND ? rows : SNOW_VALUE_BAND;
    memset(own_scratch.line, 0, line_bytes(s));
    SNOW_TRY(snow_sparse_begin_band(band, snow_scheme_of(s->encoding),
                                    s->columns, rows, s->slices));
    snow_value_lines_begin(&lines, params, first, rows, own_scratch.lines);
    for (int64_t slice = 0; slice < s->slices; slice++) {
        if (snow_monitor_look(s->context->monitor, worker))
            return SNOW_STATUS_OK; /* snow_parallel fails */
        snow_value_lines_slice(&lines, slice);
        SNOW_TRY(encode_slice(s, band, snow_value_loops_of(params->isa), &lines,
                              slice, &own_scratch));
    }
    return SNOW_STATUS_OK;
}
