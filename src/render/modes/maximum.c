/* render/modes/maximum.c - largest values on the slices' lattice: mip and
 * minip.
 *
 * Where no sheet of a slice can be above what the picture holds already, the
 * slice changes nothing there.  What sheets may reach is known for every four
 * places of a row (max_bounds.c), and for every patch of the picture, four
 * columns of a cell, its smallest pixel is kept:
 *
 *   blocks of the rows    12  3  5  7
 *   patches               10  8  8  8    the first one is drawn, and with it
 *                                        the cell; others are passed over
 *
 * So are rows that no cell needs, which are not even decoded.
 *
 * Order does not matter, so slices are taken in one that comes from all of the
 * volume from the start.  A thread takes a band of lines through all slices. */
#include "render/modes/internal.h"

#include <string.h>

#define LINES_MOST (2 * SNOW_MAXIMUM_CELLS)

/* A slice of a band, decoded. */
typedef struct maximum_slice {
    snow_mask_rows rows;
    const snow_slice_place *place;
    int64_t number, first; /* of row 0 of the masks, encoded */
    uint64_t cells, whole; /* that find enough; all, in both lines */
    uint64_t *found;       /* [tile]: those that it may change */
} maximum_slice;

/* A worker's own memory, laid out in snow_shear_warp.scratch. */
typedef struct maximum_scratch {
    maximum_slice *slice;
    snow_span *spans;
    float *samples, *ring, *zero;
    float *lines;                  /* [tile][line][phase][pixel] */
    uint16_t *least;               /* [cell][patch of all tiles] */
    uint64_t *found;               /* of the slice */
    struct maximum_reach *reaches; /* [slice][phase along v] */
    float *pixels, *usual;         /* of a line: [phase][pixel] */
} maximum_scratch;

typedef struct maximum_band_task {
    const projection_pass *pass;
    int worker;
    maximum_scratch scratch;
    int first_cell, cells;
    bool found_usual; /* pixels of usual lines are there */
} maximum_band_task;

/* Patches of a tile; and of a row of tiles: as many more are read at most. */
static int tile_patches(const projection_pass *pass) {
    return pass->columns / SNOW_PATCH_COLUMNS;
}

static size_t row_patches(const projection_pass *pass) {
    return (size_t)pass->tiles * (size_t)tile_patches(pass) + 32;
}

/* --- a tile of a slice ---------------------------------------------------- */

/* The first column of a tile's window, as it is encoded. */
static int64_t first_column(const projection_pass *pass,
                            const snow_slice_place *place, int64_t tile) {
    return place->across[0].start - pass->stored[0] +
           tile * pass->columns * pass->shear.u.stride;
}

/* What the pixels of a tile find of their weights along u, 0 to 1; 0 of those
 * that are another part's. */
static void find_shares(const maximum_band_task *stroke,
                        const snow_slice_place *place, int64_t tile,
                        float *shares) {
    int columns = stroke->pass->columns;
    for (int phase = 0; phase < stroke->pass->shear.u.phases; phase++) {
        const snow_coverage *cover = &place->across[phase];
        const int *own = place->own[0][phase];
        int from = cover->from > own[0] ? cover->from : own[0];
        int to = cover->to < own[1] ? cover->to : own[1];
        for (int n = 0; n < columns; n++) {
            int at = (int)tile * columns + n;
            shares[phase * columns + n] =
                at >= from && at < to ? snow_coverage_at(cover, at) : 0;
        }
    }
}

/* Makes up for the weights that a line's pixels do not find; 0 where they are
 * too few.  The same comparison as in snow_coverage_range. */
static void fill_factors(const float *shares, float found, float *factors) {
    float enough = SNOW_WEIGHT_ENOUGH / found;
    for (int n = 0; n < SNOW_MAXIMUM_LINE; n++)
        factors[n] = shares[n] >= enough ? 1 / (found * shares[n]) : 0;
}

/* Whether all pixels of a tile find all weights along u, and are the part's. */
static bool is_inner(const maximum_band_task *stroke,
                     const snow_slice_place *place, int64_t tile) {
    for (int phase = 0; phase < stroke->pass->shear.u.phases; phase++) {
        const snow_coverage *cover = &place->across[phase];
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

/* What a line of a slice finds of its weights along v; 0 where that is too
 * little, or the line another part's. */
static float find_line(const snow_slice_place *place, int phase, int cell) {
    const int *own = place->own[1][phase];
    float found = snow_coverage_at(&place->down[phase], cell);
    return found >= SNOW_WEIGHT_ENOUGH && cell >= own[0] && cell < own[1]
               ? found
               : 0;
}

/* One cell at an end of the slice: each line has its own factors. */
static void draw_end(const maximum_band_task *stroke,
                     const maximum_slice *slice, const float *shares, int cell,
                     snow_maximum_tile *t) {
    float factors[2 * SNOW_MAXIMUM_LINE] = {0};
    for (int phase = 0; phase < t->phases[1]; phase++) {
        float found = find_line(slice->place, phase, stroke->first_cell + cell);
        if (found > 0)
            fill_factors(shares, found, factors + phase * SNOW_MAXIMUM_LINE);
    }
    t->factors = factors;
    t->cells = UINT64_C(1) << cell;
    stroke->pass->fns->most(t);
    t->factors = NULL;
}

/* Lines 08 to 13 for the cells of a tile, whose rows are combed. */
static void draw_cells(const maximum_band_task *stroke,
                       const maximum_slice *slice, int64_t tile, uint64_t cells,
                       snow_maximum_tile *t) {
    float shares[SNOW_MAXIMUM_LINE] = {0}, factors[2 * SNOW_MAXIMUM_LINE];
    bool inner = is_inner(stroke, slice->place, tile);
    uint64_t ends = cells & ~slice->whole;
    if (!inner || ends)
        find_shares(stroke, slice->place, tile, shares);
    for (; ends; ends &= ends - 1)
        draw_end(stroke, slice, shares, __builtin_ctzll(ends), t);
    t->cells = cells & slice->whole;
    if (!inner) {
        fill_factors(shares, 1, factors);
        fill_factors(shares, 1, factors + SNOW_MAXIMUM_LINE);
        t->factors = factors;
    }
    if (t->cells)
        stroke->pass->fns->most(t);
    t->factors = NULL;
}

static void draw_tile(const maximum_band_task *stroke,
                      const maximum_slice *slice, int64_t tile) {
    const projection_pass *pass = stroke->pass;
    const snow_slice_place *place = slice->place;
    const snow_lattice *u = &pass->shear.u, *v = &pass->shear.v;
    uint64_t bits[SNOW_DECODE_ROWS], held;
    uint32_t before[SNOW_DECODE_ROWS];
    int64_t column = first_column(pass, place, tile);
    int window =
        (pass->columns - 1) * u->stride + pass->taps[0] + place->u->lead[1];
    int reach = place->v->lead[1] + pass->taps[1];
    uint64_t cells = slice->found[tile];
    if (!cells)
        return;
    held = pass->windows->windows(&slice->rows,
                                  snow_rows_of_cells(cells, v->stride, reach),
                                  column, window, bits, before);
    if (!held)
        return;
    /* Sheets of rows without voxels are 0, the smallest value. */
    cells = snow_cells_of_rows(held, cells, v->stride, reach);
    snow_maximum_tile t = {
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
        .lines = stroke->scratch.lines + tile * LINES_MOST * SNOW_MAXIMUM_LINE,
        .least = stroke->scratch.least + tile * tile_patches(pass),
        .patches = row_patches(pass),
    };
    pass->fns->comb(&t);
    draw_cells(stroke, slice, tile, cells, &t);
}

/* --- a band --------------------------------------------------------------- */

/* Cells first .. end - 1, as far as the band has them. */
static uint64_t cells_between(const maximum_band_task *stroke, int first,
                              int end) {
    first -= stroke->first_cell;
    end -= stroke->first_cell;
    first = first > 0 ? first : 0;
    end = end < stroke->cells ? end : stroke->cells;
    return first < end ? ~UINT64_C(0) >> (64 - (end - first)) << first : 0;
}

/* The cells in which a slice has pixels at all. */
static void find_cells(const maximum_band_task *stroke, maximum_slice *slice) {
    const snow_slice_place *place = slice->place;
    slice->cells = 0;
    slice->whole = ~UINT64_C(0);
    for (int phase = 0; phase < stroke->pass->shear.v.phases; phase++) {
        const snow_coverage *down = &place->down[phase];
        const int *own = place->own[1][phase];
        uint64_t is_own = cells_between(stroke, own[0], own[1]);
        slice->cells |= is_own & cells_between(stroke, down->from, down->to);
        slice->whole &= is_own & cells_between(stroke, down->in, down->out);
    }
    for (uint64_t left = slice->cells & ~slice->whole; left; left &= left - 1) {
        int cell = __builtin_ctzll(left);
        float found = 0;
        for (int phase = 0; phase < stroke->pass->shear.v.phases; phase++)
            found += find_line(place, phase, stroke->first_cell + cell);
        slice->cells &= ~((uint64_t) !(found > 0) << cell);
    }
}

/* Where the blocks of patches lie along an axis: of patch 0, and how many. */
static int64_t place_blocks(int64_t first, int count, int *across) {
    int64_t block =
        first >= 0 ? first / SNOW_BLOCK_COLUMNS
                   : -((SNOW_BLOCK_COLUMNS - 1 - first) / SNOW_BLOCK_COLUMNS);
    int beside = (int)(first - block * SNOW_BLOCK_COLUMNS);
    *across = (beside + count - 1) / SNOW_BLOCK_COLUMNS + 1;
    return block;
}

/* The cells that a slice may change, of each tile; returns those of any.  Of
 * splines the places between all voxels but the first and the last count. */
static uint64_t look(const maximum_band_task *stroke,
                     const maximum_slice *slice) {
    const projection_pass *pass = stroke->pass;
    const snow_lattice *u = &pass->shear.u, *v = &pass->shear.v;
    const snow_slice_place *place = slice->place;
    int ends = pass->hull ? 3 : 0, middle = pass->hull ? 2 : 0;
    int64_t column = first_column(pass, place, 0);
    int reach = (SNOW_PATCH_COLUMNS - 1) * u->stride + place->u->lead[1] +
                pass->taps[0] - ends;
    snow_maximum_look look = {
        .blocks =
            pass->bounded ? snow_maximum_bounds(pass, slice->number) : NULL,
        .columns = snow_block_columns(&pass->shear_warp->bands),
        .row = slice->first + middle,
        .least = stroke->scratch.least,
        .patches = row_patches(pass),
        .step = u->stride,
        .stride = v->stride,
        .reach = place->v->lead[1] + pass->taps[1] - ends,
        .cells = slice->cells,
        .fours = tile_patches(pass) / 4,
        .found = slice->found,
    };
    look.column = place_blocks(column + middle, reach, &look.across);
    look.end = (int)pass->tiles;
    int window = pass->columns * u->stride + pass->taps[0];
    while (look.first < look.end &&
           first_column(pass, place, look.first) <= -window)
        look.first++;
    while (look.first < look.end && first_column(pass, place, look.end - 1) >=
                                        pass->shear_warp->bands.columns)
        look.end--;
    memset(slice->found, 0, (size_t)pass->tiles * sizeof *slice->found);
    if (pass->bounded)
        pass->fns->look(&look);
    else
        for (int tile = look.first; tile < look.end; tile++)
            slice->found[tile] = slice->cells;
    uint64_t any = 0;
    for (int tile = look.first; tile < look.end; tile++)
        any |= slice->found[tile];
    memset(slice->found + look.end, 0,
           (size_t)(pass->tiles - look.end) * sizeof *slice->found);
    return any;
}

/* The row of a slice that a band's masks begin with, as it is encoded. */
static int64_t first_row(const maximum_band_task *stroke, int64_t slice) {
    const projection_pass *pass = stroke->pass;
    return pass->places[slice].first_row - pass->stored[1] +
           (int64_t)stroke->first_cell * pass->shear.v.stride;
}

/* Rows that no tile needs are not decoded. */
static void read_slice(const maximum_band_task *stroke, int64_t number,
                       maximum_slice *slice) {
    const projection_pass *pass = stroke->pass;
    int stride = pass->shear.v.stride;
    slice->number = number;
    slice->place = &pass->places[number];
    slice->first = first_row(stroke, number);
    slice->rows.held = 0;
    find_cells(stroke, slice);
    uint64_t cells = slice->cells ? look(stroke, slice) : 0;
    if (cells)
        pass->windows->read(
            &pass->shear_warp->bands, number, slice->first,
            snow_rows_of_cells(cells, stride,
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

static void draw_slices(const maximum_band_task *stroke) {
    const projection_pass *pass = stroke->pass;
    maximum_slice *slice = stroke->scratch.slice;
    int64_t count = pass->slices, step = spread_step(count), number = 0;
    for (int64_t done = 0; done < count; done++) {
        if (snow_monitor_look(pass->shear_warp->monitor, stroke->worker))
            return;
        read_slice(stroke, number, slice);
        for (int64_t tile = 0; slice->rows.held && tile < pass->tiles; tile++)
            draw_tile(stroke, slice, tile);
        number = (number + step) % count;
    }
}

/* Which pixels of a line a slice reaches: those of some range on lines from ..
 * to - 1, of which in .. out - 1 find all weights along v. */
typedef struct maximum_reach {
    int from, in, out, to;
    int range[2][2]; /* per phase along u, where all are found */
} maximum_reach;

static void find_reaches(const maximum_band_task *stroke) {
    const projection_pass *pass = stroke->pass;
    int phases = pass->shear.v.phases;
    for (int64_t n = 0; n < phases * pass->slices; n++) {
        const snow_slice_place *place = &pass->places[n / phases];
        const snow_coverage *cover = &place->down[n % phases];
        const int *own = place->own[1][n % phases];
        maximum_reach *reach = &stroke->scratch.reaches[n];
        reach->from = cover->from > own[0] ? cover->from : own[0];
        reach->to = cover->to < own[1] ? cover->to : own[1];
        reach->in = cover->in;
        reach->out = cover->out;
        memcpy(reach->range, place->range, sizeof reach->range);
    }
}

/* Pixels of a phase, one after the other, that are reached. */
typedef struct maximum_run {
    int first, end;
    float *pixels;
} maximum_run;

static void end_run(maximum_run *run) {
    for (int n = run->first; n < run->end; n++)
        run->pixels[n] = 0;
}

static void add_range(maximum_run *run, const int range[2]) {
    if (range[0] >= range[1])
        return;
    if (range[0] > run->end || range[1] < run->first) {
        end_run(run);
        run->first = range[0];
        run->end = range[1];
    }
    run->first = range[0] < run->first ? range[0] : run->first;
    run->end = range[1] > run->end ? range[1] : run->end;
}

/* Adds the pixels that a slice reaches on a line at one of its ends. */
static void add_end(const maximum_band_task *stroke, int64_t slice, int cell,
                    int down, maximum_run *runs) {
    const projection_pass *pass = stroke->pass;
    const snow_slice_place *place = &pass->places[slice];
    float found = find_line(place, down, cell);
    if (!(found > 0))
        return;
    for (int phase = 0; phase < pass->shear.u.phases; phase++) {
        int range[2];
        snow_modes_range(place, phase, found, range);
        add_range(&runs[phase], range);
    }
}

/* A line's pixels as they begin: those that a slice reaches as the smallest
 * value. */
static void find_pixels(const maximum_band_task *stroke, int cell, int down,
                        float *pixels) {
    const projection_pass *pass = stroke->pass;
    const int phases = pass->shear.u.phases;
    for (size_t n = 0; n < (size_t)phases * pass->row; n++)
        pixels[n] = SNOW_MAXIMUM_NONE;
    maximum_run runs[2] = {{0, 0, pixels}, {0, 0, pixels + pass->row}};
    const maximum_reach *reach = stroke->scratch.reaches + down;
    for (int64_t k = 0; k < pass->slices; k++, reach += pass->shear.v.phases) {
        if (cell < reach->from || cell >= reach->to)
            continue;
        if (cell < reach->in || cell >= reach->out) {
            add_end(stroke, k, cell, down, runs);
            continue;
        }
        for (int phase = 0; phase < phases; phase++)
            add_range(&runs[phase], reach->range[phase]);
    }
    for (int phase = 0; phase < phases; phase++)
        end_run(&runs[phase]);
}

/* The same; most lines lie within all slices, and are alike. */
static const float *pixels_of(maximum_band_task *stroke, int cell, int down) {
    const projection_pass *pass = stroke->pass;
    bool within = cell >= pass->within[down][0] && cell < pass->within[down][1];
    float *pixels = within ? stroke->scratch.usual : stroke->scratch.pixels;
    if (!within || !stroke->found_usual)
        find_pixels(stroke, cell, down, pixels);
    stroke->found_usual |= within;
    return pixels;
}

/* Patches that have a pixel. */
static void clear_patches(const maximum_band_task *stroke, const float *pixels,
                          int cell) {
    const projection_pass *pass = stroke->pass;
    uint16_t *least = stroke->scratch.least + (size_t)cell * row_patches(pass);
    for (int phase = 0; phase < pass->shear.u.phases; phase++) {
        const float *four = pixels + (size_t)phase * pass->row;
        for (int64_t n = 0; n < pass->tiles * tile_patches(pass);
             n++, four += 4)
            if (!(four[0] > 0 && four[1] > 0 && four[2] > 0 && four[3] > 0))
                least[n] = 0;
    }
}

static void clear_line(maximum_band_task *stroke, int n) {
    const projection_pass *pass = stroke->pass;
    int phases = pass->shear.v.phases, cell = n / phases;
    size_t columns = (size_t)pass->columns;
    const float *pixels =
        pixels_of(stroke, stroke->first_cell + cell, n % phases);
    clear_patches(stroke, pixels, cell);
    for (size_t tile = 0; tile < (size_t)pass->tiles; tile++) {
        float *line = stroke->scratch.lines +
                      (tile * LINES_MOST + (size_t)n) * SNOW_MAXIMUM_LINE;
        for (int phase = 0; phase < pass->shear.u.phases; phase++)
            memcpy(line + (size_t)phase * columns,
                   pixels + (size_t)phase * pass->row + tile * columns,
                   columns * sizeof *line);
    }
}

/* Lines of the plane, out of tiles. */
static void finish_line(const maximum_band_task *stroke, int n) {
    const projection_pass *pass = stroke->pass;
    const int phases = pass->shear.u.phases;
    int at = stroke->first_cell * pass->shear.v.phases + n;
    float *out = pass->plane + (size_t)at * pass->stride;
    if (at >= pass->shear.v.count)
        return;
    for (int64_t tile = 0; tile < pass->tiles; tile++) {
        float *line =
            stroke->scratch.lines + (tile * LINES_MOST + n) * SNOW_MAXIMUM_LINE;
        int left = pass->pixels[0] - (int)tile * pass->columns;
        pass->fns->settle(line, phases, pass->columns,
                          left < pass->columns ? left : pass->columns, out);
        out += 2 * phases * pass->columns;
    }
}

static size_t lay_out(const projection_pass *pass, char *base,
                      maximum_scratch *s) {
    int64_t columns = pass->shear_warp->bands.columns;
    size_t at = 0;
    snow_mask_rows unused;
    size_t phases = (size_t)pass->shear.u.phases, tiles = (size_t)pass->tiles;
    size_t line = SNOW_MAXIMUM_LINE * sizeof(float);
    s->slice = snow_lay_out(base, &at, sizeof *s->slice);
    snow_mask_rows_lay_out(base ? &s->slice->rows : &unused, columns, base,
                           &at);
    s->spans =
        snow_lay_out(base, &at, ((size_t)columns / 2 + 1) * sizeof *s->spans);
    s->samples = snow_lay_out(
        base, &at, SNOW_MAXIMUM_ROWS * SNOW_MAXIMUM_WINDOW * sizeof(float));
    s->ring = snow_lay_out(base, &at, SNOW_MAXIMUM_ROWS * line);
    s->zero = snow_lay_out(base, &at, line);
    s->lines = snow_lay_out(base, &at, tiles * LINES_MOST * line);
    s->least = snow_lay_out(
        base, &at, SNOW_MAXIMUM_CELLS * row_patches(pass) * sizeof *s->least);
    s->found = snow_lay_out(base, &at, (tiles + 8) * sizeof *s->found);
    s->reaches = snow_lay_out(base, &at,
                              (size_t)(pass->slices * pass->shear.v.phases) *
                                  sizeof *s->reaches);
    s->pixels = snow_lay_out(base, &at, phases * pass->row * sizeof(float));
    s->usual = snow_lay_out(base, &at, phases * pass->row * sizeof(float));
    return at;
}

size_t snow_maximum_scratch(const projection_pass *pass) {
    maximum_scratch unused;
    return lay_out(pass, NULL, &unused);
}

void snow_maximum_band(void *of, int64_t band, int worker) {
    const projection_pass *pass = of;
    maximum_band_task stroke = {.pass = pass, .worker = worker};
    maximum_scratch *s = &stroke.scratch;
    lay_out(pass,
            pass->shear_warp->scratch + (size_t)worker * pass->scratch_bytes,
            s);
    s->slice->rows.fetch = true;
    s->slice->found = s->found;
    stroke.first_cell = (int)band * pass->cells;
    int left = pass->pixels[1] - stroke.first_cell;
    stroke.cells = left < pass->cells ? left : pass->cells;
    memset(s->zero, 0, SNOW_MAXIMUM_LINE * sizeof *s->zero);
    memset(s->least, 255,
           SNOW_MAXIMUM_CELLS * row_patches(pass) * sizeof *s->least);
    find_reaches(&stroke);
    for (int n = 0; n < stroke.cells * pass->shear.v.phases; n++)
        clear_line(&stroke, n);
    draw_slices(&stroke);
    for (int n = 0; n < stroke.cells * pass->shear.v.phases; n++)
        finish_line(&stroke, n);
}
