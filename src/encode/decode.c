/* encode/decode.c - decodes rows of a band to bit masks. */
#include "encode/decode.h"

#include <string.h>

/* Bytes of a cache line. */
#define LINE 64

void snow_mask_rows_lay_out(snow_mask_rows *rows, int64_t columns, char *base,
                            size_t *at) {
    size_t words = snow_decode_words(columns), all = words * SNOW_DECODE_ROWS;
    rows->words = words;
    rows->bits = snow_lay_out(base, at, all * sizeof *rows->bits);
    rows->rank = snow_lay_out(base, at, all * sizeof *rows->rank);
    rows->any = snow_lay_out(base, at, words * sizeof *rows->any);
}

/* Sets bits [from, to) of a row. */
static void set_bits(uint64_t *bits, size_t from, size_t to) {
    for (size_t word = from / 64; word * 64 < to; word++) {
        uint64_t mask = ~UINT64_C(0);
        if (word * 64 < from)
            mask <<= from % 64;
        if (to - word * 64 < 64)
            mask &= (UINT64_C(1) << (to - word * 64)) - 1;
        bits[word * SNOW_DECODE_ROWS] |= mask;
    }
}

static void set_spans(uint64_t *bits, const snow_span *spans, size_t count) {
    for (size_t i = 0; i < count; i++) {
        size_t from = SNOW_DECODE_PAD + (size_t)spans[i].column;
        set_bits(bits, from, from + spans[i].length);
    }
}

/* The next row of a walk as bits, padding included. Advances the walk except
 * for its row and voxel. */
static void next_mask(snow_walk *walk, snow_span *spans, uint64_t *bits,
                      size_t words) {
    const size_t step = SNOW_DECODE_ROWS;
    if (walk->reader->next_mask) {
        bits[0] = bits[(words - 1) * step] = bits[(words - 2) * step] = 0;
        walk->reader->next_mask(walk, bits + SNOW_DECODE_PAD / 64 * step, step);
        return;
    }
    for (size_t word = 0; word < words; word++)
        bits[word * step] = 0;
    set_spans(bits, spans, walk->reader->next_row(walk, spans));
}

#define TEMPLATE "encode/decode.tmpl.h"
#include "simd/each_isa.h"

const snow_decode_fns *snow_decode_fns_of(snow_isa isa) {
    return SNOW_OF_ISA(isa, &decode_fns);
}
