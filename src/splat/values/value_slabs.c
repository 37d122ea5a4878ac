/* splat/values/value_slabs.c - which slabs of a tile have anything, by the
 * coarse masks: of eight slices first, then of each. */
#include "splat/values/value_room.h"

/* Cells that the windows of some sheets cover. */
typedef struct box {
    int64_t low[2], high[2];
} box;

/* Those of a phase along an axis of a sheet. */
static void cover_axis(const snow_value_splat *p, int sheet, int phase,
                       int axis, const int tile[2], int64_t ends[2]) {
    if (p->rays) {
        const snow_value_lanes *lanes =
            value_lanes_of(p->rays, sheet, phase, axis, tile[axis]);
        ends[0] = lanes->first + lanes->at[axis];
        ends[1] = lanes->first + lanes->at[31 + axis];
        return;
    }
    ends[0] = axis ? value_tile_row(p, tile[1]) : value_tile_column(p, tile[0]);
    ends[0] += p->places[sheet * p->phases + phase].whole[axis];
    ends[1] = ends[0] + 31;
}

/* Those of some phases on a sheet. */
static void cover(const snow_value_splat *p, int sheet, int first, int end,
                  const int tile[2], box *b) {
    for (int phase = first; phase < end; phase++)
        for (int axis = 0; axis < 2; axis++) {
            int64_t at[2];
            cover_axis(p, sheet, phase, axis, tile, at);
            b->low[axis] = at[0] < b->low[axis] ? at[0] : b->low[axis];
            b->high[axis] = at[1] > b->high[axis] ? at[1] : b->high[axis];
        }
}

static const box nothing = {{INT64_MAX, INT64_MAX}, {INT64_MIN, INT64_MIN}};

/* Whether a coarse mask has anything in a box. */
static bool has_any(const snow_value_store *s, const uint64_t *coarse,
                    const box *b) {
    const int64_t zero = s->margin + 32; /* of cell 0 */
    const int64_t end[2] = {(int64_t)s->mask_words * 32, (int64_t)s->mask_rows};
    int64_t low[2], high[2];
    for (int axis = 0; axis < 2; axis++) {
        low[axis] = b->low[axis] + zero > 0 ? b->low[axis] + zero : 0;
        high[axis] = b->high[axis] + zero;
        high[axis] = high[axis] < end[axis] ? high[axis] : end[axis] - 1;
        if (low[axis] > high[axis])
            return false;
    }
    size_t top = (size_t)low[1] / SNOW_VALUE_COARSE;
    size_t bottom = (size_t)high[1] / SNOW_VALUE_COARSE;
    for (size_t n = top / 64; n <= bottom / 64; n++) {
        uint64_t rows = n == top / 64 ? ~UINT64_C(0) << top % 64 : ~UINT64_C(0);
        if (n == bottom / 64)
            rows &= ~UINT64_C(0) >> (63 - bottom % 64);
        for (size_t word = (size_t)low[0] / 32; word <= (size_t)high[0] / 32;
             word++)
            if (coarse[word * s->coarse_words + n] & rows)
                return true;
    }
    return false;
}

/* A bit for each run with cells that it does not hide, in a slice (of every
 * slice, or of each eight) and, for sheets between, in the next one. */
static unsigned runs_of(const snow_value_store *s, const uint64_t *coarse,
                        int64_t slices, int64_t slice, bool between,
                        const box *b) {
    size_t size = s->mask_words * s->coarse_words;
    unsigned runs = 0;
    for (int run = 0; run < s->run_count; run++)
        for (int64_t k = slice; k <= slice + between && k < slices; k++)
            if (has_any(s, coarse + (size_t)(run * slices + k) * size, b))
                runs |= 1U << run;
    return runs;
}

/* The last sheet of the same eight slices. */
static int last_of_eight(const snow_value_splat *p, int sheet) {
    int64_t eight = p->sheets[sheet].slice / SNOW_VALUE_EIGHT;
    while (sheet < p->slabs[1] &&
           p->sheets[sheet + 1].slice / SNOW_VALUE_EIGHT == eight)
        sheet++;
    return sheet;
}

int value_list_slabs(const snow_value_splat *p, int first, int end,
                     const int tile[2], int32_t *out) {
    const snow_value_store *s = p->store;
    const unsigned all = (1U << s->run_count) - 1;
    unsigned before = 0;
    int count = 0;
    if (p->slabs[0] >= p->slabs[1])
        return 0;
    for (int n = p->slabs[0], last; n <= p->slabs[1]; n = last + 1) {
        const snow_value_sheet *sheet = p->sheets + n;
        box b = nothing;
        last = last_of_eight(p, n);
        cover(p, n, first, end, tile, &b);
        cover(p, last, first, end, tile, &b);
        bool some = runs_of(s, s->eights, s->eight_count,
                            sheet->slice / SNOW_VALUE_EIGHT,
                            sheet->between || p->sheets[last].between, &b) != 0;
        for (int m = n; m <= last; m++, sheet++) {
            unsigned here = 0;
            if (some || !all) {
                b = nothing;
                cover(p, m, first, end, tile, &b);
                here = runs_of(s, s->coarse, s->slices, sheet->slice,
                               sheet->between, &b);
            }
            if (m > p->slabs[0] && (before | here) == all)
                out[count++] = m - 1;
            before = here;
        }
    }
    return count;
}

int snow_value_list(const snow_value_splat *p, const int tile[2],
                    int32_t *out) {
    return value_list_slabs(p, 0, p->phases, tile, out);
}
