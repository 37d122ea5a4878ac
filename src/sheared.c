/* sheared.c - the sheared method: encode, splat and composite on the slices'
 * own lattice, warp once (transform/shear.h).
 *
 * The intermediate image is cut into bands of lines.  A band is the unit of
 * work of a thread, which walks all slices from front to back for it:
 *
 *   slice k, rows of voxels        ring            band of the image
 *   EA, IA --spans--> samples --across--> taps rows --down--> line behind line
 *
 * Bands share nothing, so the picture does not depend on the threads; what lies
 * behind opaque chunks is skipped, voxels included. */
#include "sheared.h"

#include "base/parallel.h"
#include "image/image.h"
#include "sheared_parts.h"
#include "volume/volume.h"
#include "warp/warp.h"

#include <math.h>
#include <string.h>

/* One picture in the making. */
typedef struct snow_pass {
    const snow_sheared_order *order;
    snow_sheared *sheared;
    snow_shear shear;
    snow_taper taper[2];     /* along u and v */
    int taps[2];             /* of the tapers */
    const snow_comb *combs;  /* [2 * slice + axis] */
    int64_t columns, slices; /* of the bands */
    bool nearest_first;
    int channels;
    size_t code_bytes;
    const float *palette;
    const snow_gloss *gloss; /* NULL: unshaded */
    const snow_window_fns *windows;
    snow_sample_fn *sample;
    snow_tile_fn *tile;
    snow_warp_fn *warp;
    snow_filter filter;
    int cells;     /* of a band */
    int64_t tiles; /* of a band */
    int64_t bands;
    int threads; /* that splat */
    int window;  /* voxels that a tile can need of a row */
    size_t window_floats;
    size_t stride; /* floats of a line of the plane */
    size_t scratch_bytes;
    float *pixels;
} snow_pass;

/* Slices that pass over a tile together. */
#define SLICES_AT_ONCE 8

/* A slice of a band, decoded. */
typedef struct slice_rows {
    snow_mask_rows rows;
    const snow_comb *u, *v;
    int reach;         /* rows that a cell needs */
    int64_t low, high; /* tiles that it may touch: low .. high - 1 */
} slice_rows;

/* A worker's own memory, laid out in snow_sheared.scratch. */
typedef struct snow_scratch {
    slice_rows *slices;
    uint64_t *bits; /* of the rows of the slices */
    uint32_t *rank;
    float *samples; /* windows of a tile */
    snow_sample_room *room;
    float *ring; /* filtered rows of a tile */
    float *zero;
    uint64_t *alive; /* per tile: cells that something shines through */
    snow_span *spans;
} snow_scratch;

/* A band on its way through the slices. */
typedef struct snow_stroke {
    const snow_pass *pass;
    snow_scratch scratch;
    int64_t first_cell;
    int cells;
    bool finished;        /* a cell is not alive any more */
    float *pixels;        /* of the plane */
    unsigned char *drawn; /* tiles of the band that were drawn on */
} snow_stroke;

snow_status snow_sheared_new(snow_context *context, snow_sheared **out) {
    snow_sheared *sheared = snow_allocate_clear(context, sizeof *sheared);
    if (!sheared)
        return SNOW_NO_MEMORY;
    sheared->context = sheared->bands.context = context;
    *out = sheared;
    return SNOW_OK;
}

void snow_sheared_free(snow_sheared *s) {
    if (!s)
        return;
    snow_bands_fini(&s->bands);
    snow_coder_fini(s->context, &s->coder);
    snow_coder_fini(s->context, &s->next);
    snow_palette_fini(s->context, &s->palette);
    snow_release(s->context, s->gloss);
    snow_release(s->context, s->combs);
    snow_release(s->context, s->plane);
    snow_release(s->context, s->drawn);
    snow_release(s->context, s->scratch);
    snow_release(s->context, s->seen);
    snow_release(s->context, s->teeth);
    snow_release(s->context, s->reach);
    snow_release(s->context, s);
}

/* How many voxels a pixel of the picture is wide along u or v. */
static double pixel_width(const snow_placement *p, int axis) {
    return hypot(p->inverse[axis][0], p->inverse[axis][1]);
}

bool snow_sheared_fits(const snow_placement *p, const snow_settings *settings) {
    if (p->perspective)
        return snow_sheared_seen_fits(p, settings);
    for (int axis = 0; axis < 2; axis++) {
        snow_taper taper = snow_taper_make(
            settings->kernel, settings->footprint, pixel_width(p, axis));
        if (snow_comb_taps(&taper) > SNOW_TAPS_MOST)
            return false;
    }
    return true;
}

/* --- encoding --------------------------------------------------------------
 */

static bool same_key(const snow_encoded_key *a, const snow_encoded_key *b) {
    return a->serial && a->serial == b->serial &&
           a->slice_axis == b->slice_axis && a->shaded == b->shaded &&
           a->between == b->between && a->encoding == b->encoding &&
           a->slab.first == b->slab.first && a->slab.count == b->slab.count;
}

static snow_status encode_bands(snow_sheared *s,
                                const snow_sheared_order *order, bool between) {
    snow_normal_maker maker;
    bool shaded = order->settings->shade == SNOW_SHADE_PHONG;
    if (shaded)
        SNOW_TRY(snow_normal_maker_init(s->context, order->volume, &maker));
    snow_bands_order bands = {
        .volume = order->volume,
        .placement = order->placement,
        .coder = &s->coder,
        .maker = shaded ? &maker : NULL,
        .encoding = order->settings->encoding,
        .first_slice = order->slab.first,
        .slice_count = order->slab.count,
        .between = between,
        .isa = order->settings->isa,
        .threads = order->settings->threads,
    };
    return snow_bands_encode(&s->bands, &bands);
}

snow_status snow_sheared_encode(snow_sheared *s,
                                const snow_sheared_order *order,
                                snow_stats *stats) {
    const snow_settings *settings = order->settings;
    snow_encoded_key key = {
        .serial = order->volume->serial,
        .slice_axis = order->placement->slice_axis,
        .shaded = settings->shade == SNOW_SHADE_PHONG,
        .between = settings->quality == SNOW_QUALITY_HIGH,
        .encoding = settings->encoding,
        .slab = order->slab,
    };
    SNOW_TRY(snow_coder_make(s->context, order->volume, order->transfer,
                             settings->threshold, &s->next));
    bool kept = same_key(&key, &s->key) && snow_coder_same(&s->next, &s->coder);
    snow_coder coder = s->coder;
    s->coder = s->next;
    s->next = coder;
    if (!coder.native_runs) /* the first time: so that the second takes none */
        SNOW_TRY(snow_coder_make(s->context, order->volume, order->transfer,
                                 settings->threshold, &s->next));
    if (kept)
        return SNOW_OK;
    s->key.serial = 0; /* should the encoding fail half-way */
    SNOW_TRY(encode_bands(s, order, key.between));
    s->key = key;
    stats->encoded = 1;
    return SNOW_OK;
}

/* --- one band of lines -----------------------------------------------------
 */

/* Cells of `wanted`, in terms of the rows that they need: cell i needs rows
 * i * stride to i * stride + reach - 1.  Where stride is 1 both are shifts. */
static uint64_t cells_of_rows(uint64_t rows, int cells, int stride, int reach) {
    uint64_t found = 0;
    if (stride == 1) {
        for (int m = 0; m < reach; m++)
            found |= rows >> m;
        return found & (~UINT64_C(0) >> (64 - cells));
    }
    uint64_t needed = ~UINT64_C(0) >> (64 - reach);
    for (int i = 0; i < cells; i++)
        found |= (uint64_t)((rows >> i * stride & needed) != 0) << i;
    return found;
}

static uint64_t rows_of_cells(uint64_t cells, int stride, int reach) {
    uint64_t rows = 0, needed = ~UINT64_C(0) >> (64 - reach);
    if (stride == 1) {
        for (int m = 0; m < reach; m++)
            rows |= cells << m;
        return rows;
    }
    for (; cells; cells &= cells - 1)
        rows |= needed << __builtin_ctzll(cells) * stride;
    return rows;
}

/* Lines 08 to 13 for one tile of a slice: the cells that can be seen and have a
 * voxel in reach. */
static void draw_tile(snow_stroke *stroke, const slice_rows *slice,
                      int64_t index) {
    const snow_pass *pass = stroke->pass;
    const snow_scratch *scratch = &stroke->scratch;
    const snow_lattice *u = &pass->shear.u, *v = &pass->shear.v;
    int64_t column =
        (u->first / u->phases + index * SNOW_TILE_COLUMNS) * u->stride +
        slice->u->offset;
    uint64_t bits[SNOW_WINDOW_ROWS], held;
    uint32_t before[SNOW_WINDOW_ROWS];
    uint64_t alive = scratch->alive[index];
    held = pass->windows->windows(&slice->rows,
                                  rows_of_cells(alive, v->stride, slice->reach),
                                  column, pass->window, bits, before);
    uint64_t cells =
        cells_of_rows(held, stroke->cells, v->stride, slice->reach) & alive;
    if (!cells)
        return;
    held &= rows_of_cells(cells, v->stride, slice->reach);
    size_t pixel = (size_t)pass->channels, floats = pass->window_floats;
    snow_sample_job job = {held,
                           pass->window,
                           bits,
                           slice->rows.codes,
                           slice->rows.normals,
                           before,
                           pass->palette,
                           pass->gloss,
                           scratch->room,
                           scratch->samples,
                           floats};
    pass->sample(&job);
    snow_tile tile = {u,
                      v,
                      slice->u,
                      slice->v,
                      pass->taps[0],
                      pass->taps[1],
                      scratch->samples,
                      floats,
                      held,
                      cells,
                      scratch->ring,
                      scratch->zero,
                      stroke->pixels + (size_t)index * SNOW_TILE_COLUMNS *
                                           (size_t)u->phases * pixel,
                      pass->stride};
    uint64_t finished = pass->tile(&tile);
    scratch->alive[index] &= ~finished;
    stroke->finished |= finished != 0;
    stroke->drawn[index] = 1;
}

/* Reads the band's rows of a slice as masks, and tells the tiles that they
 * reach: those whose window overlaps the columns. */
static void read_slice(snow_stroke *stroke, int64_t number, slice_rows *slice) {
    const snow_pass *pass = stroke->pass;
    const snow_lattice *u = &pass->shear.u, *v = &pass->shear.v;
    slice->u = &pass->combs[2 * number];
    slice->v = &pass->combs[2 * number + 1];
    slice->reach = slice->v->lead[1] + pass->taps[1];
    int64_t first = (v->first / v->phases + stroke->first_cell) * v->stride +
                    slice->v->offset;
    pass->windows->read(&pass->sheared->bands, number, first,
                        (stroke->cells - 1) * v->stride + slice->reach,
                        stroke->scratch.spans, &slice->rows);
    int64_t step = SNOW_TILE_COLUMNS * u->stride;
    int64_t start = u->first / u->phases * u->stride + slice->u->offset;
    int64_t low = -start - pass->window + 1, high = pass->columns - start;
    slice->low = low > 0 ? (low + step - 1) / step : 0;
    slice->high = high > 0 ? (high + step - 1) / step : 0;
    if (!slice->rows.held)
        slice->high = 0;
}

/* Some slices of the band, the nearest first, tile by tile: a tile's pixels
 * stay in the first-level cache while all of them pass over it. */
static void draw_slices(snow_stroke *stroke, int64_t first, int count) {
    const snow_pass *pass = stroke->pass;
    slice_rows *slices = stroke->scratch.slices;
    for (int n = 0; n < count; n++)
        read_slice(stroke,
                   pass->nearest_first ? first + n
                                       : pass->slices - 1 - first - n,
                   &slices[n]);
    for (int64_t tile = 0; tile < pass->tiles; tile++)
        for (int n = 0; n < count && stroke->scratch.alive[tile]; n++)
            if (slices[n].low <= tile && tile < slices[n].high)
                draw_tile(stroke, &slices[n], tile);
}

/* The parts of a worker's memory, each aligned to 64 bytes; returns the bytes
 * that they take.  With a NULL base nothing but the sum counts. */
static size_t lay_out(const snow_pass *pass, char *base, snow_scratch *out) {
    size_t at = 0, pixel = (size_t)pass->channels * sizeof(float);
    size_t words = snow_window_words(pass->columns) * SNOW_WINDOW_ROWS;
    size_t filtered = 2 * SNOW_TILE_COLUMNS * pixel;
#define PART(field, bytes)                              \
    do {                                                \
        out->field = base ? (void *)(base + at) : NULL; \
        at += ((bytes) + 63) / 64 * 64;                 \
    } while (0)
    PART(slices, SLICES_AT_ONCE * sizeof *out->slices);
    PART(bits, SLICES_AT_ONCE * words * sizeof *out->bits);
    PART(rank, SLICES_AT_ONCE * words * sizeof *out->rank);
    PART(samples,
         (SNOW_WINDOW_ROWS * pass->window_floats + 64) * sizeof(float));
    PART(room, sizeof *out->room);
    PART(ring, SNOW_WINDOW_ROWS * filtered);
    PART(zero, filtered);
    PART(alive, (size_t)pass->tiles * sizeof *out->alive);
    PART(spans, ((size_t)pass->columns / 2 + 1) * sizeof *out->spans);
#undef PART
    return at;
}

/* Line 07 for one band of lines: all slices, front to back. */
static void splat_band(void *job, int64_t item, int worker) {
    const snow_pass *pass = job;
    const snow_lattice *v = &pass->shear.v;
    snow_stroke stroke = {.pass = pass};
    lay_out(pass, pass->sheared->scratch + (size_t)worker * pass->scratch_bytes,
            &stroke.scratch);
    memset(stroke.scratch.zero, 0,
           2 * SNOW_TILE_COLUMNS * (size_t)pass->channels * sizeof(float));
    size_t words = snow_window_words(pass->columns);
    for (size_t n = 0; n < SLICES_AT_ONCE; n++) {
        snow_mask_rows *rows = &stroke.scratch.slices[n].rows;
        rows->bits = stroke.scratch.bits + n * words * SNOW_WINDOW_ROWS;
        rows->rank = stroke.scratch.rank + n * words * SNOW_WINDOW_ROWS;
        rows->words = words;
    }
    stroke.first_cell = item * pass->cells;
    int64_t cells = (v->count + v->phases - 1) / v->phases - stroke.first_cell;
    stroke.cells = cells < pass->cells ? (int)cells : pass->cells;
    size_t lines = (size_t)(stroke.cells * v->phases);
    size_t pixels = lines * pass->stride / (size_t)pass->channels;
    stroke.pixels = pass->sheared->plane +
                    (size_t)(stroke.first_cell * v->phases) * pass->stride;
    stroke.drawn = pass->sheared->drawn + item * pass->tiles;
    memset(stroke.drawn, 0, (size_t)pass->tiles);
    snow_tile_clear(stroke.pixels, pixels, pass->channels);
    for (int64_t tile = 0; tile < pass->tiles; tile++)
        stroke.scratch.alive[tile] = ~UINT64_C(0) >> (64 - stroke.cells);
    for (int64_t n = 0; n < pass->slices &&
                        (!stroke.finished ||
                         snow_any_alive(stroke.scratch.alive, pass->tiles));
         n += SLICES_AT_ONCE)
        draw_slices(&stroke, n,
                    pass->slices - n < SLICES_AT_ONCE ? (int)(pass->slices - n)
                                                      : SLICES_AT_ONCE);
    snow_tile_finish(stroke.pixels, pixels, pass->channels);
}

static void warp_lines(void *job, int64_t item, int worker) {
    const snow_pass *pass = job;
    (void)worker;
    const snow_view *view = pass->order->view;
    const snow_lattice *u = &pass->shear.u, *v = &pass->shear.v;
    snow_plane plane = {pass->sheared->plane,
                        pass->stride,
                        u->count,
                        v->count,
                        pass->channels,
                        pass->sheared->drawn,
                        SNOW_TILE_COLUMNS * u->phases,
                        pass->cells * v->phases,
                        (int)pass->tiles};
    int first = (int)item * SNOW_WARP_LINES, last = first + SNOW_WARP_LINES;
    for (int y = first; y < last && y < view->height; y++)
        snow_warp_row(&plane, &pass->shear, pass->filter, pass->warp, y,
                      view->width,
                      pass->pixels + (size_t)y * (size_t)view->width *
                                         (size_t)pass->channels);
}

/* --- a picture -------------------------------------------------------------
 */

/* Pixels a voxel, or voxels a pixel, along one axis.  A kernel that is widened
 * needs fewer of them: Engine and CThead, warped from a pixel a voxel, are 52
 * dB and more from the exact picture at their own width, 57 dB and more from a
 * widening of 1.22 on. */
static void choose_pitch(const snow_taper *taper, bool draft, int *phases,
                         int *stride) {
    *phases = !draft && taper->wide < 1.2 ? 2 : 1;
    *stride = taper->wide >= (draft ? 2 : 2.5) ? 2 : 1;
}

static snow_status place_lattice(snow_pass *pass) {
    const snow_placement *p = pass->order->placement;
    const snow_settings *settings = pass->order->settings;
    bool draft = settings->quality == SNOW_QUALITY_DRAFT;
    snow_shear_options options;
    for (int axis = 0; axis < 2; axis++) {
        snow_taper *taper = &pass->taper[axis];
        *taper = snow_taper_make(settings->kernel, settings->footprint,
                                 pixel_width(p, axis));
        pass->taps[axis] = snow_comb_taps(taper);
        choose_pitch(taper, draft, &options.phases[axis],
                     &options.stride[axis]);
        options.reach[axis] = snow_taper_reach(taper);
    }
    SNOW_TRY(
        snow_shear_make(pass->sheared->context, p, &options, &pass->shear));
    pass->filter = draft ? SNOW_BILINEAR : SNOW_CATMULL_ROM;
    const snow_lattice *u = &pass->shear.u, *v = &pass->shear.v;
    int columns = SNOW_TILE_COLUMNS * u->phases;
    pass->tiles = (u->count + columns - 1) / columns;
    /* The warp may read a vector beyond the last pixel. */
    pass->stride = (size_t)((pass->tiles + 1) * columns * pass->channels);
    pass->window =
        (SNOW_TILE_COLUMNS - 1) * u->stride + pass->taps[0] + u->phases - 1;
    /* Samples are made four at a time; what is beyond a window belongs to the
     * next, which is made later. */
    pass->window_floats =
        (size_t)((pass->window + 3) / 4 * 4) * (size_t)pass->channels;
    int rows = SNOW_WINDOW_ROWS - pass->taps[1] - v->phases + 1;
    pass->cells = rows / v->stride + 1;
    if (pass->cells > SNOW_TILE_CELLS)
        pass->cells = SNOW_TILE_CELLS;
    int64_t cells = (v->count + v->phases - 1) / v->phases;
    pass->bands = (cells + pass->cells - 1) / pass->cells;
    pass->threads =
        settings->threads < pass->bands ? settings->threads : (int)pass->bands;
    return SNOW_OK;
}

/* The kernels of all slices: their shifts differ. */
static snow_status place_slices(snow_pass *pass) {
    snow_sheared *s = pass->sheared;
    size_t slices = (size_t)pass->slices;
    SNOW_TRY(snow_reserve(s->context, &s->combs, &s->combs_capacity, 0,
                          2 * slices * sizeof *s->combs));
    double step = s->key.between ? 0.5 : 1;
    const snow_lattice *lattices[2] = {&pass->shear.u, &pass->shear.v};
    for (size_t n = 0; n < slices; n++)
        for (size_t axis = 0; axis < 2; axis++)
            snow_comb_make(&pass->taper[axis], lattices[axis],
                           (double)pass->order->slab.first + step * (double)n,
                           &s->combs[2 * n + axis]);
    pass->combs = s->combs;
    return SNOW_OK;
}

snow_status snow_sheared_shade(snow_sheared *s,
                               const snow_sheared_order *order) {
    const snow_settings *settings = order->settings;
    if (settings->shade != SNOW_SHADE_PHONG)
        return SNOW_OK;
    SNOW_TRY(snow_reserve(s->context, &s->gloss, &s->gloss_capacity, 0,
                          (SNOW_NORMALS + 1) * sizeof *s->gloss));
    s->gloss[0] = 0;
    snow_gloss_table(s->context, settings, order->placement, settings->threads,
                     s->gloss + 1);
    return SNOW_OK;
}

/* Lines 02 and 03: tables for this look, light and view. */
static snow_status classify_and_shade(snow_pass *pass, snow_stats *stats) {
    snow_sheared *s = pass->sheared;
    const snow_settings *settings = pass->order->settings;
    bool shaded = settings->shade == SNOW_SHADE_PHONG;
    double path = pass->order->placement->path / (s->key.between ? 2 : 1);
    double mark = snow_seconds();
    SNOW_TRY(snow_palette_make(s->context, &s->coder, pass->order->transfer,
                               path / settings->opacity_length, !shaded,
                               settings->threads, &s->palette));
    double classified = snow_seconds();
    SNOW_TRY(snow_sheared_shade(s, pass->order));
    stats->seconds_classify += classified - mark;
    stats->seconds_shade += snow_seconds() - classified;
    pass->palette = s->palette.samples;
    pass->gloss = shaded ? s->gloss + 1 : NULL;
    pass->channels = pass->order->channels;
    pass->sample =
        snow_sample_of(settings->isa, s->coder.bytes, pass->channels, shaded);
    pass->code_bytes = (size_t)s->coder.bytes;
    pass->tile = snow_tile_of(settings->isa, pass->channels);
    pass->windows = snow_window_fns_of(settings->isa);
    return SNOW_OK;
}

static snow_status reserve_buffers(snow_pass *pass) {
    snow_sheared *s = pass->sheared;
    snow_scratch unused;
    pass->scratch_bytes = lay_out(pass, NULL, &unused);
    size_t lines = (size_t)pass->shear.v.count + 1;
    SNOW_TRY(snow_reserve(s->context, &s->scratch, &s->scratch_capacity, 0,
                          pass->scratch_bytes * (size_t)pass->threads));
    SNOW_TRY(snow_reserve(s->context, &s->drawn, &s->drawn_capacity, 0,
                          (size_t)(pass->bands * pass->tiles)));
    return snow_reserve(s->context, &s->plane, &s->plane_capacity, 0,
                        lines * pass->stride * sizeof *s->plane);
}

/* The interesting voxels of the volume: without those of slices between. */
static int64_t count_interesting(const snow_sheared *s) {
    if (!s->key.between)
        return (int64_t)s->bands.voxels;
    int64_t count = 0;
    for (int64_t band = 0; band < s->bands.band_count; band++) {
        const snow_slice_pointer *pa = s->bands.bands[band].pa;
        for (int64_t slice = 0; slice < s->bands.slices; slice += 2)
            count += (int64_t)(pa[slice + 1].ia - pa[slice].ia);
    }
    return count;
}

/* The bytes of several axes, where a picture is blended, add up. */
void snow_sheared_fill_figures(const snow_sheared *s, snow_stats *stats) {
    stats->encoding = s->bands.encoding;
    stats->interesting = count_interesting(s);
    stats->ea_bytes += s->bands.ea_bytes;
    stats->ia_bytes += s->bands.ia_bytes;
    stats->pa_bytes += s->bands.pa_bytes;
}

/* Lines 07 to 13, and the warp. */
static void draw(snow_pass *pass, snow_stats *stats) {
    int threads = pass->order->settings->threads;
    double mark = snow_seconds();
    snow_parallel(pass->sheared->context, threads, pass->bands, splat_band,
                  pass);
    double splatted = snow_seconds();
    pass->warp =
        snow_warp_of(pass->order->settings->isa, pass->filter, pass->channels);
    snow_parallel(pass->sheared->context, threads,
                  (pass->order->view->height + SNOW_WARP_LINES - 1) /
                      SNOW_WARP_LINES,
                  warp_lines, pass);
    stats->seconds_splat += splatted - mark;
    stats->seconds_warp += snow_seconds() - splatted;
}

snow_status snow_sheared_render(snow_sheared *s,
                                const snow_sheared_order *order, float *pixels,
                                snow_stats *stats) {
    if (order->placement->perspective)
        return snow_sheared_seen_render(s, order, pixels, stats);
    snow_pass pass = {.order = order, .sheared = s, .pixels = pixels};
    double mark = snow_seconds();
    SNOW_TRY(snow_sheared_encode(s, order, stats));
    stats->seconds_encode += snow_seconds() - mark;
    pass.slices = s->bands.slices;
    pass.columns = s->bands.columns;
    pass.nearest_first = order->placement->nearest_first;
    SNOW_TRY(classify_and_shade(&pass, stats));
    SNOW_TRY(place_lattice(&pass));
    snow_sheared_fill_figures(s, stats);
    if (pass.shear.u.count == 0 || pass.shear.v.count == 0 ||
        pass.slices == 0) {
        memset(pixels, 0,
               (size_t)order->view->width * (size_t)order->view->height *
                   (size_t)order->channels * sizeof *pixels);
        return SNOW_OK;
    }
    SNOW_TRY(place_slices(&pass));
    SNOW_TRY(reserve_buffers(&pass));
    draw(&pass, stats);
    return SNOW_OK;
}
