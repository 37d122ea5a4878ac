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
#include "classify/sample.h"
#include "composite/down.h"
#include "encode/bands.h"
#include "image/image.h"
#include "splat/across.h"
#include "volume/volume.h"
#include "warp/warp.h"

#include <math.h>
#include <string.h>

/* A band's part of the intermediate image stays in the second-level cache while
 * all slices pass over it. */
#define BAND_BYTES (512 * 1024)
#define BAND_LINES_LEAST 8
#define BAND_LINES_MOST 64

/* Lines of the picture that are warped as one item of work. */
#define WARP_LINES 16

/* What the bands in memory were encoded from. */
typedef struct encoded_key {
    uint64_t serial; /* of the volume; 0: nothing is encoded */
    int slice_axis;
    bool shaded, between;
    snow_encoding encoding; /* as asked for */
    snow_slab slab;
} encoded_key;

struct snow_sheared {
    snow_context *context;
    snow_coder coder; /* of the bands */
    snow_bands bands;
    encoded_key key;
    snow_palette palette;
    snow_gloss *gloss; /* SNOW_NORMALS entries */
    float *weights;    /* of all slices, along u and v */
    snow_across *places;
    float *plane;     /* the intermediate image */
    char *scratch;    /* of all workers */
    size_t gloss_capacity, weights_capacity, places_capacity, plane_capacity,
        scratch_capacity; /* bytes */
};

/* One picture in the making. */
typedef struct snow_pass {
    const snow_sheared_order *order;
    snow_sheared *sheared;
    snow_shear shear;
    snow_taper taper[2];        /* along u and v */
    const snow_across *places;  /* [2 * slice + axis] */
    int64_t slices;             /* of the bands */
    bool nearest_first;
    int channels;
    const float *palette;
    const snow_gloss *gloss; /* NULL: unshaded */
    snow_sample_fn *sample;
    snow_across_fn *across;
    snow_down_fn *down;
    snow_warp_fn *warp;
    snow_filter filter;
    size_t ring;     /* rows that the ring has room for: a power of 2 */
    size_t words;    /* of a chunk mask */
    int band_lines;
    size_t stride;   /* floats of a line of the plane */
    int64_t pad;     /* voxels before and after a row of samples */
    size_t scratch_bytes;
    float *pixels;
} snow_pass;

/* A worker's own memory, laid out in snow_sheared.scratch. */
typedef struct snow_scratch {
    float *row;        /* voxel 0 of the samples of one row */
    float *ring;       /* taps filtered rows */
    const float **rows; /* pointers into the ring, in the order of the taps */
    uint64_t *dirty;   /* per row of the ring: chunks that are not zero */
    uint64_t *held;    /* per row of the ring: chunks of the row it holds */
    uint64_t *alive;   /* per line of the band */
    uint64_t *wanted, *mask;
    snow_span *spans;
} snow_scratch;

/* A band on its way through one slice. */
typedef struct snow_stroke {
    const snow_pass *pass;
    snow_scratch scratch;
    int first_line, lines;
    bool some_dead; /* chunks of the band */
    int64_t slice;  /* of the bands */
    const snow_across *u, *v;
    snow_walk walk;
    const snow_sparse *band; /* of rows, where the walk is */
    int64_t next_row;
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
    snow_palette_fini(s->context, &s->palette);
    snow_release(s->context, s->gloss);
    snow_release(s->context, s->weights);
    snow_release(s->context, s->places);
    snow_release(s->context, s->plane);
    snow_release(s->context, s->scratch);
    snow_release(s->context, s);
}

/* How many voxels a pixel of the picture is wide along u or v. */
static double pixel_width(const snow_placement *p, int axis) {
    return hypot(p->inverse[axis][0], p->inverse[axis][1]);
}

bool snow_sheared_fits(const snow_placement *p) {
    return pixel_width(p, 0) <= SNOW_SHEARED_WIDEST &&
           pixel_width(p, 1) <= SNOW_SHEARED_WIDEST;
}

/* --- encoding -------------------------------------------------------------- */

static bool same_key(const encoded_key *a, const encoded_key *b) {
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

/* Lines 04 to 06, unless the bands hold just that already: colours, light and
 * the camera may change as they like as long as the slice axis stays. */
static snow_status encode(snow_sheared *s, const snow_sheared_order *order,
                          snow_stats *stats) {
    const snow_settings *settings = order->settings;
    encoded_key key = {
        .serial = order->volume->serial,
        .slice_axis = order->placement->slice_axis,
        .shaded = settings->shade == SNOW_SHADE_PHONG,
        .between = settings->quality == SNOW_QUALITY_HIGH,
        .encoding = settings->encoding,
        .slab = order->slab,
    };
    snow_coder coder;
    SNOW_TRY(snow_coder_init(s->context, order->volume, order->transfer,
                             settings->threshold, &coder));
    bool kept = same_key(&key, &s->key) && snow_coder_same(&coder, &s->coder);
    snow_coder_fini(s->context, &s->coder);
    s->coder = coder;
    if (kept)
        return SNOW_OK;
    s->key.serial = 0; /* should the encoding fail half-way */
    SNOW_TRY(encode_bands(s, order, key.between));
    s->key = key;
    stats->encoded = 1;
    return SNOW_OK;
}

/* --- one band of lines ----------------------------------------------------- */

/* Sets the bits of the chunks low .. high of a mask. */
static void mark_chunks(uint64_t *mask, int64_t low, int64_t high) {
    for (int64_t word = low / 64; word <= high / 64; word++) {
        int64_t from = word * 64 < low ? low % 64 : 0;
        int64_t to = word * 64 + 63 > high ? high % 64 : 63;
        mask[word] |= (~UINT64_C(0) >> (63 - (to - from))) << from;
    }
}

/* The chunks that the spans of a row reach. */
static void chunks_of_spans(const snow_stroke *stroke, const snow_span *spans,
                            size_t count, uint64_t *mask) {
    int64_t width = stroke->pass->shear.u.count;
    memset(mask, 0, stroke->pass->words * sizeof *mask);
    for (size_t i = 0; i < count; i++) {
        int64_t low, high;
        int64_t last = (int64_t)spans[i].column + spans[i].length - 1;
        snow_across_reach(stroke->u, spans[i].column, last, &low, &high);
        if (high < 0 || low >= width)
            continue;
        mark_chunks(mask, (low < 0 ? 0 : low) / SNOW_CHUNK,
                    (high >= width ? width - 1 : high) / SNOW_CHUNK);
    }
}

/* The first row of voxels that a line sums. */
static int64_t first_row_of(const snow_stroke *stroke, int line) {
    const snow_across *v = stroke->v;
    int64_t pixel = v->first + stroke->first_line + line;
    if (v->phases == 2)
        return (pixel >> 1) + v->offset[pixel & 1];
    return pixel * v->stride + v->offset[0];
}

/* Leaves of a mask the chunks that are alive in a line that the row is for:
 * `line` and those after it.  False when nothing is left. */
static bool keep_alive(const snow_stroke *stroke, int64_t row, int line,
                       uint64_t *mask) {
    size_t words = stroke->pass->words;
    uint64_t *wanted = stroke->scratch.wanted, any = 0;
    if (!stroke->some_dead)
        return true;
    memset(wanted, 0, words * sizeof *wanted);
    for (; line < stroke->lines && first_row_of(stroke, line) <= row; line++)
        for (size_t w = 0; w < words; w++)
            wanted[w] |= stroke->scratch.alive[(size_t)line * words + w];
    for (size_t w = 0; w < words; w++)
        any |= mask[w] &= wanted[w];
    return any != 0;
}

/* The next row's spans; the walk goes from band of rows to band of rows. */
static size_t walk_row(snow_stroke *stroke, int64_t row, size_t *voxel) {
    const snow_bands *bands = &stroke->pass->sheared->bands;
    if (!stroke->band || row % SNOW_BAND_ROWS == 0) {
        stroke->band = &bands->bands[row / SNOW_BAND_ROWS];
        snow_walk_begin(&stroke->walk, stroke->band, stroke->slice);
        if (row % SNOW_BAND_ROWS)
            snow_walk_skip(&stroke->walk, row % SNOW_BAND_ROWS);
    }
    return snow_walk_row(&stroke->walk, stroke->scratch.spans, voxel);
}

/* Classifies a row's voxels into the row of samples, or clears them again. */
static void sample_spans(const snow_stroke *stroke, size_t count,
                         size_t voxel) {
    const snow_pass *pass = stroke->pass;
    const snow_span *span = stroke->scratch.spans;
    for (; count; count--, span++) {
        pass->sample(snow_bands_codes(stroke->band, voxel),
                     pass->gloss ? snow_bands_normals(stroke->band, voxel)
                                 : NULL,
                     span->length, pass->palette, pass->gloss,
                     stroke->scratch.row +
                         (int64_t)span->column * pass->channels);
        voxel += span->length;
    }
}

static void clear_spans(const snow_stroke *stroke, size_t count) {
    size_t pixel = (size_t)stroke->pass->channels;
    const snow_span *span = stroke->scratch.spans;
    for (; count; count--, span++) {
        float *sample = stroke->scratch.row + span->column * pixel;
        for (size_t n = 0; n < span->length * pixel; n++)
            sample[n] = 0;
    }
}

/* Makes a row of the ring zero where it held something else. */
static void wipe_chunks(const snow_pass *pass, float *line, uint64_t *dirty,
                        const uint64_t *mask) {
    size_t floats = SNOW_CHUNK * (size_t)pass->channels;
    for (size_t w = 0; w < pass->words; w++) {
        for (uint64_t bits = dirty[w] & ~mask[w]; bits; bits &= bits - 1) {
            size_t chunk = w * 64 + (size_t)__builtin_ctzll(bits);
            memset(line + chunk * floats, 0, floats * sizeof *line);
        }
        dirty[w] = mask[w];
    }
}

/* Lines 08 to 12: one row of voxels, filtered along u, into the ring. */
static void load_row(snow_stroke *stroke, int64_t row, int line) {
    const snow_pass *pass = stroke->pass;
    const snow_scratch *scratch = &stroke->scratch;
    size_t slot = (size_t)row & (pass->ring - 1);
    uint64_t *held = scratch->held + slot * pass->words;
    float *filtered = scratch->ring + slot * pass->stride;
    size_t voxel = 0, count = 0;
    if (row < pass->order->placement->rows)
        count = walk_row(stroke, row, &voxel);
    chunks_of_spans(stroke, scratch->spans, count, held);
    bool seen = count && keep_alive(stroke, row, line, held);
    wipe_chunks(pass, filtered, scratch->dirty + slot * pass->words, held);
    if (!seen)
        return;
    sample_spans(stroke, count, voxel);
    pass->across(stroke->u, scratch->row, held, pass->words, filtered);
    clear_spans(stroke, count);
}

/* Line 13: one line of the slice's sheet, behind what the image holds. */
static void lay_line(snow_stroke *stroke, int line) {
    const snow_pass *pass = stroke->pass;
    const snow_scratch *scratch = &stroke->scratch;
    const snow_across *v = stroke->v;
    int64_t first = first_row_of(stroke, line);
    int64_t pixel = v->first + stroke->first_line + line;
    const float *weights =
        v->weights + (v->phases == 2 ? (pixel & 1) * v->taps : 0);
    uint64_t *alive = scratch->alive + (size_t)line * pass->words, any = 0;
    for (size_t w = 0; w < pass->words; w++)
        scratch->mask[w] = 0;
    for (int m = 0; m < v->taps; m++) {
        int64_t row = first + m;
        size_t slot = (size_t)row & (pass->ring - 1);
        scratch->rows[m] = scratch->ring + slot * pass->stride;
        for (size_t w = 0; w < pass->words; w++)
            scratch->mask[w] |= scratch->held[slot * pass->words + w];
    }
    for (size_t w = 0; w < pass->words; w++)
        any |= scratch->mask[w] &= alive[w];
    if (!any)
        return;
    float *pixels = pass->sheared->plane +
                    (size_t)(stroke->first_line + line) * pass->stride;
    if (pass->down(pixels, scratch->rows, weights, v->taps, scratch->mask,
                   pass->words, alive))
        stroke->some_dead = true;
}

/* Whether the bands of rows first .. last hold a voxel of the slice. */
static bool any_voxel(const snow_stroke *stroke, int64_t first, int64_t last) {
    const snow_bands *bands = &stroke->pass->sheared->bands;
    for (int64_t n = first / SNOW_BAND_ROWS; n <= last / SNOW_BAND_ROWS; n++) {
        const snow_slice_pointer *pa = bands->bands[n].pa + stroke->slice;
        if (pa[1].ia > pa[0].ia)
            return true;
    }
    return false;
}

/* Rows before the first one are never loaded, so the ring must be zero there.
 */
static void empty_ring(snow_stroke *stroke) {
    const snow_pass *pass = stroke->pass;
    const snow_scratch *scratch = &stroke->scratch;
    size_t taps = pass->ring;
    memset(scratch->held, 0, taps * pass->words * sizeof *scratch->held);
    for (size_t n = 0; n < taps; n++)
        wipe_chunks(pass, scratch->ring + n * pass->stride,
                    scratch->dirty + n * pass->words,
                    scratch->held + n * pass->words);
}

/* Rows come in order, each once; the ring holds as many as a line sums.  Rows
 * before the first and after the last voxel are empty. */
static void stroke_slice(snow_stroke *stroke) {
    const snow_pass *pass = stroke->pass;
    int64_t rows = pass->order->placement->rows;
    int64_t first = first_row_of(stroke, 0);
    int64_t last = first_row_of(stroke, stroke->lines - 1) + stroke->v->taps;
    if (first < 0)
        first = 0;
    if (last > rows)
        last = rows;
    if (first >= last || !any_voxel(stroke, first, last - 1))
        return;
    if (first_row_of(stroke, 0) < 0)
        empty_ring(stroke);
    stroke->band = NULL;
    stroke->next_row = first;
    for (int line = 0; line < stroke->lines; line++) {
        int64_t need = first_row_of(stroke, line) + stroke->v->taps;
        for (; stroke->next_row < need; stroke->next_row++)
            load_row(stroke, stroke->next_row, line);
        lay_line(stroke, line);
    }
}

static bool any_alive(const snow_stroke *stroke) {
    if (!stroke->some_dead)
        return true;
    size_t count = (size_t)stroke->lines * stroke->pass->words;
    for (size_t n = 0; n < count; n++)
        if (stroke->scratch.alive[n])
            return true;
    return false;
}

/* The parts of a worker's memory, each aligned to 64 bytes; returns the bytes
 * that they take.  With a NULL base nothing but the sum counts. */
static size_t lay_out(const snow_pass *pass, char *base, snow_scratch *out) {
    size_t at = 0, taps = pass->ring;
    int64_t columns = pass->order->placement->columns;
    size_t floats = sizeof(float), pixel = (size_t)pass->channels * floats;
    size_t mask = pass->words * sizeof(uint64_t);
#define PART(field, bytes)                      \
    do {                                        \
        out->field = (void *)(base + at);       \
        at += ((bytes) + 63) / 64 * 64;         \
    } while (0)
    PART(row, (size_t)(columns + 2 * pass->pad) * pixel);
    PART(ring, taps * pass->stride * floats);
    PART(rows, taps * sizeof *out->rows);
    PART(dirty, taps * mask);
    PART(held, taps * mask);
    PART(alive, (size_t)pass->band_lines * mask);
    PART(wanted, mask);
    PART(mask, mask);
    PART(spans, ((size_t)columns / 2 + 1) * sizeof *out->spans);
#undef PART
    out->row += pass->pad * pass->channels;
    return at;
}

/* Line 07 for one band of lines: all slices, front to back. */
static void splat_band(void *job, int64_t item, int worker) {
    const snow_pass *pass = job;
    snow_stroke stroke = {.pass = pass};
    lay_out(pass, pass->sheared->scratch + (size_t)worker * pass->scratch_bytes,
            &stroke.scratch);
    stroke.first_line = (int)item * pass->band_lines;
    stroke.lines = pass->shear.v.count - stroke.first_line;
    if (stroke.lines > pass->band_lines)
        stroke.lines = pass->band_lines;
    size_t mask = pass->words * sizeof(uint64_t);
    memset(pass->sheared->plane + (size_t)stroke.first_line * pass->stride, 0,
           (size_t)stroke.lines * pass->stride * sizeof(float));
    memset(stroke.scratch.alive, 0xFF, (size_t)stroke.lines * mask);
    for (int64_t n = 0; n < pass->slices && any_alive(&stroke); n++) {
        stroke.slice = pass->nearest_first ? n : pass->slices - 1 - n;
        stroke.u = &pass->places[2 * stroke.slice];
        stroke.v = &pass->places[2 * stroke.slice + 1];
        stroke_slice(&stroke);
    }
}

static void warp_lines(void *job, int64_t item, int worker) {
    const snow_pass *pass = job;
    (void)worker;
    const snow_view *view = pass->order->view;
    snow_plane plane = {pass->sheared->plane, pass->stride, pass->shear.u.count,
                        pass->shear.v.count, pass->channels};
    int first = (int)item * WARP_LINES, last = first + WARP_LINES;
    for (int y = first; y < last && y < view->height; y++)
        snow_warp_row(&plane, &pass->shear, pass->filter, pass->warp, y,
                      view->width,
                      pass->pixels + (size_t)y * (size_t)view->width *
                                         (size_t)pass->channels);
}

/* --- a picture ------------------------------------------------------------- */

/* Pixels a voxel, or voxels a pixel, along one axis: a pixel of the lattice is
 * to be at most two thirds of the (widened) kernel's unit, or one in a draft. */
static void choose_pitch(const snow_taper *taper, bool draft, int *phases,
                         int *stride) {
    double pitch = taper->wide / (draft ? 1 : 1.5);
    *phases = pitch < 1 ? 2 : 1;
    *stride = pitch < 2 ? 1 : (int)pitch;
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
        choose_pitch(taper, draft, &options.phases[axis],
                     &options.stride[axis]);
        options.reach[axis] = snow_taper_reach(taper);
    }
    SNOW_TRY(snow_shear_make(pass->sheared->context, p, &options,
                             &pass->shear));
    for (pass->ring = 1; pass->ring < (size_t)snow_taper_taps(&pass->taper[1]);)
        pass->ring *= 2;
    pass->filter = draft ? SNOW_BILINEAR : SNOW_CATMULL_ROM;
    size_t width = (size_t)pass->shear.u.count;
    size_t chunks = (width + SNOW_CHUNK - 1) / SNOW_CHUNK;
    pass->words = (chunks + 63) / 64;
    /* The warp may read a vector beyond the last pixel. */
    pass->stride = (chunks + 1) * SNOW_CHUNK * (size_t)pass->channels;
    size_t lines = BAND_BYTES / (pass->stride * sizeof(float));
    pass->band_lines = lines < BAND_LINES_LEAST  ? BAND_LINES_LEAST
                       : lines > BAND_LINES_MOST ? BAND_LINES_MOST
                                                 : (int)lines;
    pass->pad = SNOW_CHUNK * pass->shear.u.stride + 2 +
                2 * snow_taper_taps(&pass->taper[0]);
    return SNOW_OK;
}

/* The kernels of all slices: their shifts differ. */
static snow_status place_slices(snow_pass *pass) {
    snow_sheared *s = pass->sheared;
    size_t floats[2];
    for (int axis = 0; axis < 2; axis++)
        floats[axis] = 2 * (size_t)snow_taper_taps(&pass->taper[axis]);
    size_t slices = (size_t)pass->slices;
    SNOW_TRY(snow_reserve(s->context, &s->places, &s->places_capacity, 0,
                          2 * slices * sizeof *s->places));
    SNOW_TRY(snow_reserve(s->context, &s->weights, &s->weights_capacity, 0,
                          (floats[0] + floats[1]) * slices *
                              sizeof *s->weights));
    float *weights = s->weights;
    double step = s->key.between ? 0.5 : 1;
    const snow_lattice *lattices[2] = {&pass->shear.u, &pass->shear.v};
    for (size_t n = 0; n < slices; n++)
        for (int axis = 0; axis < 2; axis++) {
            double slice = (double)pass->order->slab.first + step * (double)n;
            snow_across_place(&pass->taper[axis], lattices[axis], slice,
                              weights, &s->places[2 * n + (size_t)axis]);
            weights += floats[axis];
        }
    pass->places = s->places;
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
    if (shaded) {
        SNOW_TRY(snow_reserve(s->context, &s->gloss, &s->gloss_capacity, 0,
                              SNOW_NORMALS * sizeof *s->gloss));
        snow_gloss_table(settings, pass->order->placement, settings->threads,
                         s->gloss);
    }
    stats->seconds_classify += classified - mark;
    stats->seconds_shade += snow_seconds() - classified;
    pass->palette = s->palette.samples;
    pass->gloss = shaded ? s->gloss : NULL;
    pass->channels = pass->order->channels;
    pass->sample =
        snow_sample_of(s->coder.bytes, pass->channels, shaded);
    pass->across = snow_across_of(settings->isa, pass->channels);
    pass->down = snow_down_of(settings->isa, pass->channels);
    return SNOW_OK;
}

static snow_status reserve_buffers(snow_pass *pass) {
    snow_sheared *s = pass->sheared;
    snow_scratch unused;
    pass->scratch_bytes = lay_out(pass, NULL, &unused);
    size_t lines = (size_t)pass->shear.v.count, bytes;
    uint64_t all;
    if (!snow_mul_u64(pass->scratch_bytes,
                      (uint64_t)pass->order->settings->threads, &all) ||
        all > SIZE_MAX)
        return snow_fail(s->context, SNOW_NO_MEMORY,
                         "no memory for %d threads; give --threads a smaller "
                         "number",
                         pass->order->settings->threads);
    SNOW_TRY(snow_reserve(s->context, &s->scratch, &s->scratch_capacity, 0,
                          (size_t)all));
    /* Samples and filtered rows are zero where they hold nothing. */
    memset(s->scratch, 0, (size_t)all);
    bytes = lines * pass->stride * sizeof *s->plane;
    return snow_reserve(s->context, &s->plane, &s->plane_capacity, 0, bytes);
}

static void fill_figures(const snow_sheared *s, snow_stats *stats) {
    stats->encoding = s->bands.encoding;
    stats->interesting = (int64_t)s->bands.voxels;
    stats->ea_bytes = s->bands.ea_bytes;
    stats->ia_bytes = s->bands.ia_bytes;
    stats->pa_bytes = s->bands.pa_bytes;
}

/* Lines 07 to 13, and the warp. */
static void draw(snow_pass *pass, snow_stats *stats) {
    int threads = pass->order->settings->threads;
    int64_t lines = pass->shear.v.count;
    double mark = snow_seconds();
    snow_parallel(threads,
                  (lines + pass->band_lines - 1) / pass->band_lines,
                  splat_band, pass);
    double splatted = snow_seconds();
    pass->warp =
        snow_warp_of(pass->order->settings->isa, pass->filter, pass->channels);
    snow_parallel(threads,
                  (pass->order->view->height + WARP_LINES - 1) / WARP_LINES,
                  warp_lines, pass);
    stats->seconds_splat += splatted - mark;
    stats->seconds_warp += snow_seconds() - splatted;
}

snow_status snow_sheared_render(snow_sheared *s,
                                const snow_sheared_order *order, float *pixels,
                                snow_stats *stats) {
    snow_pass pass = {.order = order, .sheared = s, .pixels = pixels};
    double mark = snow_seconds();
    SNOW_TRY(encode(s, order, stats));
    stats->seconds_encode += snow_seconds() - mark;
    pass.slices = s->bands.slices;
    pass.nearest_first = order->placement->nearest_first;
    SNOW_TRY(classify_and_shade(&pass, stats));
    SNOW_TRY(place_lattice(&pass));
    fill_figures(s, stats);
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
