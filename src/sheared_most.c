/* sheared_most.c - largest values on the slices' lattice: mip and minip.
 *
 * A sheet's value is a mean of voxels, and so not above the largest of them:
 * where that is not above what the picture holds already, the sheet cannot
 * change it.  For every row of voxels the largest of each 16 is kept
 * (splat/rows.h), and the smallest pixel of every cell of a tile; cells that a
 * slice cannot change are passed over, and rows that no other needs with them.
 *
 *   voxels of the rows    12  3 |  5  7     largest: 12 |  7
 *   cells of the tile     picture holds 8 or more:  draw | pass
 *
 * Order does not matter, so slices are taken in one that comes from all of the
 * volume from the start.  A thread takes a band of lines through all slices,
 * some at once: a tile stays in the first-level cache while they pass. */
#include "sheared_reduce.h"

#include "base/parallel.h"

#include <string.h>

#define SLICES_AT_ONCE 8
#define LINES_MOST (2 * SNOW_MOST_CELLS)

/* What is above all values: of pixels that no slice reaches. */
#define NO_PIXEL 2.0f

/* A slice of a band, decoded. */
typedef struct most_slice {
    snow_mask_rows rows;
    const snow_slice_place *place;
    int64_t number, first; /* of row 0 of the masks, encoded */
    uint64_t cells, whole; /* that find enough; all, in both lines */
} most_slice;

/* A worker's own memory, laid out in snow_sheared.scratch. */
typedef struct most_scratch {
    most_slice *slices;
    uint64_t *bits; /* of the rows of the slices */
    uint32_t *rank;
    uint64_t *any;
    snow_span *spans;
    float *samples, *ring, *zero, *factors;
    float *lines; /* [tile][line][phase][pixel] */
    float *least; /* [tile][cell] */
    double *rise;
    float *weights, *usual; /* of a line: [phase][pixel] */
} most_scratch;

typedef struct most_stroke {
    const snow_modes_pass *pass;
    most_scratch scratch;
    int first_cell, cells;
    bool weighed; /* usual weights are there */
} most_stroke;

/* --- blocks ----------------------------------------------------------------
 */

static size_t block_columns(const snow_bands *bands) {
    return (size_t)bands->columns / SNOW_BLOCK_COLUMNS + 1;
}

typedef struct blocks_job {
    const snow_modes_pass *pass;
    char *scratch;
    size_t scratch_bytes;
} blocks_job;

static size_t blocks_scratch(const snow_bands *bands) {
    size_t words = snow_window_words(bands->columns);
    size_t bytes =
        words * SNOW_WINDOW_ROWS * (sizeof(uint64_t) + sizeof(uint32_t)) +
        words * (sizeof(uint64_t) + 64 * sizeof(float)) +
        ((size_t)bands->columns / 2 + 1) * sizeof(snow_span);
    return (bytes + 63) / 64 * 64;
}

/* The blocks of a slice: of all rows that hold a voxel. */
static void find_blocks(void *of, int64_t slice, int worker) {
    const blocks_job *job = of;
    const snow_modes_pass *pass = job->pass;
    const snow_bands *bands = &pass->sheared->bands;
    size_t words = snow_window_words(bands->columns), rows = words - 2;
    snow_mask_rows masks = {.words = words};
    char *at = job->scratch + (size_t)worker * job->scratch_bytes;
    masks.bits = (uint64_t *)(void *)at;
    masks.any = masks.bits + words * SNOW_WINDOW_ROWS;
    masks.rank = (uint32_t *)(void *)(masks.any + words);
    float *row = (float *)(void *)(masks.rank + words * SNOW_WINDOW_ROWS);
    snow_span *spans = (snow_span *)(void *)(row + 64 * words);
    uint16_t *blocks = pass->sheared->blocks + (size_t)slice *
                                                   block_columns(bands) *
                                                   (size_t)bands->rows;
    for (int64_t first = 0; first < bands->rows; first += SNOW_WINDOW_ROWS) {
        pass->windows->read(bands, slice, first, ~UINT64_C(0), spans, &masks);
        for (uint64_t held = masks.held; held; held &= held - 1) {
            int n = __builtin_ctzll(held);
            (pass->code_bytes == 1 ? pass->fns->spread8 : pass->fns->spread16)(
                masks.bits + n + SNOW_WINDOW_ROWS, SNOW_WINDOW_ROWS, rows,
                masks.codes[n], pass->scale, pass->start, row);
            pass->fns->block(row, bands->columns, (size_t)bands->rows,
                             blocks + first + n);
        }
    }
}

snow_status snow_most_prepare(snow_modes_pass *pass,
                              const snow_value_scale *scale) {
    snow_sheared *s = pass->sheared;
    const snow_bands *bands = &s->bands;
    uint64_t count;
    if (s->blocks_of == s->encodings && s->blocks_scale.from == scale->from &&
        s->blocks_scale.step == scale->step)
        return SNOW_OK;
    if (!snow_mul_u64((uint64_t)block_columns(bands), (uint64_t)bands->rows,
                      &count) ||
        !snow_mul_u64(count, (uint64_t)bands->slices, &count) ||
        !snow_mul_u64(count, sizeof *s->blocks, &count) || count >= SIZE_MAX)
        return snow_fail(s->context, SNOW_NO_MEMORY,
                         "no memory for the largest values of rows");
    s->blocks_of = 0;
    SNOW_TRY(snow_reserve(s->context, &s->blocks, &s->blocks_capacity, 0,
                          (size_t)count + 1));
    memset(s->blocks, 0, (size_t)count);
    blocks_job job = {pass, NULL, blocks_scratch(bands)};
    int threads = pass->order->settings->threads;
    job.scratch =
        snow_allocate_array(s->context, (uint64_t)threads, job.scratch_bytes);
    if (!job.scratch)
        return SNOW_NO_MEMORY;
    snow_parallel(s->context, threads, bands->slices, find_blocks, &job);
    snow_release(s->context, job.scratch);
    s->blocks_of = s->encodings;
    s->blocks_scale = *scale;
    return SNOW_OK;
}

/* --- a tile of a slice -----------------------------------------------------
 */

/* The cells of a tile that a slice may change; `column` is the first encoded
 * one of its window. */
static uint64_t look(const most_stroke *stroke, const most_slice *slice,
                     int64_t column, int window, const float *least) {
    const snow_modes_pass *pass = stroke->pass;
    const snow_bands *bands = &pass->sheared->bands;
    const uint16_t *columns[SNOW_WINDOW_MOST / SNOW_BLOCK_COLUMNS + 2];
    int64_t end =
        column + window < bands->columns ? column + window : bands->columns;
    int64_t block = (column > 0 ? column : 0) / SNOW_BLOCK_COLUMNS;
    const uint16_t *blocks = pass->sheared->blocks + (size_t)slice->number *
                                                         block_columns(bands) *
                                                         (size_t)bands->rows;
    snow_most_look look = {.blocks = columns,
                           .cells = stroke->cells,
                           .stride = pass->shear.v.stride,
                           .reach = slice->place->v->lead[1] + pass->taps[1],
                           .least = least};
    int64_t last = bands->rows - slice->first;
    look.first = slice->first < 0 ? (int)-slice->first : 0;
    look.end = last < SNOW_MOST_ROWS ? (int)last : SNOW_MOST_ROWS;
    for (; block * SNOW_BLOCK_COLUMNS < end; block++)
        columns[look.block_count++] =
            blocks + block * bands->rows + slice->first;
    return pass->fns->look(&look);
}

/* Makes up for the weights that a line's pixels do not find; 0 where they are
 * too few, or the pixel another part's. */
static void fill_factors(const most_stroke *stroke, const most_slice *slice,
                         int64_t tile, float found, float *factors) {
    const snow_slice_place *place = slice->place;
    for (int phase = 0; phase < stroke->pass->shear.u.phases; phase++) {
        int range[2] = {place->range[phase][0], place->range[phase][1]};
        if (found < 1)
            snow_modes_range(place, phase, found, range);
        for (int n = 0; n < stroke->pass->columns; n++) {
            int at = (int)tile * stroke->pass->columns + n;
            factors[phase * stroke->pass->columns + n] =
                at >= range[0] && at < range[1]
                    ? 1 / (found * snow_cover_at(&place->across[phase], at))
                    : 0;
        }
    }
}

/* Whether all pixels of a tile find all weights along u, and are the part's. */
static bool is_inner(const most_stroke *stroke, const snow_slice_place *place,
                     int64_t tile) {
    for (int phase = 0; phase < stroke->pass->shear.u.phases; phase++) {
        const snow_cover *cover = &place->across[phase];
        const int *own = place->own[0][phase];
        int first = (int)tile * stroke->pass->columns,
            end = first + stroke->pass->columns;
        int last = stroke->pass->pixels[0];
        end = end < last ? end : last;
        if (first < cover->in || end > cover->out || first < own[0] ||
            end > own[1])
            return false;
    }
    return true;
}

/* One cell at an end of the slice: each line has its own factors. */
static void draw_end(const most_stroke *stroke, const most_slice *slice,
                     int64_t tile, int cell, snow_most_tile *t) {
    const snow_slice_place *place = slice->place;
    float *factors = stroke->scratch.factors;
    int at = stroke->first_cell + cell;
    memset(factors, 0, 2 * SNOW_MOST_LINE * sizeof *factors);
    for (int phase = 0; phase < t->phases[1]; phase++) {
        const int *own = place->own[1][phase];
        float found = snow_cover_at(&place->down[phase], at);
        if (found >= SNOW_WEIGHT_ENOUGH && at >= own[0] && at < own[1])
            fill_factors(stroke, slice, tile, found,
                         factors + phase * SNOW_MOST_LINE);
    }
    t->factors = factors;
    t->cells = UINT64_C(1) << cell;
    stroke->pass->fns->most(t);
}

/* Lines 08 to 13 for the cells of a tile, whose rows are combed. */
static void draw_cells(const most_stroke *stroke, const most_slice *slice,
                       int64_t tile, uint64_t cells, snow_most_tile *t) {
    float *factors = stroke->scratch.factors;
    for (uint64_t left = cells & ~slice->whole; left; left &= left - 1)
        draw_end(stroke, slice, tile, __builtin_ctzll(left), t);
    t->cells = cells & slice->whole;
    t->factors = NULL;
    if (!t->cells)
        return;
    if (!is_inner(stroke, slice->place, tile)) {
        fill_factors(stroke, slice, tile, 1, factors);
        for (int i = 0; i < SNOW_MOST_LINE; i++)
            factors[SNOW_MOST_LINE + i] = factors[i];
        t->factors = factors;
    }
    stroke->pass->fns->most(t);
}

static void draw_tile(const most_stroke *stroke, const most_slice *slice,
                      int64_t tile) {
    const snow_modes_pass *pass = stroke->pass;
    const snow_slice_place *place = slice->place;
    const snow_lattice *u = &pass->shear.u, *v = &pass->shear.v;
    uint64_t bits[SNOW_WINDOW_ROWS], held;
    uint32_t before[SNOW_WINDOW_ROWS];
    float *least = stroke->scratch.least + tile * SNOW_MOST_CELLS;
    int64_t column = place->across[0].start - pass->stored[0] +
                     tile * pass->columns * u->stride;
    int window =
        (pass->columns - 1) * u->stride + pass->taps[0] + place->u->lead[1];
    int reach = place->v->lead[1] + pass->taps[1];
    if (column <= -window || column >= pass->sheared->bands.columns)
        return;
    uint64_t cells = look(stroke, slice, column, window, least) & slice->cells;
    if (!cells)
        return;
    held = pass->windows->windows(&slice->rows,
                                  snow_rows_of_cells(cells, v->stride, reach),
                                  column, window, bits, before);
    if (!held)
        return;
    snow_most_tile t = {
        .columns = pass->columns,
        .phases = {u->phases, v->phases},
        .stride = {u->stride, v->stride},
        .taps = {pass->taps[0], pass->taps[1]},
        .lead = {place->u->lead[1], place->v->lead[1]},
        .weights = {{place->u->weights[0], place->u->weights[1]},
                    {place->v->weights[0], place->v->weights[1]}},
        .held = held,
        .bits = bits,
        .before = before,
        .codes = slice->rows.codes,
        .code_bytes = pass->code_bytes,
        .window = window,
        .scale = pass->scale,
        .start = pass->start,
        .samples = stroke->scratch.samples,
        .ring = stroke->scratch.ring,
        .zero = stroke->scratch.zero,
        .lines = stroke->scratch.lines + tile * LINES_MOST * SNOW_MOST_LINE,
        .least = least,
    };
    pass->fns->comb(&t);
    draw_cells(stroke, slice, tile, cells, &t);
}

/* --- a band ----------------------------------------------------------------
 */

/* Cells first .. end - 1, as far as the band has them. */
static uint64_t cells_between(const most_stroke *stroke, int first, int end) {
    first -= stroke->first_cell;
    end -= stroke->first_cell;
    first = first > 0 ? first : 0;
    end = end < stroke->cells ? end : stroke->cells;
    return first < end ? ~UINT64_C(0) >> (64 - (end - first)) << first : 0;
}

/* The cells in which a slice has pixels at all. */
static void find_cells(const most_stroke *stroke, most_slice *slice) {
    const snow_slice_place *place = slice->place;
    slice->cells = 0;
    slice->whole = ~UINT64_C(0);
    for (int phase = 0; phase < stroke->pass->shear.v.phases; phase++) {
        const snow_cover *down = &place->down[phase];
        const int *own = place->own[1][phase];
        uint64_t is_own = cells_between(stroke, own[0], own[1]);
        slice->cells |= is_own & cells_between(stroke, down->from, down->to);
        slice->whole &= is_own & cells_between(stroke, down->in, down->out);
    }
}

static void read_slice(const most_stroke *stroke, int64_t number,
                       most_slice *slice) {
    const snow_modes_pass *pass = stroke->pass;
    int stride = pass->shear.v.stride;
    slice->number = number;
    slice->place = &pass->places[number];
    slice->first = slice->place->first_row - pass->stored[1] +
                   (int64_t)stroke->first_cell * stride;
    slice->rows.held = 0;
    find_cells(stroke, slice);
    if (slice->cells)
        pass->windows->read(
            &pass->sheared->bands, number, slice->first,
            snow_rows_of_cells(slice->cells, stride,
                               slice->place->v->lead[1] + pass->taps[1]),
            stroke->scratch.spans, &slice->rows);
}

/* A number that has no factor in common with the count of slices, and is about
 * 0.38 of it: multiples of it, modulo the count, are evenly spread from the
 * start. */
static int64_t spread_step(int64_t count) {
    int64_t step = count * 382 / 1000;
    for (step = step > 1 ? step : 1;; step++) {
        int64_t a = count, b = step;
        while (b) {
            int64_t rest = a % b;
            a = b;
            b = rest;
        }
        if (a == 1)
            return step;
    }
}

static void draw_slices(const most_stroke *stroke) {
    const snow_modes_pass *pass = stroke->pass;
    most_slice *slices = stroke->scratch.slices;
    int64_t count = pass->slices, step = spread_step(count), number = 0;
    for (int64_t done = 0; done < count;) {
        int here = 0;
        for (; here < SLICES_AT_ONCE && done < count; done++) {
            read_slice(stroke, number, &slices[here]);
            here += slices[here].rows.held != 0;
            number = (number + step) % count;
        }
        for (int64_t tile = 0; tile < pass->tiles; tile++)
            for (int n = 0; n < here; n++)
                draw_tile(stroke, &slices[n], tile);
    }
}

/* The weights of a line; most lines lie within all slices, and have the same.
 */
static const float *weights_of(most_stroke *stroke, int cell, int down) {
    const snow_modes_pass *pass = stroke->pass;
    bool within = cell >= pass->within[down][0] && cell < pass->within[down][1];
    float *weights = within ? stroke->scratch.usual : stroke->scratch.weights;
    if (!within || !stroke->weighed)
        snow_modes_weigh(pass, cell, down, stroke->scratch.rise, weights);
    stroke->weighed |= within;
    return weights;
}

/* Pixels that a slice reaches begin as the smallest value; returns whether
 * there is one. */
static bool clear_pixels(const float *weights, int count, int columns,
                         float *pixels) {
    int there = 0;
    for (int n = 0; n < count; n++) {
        pixels[n] = weights[n] > 0 ? 0 : NO_PIXEL;
        there |= weights[n] > 0;
    }
    for (int n = count; n < columns; n++)
        pixels[n] = NO_PIXEL;
    return there;
}

static void clear_line(most_stroke *stroke, int n) {
    const snow_modes_pass *pass = stroke->pass;
    int phases = pass->shear.v.phases, cell = n / phases;
    const float *weights =
        weights_of(stroke, stroke->first_cell + cell, n % phases);
    for (int64_t tile = 0; tile < pass->tiles; tile++) {
        float *line =
            stroke->scratch.lines + (tile * LINES_MOST + n) * SNOW_MOST_LINE;
        int left = pass->pixels[0] - (int)tile * pass->columns;
        for (int phase = 0; phase < pass->shear.u.phases; phase++)
            if (clear_pixels(weights + (size_t)phase * pass->row +
                                 (size_t)(tile * pass->columns),
                             left < pass->columns ? left : pass->columns,
                             pass->columns, line + phase * pass->columns))
                stroke->scratch.least[tile * SNOW_MOST_CELLS + cell] = 0;
    }
}

/* Lines of the plane, out of tiles. */
static void finish_line(const most_stroke *stroke, int n) {
    const snow_modes_pass *pass = stroke->pass;
    const int phases = pass->shear.u.phases;
    int at = stroke->first_cell * pass->shear.v.phases + n;
    float *out = pass->plane + (size_t)at * pass->stride;
    if (at >= pass->shear.v.count)
        return;
    for (int64_t tile = 0; tile < pass->tiles; tile++) {
        float *line =
            stroke->scratch.lines + (tile * LINES_MOST + n) * SNOW_MOST_LINE;
        float there[SNOW_MOST_LINE];
        int left = pass->pixels[0] - (int)tile * pass->columns;
        for (int i = 0; i < phases * pass->columns; i++) {
            there[i] = line[i] < NO_PIXEL ? 1 : 0;
            line[i] = there[i] * snow_most_step(line[i]) / SNOW_MOST_STEPS;
        }
        const float *values[2] = {line, line + pass->columns};
        const float *found[2] = {there, there + pass->columns};
        pass->fns->weave(values, found, phases,
                         left < pass->columns ? left : pass->columns, out);
        out += 2 * phases * pass->columns;
    }
}

static void lay_out(const snow_modes_pass *pass, char *base, size_t *bytes,
                    most_scratch *s) {
    int64_t columns = pass->sheared->bands.columns;
    size_t words = snow_window_words(columns), at = 0;
    size_t all = SLICES_AT_ONCE * words * SNOW_WINDOW_ROWS;
    size_t phases = (size_t)pass->shear.u.phases, tiles = (size_t)pass->tiles;
    size_t line = SNOW_MOST_LINE * sizeof(float);
    s->slices = snow_modes_part(base, &at, SLICES_AT_ONCE * sizeof *s->slices);
    s->bits = snow_modes_part(base, &at, all * sizeof *s->bits);
    s->rank = snow_modes_part(base, &at, all * sizeof *s->rank);
    s->any =
        snow_modes_part(base, &at, SLICES_AT_ONCE * words * sizeof *s->any);
    s->spans = snow_modes_part(base, &at,
                               ((size_t)columns / 2 + 1) * sizeof *s->spans);
    s->samples = snow_modes_part(
        base, &at, SNOW_MOST_ROWS * SNOW_MOST_WINDOW * sizeof(float));
    s->ring = snow_modes_part(base, &at, SNOW_MOST_ROWS * line);
    s->zero = snow_modes_part(base, &at, line);
    s->factors = snow_modes_part(base, &at, 2 * line);
    s->lines = snow_modes_part(base, &at, tiles * LINES_MOST * line);
    /* A vector more is read. */
    s->least = snow_modes_part(base, &at,
                               (tiles * SNOW_MOST_CELLS + 16) * sizeof(float));
    s->rise = snow_modes_part(
        base, &at, phases * ((size_t)pass->pixels[0] + 1) * sizeof *s->rise);
    s->weights = snow_modes_part(base, &at, phases * pass->row * sizeof(float));
    s->usual = snow_modes_part(base, &at, phases * pass->row * sizeof(float));
    *bytes = at;
}

size_t snow_most_scratch(const snow_modes_pass *pass) {
    most_scratch unused;
    size_t bytes;
    lay_out(pass, NULL, &bytes, &unused);
    return bytes;
}

void snow_most_band(void *of, int64_t band, int worker) {
    const snow_modes_pass *pass = of;
    most_stroke stroke = {.pass = pass};
    most_scratch *s = &stroke.scratch;
    size_t bytes, words = snow_window_words(pass->sheared->bands.columns);
    lay_out(pass, pass->sheared->scratch + (size_t)worker * pass->scratch_bytes,
            &bytes, s);
    for (size_t n = 0; n < SLICES_AT_ONCE; n++) {
        snow_mask_rows *rows = &s->slices[n].rows;
        rows->bits = s->bits + n * words * SNOW_WINDOW_ROWS;
        rows->rank = s->rank + n * words * SNOW_WINDOW_ROWS;
        rows->any = s->any + n * words;
        rows->words = words;
        rows->fetch = true;
    }
    stroke.first_cell = (int)band * pass->cells;
    int left = pass->pixels[1] - stroke.first_cell;
    stroke.cells = left < pass->cells ? left : pass->cells;
    memset(s->zero, 0, SNOW_MOST_LINE * sizeof *s->zero);
    for (int64_t n = 0; n < pass->tiles * SNOW_MOST_CELLS; n++)
        s->least[n] = NO_PIXEL * SNOW_MOST_STEPS;
    for (int n = 0; n < stroke.cells * pass->shear.v.phases; n++)
        clear_line(&stroke, n);
    draw_slices(&stroke);
    for (int n = 0; n < stroke.cells * pass->shear.v.phases; n++)
        finish_line(&stroke, n);
}
