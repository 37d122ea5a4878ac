/* sheared_seen.c - the sheared method in perspective: as sheared.c, but slices
 * are scaled as they are moved (transform/scaled.h), so that each has its own
 * kernel, and each pixel of the intermediate image its own weights; and each
 * voxel has its own ray and opacity (classify/rays.h). */
#include "base/parallel.h"
#include "classify/rays.h"
#include "composite/ray_tile.h"
#include "sheared_parts.h"
#include "transform/scaled.h"
#include "volume/volume.h"
#include "warp/warp.h"

#include <math.h>
#include <string.h>

/* The farthest slice is at most this many times as far from the eye as the
 * nearest one: near slices have that many more pixels a voxel than they need.
 */
#define RATIO_MOST 8

/* One slice of the bands on the lattice.  Along u, first voxels and weights
 * (splat/rake.h) are of all columns; along v each band makes its own. */
typedef struct snow_seen_slice {
    snow_rake u, v;
    double height; /* above the eye, slices */
    int32_t *first;
    float *weights;
} snow_seen_slice;

/* One picture in the making. */
typedef struct seen_pass {
    const snow_sheared_order *order;
    snow_sheared *sheared;
    snow_scaled scaled;
    snow_seen_slice *slices;
    int64_t slice_count, voxel_columns, voxel_rows; /* of the bands */
    int taps[2];                  /* the most of a slice, along u and v */
    double step[2];               /* the most of a slice, voxels a pixel */
    int channels, columns, lines; /* of a tile */
    int64_t tiles;                /* of a band */
    int64_t bands;
    int threads;          /* that splat */
    size_t width;         /* pixels of all tiles */
    size_t window_floats; /* of a tile's row */
    size_t stride;        /* floats of a line of the plane */
    size_t scratch_bytes, code_bytes;
    double share; /* of the exponent: 1 / opacity length, or half of it */
    const float *palette;
    const snow_gloss *gloss; /* NULL: unshaded */
    const snow_window_fns *windows;
    snow_ray_sample_fn *sample;
    snow_ray_tile_fn *tile;
    snow_warp_places_fn *warp;
    snow_filter filter;
    float *pixels;
} seen_pass;

/* A worker's own memory, laid out in snow_sheared.scratch. */
typedef struct seen_scratch {
    uint64_t *bits; /* of the rows of a slice */
    uint32_t *rank;
    float *samples; /* windows of a tile */
    float *ring;    /* filtered rows of a tile */
    float *zero;
    uint64_t *alive; /* per tile: lines that something shines through */
    snow_span *spans;
    int32_t *first; /* along v, of the band's lines */
    float *weights;
} seen_scratch;

/* A band on its way through the slices. */
typedef struct seen_stroke {
    const seen_pass *pass;
    seen_scratch scratch;
    snow_mask_rows rows;
    int first_line, lines;
    bool finished;        /* a line is not alive any more */
    float *pixels;        /* of the plane */
    unsigned char *drawn; /* tiles of the band that were drawn on */
    const snow_seen_slice *slice;
    int64_t row;                             /* the voxel row of mask row 0 */
    uint64_t lines_of_row[SNOW_WINDOW_ROWS]; /* that need a mask row */
} seen_stroke;

/* --- geometry --------------------------------------------------------------
 */

/* Voxels a pixel of the intermediate image may be wide on a slice whose kernel
 * is `wide`: a wider one leaves less to be lost.  At these pitches Engine and
 * CThead are as near to the exact picture as they are in a parallel view. */
static double widest_pitch(double wide, bool draft) {
    double share = wide < 1.1 ? 0.6 : fmin(0.6 + (wide - 1.1), 0.7);
    return fmin((draft ? 0.99 : share) * wide, 2);
}

static void tapers_at(const snow_placement *p, const snow_settings *settings,
                      double slice, snow_taper taper[2]) {
    double width[2];
    snow_eye_pixel_width(p, slice, width);
    for (int axis = 0; axis < 2; axis++)
        taper[axis] =
            snow_taper_make(settings->kernel, settings->footprint, width[axis]);
}

bool snow_sheared_seen_fits(const snow_placement *p,
                            const snow_settings *settings) {
    if (!(snow_scaled_ratio(p) <= RATIO_MOST))
        return false;
    for (int64_t k = 0; k < p->slices; k++) {
        snow_taper taper[2];
        tapers_at(p, settings, (double)k, taper);
        for (int axis = 0; axis < 2; axis++)
            if (snow_comb_taps(&taper[axis]) > SNOW_TAPS_MOST)
                return false;
    }
    return true;
}

/* The pitch of the lattice: fine enough for every slice. */
static snow_status place_lattice(seen_pass *pass) {
    const snow_placement *p = pass->order->placement;
    const snow_settings *settings = pass->order->settings;
    snow_sheared *s = pass->sheared;
    bool draft = settings->quality == SNOW_QUALITY_DRAFT;
    size_t slices = (size_t)p->slices;
    SNOW_TRY(snow_reserve(s->context, &s->reach, &s->reach_capacity, 0,
                          2 * slices * sizeof *s->reach));
    snow_scaled_options options = {.pitch = {INFINITY, INFINITY},
                                   .reach = {s->reach, s->reach + slices}};
    double near =
        fmin(fabs(p->eye.at[2]), fabs((double)(p->slices - 1) - p->eye.at[2]));
    for (size_t k = 0; k < slices; k++) {
        snow_taper taper[2];
        double step = fabs((double)k - p->eye.at[2]) / near;
        tapers_at(p, settings, (double)k, taper);
        for (size_t axis = 0; axis < 2; axis++) {
            double pitch = widest_pitch(taper[axis].wide, draft) / step;
            options.pitch[axis] = fmin(options.pitch[axis], pitch);
            s->reach[axis * slices + k] = snow_taper_reach(&taper[axis]);
        }
    }
    return snow_scaled_make(s->context, p, &options, &pass->scaled);
}

/* How every slice of the bands lies on the lattice. */
static snow_status place_slices(seen_pass *pass) {
    const snow_sheared_order *order = pass->order;
    snow_sheared *s = pass->sheared;
    double spacing = s->key.between ? 0.5 : 1;
    SNOW_TRY(snow_reserve(s->context, &s->seen, &s->seen_capacity, 0,
                          (size_t)pass->slice_count * sizeof *s->seen));
    pass->slices = s->seen;
    for (int64_t n = 0; n < pass->slice_count; n++) {
        snow_seen_slice *slice = &pass->slices[n];
        double k = (double)order->slab.first + spacing * (double)n;
        double step = snow_scaled_step(&pass->scaled, k);
        const snow_scaled_axis *axes[2] = {&pass->scaled.u, &pass->scaled.v};
        snow_rake *rakes[2] = {&slice->u, &slice->v};
        snow_taper taper[2];
        tapers_at(order->placement, order->settings, k, taper);
        slice->height = k - pass->scaled.level;
        for (int axis = 0; axis < 2; axis++) {
            *rakes[axis] =
                (snow_rake){taper[axis], snow_comb_taps(&taper[axis]),
                            snow_scaled_start(axes[axis], step),
                            axes[axis]->pitch * step, axes[axis]->count};
            if (rakes[axis]->taps > pass->taps[axis])
                pass->taps[axis] = rakes[axis]->taps;
            pass->step[axis] = fmax(pass->step[axis], rakes[axis]->step);
        }
    }
    return SNOW_OK;
}

/* Tiles and bands so large that masks of a word hold their voxels. */
static void choose_tiles(seen_pass *pass) {
    int columns = SNOW_RAY_TILE_COLUMNS;
    if (pass->step[0] * (columns - 1) + pass->taps[0] + 1 > SNOW_WINDOW_MOST)
        columns /= 2;
    double lines = (SNOW_WINDOW_ROWS - 1 - pass->taps[1]) / pass->step[1];
    pass->lines =
        lines < SNOW_RAY_TILE_LINES ? (int)lines : SNOW_RAY_TILE_LINES;
    pass->bands = (pass->scaled.v.count + pass->lines - 1) / pass->lines;
    pass->threads = pass->order->settings->threads;
    if (pass->threads > pass->bands)
        pass->threads = (int)pass->bands;
    pass->columns = columns;
    pass->tiles = (pass->scaled.u.count + columns - 1) / columns;
    pass->width = (size_t)pass->tiles * (size_t)columns;
    /* The warp may read a vector beyond the last pixel, and the tiles one
     * beyond a window. */
    pass->stride = (pass->width + 8) * (size_t)pass->channels;
    pass->window_floats = (size_t)(SNOW_WINDOW_MOST + SNOW_TILE_COLUMNS + 1) *
                          (size_t)pass->channels;
}

/* Weights along u of one slice, where it holds voxels. */
static void fill_slice(void *job, int64_t item, int worker) {
    const seen_pass *pass = job;
    snow_seen_slice *slice = &pass->slices[item];
    const snow_rake *rake = &slice->u;
    (void)worker;
    double low = (-rake->taps - rake->start) / rake->step;
    double high =
        ((double)pass->voxel_columns + rake->taps - rake->start) / rake->step;
    int from = low > 0 ? (int)fmin(low, (double)pass->width) : 0;
    int to = high > 0 ? (int)fmin(high + 1, (double)pass->width) : 0;
    /* Whole tiles, which read all of their weights. */
    from -= from % pass->columns;
    to = (to + pass->columns - 1) / pass->columns * pass->columns;
    if (from < to)
        snow_rake_fill(rake, from, to, pass->width, slice->first,
                       slice->weights);
}

static snow_status fill_slices(seen_pass *pass) {
    snow_sheared *s = pass->sheared;
    uint64_t entry = pass->width * (1 + (uint64_t)pass->taps[0]) * 4, bytes;
    /* A group of pixels may read a vector of weights beyond its end. */
    if (!snow_mul_u64(entry, (uint64_t)pass->slice_count, &bytes) ||
        bytes > SIZE_MAX - 64)
        return snow_fail(s->context, SNOW_NO_MEMORY,
                         "no memory for the weights of %lld slices",
                         (long long)pass->slice_count);
    SNOW_TRY(snow_reserve(s->context, &s->teeth, &s->teeth_capacity, 0,
                          (size_t)bytes + 64));
    for (int64_t n = 0; n < pass->slice_count; n++) {
        char *at = s->teeth + (size_t)n * (size_t)entry;
        pass->slices[n].first = (int32_t *)(void *)at;
        pass->slices[n].weights = (float *)(void *)(at + pass->width * 4);
    }
    snow_parallel(s->context, pass->order->settings->threads, pass->slice_count,
                  fill_slice, pass);
    return SNOW_OK;
}

/* --- one band of lines -----------------------------------------------------
 */

/* The polynomial whose root is the exponent of the voxel at column + x of a row
 * (classify/rays.h): the squared length of the ray's step between two slices,
 * in reference lengths. */
static void exponents_of_row(const seen_pass *pass, double height,
                             int64_t column, int64_t row, float square[3]) {
    const snow_eye *eye = &pass->order->placement->eye;
    double u = (double)column - eye->at[0], v = (double)row - eye->at[1];
    double scale = pass->share / height;
    scale *= scale;
    double across = eye->metric[0][1] * v + eye->metric[0][2] * height;
    double rest = eye->metric[1][1] * v * v +
                  2 * eye->metric[1][2] * v * height +
                  eye->metric[2][2] * height * height;
    double first = eye->metric[0][0] * u * u + 2 * u * across + rest;
    double terms[3] = {first, 2 * (eye->metric[0][0] * u + across),
                       eye->metric[0][0]};
    for (int i = 0; i < 3; i++)
        square[i] = (float)fmin(terms[i] * scale, 1e30);
}

static uint64_t lines_of_rows(const seen_stroke *stroke, uint64_t rows) {
    uint64_t lines = 0;
    for (; rows; rows &= rows - 1)
        lines |= stroke->lines_of_row[__builtin_ctzll(rows)];
    return lines;
}

static uint64_t rows_of_lines(const seen_stroke *stroke, uint64_t rows,
                              uint64_t lines) {
    uint64_t needed = 0;
    for (; rows; rows &= rows - 1)
        if (stroke->lines_of_row[__builtin_ctzll(rows)] & lines)
            needed |= rows & -rows;
    return needed;
}

static void sample_rows(const seen_stroke *stroke, uint64_t held, int column,
                        int count, const uint64_t *bits,
                        const uint32_t *before) {
    const seen_pass *pass = stroke->pass;
    for (; held; held &= held - 1) {
        int row = __builtin_ctzll(held);
        const uint16_t *normals = stroke->rows.normals[row];
        float square[3];
        exponents_of_row(pass, stroke->slice->height, column, stroke->row + row,
                         square);
        pass->sample(stroke->rows.codes[row] + before[row] * pass->code_bytes,
                     normals ? normals + before[row] : NULL, bits[row], count,
                     pass->palette, pass->gloss, square,
                     stroke->scratch.samples +
                         (size_t)row * pass->window_floats);
    }
}

/* Lines 08 to 13 for one tile of the slice: the lines that can be seen and have
 * a voxel in reach. */
static void draw_tile(seen_stroke *stroke, int64_t index) {
    const seen_pass *pass = stroke->pass;
    const seen_scratch *scratch = &stroke->scratch;
    const snow_seen_slice *slice = stroke->slice;
    size_t at = (size_t)index * (size_t)pass->columns;
    int column = slice->first[at];
    int count =
        slice->first[at + (size_t)pass->columns - 1] - column + slice->u.taps;
    if (column <= -count || column >= pass->voxel_columns)
        return;
    uint64_t bits[SNOW_WINDOW_ROWS];
    uint32_t before[SNOW_WINDOW_ROWS];
    uint64_t alive = scratch->alive[index];
    uint64_t held = pass->windows->windows(
        &stroke->rows, rows_of_lines(stroke, stroke->rows.held, alive), column,
        count, bits, before);
    uint64_t lines = lines_of_rows(stroke, held) & alive;
    if (!lines)
        return;
    held = rows_of_lines(stroke, held, lines);
    sample_rows(stroke, held, column, count, bits, before);
    snow_ray_tile tile = {
        .u = {slice->first + at, slice->weights + at, pass->width,
              slice->u.taps},
        .v = {scratch->first, scratch->weights, SNOW_RAY_TILE_LINES,
              slice->v.taps},
        .columns = pass->columns,
        .dense = slice->u.step < 0.9999, /* far from being rounded to 1 */
        .row = stroke->row,
        .samples = scratch->samples,
        .window = pass->window_floats,
        .held = held,
        .wanted = lines,
        .ring = scratch->ring,
        .zero = scratch->zero,
        .pixels = stroke->pixels + at * (size_t)pass->channels,
        .line = pass->stride,
    };
    uint64_t finished = pass->tile(&tile);
    scratch->alive[index] &= ~finished;
    stroke->finished |= finished != 0;
    stroke->drawn[index] = 1;
}

/* Weights of the band's lines, and which of them need which row. */
static void fill_lines(seen_stroke *stroke) {
    const snow_rake *rake = &stroke->slice->v;
    snow_rake of_band = *rake;
    of_band.start += rake->step * stroke->first_line;
    snow_rake_fill(&of_band, 0, stroke->lines, SNOW_RAY_TILE_LINES,
                   stroke->scratch.first, stroke->scratch.weights);
    memset(stroke->lines_of_row, 0, sizeof stroke->lines_of_row);
    for (int n = 0; n < stroke->lines; n++)
        for (int m = 0; m < rake->taps; m++)
            stroke->lines_of_row[stroke->scratch.first[n] - stroke->row + m] |=
                UINT64_C(1) << n;
}

/* One slice of the band: its rows as masks, and each tile in turn. */
static void draw_slice(seen_stroke *stroke, int64_t index) {
    const seen_pass *pass = stroke->pass;
    const snow_seen_slice *slice = &pass->slices[index];
    snow_rake of_band = slice->v;
    of_band.start += slice->v.step * stroke->first_line;
    stroke->slice = slice;
    stroke->row = snow_rake_first(&of_band, 0);
    int64_t end = snow_rake_first(&of_band, stroke->lines - 1) + slice->v.taps;
    if (end <= 0 || stroke->row >= pass->voxel_rows)
        return;
    pass->windows->read(&pass->sheared->bands, index, stroke->row,
                        (int)(end - stroke->row), stroke->scratch.spans,
                        &stroke->rows);
    if (!stroke->rows.held)
        return;
    fill_lines(stroke);
    /* Tiles whose pixels can reach a column; draw_tile looks closer. */
    const snow_rake *u = &slice->u;
    double low = (-u->taps - u->start) / u->step / pass->columns;
    double high = ((double)pass->voxel_columns + u->taps - u->start) / u->step /
                  pass->columns;
    int64_t tile = low > 0 ? (int64_t)fmin(low, (double)pass->tiles) : 0;
    for (; tile < pass->tiles && (double)tile < high; tile++)
        if (stroke->scratch.alive[tile])
            draw_tile(stroke, tile);
}

/* The parts of a worker's memory, each aligned to 64 bytes; returns the bytes
 * that they take.  With a NULL base nothing but the sum counts. */
static size_t lay_out(const seen_pass *pass, char *base, seen_scratch *out) {
    size_t at = 0, pixel = (size_t)pass->channels * sizeof(float);
    size_t words = snow_window_words(pass->voxel_columns) * SNOW_WINDOW_ROWS;
    size_t filtered = SNOW_RAY_TILE_COLUMNS * pixel;
#define PART(field, bytes)                              \
    do {                                                \
        out->field = base ? (void *)(base + at) : NULL; \
        at += ((bytes) + 63) / 64 * 64;                 \
    } while (0)
    PART(bits, words * sizeof *out->bits);
    PART(rank, words * sizeof *out->rank);
    PART(samples, SNOW_WINDOW_ROWS * pass->window_floats * sizeof(float));
    PART(ring, SNOW_WINDOW_ROWS * filtered);
    PART(zero, filtered);
    PART(alive, (size_t)pass->tiles * sizeof *out->alive);
    PART(spans, ((size_t)pass->voxel_columns / 2 + 1) * sizeof *out->spans);
    PART(first, SNOW_RAY_TILE_LINES * sizeof *out->first);
    PART(weights,
         (size_t)pass->taps[1] * SNOW_RAY_TILE_LINES * sizeof *out->weights);
#undef PART
    return at;
}

/* Line 07 for one band of lines: all slices, front to back. */
static void splat_band(void *job, int64_t item, int worker) {
    const seen_pass *pass = job;
    seen_stroke stroke = {.pass = pass};
    lay_out(pass, pass->sheared->scratch + (size_t)worker * pass->scratch_bytes,
            &stroke.scratch);
    stroke.rows.bits = stroke.scratch.bits;
    stroke.rows.rank = stroke.scratch.rank;
    stroke.rows.words = snow_window_words(pass->voxel_columns);
    stroke.first_line = (int)item * pass->lines;
    stroke.lines = pass->scaled.v.count - stroke.first_line;
    if (stroke.lines > pass->lines)
        stroke.lines = pass->lines;
    size_t pixels =
        (size_t)stroke.lines * pass->stride / (size_t)pass->channels;
    stroke.pixels =
        pass->sheared->plane + (size_t)stroke.first_line * pass->stride;
    stroke.drawn = pass->sheared->drawn + item * pass->tiles;
    memset(stroke.drawn, 0, (size_t)pass->tiles);
    memset(stroke.scratch.zero, 0,
           SNOW_RAY_TILE_COLUMNS * (size_t)pass->channels * sizeof(float));
    snow_tile_clear(stroke.pixels, pixels, pass->channels);
    for (int64_t tile = 0; tile < pass->tiles; tile++)
        stroke.scratch.alive[tile] = ~UINT64_C(0) >> (64 - stroke.lines);
    bool rising = pass->scaled.height > 0;
    for (int64_t n = 0; n < pass->slice_count &&
                        (!stroke.finished ||
                         snow_any_alive(stroke.scratch.alive, pass->tiles));
         n++)
        draw_slice(&stroke, rising ? n : pass->slice_count - 1 - n);
    snow_tile_finish(stroke.pixels, pixels, pass->channels);
}

static void warp_lines(void *job, int64_t item, int worker) {
    const seen_pass *pass = job;
    (void)worker;
    const snow_view *view = pass->order->view;
    snow_plane plane = {
        pass->sheared->plane, pass->stride,   pass->scaled.u.count,
        pass->scaled.v.count, pass->channels, pass->sheared->drawn,
        pass->columns,        pass->lines,    (int)pass->tiles};
    int first = (int)item * SNOW_WARP_LINES, last = first + SNOW_WARP_LINES;
    for (int y = first; y < last && y < view->height; y++)
        snow_warp_row_seen(&plane, &pass->scaled, pass->filter, pass->warp, y,
                           view->width,
                           pass->pixels + (size_t)y * (size_t)view->width *
                                              (size_t)pass->channels);
}

/* --- a picture -------------------------------------------------------------
 */

/* Lines 02 and 03: tables for this look, light and view. */
static snow_status classify_and_shade(seen_pass *pass, snow_stats *stats) {
    snow_sheared *s = pass->sheared;
    const snow_settings *settings = pass->order->settings;
    bool shaded = settings->shade == SNOW_SHADE_PHONG;
    double mark = snow_seconds();
    SNOW_TRY(snow_palette_make_clear(s->context, &s->coder,
                                     pass->order->transfer, settings->threads,
                                     &s->palette));
    double classified = snow_seconds();
    SNOW_TRY(snow_sheared_shade(s, pass->order));
    stats->seconds_classify += classified - mark;
    stats->seconds_shade += snow_seconds() - classified;
    pass->share = (s->key.between ? 0.5 : 1) / settings->opacity_length;
    pass->palette = s->palette.samples;
    pass->gloss = shaded ? s->gloss + 1 : NULL;
    pass->channels = pass->order->channels;
    pass->code_bytes = (size_t)s->coder.bytes;
    pass->sample = snow_ray_sample_of(settings->isa, s->coder.bytes,
                                      pass->channels, shaded);
    pass->tile = snow_ray_tile_of(settings->isa, pass->channels);
    pass->windows = snow_window_fns_of(settings->isa);
    pass->filter = settings->quality == SNOW_QUALITY_DRAFT ? SNOW_BILINEAR
                                                           : SNOW_CATMULL_ROM;
    pass->warp =
        snow_warp_places_of(settings->isa, pass->filter, pass->channels);
    return SNOW_OK;
}

static snow_status reserve_buffers(seen_pass *pass) {
    snow_sheared *s = pass->sheared;
    seen_scratch unused;
    pass->scratch_bytes = lay_out(pass, NULL, &unused);
    size_t lines = (size_t)pass->scaled.v.count + 1;
    SNOW_TRY(snow_reserve(s->context, &s->scratch, &s->scratch_capacity, 0,
                          pass->scratch_bytes * (size_t)pass->threads));
    SNOW_TRY(snow_reserve(s->context, &s->drawn, &s->drawn_capacity, 0,
                          (size_t)(pass->bands * pass->tiles)));
    return snow_reserve(s->context, &s->plane, &s->plane_capacity, 0,
                        lines * pass->stride * sizeof *s->plane);
}

/* Lines 07 to 13, and the warp. */
static snow_status draw(seen_pass *pass, snow_stats *stats) {
    int threads = pass->order->settings->threads;
    double mark = snow_seconds();
    SNOW_TRY(fill_slices(pass));
    SNOW_TRY(reserve_buffers(pass));
    snow_parallel(pass->sheared->context, threads, pass->bands, splat_band,
                  pass);
    double splatted = snow_seconds();
    snow_parallel(pass->sheared->context, threads,
                  (pass->order->view->height + SNOW_WARP_LINES - 1) /
                      SNOW_WARP_LINES,
                  warp_lines, pass);
    stats->seconds_splat += splatted - mark;
    stats->seconds_warp += snow_seconds() - splatted;
    return SNOW_OK;
}

snow_status snow_sheared_seen_render(snow_sheared *s,
                                     const snow_sheared_order *order,
                                     float *pixels, snow_stats *stats) {
    seen_pass pass = {.order = order, .sheared = s, .pixels = pixels};
    double mark = snow_seconds();
    SNOW_TRY(snow_sheared_encode(s, order, stats));
    stats->seconds_encode += snow_seconds() - mark;
    pass.slice_count = s->bands.slices;
    pass.voxel_columns = s->bands.columns;
    pass.voxel_rows = s->bands.rows;
    SNOW_TRY(classify_and_shade(&pass, stats));
    SNOW_TRY(place_lattice(&pass));
    snow_sheared_fill_figures(s, stats);
    if (pass.scaled.u.count == 0 || pass.scaled.v.count == 0 ||
        pass.slice_count == 0) {
        memset(pixels, 0,
               (size_t)order->view->width * (size_t)order->view->height *
                   (size_t)order->channels * sizeof *pixels);
        return SNOW_OK;
    }
    SNOW_TRY(place_slices(&pass));
    choose_tiles(&pass);
    return draw(&pass, stats);
}
