/* render/shear_warp/shear_warp.c - the sheared method: encode, splat and
 * composite on the slices' own lattice, warp once (transform/shear.h).
 *
 * The intermediate image is cut into bands of lines.  A band is the unit of
 * work of a thread, which walks all slices from front to back for it:
 *
 *   slice k, rows of voxels        ring            band of the image
 *   EA, IA --spans--> samples --across--> taps rows --down--> line behind line
 *
 * Bands share nothing, so the picture does not depend on the threads; what lies
 * behind opaque chunks is skipped, voxels included. */
#include "render/shear_warp/shear_warp.h"

#include "image/image.h"
#include "render/shear_warp/internal.h"
#include "volume/volume.h"
#include "warp/warp.h"

#include <math.h>
#include <string.h>

/* One picture in the making. */
typedef struct shear_warp_pass {
    const snow_shear_warp_params *params;
    snow_shear_warp *shear_warp;
    snow_shear shear;
    snow_scaled_kernel scaled_kernel[2]; /* along u and v */
    int taps[2];                         /* of the tapers */
    const snow_comb *combs;              /* [2 * slice + axis] */
    int64_t columns, slices;             /* of the bands; that are drawn */
    bool nearest_first;
    bool lazy; /* tiles are cleared when they are first drawn on */
    double first_slice, slice_step; /* where the drawn ones lie in the whole */
    snow_grouping grouping;
    int channels;
    size_t code_bytes;
    const float *palette;
    const snow_gloss *gloss; /* NULL: unshaded */
    float exponent;          /* of a faded picture */
    const snow_decode_fns *windows;
    snow_sample_fn *sample;
    snow_tile_fn *tile;
    int cells;     /* of a band */
    int64_t tiles; /* of a band */
    int64_t bands;
    int threads; /* that splat */
    int window;  /* voxels that a tile can need of a row */
    size_t window_floats;
    size_t stride; /* floats of a line of the plane */
    size_t scratch_bytes;
    snow_shear_warp_image image;
} shear_warp_pass;

/* Slices that pass over a tile together. */
#define SLICES_AT_ONCE 8

/* A slice of a band, decoded. */
typedef struct slice_rows {
    snow_mask_rows rows;
    const snow_comb *u, *v;
    int reach;                  /* rows that a cell needs */
    int64_t column;             /* the first voxel of tile 0's windows */
    int64_t low, high;          /* tiles that it may touch: low .. high - 1 */
    uint64_t cells;             /* cells that it may touch */
    int u_range[2], v_range[2]; /* a part's pixels of the plane; where it cuts
                                 */
} slice_rows;

/* A worker's own memory, laid out in snow_shear_warp.scratch. */
typedef struct snow_scratch {
    slice_rows *slices;
    float *samples; /* windows of a tile */
    snow_sample_room *room;
    float *ring; /* filtered rows of a tile */
    float *zero;
    uint64_t *unsaturated; /* per tile: cells that something shines through */
    snow_span *spans;
    float *kept;                       /* a cut tile's pixels */
    snow_band spare[SNOW_GROUP_RANKS]; /* to be combined */
} snow_scratch;

/* A band on its way through the slices. */
typedef struct shear_warp_band_task {
    const shear_warp_pass *pass;
    int worker;
    snow_scratch scratch;
    int64_t first_cell;
    int cells;
    uint64_t unsaturated; /* cells that something shines through in any tile */
    bool fetch;           /* and so they do in most tiles */
    snow_band_shape shape;
    float *pixels;        /* of the plane */
    unsigned char *drawn; /* tiles of the band that were drawn on */
    int64_t first, count; /* slices that are drawn */
} shear_warp_band_task;

snow_status snow_shear_warp_new(snow_context *context, snow_shear_warp **out) {
    if (*out)
        return SNOW_STATUS_OK;
    snow_shear_warp *shear_warp =
        snow_allocate_clear(context, sizeof *shear_warp);
    if (!shear_warp)
        return SNOW_STATUS_NO_MEMORY;
    shear_warp->context = shear_warp->bands.context = context;
    shear_warp->intermediate = shear_warp->intermediates;
    *out = shear_warp;
    return SNOW_STATUS_OK;
}

void snow_shear_warp_free(snow_shear_warp *s) {
    if (!s)
        return;
    snow_bands_fini(&s->bands);
    snow_encoding_cache_fini(s->context, &s->encoding_cache);
    snow_quantizer_fini(s->context, &s->quantizer);
    snow_quantizer_fini(s->context, &s->next);
    snow_palette_fini(s->context, &s->palette);
    snow_release(s->context, s->blocks);
    snow_release(s->context, s->gradient_opacity_key);
    snow_release(s->context, s->next_gradient_opacity_key);
    snow_release(s->context, s->gloss);
    snow_release(s->context, s->combs);
    for (int n = 0; n < 2; n++) {
        snow_release(s->context, s->intermediates[n].plane);
        snow_release(s->context, s->intermediates[n].drawn);
    }
    snow_release(s->context, s->scratch);
    snow_line_batch_fini(&s->batch);
    snow_release(s->context, s->pass);
    snow_release(s->context, s->seen);
    snow_release(s->context, s->teeth);
    snow_release(s->context, s->reach);
    snow_release(s->context, s);
}

/* How many voxels a pixel of the picture is wide along u or v. */
static double pixel_width(const snow_placement *p, int axis) {
    return hypot(p->inverse[axis][0], p->inverse[axis][1]);
}

static snow_scaled_kernel scaled_kernel_along(const snow_placement *p,
                                              const snow_settings *settings,
                                              int axis) {
    return snow_scaled_kernel_make_level(settings->kernel, settings->footprint,
                                         pixel_width(p, axis), p->fine[axis]);
}

bool snow_shear_warp_fits(const snow_placement *p,
                          const snow_settings *settings) {
    if (p->perspective)
        return snow_shear_warp_perspective_fits(p, settings);
    for (int axis = 0; axis < 2; axis++) {
        snow_scaled_kernel scaled_kernel =
            scaled_kernel_along(p, settings, axis);
        if (snow_comb_taps(&scaled_kernel) > SNOW_TAPS_MOST)
            return false;
    }
    return true;
}

/* --- encoding ------------------------------------------------------------- */

static bool same_key(const snow_encoded_key *a, const snow_encoded_key *b) {
    return a->generation && a->generation == b->generation &&
           a->slice_axis == b->slice_axis && a->shaded == b->shaded &&
           a->between == b->between &&
           a->with_gradient_opacity == b->with_gradient_opacity &&
           a->numbers == b->numbers && a->encoding == b->encoding &&
           a->threshold == b->threshold && a->slab.first == b->slab.first &&
           a->slab.count == b->slab.count;
}

int64_t snow_shear_warp_slices(const snow_shear_warp_params *params) {
    snow_slab slab = params->slab;
    if (params->settings->quality != SNOW_QUALITY_HIGH || slab.count == 0)
        return slab.count;
    bool last = slab.first + slab.count == params->placement->slices;
    return 2 * slab.count - last;
}

/* The stored slices that the drawn ones are made of: the one behind the last
 * has a share in the slice between. */
static snow_slab encoded_slab(const snow_shear_warp_params *params,
                              bool between) {
    snow_slab slab = params->slab;
    if (slab.count == 0)
        return (snow_slab){0, 0};
    if (between && slab.first + slab.count < params->placement->slices)
        slab.count++;
    slab.first -= params->clip.stored[2];
    return slab;
}

snow_status snow_shear_warp_bands_params(
    snow_shear_warp *s, const snow_shear_warp_params *params,
    const snow_encoded_key *key, const snow_volume *volume,
    const snow_clip *clip, snow_band_tools *tools, snow_bands_params *out) {
    snow_clip_placement(clip, params->placement, &tools->stored);
    if (key->shaded)
        SNOW_TRY(snow_normal_maker_init(s->context, volume, &tools->maker));
    if (key->with_gradient_opacity)
        SNOW_TRY(snow_gradient_opacity_init(
            s->context, volume, params->transfer, key->threshold,
            params->settings->isa, &tools->gradient_opacity));
    *out = (snow_bands_params){
        .volume = volume,
        .placement = &tools->stored,
        .quantizer = &s->quantizer,
        .maker = key->shaded ? &tools->maker : NULL,
        .gradient_opacity =
            key->with_gradient_opacity ? &tools->gradient_opacity : NULL,
        .encoding = params->settings->encoding,
        .first_slice = key->slab.first,
        .slice_count = key->slab.count,
        .between = key->between,
        .isa = params->settings->isa,
        .threads = params->settings->threads,
    };
    return SNOW_STATUS_OK;
}

static snow_status encode_bands(snow_shear_warp *s,
                                const snow_shear_warp_params *params,
                                const snow_encoded_key *key) {
    snow_band_tools tools;
    snow_bands_params bands;
    if (params->volume->stream)
        return snow_shear_warp_encode_stream(s, params, key);
    SNOW_TRY(snow_shear_warp_bands_params(s, params, key, params->volume,
                                          &params->clip, &tools, &bands));
    return snow_bands_encode(&s->bands, &bands);
}

/* Takes all that the bands depend on of a gradient opacity into the key; *same
 * is whether it was the same.  Where a threshold has to be passed by the
 * product with the opacity, that is the opacity function too. */
static snow_status
take_gradient_opacity_key(snow_shear_warp *s,
                          const snow_shear_warp_params *params, bool *same) {
    const snow_transfer *t = params->transfer;
    size_t curve = t->gradient_count, bytes = sizeof *s->gradient_opacity_key;
    size_t count = curve;
    if (params->settings->threshold > 0)
        count += t->opacity_count + 1;
    *same = true;
    if (!curve)
        return SNOW_STATUS_OK;
    /* Both at once, so that a second picture takes no memory. */
    SNOW_TRY(snow_reserve(s->context, &s->gradient_opacity_key,
                          &s->gradient_opacity_key_capacity,
                          s->gradient_opacity_points * bytes, count * bytes));
    SNOW_TRY(snow_reserve(s->context, &s->next_gradient_opacity_key,
                          &s->next_gradient_opacity_key_capacity, 0,
                          count * bytes));
    snow_opacity_point *key = s->next_gradient_opacity_key;
    memcpy(key, t->gradients, curve * bytes);
    if (count > curve) {
        memcpy(key + curve, t->opacities, t->opacity_count * bytes);
        key[count - 1] = (snow_opacity_point){t->log, 0};
    }
    *same = count == s->gradient_opacity_points &&
            memcmp(key, s->gradient_opacity_key, count * bytes) == 0;
    size_t capacity = s->next_gradient_opacity_key_capacity;
    s->next_gradient_opacity_key_capacity = s->gradient_opacity_key_capacity;
    s->next_gradient_opacity_key = s->gradient_opacity_key;
    s->gradient_opacity_key_capacity = capacity;
    s->gradient_opacity_key = key;
    s->gradient_opacity_points = count;
    return SNOW_STATUS_OK;
}

/* What an encoding costs, in pictures, about: with normals, without, and of a
 * file that is read for it. */
#define SHADED_PRICE 3
#define PLAIN_PRICE 0.5
#define STREAM_PRICE 20

/* Whether bands of the same key are good for the next coder. */
static snow_status ask_bands(snow_shear_warp *s, const snow_encoded_key *key,
                             bool streams, bool *serve) {
    double price = key->shaded ? SHADED_PRICE : PLAIN_PRICE;
    if (!key->with_gradient_opacity && snow_encoding_cache_knows(&s->next))
        return snow_encoding_cache_ask(s->context, &s->encoding_cache,
                                       &s->bands, key->between, &s->next,
                                       streams ? STREAM_PRICE : price, serve);
    *serve = snow_quantizer_same(&s->next, &s->quantizer);
    return SNOW_STATUS_OK;
}

static snow_status encode(snow_shear_warp *s,
                          const snow_shear_warp_params *params,
                          snow_stats *stats) {
    const snow_settings *settings = params->settings;
    snow_encoded_key key = {
        .generation = params->volume->generation,
        .slice_axis = params->placement->slice_axis,
        .shaded = settings->shade == SNOW_SHADE_PHONG,
        .between = settings->quality == SNOW_QUALITY_HIGH,
        .with_gradient_opacity =
            snow_transfer_has_gradient_opacity(params->transfer),
        .numbers =
            settings->mode != SNOW_MODE_OVER && settings->mode != SNOW_MODE_ISO,
        .threshold = snow_transfer_has_gradient_opacity(params->transfer)
                         ? settings->threshold
                         : 0,
        .encoding = settings->encoding,
    };
    bool same_fade;
    key.slab = encoded_slab(params, key.between);
    SNOW_TRY(snow_quantizer_make(s->context, params->volume, params->transfer,
                                 settings->threshold, &s->next));
    SNOW_TRY(take_gradient_opacity_key(s, params, &same_fade));
    bool kept = same_key(&key, &s->key) && same_fade;
    if (kept)
        SNOW_TRY(ask_bands(s, &key, params->volume->stream != NULL, &kept));
    snow_quantizer quantizer = s->quantizer;
    s->quantizer = s->next;
    s->next = quantizer;
    if (!quantizer
             .native_runs) /* the first time: so that the second takes none */
        SNOW_TRY(snow_quantizer_make(s->context, params->volume,
                                     params->transfer, settings->threshold,
                                     &s->next));
    if (kept)
        return SNOW_STATUS_OK;
    s->key.generation = 0; /* should the encoding fail half-way */
    SNOW_TRY(encode_bands(s, params, &key));
    SNOW_TRY(snow_encoding_cache_begin(s->context, &s->encoding_cache,
                                       &s->bands, key.between, &s->quantizer));
    s->key = key;
    s->encodings++;
    stats->encoded = 1;
    return SNOW_STATUS_OK;
}

/* What reading a file took is not encoding. */
snow_status snow_shear_warp_encode(snow_shear_warp *s,
                                   const snow_shear_warp_params *params,
                                   snow_stats *stats) {
    double mark = snow_seconds();
    double reading = snow_volume_read_seconds(params->volume);
    SNOW_TRY(encode(s, params, stats));
    reading = snow_volume_read_seconds(params->volume) - reading;
    stats->seconds_encode += snow_seconds() - mark - reading;
    return SNOW_STATUS_OK;
}

/* --- one band of lines ---------------------------------------------------- */

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

static int between_ends(int64_t at, int end) {
    if (at < 0)
        return 0;
    return at < end ? (int)at : end;
}

/* A tile that the border of a part may cross. */
static uint64_t draw_cut_tile(const shear_warp_band_task *stroke,
                              const slice_rows *slice, int64_t index,
                              const snow_tile *tile) {
    const snow_band_shape *shape = &stroke->shape;
    int64_t left = index * shape->width;
    int64_t top = stroke->first_cell * tile->lattice_v->phases;
    const snow_cut_tile cut = {
        .pixels = tile->pixels,
        .stride = shape->stride,
        .width = shape->width,
        .lines = tile->lattice_v->phases,
        .channels = shape->channels,
        .x0 = between_ends(slice->u_range[0] - left, shape->width),
        .x1 = between_ends(slice->u_range[1] - left, shape->width),
        .y0 = between_ends(slice->v_range[0] - top, shape->lines),
        .y1 = between_ends(slice->v_range[1] - top, shape->lines),
        .kept = stroke->scratch.kept,
    };
    if (cut.x0 == 0 && cut.x1 == shape->width && cut.y0 == 0 &&
        cut.y1 == shape->lines)
        return stroke->pass->tile(tile);
    snow_cut_keep(&cut, tile->wanted);
    return snow_cut_restore(&cut, tile->wanted, stroke->pass->tile(tile));
}

/* Lines 08 to 13 for one tile of a slice: the cells that can be seen and have a
 * voxel in reach. */
static void draw_tile(shear_warp_band_task *stroke, const slice_rows *slice,
                      int64_t index) {
    const shear_warp_pass *pass = stroke->pass;
    const snow_scratch *scratch = &stroke->scratch;
    const snow_lattice *u = &pass->shear.u, *v = &pass->shear.v;
    int64_t column = slice->column + index * SNOW_TILE_COLUMNS * u->stride;
    if (!snow_decode_any(&slice->rows, column, pass->window))
        return;
    uint64_t bits[SNOW_DECODE_ROWS], held;
    uint32_t before[SNOW_DECODE_ROWS];
    uint64_t unsaturated = scratch->unsaturated[index] & slice->cells;
    held = pass->windows->windows(
        &slice->rows, snow_rows_of_cells(unsaturated, v->stride, slice->reach),
        column, pass->window, bits, before);
    uint64_t cells =
        cells_of_rows(held, stroke->cells, v->stride, slice->reach) &
        unsaturated;
    if (!cells)
        return;
    held &= snow_rows_of_cells(cells, v->stride, slice->reach);
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
                           floats,
                           slice->rows.gradient_factors,
                           pass->exponent};
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
    if (pass->lazy && !stroke->drawn[index])
        snow_band_clear_tile(
            &stroke->shape, &(snow_band){stroke->pixels, stroke->drawn}, index);
    uint64_t finished = pass->params->clip.cuts
                            ? draw_cut_tile(stroke, slice, index, &tile)
                            : pass->tile(&tile);
    scratch->unsaturated[index] &= ~finished;
    stroke->drawn[index] = 1;
}

/* The part's pixels on a slice, and the cells of the band that hold some.
 * Pixels beyond the plane, which tiles have, count as its last. */
static void cut_slice(const shear_warp_band_task *stroke, int64_t number,
                      slice_rows *slice) {
    const shear_warp_pass *pass = stroke->pass;
    const snow_clip *clip = &pass->params->clip;
    const snow_lattice *u = &pass->shear.u, *v = &pass->shear.v;
    double place = pass->first_slice + pass->slice_step * (double)number;
    snow_clip_lattice(clip, 0, u, place, slice->u_range);
    snow_clip_lattice(clip, 1, v, place, slice->v_range);
    if (slice->u_range[1] == u->count)
        slice->u_range[1] = (int)pass->tiles * stroke->shape.width;
    if (slice->v_range[1] == v->count)
        slice->v_range[1] += v->phases;
    int64_t first = slice->v_range[0] / v->phases - stroke->first_cell;
    int64_t end = (slice->v_range[1] + v->phases - 1) / v->phases;
    int from = between_ends(first, stroke->cells);
    int to = between_ends(end - stroke->first_cell, stroke->cells);
    slice->cells = 0;
    if (from < to && slice->u_range[0] < slice->u_range[1] &&
        slice->v_range[0] < slice->v_range[1])
        slice->cells = ~UINT64_C(0) >> (64 - (to - from)) << from;
}

/* Tiles that the part's pixels on a slice reach. */
static void cut_tiles(const shear_warp_band_task *stroke, slice_rows *slice) {
    int width = stroke->shape.width;
    int64_t low = slice->u_range[0] / width;
    int64_t high = (slice->u_range[1] + width - 1) / width;
    slice->low = slice->low > low ? slice->low : low;
    slice->high = slice->high < high ? slice->high : high;
}

/* Reads the band's rows of a slice as masks, and marks the tiles that they
 * reach: those whose window overlaps the columns. */
static void read_slice(shear_warp_band_task *stroke, int64_t number,
                       slice_rows *slice) {
    const shear_warp_pass *pass = stroke->pass;
    const snow_clip *clip = &pass->params->clip;
    const snow_lattice *u = &pass->shear.u, *v = &pass->shear.v;
    slice->u = &pass->combs[2 * number];
    slice->v = &pass->combs[2 * number + 1];
    slice->reach = slice->v->lead[1] + pass->taps[1];
    slice->cells = ~UINT64_C(0);
    slice->low = slice->high = 0;
    if (clip->cuts)
        cut_slice(stroke, number, slice);
    if (!slice->cells)
        return;
    int64_t first = (v->first / v->phases + stroke->first_cell) * v->stride +
                    slice->v->offset - clip->stored[1];
    slice->rows.fetch = stroke->fetch;
    pass->windows->read(
        &pass->shear_warp->bands, number, first,
        snow_rows_of_cells(stroke->unsaturated, v->stride, slice->reach),
        stroke->scratch.spans, &slice->rows);
    int64_t step = SNOW_TILE_COLUMNS * u->stride;
    slice->column =
        u->first / u->phases * u->stride + slice->u->offset - clip->stored[0];
    int64_t low = -slice->column - pass->window + 1;
    int64_t high = pass->columns - slice->column;
    slice->low = low > 0 ? (low + step - 1) / step : 0;
    slice->high = high > 0 ? (high + step - 1) / step : 0;
    if (clip->cuts)
        cut_tiles(stroke, slice);
    if (!slice->rows.held)
        slice->high = 0;
}

/* Some slices of the band, the nearest first, tile by tile: a tile's pixels
 * stay in the first-level cache while all of them pass over it. */
static void draw_slices(shear_warp_band_task *stroke, int64_t first,
                        int count) {
    const shear_warp_pass *pass = stroke->pass;
    slice_rows *slices = stroke->scratch.slices;
    for (int n = 0; n < count; n++)
        read_slice(stroke,
                   pass->nearest_first
                       ? stroke->first + first + n
                       : stroke->first + stroke->count - 1 - first - n,
                   &slices[n]);
    for (int64_t tile = 0; tile < pass->tiles; tile++)
        for (int n = 0; n < count && stroke->scratch.unsaturated[tile]; n++)
            if (slices[n].low <= tile && tile < slices[n].high)
                draw_tile(stroke, &slices[n], tile);
}

/* The parts of a worker's memory, each aligned to 64 bytes; returns the bytes
 * that they take.  With a NULL base nothing but the sum counts. */
static size_t lay_out(const shear_warp_pass *pass, char *base,
                      snow_scratch *out) {
    size_t at = 0, pixel = (size_t)pass->channels * sizeof(float);
    snow_mask_rows unused;
    size_t filtered = 2 * SNOW_TILE_COLUMNS * pixel;
#define PART(field, bytes) (out->field = snow_lay_out(base, &at, bytes))
    PART(slices, SLICES_AT_ONCE * sizeof *out->slices);
    for (int n = 0; n < SLICES_AT_ONCE; n++)
        snow_mask_rows_lay_out(base ? &out->slices[n].rows : &unused,
                               pass->columns, base, &at);
    PART(samples,
         (SNOW_DECODE_ROWS * pass->window_floats + 64) * sizeof(float));
    PART(room, sizeof *out->room);
    PART(ring, SNOW_DECODE_ROWS * filtered);
    PART(zero, filtered);
    PART(unsaturated, (size_t)pass->tiles * sizeof *out->unsaturated);
    PART(spans, ((size_t)pass->columns / 2 + 1) * sizeof *out->spans);
    if (pass->params->clip.cuts)
        PART(kept, (size_t)pass->cells * 2 * filtered);
    snow_grouping_lay_out(&pass->grouping,
                          (size_t)(pass->cells * pass->shear.v.phases) *
                              pass->stride,
                          pass->tiles, base, &at, out->spare);
#undef PART
    return at;
}

/* Counts the pixels that are not opaque yet; their share of those drawn on
 * predicts how much of the slices to come will be used. */
static void look_through(shear_warp_band_task *stroke) {
    int64_t open = 0;
    stroke->unsaturated = 0;
    for (int64_t tile = 0; tile < stroke->pass->tiles; tile++) {
        uint64_t unsaturated = stroke->scratch.unsaturated[tile];
        stroke->unsaturated |= unsaturated;
        if (stroke->drawn[tile])
            open += 2 * __builtin_popcountll(unsaturated) - stroke->cells;
    }
    stroke->fetch = open >= 0;
}

/* Line 07 for one band of lines: slices from front to back. */
static void draw_slab(void *of, int64_t first, int64_t count,
                      const snow_band *band) {
    shear_warp_band_task *stroke = of;
    uint64_t *unsaturated = stroke->scratch.unsaturated;
    int64_t tiles = stroke->pass->tiles;
    stroke->pixels = band->pixels;
    stroke->drawn = band->drawn;
    stroke->first = first;
    stroke->count = count;
    for (int64_t tile = 0; tile < tiles; tile++)
        unsaturated[tile] = ~UINT64_C(0) >> (64 - stroke->cells);
    for (int64_t n = 0; n < count; n += SLICES_AT_ONCE) {
        look_through(stroke);
        if (!stroke->unsaturated ||
            snow_monitor_look(stroke->pass->shear_warp->monitor,
                              stroke->worker))
            break;
        draw_slices(stroke, n,
                    count - n < SLICES_AT_ONCE ? (int)(count - n)
                                               : SLICES_AT_ONCE);
    }
}

static void splat_band(void *job, int64_t item, int worker) {
    const shear_warp_pass *pass = job;
    const snow_lattice *v = &pass->shear.v;
    shear_warp_band_task stroke = {.pass = pass, .worker = worker};
    lay_out(pass,
            pass->shear_warp->scratch + (size_t)worker * pass->scratch_bytes,
            &stroke.scratch);
    memset(stroke.scratch.zero, 0,
           2 * SNOW_TILE_COLUMNS * (size_t)pass->channels * sizeof(float));
    stroke.first_cell = item * pass->cells;
    int64_t cells = (v->count + v->phases - 1) / v->phases - stroke.first_cell;
    stroke.cells = cells < pass->cells ? (int)cells : pass->cells;
    stroke.shape = (snow_band_shape){
        pass->tiles, SNOW_TILE_COLUMNS * pass->shear.u.phases,
        stroke.cells * v->phases, pass->channels, pass->stride};
    const snow_band band = {pass->image.pixels +
                                (size_t)(stroke.first_cell * v->phases) *
                                    pass->stride,
                            pass->image.drawn + item * pass->tiles};
    snow_band_draw(&pass->grouping, &pass->image, pass->lazy, &stroke.shape,
                   draw_slab, &stroke, stroke.scratch.spare, &band);
}

/* --- setting up ----------------------------------------------------------- */

/* Pixels a voxel, or voxels a pixel, along one axis.  A kernel that is widened
 * needs fewer of them: Engine and CThead, warped from a pixel a voxel, are 52
 * dB and more from the exact picture at their own width, 57 dB and more from a
 * widening of 1.22 on. */
static void choose_pitch(const snow_scaled_kernel *scaled_kernel, bool draft,
                         int *phases, int *stride) {
    *phases = !draft && scaled_kernel->wide < 1.2 ? 2 : 1;
    *stride = scaled_kernel->wide >= (draft ? 2 : 2.5) ? 2 : 1;
}

static snow_status place_lattice(shear_warp_pass *pass) {
    const snow_placement *p = pass->params->placement;
    const snow_settings *settings = pass->params->settings;
    bool draft = settings->quality == SNOW_QUALITY_DRAFT;
    snow_shear_options options;
    for (int axis = 0; axis < 2; axis++) {
        snow_scaled_kernel *scaled_kernel = &pass->scaled_kernel[axis];
        *scaled_kernel = scaled_kernel_along(p, settings, axis);
        pass->taps[axis] = snow_comb_taps(scaled_kernel);
        choose_pitch(scaled_kernel, draft, &options.phases[axis],
                     &options.stride[axis]);
        options.reach[axis] = snow_scaled_kernel_reach(scaled_kernel);
    }
    SNOW_TRY(
        snow_shear_make(pass->shear_warp->context, p, &options, &pass->shear));
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
    int rows = SNOW_DECODE_ROWS - pass->taps[1] - v->phases + 1;
    pass->cells = rows / v->stride + 1;
    if (pass->cells > SNOW_TILE_CELLS)
        pass->cells = SNOW_TILE_CELLS;
    int64_t cells = (v->count + v->phases - 1) / v->phases;
    pass->bands = (cells + pass->cells - 1) / pass->cells;
    pass->threads =
        settings->threads < pass->bands ? settings->threads : (int)pass->bands;
    return SNOW_STATUS_OK;
}

/* The kernels of all slices: their shifts differ. */
static snow_status place_slices(shear_warp_pass *pass) {
    snow_shear_warp *s = pass->shear_warp;
    size_t slices = (size_t)pass->slices;
    SNOW_TRY(snow_reserve(s->context, &s->combs, &s->combs_capacity, 0,
                          2 * slices * sizeof *s->combs));
    const snow_lattice *lattices[2] = {&pass->shear.u, &pass->shear.v};
    for (size_t n = 0; n < slices; n++)
        for (size_t axis = 0; axis < 2; axis++)
            snow_comb_make(&pass->scaled_kernel[axis], lattices[axis],
                           pass->first_slice + pass->slice_step * (double)n,
                           &s->combs[2 * n + axis]);
    pass->combs = s->combs;
    return SNOW_STATUS_OK;
}

static snow_status shade(snow_shear_warp *s,
                         const snow_shear_warp_params *params) {
    const snow_settings *settings = params->settings;
    if (settings->shade != SNOW_SHADE_PHONG)
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_reserve(s->context, &s->gloss, &s->gloss_capacity, 0,
                          (SNOW_NORMALS + 1) * sizeof *s->gloss));
    s->gloss[0] = 0;
    return snow_gloss_table(s->context, settings, params->placement,
                            settings->threads, s->gloss + 1);
}

static snow_status classify(snow_shear_warp *s,
                            const snow_shear_warp_params *params,
                            double exponent) {
    const snow_settings *settings = params->settings;
    bool shaded = settings->shade == SNOW_SHADE_PHONG;
    if (s->key.with_gradient_opacity) /* opacities wait for the factors */
        return snow_palette_make(s->context, &s->quantizer, params->transfer, 1,
                                 false, settings->threads, &s->palette);
    if (exponent < 0)
        return snow_palette_make_clear(s->context, &s->quantizer,
                                       params->transfer, settings->threads,
                                       &s->palette);
    return snow_palette_make(s->context, &s->quantizer, params->transfer,
                             exponent, !shaded, settings->threads, &s->palette);
}

snow_status
snow_shear_warp_classify_and_shade(snow_shear_warp *s,
                                   const snow_shear_warp_params *params,
                                   double exponent, snow_stats *stats) {
    double mark = snow_seconds();
    SNOW_TRY(classify(s, params, exponent));
    snow_lap(&mark, &stats->seconds_classify);
    SNOW_TRY(shade(s, params));
    snow_lap(&mark, &stats->seconds_shade);
    return SNOW_STATUS_OK;
}

/* Lines 02 and 03: tables for this look, light and view. */
static snow_status classify_and_shade(shear_warp_pass *pass,
                                      snow_stats *stats) {
    snow_shear_warp *s = pass->shear_warp;
    const snow_settings *settings = pass->params->settings;
    bool shaded = settings->shade == SNOW_SHADE_PHONG;
    double path = pass->params->placement->path / (s->key.between ? 2 : 1);
    double exponent = path / settings->opacity_length;
    SNOW_TRY(
        snow_shear_warp_classify_and_shade(s, pass->params, exponent, stats));
    pass->exponent = (float)fmin(exponent, 1e30);
    pass->palette = s->palette.samples;
    pass->gloss = shaded ? s->gloss + 1 : NULL;
    pass->channels = pass->params->channels;
    pass->sample =
        snow_sample_of(settings->isa, s->quantizer.bytes, pass->channels,
                       shaded, s->key.with_gradient_opacity);
    pass->code_bytes = (size_t)s->quantizer.bytes;
    pass->tile = snow_tile_of(settings->isa, pass->channels);
    pass->windows = snow_decode_fns_of(settings->isa);
    return SNOW_STATUS_OK;
}

snow_status snow_shear_warp_make_room(snow_shear_warp *s, size_t scratch_bytes,
                                      const snow_grouping *grouping,
                                      int64_t bands,
                                      snow_shear_warp_image *image) {
    uint64_t floats, bytes;
    snow_intermediate *intermediate = s->intermediate;
    /* One without a node has room for lines that others made. */
    size_t layers = grouping->node_count > 1 ? (size_t)grouping->node_count : 1;
    image->layers = grouping->node_count;
    memcpy(image->nodes, grouping->nodes, sizeof image->nodes);
    image->layer_tiles = (size_t)(bands * image->tiles);
    image->layer_floats = ((size_t)image->height + 1) * image->stride;
    if (!snow_mul_u64(image->layer_floats, layers, &floats) ||
        !snow_mul_u64(floats, sizeof *intermediate->plane, &bytes) ||
        bytes > SIZE_MAX)
        return snow_fail(s->context, SNOW_STATUS_NO_MEMORY,
                         "no memory for %zu intermediate images", layers);
    SNOW_TRY(snow_reserve(s->context, &s->scratch, &s->scratch_capacity, 0,
                          scratch_bytes));
    SNOW_TRY(snow_reserve(s->context, &intermediate->drawn,
                          &intermediate->drawn_capacity, 0,
                          image->layer_tiles * layers));
    SNOW_TRY(snow_reserve(s->context, &intermediate->plane,
                          &intermediate->plane_capacity, 0, (size_t)bytes));
    if (s->context->monitor) /* bands may never be drawn */
        memset(intermediate->drawn, 0, image->layer_tiles * layers);
    image->pixels = intermediate->plane;
    image->drawn = intermediate->drawn;
    return SNOW_STATUS_OK;
}

static snow_status reserve_buffers(shear_warp_pass *pass) {
    const snow_lattice *u = &pass->shear.u, *v = &pass->shear.v;
    snow_scratch unused;
    pass->scratch_bytes = lay_out(pass, NULL, &unused);
    pass->image =
        (snow_shear_warp_image){.width = u->count,
                                .height = v->count,
                                .channels = pass->channels,
                                .stride = pass->stride,
                                .tile_width = SNOW_TILE_COLUMNS * u->phases,
                                .tile_height = pass->cells * v->phases,
                                .tiles = (int)pass->tiles};
    return snow_shear_warp_make_room(
        pass->shear_warp, pass->scratch_bytes * (size_t)pass->threads,
        &pass->grouping, pass->bands, &pass->image);
}

/* The bytes of several axes, where a picture is blended, add up. */
void snow_shear_warp_fill_figures(const snow_shear_warp *s, snow_stats *stats) {
    stats->encoding = s->bands.encoding;
    stats->interesting = s->encoding_cache.shown;
    stats->ea_bytes += s->bands.ea_bytes;
    stats->ia_bytes += s->bands.ia_bytes;
    stats->pa_bytes += s->bands.pa_bytes;
}

/* --- the warp ------------------------------------------------------------- */

snow_shear_warp_warping *
snow_shear_warp_warping_of(snow_shear_warp *s,
                           const snow_shear_warp_params *params, int channels) {
    const snow_settings *settings = params->settings;
    snow_shear_warp_warping *w = &s->intermediate->warping;
    snow_filter filter = settings->quality == SNOW_QUALITY_DRAFT
                             ? SNOW_BILINEAR
                             : SNOW_CATMULL_ROM;
    *w = (snow_shear_warp_warping){
        .filter = filter,
        .warp = snow_warp_of(settings->isa, filter, channels),
        .places = snow_warp_places_of(settings->isa, filter, channels),
        .width = params->view->width,
        .height = params->view->height,
        .before = SNOW_WARP_BEFORE,
        .behind = SNOW_WARP_BEHIND};
    return w;
}

void snow_shear_warp_attach(snow_shear_warp *s, snow_shear_warp_image *image) {
    s->intermediate->warping.plane = (snow_intermediate_view){
        image->pixels,     image->stride,      image->width,
        image->height,     image->channels,    image->drawn,
        image->tile_width, image->tile_height, image->tiles};
    image->warping = &s->intermediate->warping;
}

/* --- a picture ------------------------------------------------------------ */

snow_status snow_shear_warp_begin_bands(snow_shear_warp *s,
                                        const snow_shear_warp_params *params,
                                        int64_t bands, snow_work_fn *draw) {
    const snow_line_batch_params order = {.lines = bands,
                                          .width = 1,
                                          .begin_at = params->begin_at,
                                          .threads = params->settings->threads,
                                          .draw = draw,
                                          .job = s->pass};
    s->monitor = s->context->monitor;
    snow_monitor_next(s->monitor, SNOW_STAGE_RENDER, 0, 0.9);
    return snow_line_batch_begin(s->context, &s->batch, &order);
}

snow_line_batch *snow_shear_warp_batch(snow_shear_warp *s) {
    return &s->batch;
}

/* Whether the image is empty; the same for all parts. */
static bool nothing_in_view(const shear_warp_pass *pass) {
    return pass->shear.u.count == 0 || pass->shear.v.count == 0;
}

static snow_status place_pass(shear_warp_pass *pass) {
    const snow_shear_warp_params *params = pass->params;
    bool between = params->settings->quality == SNOW_QUALITY_HIGH;
    pass->slices = snow_shear_warp_slices(params);
    pass->columns = pass->shear_warp->bands.columns;
    pass->nearest_first = params->placement->nearest_first;
    pass->first_slice = (double)params->slab.first;
    pass->slice_step = between ? 0.5 : 1;
    SNOW_TRY(snow_grouping_make(
        pass->shear_warp->context, params->placement->slices, params->slab,
        between ? 2 : 1, pass->slices, pass->nearest_first,
        params->settings->deterministic != 0, &pass->grouping));
    pass->lazy = pass->grouping.on || params->volume->is_part;
    return place_lattice(pass);
}

/* Lines 07 to 13 of a parallel view. */
static snow_status begin_shear_warp(snow_shear_warp *s,
                                    const snow_shear_warp_params *params,
                                    snow_stats *stats,
                                    snow_shear_warp_image *out) {
    SNOW_TRY(snow_reserve(s->context, &s->pass, &s->pass_capacity, 0,
                          sizeof(shear_warp_pass)));
    shear_warp_pass *pass = s->pass;
    *pass = (shear_warp_pass){.params = params, .shear_warp = s};
    SNOW_TRY(classify_and_shade(pass, stats));
    SNOW_TRY(place_pass(pass));
    snow_shear_warp_warping_of(s, params, pass->channels)->shear = pass->shear;
    if (nothing_in_view(pass)) {
        *out = (snow_shear_warp_image){.channels = params->channels};
        return SNOW_STATUS_OK;
    }
    double mark = snow_seconds();
    SNOW_TRY(place_slices(pass));
    SNOW_TRY(reserve_buffers(pass));
    SNOW_TRY(snow_shear_warp_begin_bands(s, params, pass->bands, splat_band));
    *out = pass->image;
    stats->seconds_splat += snow_seconds() - mark;
    return SNOW_STATUS_OK;
}

snow_status snow_shear_warp_begin(snow_shear_warp *s,
                                  const snow_shear_warp_params *params,
                                  bool aside, snow_stats *stats,
                                  snow_shear_warp_image *out) {
    snow_shear_warp_image image;
    if (aside)
        s->intermediate =
            &s->intermediates[s->intermediate == s->intermediates];
    SNOW_TRY(params->placement->perspective
                 ? snow_shear_warp_perspective_begin(s, params, stats, &image)
                 : begin_shear_warp(s, params, stats, &image));
    snow_shear_warp_fill_figures(s, stats);
    snow_shear_warp_attach(s, &image);
    *out = image;
    return SNOW_STATUS_OK;
}

snow_status snow_shear_warp_show(const snow_shear_warp_image *image,
                                 const snow_shear_warp_params *params,
                                 float *pixels, snow_stats *stats) {
    const snow_view *view = params->view;
    double mark = snow_seconds();
    if (image->width == 0) {
        memset(pixels, 0,
               (size_t)view->width * (size_t)view->height *
                   (size_t)params->channels * sizeof *pixels);
        return SNOW_STATUS_OK;
    }
    if (params->volume->is_part || params->settings->deterministic)
        snow_shear_warp_clear(image, 0, 0, 0, image->tiles,
                              (int)(image->layer_tiles / (size_t)image->tiles));
    SNOW_TRY(snow_shear_warp_warp_all(params->volume->context, image,
                                      params->settings->threads, pixels));
    stats->seconds_warp += snow_seconds() - mark;
    return SNOW_STATUS_OK;
}
