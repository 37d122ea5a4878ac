/* encode/values/value_cells.c - which cells of a slice a look can show. */
#include "encode/values/value_encode.h"

#include "simd/rows.h"

#include <string.h>

#define TEMPLATE "encode/values/value_rows.tmpl.h"
#include "simd/each_isa.h"

const snow_value_loops *snow_value_loops_of(snow_isa isa) {
    static const snow_value_loops scalar = {outside_scalar, pack_scalar};
#if SNOW_HAS_AVX
    static const snow_value_loops avx2 = {outside_avx2, pack_avx2};
    static const snow_value_loops avx512 = {outside_avx512, pack_avx512};
    if (isa == SNOW_ISA_AVX512)
        return &avx512;
    if (isa == SNOW_ISA_AVX2)
        return &avx2;
#endif
    (void)isa;
    return &scalar;
}

/* Bits of two lines, for each run. */
static size_t bits_bytes(const snow_value_store *s) {
    size_t words = snow_value_words(s) * 2 * SNOW_VALUE_RUNS;
    return (words * sizeof(uint32_t) + 63) / 64 * 64;
}

static size_t line_bytes(const snow_value_store *s) {
    return (32 * snow_value_words(s) * sizeof(int16_t) + 63) / 64 * 64;
}

size_t snow_value_cells_bytes(const snow_value_store *store,
                              const snow_value_store_params *params) {
    return bits_bytes(store) + line_bytes(store) +
           snow_value_lines_bytes(params, SNOW_VALUE_BAND + 4);
}

/* Cells from the bits of the lines above and below, in a row of the masks and
 * `copies` more. */
static void write_cells(snow_value_store *s, int run, int64_t slice,
                        int64_t row, int copies, const uint32_t *above,
                        const uint32_t *below) {
    size_t words = snow_value_words(s),
           bits = (size_t)s->columns + 2 * (size_t)s->margin - 1;
    uint32_t *out = s->masks + snow_value_mask_at(s, run, slice) +
                    s->mask_rows + (size_t)(row + s->margin + SNOW_VALUE_ROWS);
    for (size_t w = 0; w < words; w++, out += s->mask_rows) {
        uint32_t here = above[w] | below[w];
        uint32_t next = w + 1 < words ? above[w + 1] | below[w + 1] : 0;
        uint32_t cells = here | here >> 1 | next << 31;
        if (32 * w + 32 > bits)
            cells &= 32 * w < bits ? ~UINT32_C(0) >> (32 * w + 32 - bits) : 0;
        for (int n = 0; n <= copies; n++)
            out[n] = cells;
    }
}

/* Rows of cells first .. end - 1 of a slice. */
static void mark_slice(snow_value_store *s, snow_value_lines *lines,
                       const snow_value_loops *loops, int64_t slice,
                       int64_t first, int64_t end, int16_t *line,
                       uint32_t *bits) {
    size_t words = snow_value_words(s), all = words * SNOW_VALUE_RUNS;
    int out = s->margin - 1;
    for (int64_t row = first; row <= end; row++) {
        uint32_t *below = bits + (row & 1 ? all : 0);
        const uint32_t *above = bits + (row & 1 ? 0 : all);
        snow_value_lines_read(lines, row, line);
        for (int run = 0; run < s->run_count; run++) {
            loops->outside(line, words, s->runs[run],
                           below + (size_t)run * words);
            if (row == first)
                continue;
            bool top = row == 0, bottom = row == s->rows;
            write_cells(s, run, slice, top ? -1 - out : row - 1,
                        (top || bottom) ? out : 0, above + (size_t)run * words,
                        below + (size_t)run * words);
        }
    }
}

snow_status snow_value_cells_band(snow_value_store *s,
                                  const snow_value_store_params *params,
                                  int64_t band, int worker, void *scratch) {
    const snow_value_loops *loops = snow_value_loops_of(params->isa);
    /* The first band has the row of cells above the volume too. */
    int64_t first = band ? band * SNOW_VALUE_BAND : -1;
    int64_t end = (band + 1) * SNOW_VALUE_BAND;
    end = end < s->rows ? end : s->rows;
    int64_t low = first < 1 ? 0 : first - 1;
    int64_t high = end + 2 < s->rows ? end + 2 : s->rows;
    unsigned char *at = scratch;
    uint32_t *bits = (uint32_t *)scratch;
    int16_t *line = (int16_t *)(void *)(at + bits_bytes(s));
    snow_value_lines lines;
    memset(line, 0, line_bytes(s));
    snow_value_lines_begin(&lines, params, low, high - low,
                           at + bits_bytes(s) + line_bytes(s));
    for (int64_t slice = 0; slice < s->slices; slice++) {
        if (snow_monitor_look(s->context->monitor, worker))
            return SNOW_STATUS_OK; /* snow_parallel fails */
        snow_value_lines_slice(&lines, slice);
        mark_slice(s, &lines, loops, slice, first, end, line, bits);
    }
    return SNOW_STATUS_OK;
}

void snow_value_cells_coarse(snow_value_store *s, int64_t slice) {
    for (int run = 0; run < s->run_count; run++) {
        const uint32_t *masks = s->masks + snow_value_mask_at(s, run, slice);
        uint64_t *coarse = s->coarse + snow_value_coarse_at(s, run, slice);
        memset(coarse, 0, s->mask_words * s->coarse_words * sizeof *coarse);
        for (size_t w = 0; w < s->mask_words;
             w++, masks += s->mask_rows, coarse += s->coarse_words)
            for (size_t row = 0; row < s->mask_rows; row++) {
                size_t block = row / SNOW_VALUE_COARSE;
                coarse[block / 64] |= (uint64_t)(masks[row] != 0) << block % 64;
            }
    }
}
