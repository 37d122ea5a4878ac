/* encode/shear_warp/cells.c - which cells of a slice a look can show. */
#include "encode/shear_warp/encode.h"

#include <string.h>

/* By so much the mean of what is there may be beyond the voxels' values, for
 * means and weights are rounded. */
#define BEYOND 8

/* Bits of two lines, for each plane, and those of a row. */
static size_t bits_bytes(const snow_value_store *s) {
    size_t words = snow_value_words(s) * (2 * (SNOW_VALUE_RUNS + 1) + 1) + 2;
    return snow_align(words * sizeof(uint32_t));
}

static size_t line_bytes(const snow_value_store *s) {
    return snow_align(32 * snow_value_words(s) * sizeof(int16_t));
}

size_t snow_value_cells_bytes(const snow_value_store *store,
                              const snow_value_store_params *params) {
    return bits_bytes(store) + line_bytes(store) +
           snow_value_lines_bytes(params, SNOW_VALUE_BAND + 4);
}

/* Cells from the bits of the lines above and below, in a row of the masks and
 * `copies` more; `cells` is room for one. */
static void write_cells(snow_value_store *s, const snow_value_loops *loops,
                        int interval, int64_t slice, int64_t row, int copies,
                        const uint32_t *above, const uint32_t *below,
                        uint32_t *cells) {
    size_t words = snow_value_words(s),
           bits = (size_t)s->columns + 2 * (size_t)s->margin - 1;
    uint32_t *out = s->masks + snow_value_mask_at(s, interval, slice) +
                    s->mask_rows + (size_t)(row + s->margin + SNOW_VALUE_ROWS);
    loops->cells(above, below, words, cells);
    for (size_t w = bits / 32; w < words; w++)
        cells[w] &= w == bits / 32 ? (UINT32_C(1) << bits % 32) - 1 : 0;
    for (size_t w = 0; w < words; w++, out += s->mask_rows)
        for (int n = 0; n <= copies; n++)
            out[n] = cells[w];
}

snow_transparent_interval
snow_transparent_open(snow_transparent_interval interval) {
    return (snow_transparent_interval){
        interval.first > 0 ? interval.first : SNOW_VALUE_HOLE + 1,
        interval.last < SNOW_VALUE_MOST ? interval.last : INT16_MAX};
}

/* The quantized values that a cell must be within to be invisible. */
static snow_transparent_interval sure_interval(const snow_value_store *s,
                                               int interval) {
    snow_transparent_interval sure =
        snow_transparent_open(s->intervals[interval]);
    if (!s->holes)
        return sure;
    sure.first = (int16_t)(sure.first + (sure.first > 0 ? BEYOND : 0));
    sure.last =
        (int16_t)(sure.last - (sure.last < SNOW_VALUE_MOST ? BEYOND : 0));
    return sure;
}

/* The quantized values of a line that are outside of each interval, and then
 * its holes, which are outside of none. */
static void mark_line(const snow_value_store *s, const snow_value_loops *loops,
                      const int16_t *line, uint32_t *bits) {
    const snow_transparent_interval quantized = {SNOW_VALUE_HOLE + 1,
                                                 INT16_MAX};
    size_t words = snow_value_words(s);
    uint32_t *holes = bits + (size_t)s->interval_count * words;
    if (s->holes)
        loops->outside(line, words, quantized, holes);
    for (int interval = 0; interval < s->interval_count;
         interval++, bits += words) {
        loops->outside(line, words, sure_interval(s, interval), bits);
        for (size_t w = 0; s->holes && w < words; w++)
            bits[w] &= ~holes[w];
    }
}

/* What marks a band of rows. */
typedef struct marker {
    snow_value_store *store;
    const snow_value_store_params *params;
    const snow_value_loops *loops;
    snow_value_lines lines;
    int64_t band;
    bool by_stored;
    snow_value_stored_range ranges[SNOW_VALUE_RUNS]; /* of the intervals */
    int16_t *line;
    uint32_t *bits;  /* of two lines */
    uint32_t *cells; /* of a row, in whole words of 64 */
} marker;

/* Counts what is seen of a row of the band, and copies it where rows are
 * turned. */
static void take_row(marker *m, int64_t row, const unsigned char *stored) {
    snow_value_store *s = m->store;
    const size_t size = snow_type_size(m->params->quantizer->type);
    int64_t place = m->lines.number * s->slice_step + row * s->row_step;
    if (s->turned)
        memcpy(s->copy + (size_t)place * size, stored,
               (size_t)s->columns * size);
    if (m->store->counted_ranges)
        s->seen[m->band] +=
            snow_value_count_stored(s, m->params, stored, m->cells);
}

/* Asks memory for the same row of the next slice. */
static void ask_ahead(const marker *m, const unsigned char *stored) {
    const size_t ahead = m->lines.slice[0].ahead;
    const size_t bytes =
        (size_t)m->store->columns * snow_type_size(m->params->quantizer->type);
    for (size_t n = 0; ahead && n < bytes; n += 64)
        __builtin_prefetch(stored + ahead + n);
}

/* Marks a row, or one beyond the first or last of the volume. */
static void mark_row(marker *m, int64_t row, uint32_t *bits) {
    const snow_value_store *s = m->store;
    if (!m->by_stored || row < 0 || row >= s->rows) {
        snow_value_lines_read(&m->lines, row, m->line);
        mark_line(s, m->loops, m->line, bits);
        return;
    }
    const unsigned char *stored = snow_value_lines_stored(&m->lines, row);
    ask_ahead(m, stored);
    for (int interval = 0; interval < s->interval_count;
         interval++, bits += snow_value_words(s))
        snow_value_mark_stored(s, m->params, &m->ranges[interval], interval,
                               stored, bits);
    if (row / SNOW_VALUE_BAND == m->band)
        take_row(m, row, stored);
}

/* Rows of cells first .. end - 1 of a slice. */
static void mark_slice(marker *m, int64_t slice, int64_t first, int64_t end) {
    snow_value_store *s = m->store;
    size_t words = snow_value_words(s), all = words * (SNOW_VALUE_RUNS + 1);
    int out = s->margin - 1;
    for (int64_t row = first; row <= end; row++) {
        uint32_t *below = m->bits + (row & 1 ? all : 0);
        const uint32_t *above = m->bits + (row & 1 ? 0 : all);
        mark_row(m, row, below);
        for (int n = 0; row > first && n < snow_value_planes(s); n++) {
            bool top = row == 0, bottom = row == s->rows;
            write_cells(s, m->loops, n, slice, top ? -1 - out : row - 1,
                        (top || bottom) ? out : 0, above + (size_t)n * words,
                        below + (size_t)n * words, m->cells);
        }
    }
}

/* Rows low .. high - 1 of voxels. */
static void begin_marker(marker *m, int64_t low, int64_t high, void *scratch) {
    const snow_value_store *s = m->store;
    const snow_quantizer *quantizer = m->params->quantizer;
    unsigned char *at = scratch;
    m->loops = snow_value_loops_of(m->params->isa);
    m->bits = (uint32_t *)scratch;
    m->cells = m->bits + snow_value_words(s) * 2 * (SNOW_VALUE_RUNS + 1);
    m->line = (int16_t *)(void *)(at + bits_bytes(s));
    m->by_stored = snow_value_store_by_stored(m->params);
    for (int interval = 0; interval < s->interval_count && m->by_stored;
         interval++)
        m->ranges[interval] =
            snow_value_stored_range_of(quantizer, s->intervals[interval]);
    memset(m->line, 0, line_bytes(s));
    snow_value_lines_begin(&m->lines, m->params, low, high - low,
                           at + bits_bytes(s) + line_bytes(s));
}

void snow_value_cells_band(snow_value_store *s,
                           const snow_value_store_params *params, int64_t band,
                           int worker, void *scratch) {
    marker m = {.store = s, .params = params, .band = band};
    /* The first band has the row of cells above the volume too. */
    int64_t first = band ? band * SNOW_VALUE_BAND : -1;
    int64_t end = (band + 1) * SNOW_VALUE_BAND;
    end = end < s->rows ? end : s->rows;
    int64_t low = first < 1 ? 0 : first - 1;
    int64_t high = end + 2 < s->rows ? end + 2 : s->rows;
    begin_marker(&m, low, high, scratch);
    for (int64_t slice = 0; slice < s->slices; slice++) {
        if (snow_monitor_look(s->context->monitor, worker))
            return; /* snow_parallel fails */
        snow_value_lines_slice(&m.lines, slice);
        mark_slice(&m, slice, first, end);
    }
}

/* Bits of the rows of a column of words that have any. */
static void gather_rows(const uint32_t *masks, size_t rows, uint64_t *coarse) {
    for (size_t row = 0; row < rows; row += SNOW_VALUE_COARSE) {
        size_t block = row / SNOW_VALUE_COARSE;
        size_t end =
            row + SNOW_VALUE_COARSE < rows ? row + SNOW_VALUE_COARSE : rows;
        uint32_t any = 0;
        for (size_t n = row; n < end; n++)
            any |= masks[n];
        coarse[block / 64] |= (uint64_t)(any != 0) << block % 64;
    }
}

/* Those of a word of some slices, and of all eight. */
static void gather_slices(snow_value_store *s, int interval, size_t word,
                          int64_t first, int64_t end) {
    uint64_t *coarse =
        s->coarse + snow_value_coarse_at(s, interval, word, first);
    uint64_t *all = s->eights + snow_value_eight_at(s, interval, word,
                                                    first / SNOW_VALUE_EIGHT);
    memset(all, 0, s->coarse_words * sizeof *all);
    for (int64_t slice = first; slice < end; slice++) {
        memset(coarse, 0, s->coarse_words * sizeof *coarse);
        gather_rows(s->masks + snow_value_mask_at(s, interval, slice) +
                        word * s->mask_rows,
                    s->mask_rows, coarse);
        for (size_t n = 0; n < s->coarse_words; n++)
            all[n] |= *coarse++;
    }
}

/* Cells of 2x2 voxels to those of 4x4 around them. */
static void widen_cells(const snow_value_store *s, uint32_t *masks) {
    for (size_t w = 0; w < s->mask_words; w++) {
        uint32_t *column = masks + w * s->mask_rows, before = 0;
        for (size_t row = 0; row < s->mask_rows; row++) {
            uint32_t here = column[row];
            uint32_t next = row + 1 < s->mask_rows ? column[row + 1] : 0;
            column[row] = before | here | next;
            before = here;
        }
    }
    for (size_t row = 0; row < s->mask_rows; row++) {
        uint32_t before = 0;
        for (size_t w = 0; w < s->mask_words; w++) {
            uint32_t *at = masks + w * s->mask_rows + row, here = *at;
            uint32_t next = w + 1 < s->mask_words ? at[s->mask_rows] : 0;
            *at = here | here << 1 | here >> 1 | before >> 31 | next << 31;
            before = here;
        }
    }
}

void snow_value_cells_coarse(snow_value_store *s, int64_t eight) {
    int64_t first = eight * SNOW_VALUE_EIGHT, end = first + SNOW_VALUE_EIGHT;
    end = end < s->slices ? end : s->slices;
    for (int n = 0; n < snow_value_planes(s); n++) {
        for (int64_t slice = first; s->cubic && slice < end; slice++)
            widen_cells(s, s->masks + snow_value_mask_at(s, n, slice));
        for (size_t word = 0; word < s->mask_words; word++)
            gather_slices(s, n, word, first, end);
    }
}
