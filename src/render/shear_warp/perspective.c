/* render/shear_warp/perspective.c - the sheared method in perspective: as
 * shear_warp.c, but slices are scaled as they are moved
 * (transform/shear_perspective.h), so that each has its own kernel, and each
 * pixel of the intermediate image its own weights; and each voxel has its own
 * ray and opacity (classify/sample/opacity_correction.h).
 *
 * In modes whose order does not matter (composite/projection.h) a tile of a
 * slice is drawn by itself, and laid into the image by the mode's loop.  Voxels
 * whose number is 0 are not there; weights are those of the whole grid: of a
 * pixel on a slice that of its column along u times that of its line along v.
 */
#include "classify/sample/opacity_correction.h"
#include "composite/tile_perspective.h"
#include "render/shear_warp/internal.h"
#include "transform/shear_perspective.h"
#include "volume/volume.h"
#include "warp/warp.h"

#include <math.h>
#include <string.h>

/* The farthest slice is at most this many times as far from the eye as the
 * nearest one: near slices have that many more pixels a voxel than they need.
 */
#define RATIO_MOST 8

/* One slice of the bands on the lattice.  Along u, first voxels and weights
 * (splat/separable/rake.h) are of all columns; along v each band makes its own.
 */
typedef struct perspective_slice {
    snow_rake u, v;
    double height; /* above the eye, slices */
    int32_t *first;
    float *weights;
    float *whole; /* sums of the weights of voxels in the grid, where they are
                     wanted */
    int from, to; /* columns that have them */
} perspective_slice;

/* One picture in the making. */
typedef struct perspective_pass {
    const snow_shear_warp_params *params;
    snow_shear_warp *shear_warp;
    snow_perspective_shear scaled;
    perspective_slice *slices;
    int64_t slice_count;               /* that are drawn */
    int64_t voxel_columns, voxel_rows; /* of the bands */
    int64_t stored[2]; /* the bands' first voxel in the whole, along u, v */
    bool lazy;         /* tiles are cleared when they are first drawn on */
    double first_slice, slice_step; /* where the drawn ones lie in the whole */
    snow_grouping grouping;
    int taps[2];    /* the most of a slice of the whole, along u and v */
    double step[2]; /* the same, voxels a pixel */
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
    const snow_decode_fns *windows;
    snow_ray_sample_fn *sample;
    snow_perspective_tile_fn *tile;
    snow_shear_warp_image image;
} perspective_pass;

/* A worker's own memory, laid out in snow_shear_warp.scratch. */
typedef struct perspective_scratch {
    snow_mask_rows rows; /* of a slice */
    float *samples;      /* windows of a tile */
    float *ring;         /* filtered rows of a tile */
    float *zero;
    uint64_t *unsaturated; /* per tile: lines that something shines through */
    snow_span *spans;
    int32_t *first; /* along v, of the band's lines */
    float *weights;
    float *kept;  /* a cut tile's pixels */
    float *sheet; /* a tile of one slice */
    float *whole; /* along v, of the band's lines: as of a slice */
    snow_band spare[SNOW_GROUP_RANKS]; /* to be combined */
} perspective_scratch;

/* A band on its way through the slices. */
typedef struct perspective_band_task {
    const perspective_pass *pass;
    int worker;
    perspective_scratch scratch;
    int first_line, lines;
    bool finished; /* a line is not alive any more */
    snow_band_shape shape;
    float *pixels;        /* of the plane */
    unsigned char *drawn; /* tiles of the band that were drawn on */
    const perspective_slice *slice;
    int u_range[2], v_range[2];              /* a part's pixels on the slice */
    int64_t row;                             /* the voxel row of mask row 0 */
    uint64_t lines_of_row[SNOW_DECODE_ROWS]; /* that need a mask row */
} perspective_band_task;

/* --- geometry ------------------------------------------------------------- */

/* Voxels a pixel of the intermediate image may be wide on a slice whose kernel
 * is `wide`: a wider one leaves less to be lost.  At these pitches Engine and
 * CThead are as near to the exact picture as they are in a parallel view. */
static double widest_pitch(double wide, bool draft) {
    double share = wide < 1.1 ? 0.6 : fmin(0.6 + (wide - 1.1), 0.7);
    return fmin((draft ? 0.99 : share) * wide, 2);
}

static void scaled_kernels_at(const snow_placement *p,
                              const snow_settings *settings, double slice,
                              snow_scaled_kernel scaled_kernel[2]) {
    double width[2];
    snow_perspective_pixel_width(p, slice, width);
    for (int axis = 0; axis < 2; axis++)
        scaled_kernel[axis] = snow_scaled_kernel_make_level(
            settings->kernel, settings->footprint, width[axis], p->fine[axis]);
}

bool snow_shear_warp_perspective_fits(const snow_placement *p,
                                      const snow_settings *settings) {
    if (!(snow_perspective_shear_ratio(p) <= RATIO_MOST))
        return false;
    for (int64_t k = 0; k < p->slices; k++) {
        snow_scaled_kernel scaled_kernel[2];
        scaled_kernels_at(p, settings, (double)k, scaled_kernel);
        for (int axis = 0; axis < 2; axis++)
            if (snow_comb_taps(&scaled_kernel[axis]) > SNOW_TAPS_MOST)
                return false;
    }
    return true;
}

/* The pitch of the lattice: fine enough for every slice. */
static snow_status place_lattice(perspective_pass *pass) {
    const snow_placement *p = pass->params->placement;
    const snow_settings *settings = pass->params->settings;
    snow_shear_warp *s = pass->shear_warp;
    bool draft = settings->quality == SNOW_QUALITY_DRAFT;
    size_t slices = (size_t)p->slices;
    SNOW_TRY(snow_reserve(s->context, &s->reach, &s->reach_capacity, 0,
                          2 * slices * sizeof *s->reach));
    snow_perspective_shear_options options = {
        .pitch = {INFINITY, INFINITY}, .reach = {s->reach, s->reach + slices}};
    double near =
        fmin(fabs(p->eye.at[2]), fabs((double)(p->slices - 1) - p->eye.at[2]));
    for (size_t k = 0; k < slices; k++) {
        snow_scaled_kernel scaled_kernel[2];
        double step = fabs((double)k - p->eye.at[2]) / near;
        scaled_kernels_at(p, settings, (double)k, scaled_kernel);
        for (size_t axis = 0; axis < 2; axis++) {
            double pitch = widest_pitch(scaled_kernel[axis].wide, draft) / step;
            options.pitch[axis] = fmin(options.pitch[axis], pitch);
            s->reach[axis * slices + k] =
                snow_scaled_kernel_reach(&scaled_kernel[axis]);
            int taps = snow_comb_taps(&scaled_kernel[axis]);
            if (taps > pass->taps[axis])
                pass->taps[axis] = taps;
        }
    }
    SNOW_TRY(
        snow_perspective_shear_make(s->context, p, &options, &pass->scaled));
    for (int end = 0; end < 2; end++) {
        double step = snow_perspective_shear_step(
            &pass->scaled, end ? (double)(slices - 1) : 0);
        pass->step[0] = fmax(pass->step[0], pass->scaled.u.pitch * step);
        pass->step[1] = fmax(pass->step[1], pass->scaled.v.pitch * step);
    }
    return SNOW_STATUS_OK;
}

/* How every slice of the bands lies on the lattice. */
static snow_status place_slices(perspective_pass *pass) {
    const snow_shear_warp_params *params = pass->params;
    snow_shear_warp *s = pass->shear_warp;
    SNOW_TRY(snow_reserve(s->context, &s->seen, &s->seen_capacity, 0,
                          (size_t)pass->slice_count * sizeof *s->seen));
    pass->slices = s->seen;
    for (int64_t n = 0; n < pass->slice_count; n++) {
        perspective_slice *slice = &pass->slices[n];
        double k = pass->first_slice + pass->slice_step * (double)n;
        double step = snow_perspective_shear_step(&pass->scaled, k);
        const snow_perspective_shear_axis *axes[2] = {&pass->scaled.u,
                                                      &pass->scaled.v};
        snow_rake *rakes[2] = {&slice->u, &slice->v};
        snow_scaled_kernel scaled_kernel[2];
        scaled_kernels_at(params->placement, params->settings, k,
                          scaled_kernel);
        slice->height = k - pass->scaled.level;
        for (int axis = 0; axis < 2; axis++) {
            *rakes[axis] = (snow_rake){
                scaled_kernel[axis], snow_comb_taps(&scaled_kernel[axis]),
                snow_perspective_shear_start(axes[axis], step),
                axes[axis]->pitch * step, axes[axis]->count};
        }
    }
    return SNOW_STATUS_OK;
}

/* Tiles and bands so large that masks of a word hold their voxels. */
static void choose_tiles(perspective_pass *pass) {
    int columns = SNOW_PERSPECTIVE_TILE_COLUMNS;
    if (pass->step[0] * (columns - 1) + pass->taps[0] + 1 > SNOW_WINDOW_MOST)
        columns /= 2;
    double lines = (SNOW_DECODE_ROWS - 1 - pass->taps[1]) / pass->step[1];
    pass->lines = lines < SNOW_PERSPECTIVE_TILE_LINES
                      ? (int)lines
                      : SNOW_PERSPECTIVE_TILE_LINES;
    pass->bands = (pass->scaled.v.count + pass->lines - 1) / pass->lines;
    pass->threads = pass->params->settings->threads;
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

/* The weights of `count` pixels that fall on the `voxels` of an axis. */
static void add_teeth(const int32_t *first, const float *weights, int count,
                      size_t stride, int taps, int64_t voxels, float *whole) {
    for (int n = 0; n < count; n++) {
        float sum = 0;
        for (int m = 0; m < taps; m++)
            if (first[n] + m >= 0 && first[n] + m < voxels)
                sum += weights[(size_t)m * stride + (size_t)n];
        whole[n] = sum;
    }
}

/* Weights along u of one slice, where it holds voxels. */
static void fill_slice(void *job, int64_t item, int worker) {
    const perspective_pass *pass = job;
    perspective_slice *slice = &pass->slices[item];
    const snow_rake *rake = &slice->u;
    (void)worker;
    double start = rake->start - (double)pass->stored[0];
    double low = (-rake->taps - start) / rake->step;
    double high =
        ((double)pass->voxel_columns + rake->taps - start) / rake->step;
    int from = low > 0 ? (int)fmin(low, (double)pass->width) : 0;
    int to = high > 0 ? (int)fmin(high + 1, (double)pass->width) : 0;
    /* Whole tiles, which read all of their weights. */
    from -= from % pass->columns;
    to = (to + pass->columns - 1) / pass->columns * pass->columns;
    slice->from = from;
    slice->to = from < to ? to : from;
    if (from >= to)
        return;
    snow_rake_fill(rake, from, to, pass->width, slice->first, slice->weights);
    if (pass->params->composite)
        add_teeth(slice->first + from, slice->weights + from, to - from,
                  pass->width, rake->taps, pass->params->placement->columns,
                  slice->whole + from);
}

static snow_status fill_slices(perspective_pass *pass) {
    snow_shear_warp *s = pass->shear_warp;
    uint64_t rows =
        1 + (uint64_t)pass->taps[0] + (pass->params->composite != NULL);
    uint64_t entry = pass->width * rows * 4, bytes;
    /* A group of pixels may read a vector of weights beyond its end. */
    if (!snow_mul_u64(entry, (uint64_t)pass->slice_count, &bytes) ||
        bytes > SIZE_MAX - 64)
        return snow_fail(s->context, SNOW_STATUS_NO_MEMORY,
                         "out of memory for the weights of %lld slices",
                         (long long)pass->slice_count);
    SNOW_TRY(snow_reserve(s->context, &s->teeth, &s->teeth_capacity, 0,
                          (size_t)bytes + 64));
    for (int64_t n = 0; n < pass->slice_count; n++) {
        char *at = s->teeth + (size_t)n * (size_t)entry;
        pass->slices[n].first = (int32_t *)(void *)at;
        pass->slices[n].weights = (float *)(void *)(at + pass->width * 4);
        pass->slices[n].whole =
            pass->slices[n].weights + pass->width * (size_t)pass->taps[0];
    }
    return snow_parallel(s->context, pass->params->settings->threads,
                         pass->slice_count, fill_slice, pass);
}

/* --- one band of lines ---------------------------------------------------- */

/* The polynomial whose root is the exponent of the voxel at column + x of a row
 * (classify/sample/opacity_correction.h): the squared length of the ray's step
 * between two slices, in reference lengths. */
static void exponents_of_row(const perspective_pass *pass, double height,
                             int64_t column, int64_t row, float square[3]) {
    const snow_perspective *eye = &pass->params->placement->eye;
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

static uint64_t lines_of_rows(const perspective_band_task *stroke,
                              uint64_t rows) {
    uint64_t lines = 0;
    for (; rows; rows &= rows - 1)
        lines |= stroke->lines_of_row[__builtin_ctzll(rows)];
    return lines;
}

static uint64_t rows_of_lines(const perspective_band_task *stroke,
                              uint64_t rows, uint64_t lines) {
    uint64_t needed = 0;
    for (; rows; rows &= rows - 1)
        if (stroke->lines_of_row[__builtin_ctzll(rows)] & lines)
            needed |= rows & -rows;
    return needed;
}

static void sample_rows(const perspective_band_task *stroke, uint64_t held,
                        int column, int count, const uint64_t *bits,
                        const uint32_t *before) {
    const perspective_pass *pass = stroke->pass;
    for (; held; held &= held - 1) {
        int row = __builtin_ctzll(held);
        const uint16_t *normals = stroke->scratch.rows.normals[row];
        const uint16_t *gradient_factors =
            stroke->scratch.rows.gradient_factors[row];
        float square[3];
        exponents_of_row(pass, stroke->slice->height, column, stroke->row + row,
                         square);
        pass->sample(
            stroke->scratch.rows.codes[row] + before[row] * pass->code_bytes,
            normals ? normals + before[row] : NULL,
            gradient_factors ? gradient_factors + before[row] : NULL, bits[row],
            count, pass->palette, pass->gloss, square,
            stroke->scratch.samples + (size_t)row * pass->window_floats);
    }
}

static int between_ends(int64_t at, int end) {
    if (at < 0)
        return 0;
    return at < end ? (int)at : end;
}

/* The band's lines that hold pixels of the part. */
static uint64_t own_lines(const perspective_band_task *stroke) {
    int from = stroke->v_range[0], to = stroke->v_range[1];
    return from < to ? ~UINT64_C(0) >> (64 - (to - from)) << from : 0;
}

/* A tile that the border of a part may cross. */
static uint64_t draw_cut_tile(const perspective_band_task *stroke,
                              int64_t index,
                              const snow_perspective_tile *tile) {
    const snow_band_shape *shape = &stroke->shape;
    int64_t left = index * shape->width;
    const snow_cut_tile cut = {
        .pixels = tile->pixels,
        .stride = shape->stride,
        .width = shape->width,
        .lines = 1,
        .channels = shape->channels,
        .x0 = between_ends(stroke->u_range[0] - left, shape->width),
        .x1 = between_ends(stroke->u_range[1] - left, shape->width),
        .y0 = stroke->v_range[0],
        .y1 = stroke->v_range[1],
        .kept = stroke->scratch.kept,
    };
    if (cut.x0 == 0 && cut.x1 == shape->width)
        return stroke->pass->tile(tile); /* own lines only are wanted */
    snow_cut_keep(&cut, tile->wanted);
    return snow_cut_restore(&cut, tile->wanted, stroke->pass->tile(tile));
}

/* Lines 08 to 13 for one tile of the slice: the lines that can be seen and have
 * a voxel in reach. */
static bool find_tile(const perspective_band_task *stroke, int64_t index,
                      uint64_t unsaturated, snow_perspective_tile *out) {
    const perspective_pass *pass = stroke->pass;
    const perspective_scratch *scratch = &stroke->scratch;
    const perspective_slice *slice = stroke->slice;
    size_t at = (size_t)index * (size_t)pass->columns;
    int column = slice->first[at];
    int count =
        slice->first[at + (size_t)pass->columns - 1] - column + slice->u.taps;
    int64_t here = column - pass->stored[0];
    if (here <= -count || here >= pass->voxel_columns)
        return false;
    if (!snow_decode_any(&stroke->scratch.rows, here, count))
        return false;
    uint64_t bits[SNOW_DECODE_ROWS];
    uint32_t before[SNOW_DECODE_ROWS];
    uint64_t held = pass->windows->windows(
        &stroke->scratch.rows,
        rows_of_lines(stroke, stroke->scratch.rows.held, unsaturated), here,
        count, bits, before);
    uint64_t lines = lines_of_rows(stroke, held) & unsaturated;
    if (!lines)
        return false;
    held = rows_of_lines(stroke, held, lines);
    sample_rows(stroke, held, column, count, bits, before);
    *out = (snow_perspective_tile){
        .u = {slice->first + at, slice->weights + at, pass->width,
              slice->u.taps},
        .v = {scratch->first, scratch->weights, SNOW_PERSPECTIVE_TILE_LINES,
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
    return true;
}

static void draw_tile(perspective_band_task *stroke, int64_t index) {
    const perspective_pass *pass = stroke->pass;
    const perspective_scratch *scratch = &stroke->scratch;
    snow_perspective_tile tile;
    if (!find_tile(stroke, index,
                   scratch->unsaturated[index] & own_lines(stroke), &tile))
        return;
    if (pass->lazy && !stroke->drawn[index])
        snow_band_clear_tile(
            &stroke->shape, &(snow_band){stroke->pixels, stroke->drawn}, index);
    uint64_t finished = pass->params->clip.cuts
                            ? draw_cut_tile(stroke, index, &tile)
                            : pass->tile(&tile);
    scratch->unsaturated[index] &= ~finished;
    stroke->finished |= finished != 0;
    stroke->drawn[index] = 1;
}

/* --- sheets by themselves ------------------------------------------------- */

/* Pairs of a tile's line: values as they were drawn, or none, and weights. */
static void weigh_line(const float *across, float down, int count, bool drawn,
                       float *sheet) {
    for (int x = 0; x < count; x++) {
        sheet[2 * x] = drawn ? sheet[2 * x] : 0;
        sheet[2 * x + 1] = across[x] * down;
    }
}

/* Pixels of a tile that voxels of the slice may reach, and are the part's own.
 */
static void own_columns(const perspective_band_task *stroke, int64_t left,
                        int range[2]) {
    const perspective_pass *pass = stroke->pass;
    const perspective_slice *slice = stroke->slice;
    range[0] = between_ends(slice->from - left, pass->columns);
    range[1] = between_ends(slice->to - left, pass->columns);
    if (!pass->params->clip.cuts)
        return;
    int first = between_ends(stroke->u_range[0] - left, pass->columns);
    int end = between_ends(stroke->u_range[1] - left, pass->columns);
    range[0] = first > range[0] ? first : range[0];
    range[1] = end < range[1] ? end : range[1];
}

/* A tile by itself, and then as the mode wants it into the image. */
static void composite_tile(const perspective_band_task *stroke, int64_t index) {
    const perspective_pass *pass = stroke->pass;
    const perspective_scratch *scratch = &stroke->scratch;
    int64_t left = index * pass->columns;
    size_t line = 2 * (size_t)pass->columns;
    snow_perspective_tile tile = {.wanted = 0};
    int own[2];
    own_columns(stroke, left, own);
    if (own[0] >= own[1])
        return;
    if (find_tile(stroke, index, own_lines(stroke), &tile)) {
        tile.pixels = scratch->sheet;
        tile.line = line;
        snow_tile_clear(tile.pixels, (size_t)stroke->lines * line / 2, 2);
        pass->tile(&tile);
    }
    size_t first = 2 * (size_t)own[0], count = (size_t)(own[1] - own[0]);
    const float *across = stroke->slice->whole + left + own[0];
    for (int y = stroke->v_range[0]; y < stroke->v_range[1]; y++) {
        float *sheet = scratch->sheet + (size_t)y * line + first;
        weigh_line(across, scratch->whole[y], (int)count, tile.wanted >> y & 1,
                   sheet);
        pass->params->composite(stroke->pixels + (size_t)y * pass->stride +
                                    2 * (size_t)left + first,
                                sheet, count);
    }
    stroke->drawn[index] = 1;
}

/* Weights of the band's lines, and which of them need which row. */
static void fill_lines(perspective_band_task *stroke) {
    const snow_rake *rake = &stroke->slice->v;
    snow_rake of_band = *rake;
    of_band.start += rake->step * stroke->first_line;
    snow_rake_fill(&of_band, 0, stroke->lines, SNOW_PERSPECTIVE_TILE_LINES,
                   stroke->scratch.first, stroke->scratch.weights);
    memset(stroke->lines_of_row, 0, sizeof stroke->lines_of_row);
    for (int n = 0; n < stroke->lines; n++)
        for (int m = 0; m < rake->taps; m++)
            stroke->lines_of_row[stroke->scratch.first[n] - stroke->row + m] |=
                UINT64_C(1) << n;
    if (stroke->pass->params->composite)
        add_teeth(stroke->scratch.first, stroke->scratch.weights, stroke->lines,
                  SNOW_PERSPECTIVE_TILE_LINES, rake->taps,
                  stroke->pass->params->placement->rows, stroke->scratch.whole);
}

/* The part's pixels on a slice: columns of the image, lines of the band.  False
 * where there are none.  Pixels beyond the image, which tiles have, count as
 * its last. */
static bool cut_slice(perspective_band_task *stroke, int64_t index) {
    const perspective_pass *pass = stroke->pass;
    const snow_clip *clip = &pass->params->clip;
    double place = pass->first_slice + pass->slice_step * (double)index;
    int v[2];
    stroke->v_range[0] = 0;
    stroke->v_range[1] = stroke->lines;
    if (!clip->cuts)
        return true;
    snow_clip_perspective_shear(clip, 0, &pass->scaled, place, stroke->u_range);
    snow_clip_perspective_shear(clip, 1, &pass->scaled, place, v);
    if (stroke->u_range[1] == pass->scaled.u.count)
        stroke->u_range[1] = (int)pass->width;
    for (int n = 0; n < 2; n++)
        stroke->v_range[n] =
            between_ends(v[n] - stroke->first_line, stroke->lines);
    return stroke->u_range[0] < stroke->u_range[1] &&
           stroke->v_range[0] < stroke->v_range[1];
}

/* Tiles from range[0] to range[1] - 1, whose pixels can reach a column;
 * draw_tile looks closer. */
static void tiles_of_slice(const perspective_band_task *stroke,
                           int64_t range[2]) {
    const perspective_pass *pass = stroke->pass;
    const snow_rake *u = &stroke->slice->u;
    double start = u->start - (double)pass->stored[0];
    double low = (-u->taps - start) / u->step / pass->columns;
    double high = ((double)pass->voxel_columns + u->taps - start) / u->step /
                  pass->columns;
    range[0] = low > 0 ? (int64_t)fmin(low, (double)pass->tiles) : 0;
    range[1] = high > 0 ? (int64_t)fmin(ceil(high), (double)pass->tiles) : 0;
    if (!pass->params->clip.cuts)
        return;
    int64_t first = stroke->u_range[0] / pass->columns;
    int64_t end = (stroke->u_range[1] + pass->columns - 1) / pass->columns;
    range[0] = range[0] > first ? range[0] : first;
    range[1] = range[1] < end ? range[1] : end;
}

/* One slice of the band: its rows as masks, and each tile in turn. */
static void draw_slice(perspective_band_task *stroke, int64_t index) {
    const perspective_pass *pass = stroke->pass;
    const perspective_slice *slice = &pass->slices[index];
    snow_rake of_band = slice->v;
    of_band.start += slice->v.step * stroke->first_line;
    if (!cut_slice(stroke, index))
        return;
    stroke->slice = slice;
    stroke->row = snow_rake_first(&of_band, 0);
    int64_t end = snow_rake_first(&of_band, stroke->lines - 1) + slice->v.taps;
    int64_t here = stroke->row - pass->stored[1];
    if (end <= pass->stored[1] || here >= pass->voxel_rows)
        return;
    pass->windows->read(&pass->shear_warp->bands, index, here,
                        ~UINT64_C(0) >> (64 - (end - stroke->row)),
                        stroke->scratch.spans, &stroke->scratch.rows);
    if (!stroke->scratch.rows.held && !pass->params->composite)
        return;
    fill_lines(stroke);
    int64_t tiles[2];
    tiles_of_slice(stroke, tiles);
    for (int64_t tile = tiles[0]; tile < tiles[1]; tile++)
        if (pass->params->composite)
            composite_tile(stroke, tile);
        else if (stroke->scratch.unsaturated[tile])
            draw_tile(stroke, tile);
}

/* The parts of a worker's memory, each aligned to 64 bytes; returns the bytes
 * that they take.  With a NULL base nothing but the sum counts. */
static size_t lay_out(const perspective_pass *pass, char *base,
                      perspective_scratch *out) {
    size_t at = 0, pixel = (size_t)pass->channels * sizeof(float);
    size_t filtered = SNOW_PERSPECTIVE_TILE_COLUMNS * pixel;
#define PART(field, bytes) (out->field = snow_lay_out(base, &at, bytes))
    snow_mask_rows_lay_out(&out->rows, pass->voxel_columns, base, &at);
    PART(samples, SNOW_DECODE_ROWS * pass->window_floats * sizeof(float));
    PART(ring, SNOW_DECODE_ROWS * filtered);
    PART(zero, filtered);
    PART(unsaturated, (size_t)pass->tiles * sizeof *out->unsaturated);
    PART(spans, ((size_t)pass->voxel_columns / 2 + 1) * sizeof *out->spans);
    PART(first, SNOW_PERSPECTIVE_TILE_LINES * sizeof *out->first);
    PART(weights, (size_t)pass->taps[1] * SNOW_PERSPECTIVE_TILE_LINES *
                      sizeof *out->weights);
    if (pass->params->clip.cuts)
        PART(kept, SNOW_PERSPECTIVE_TILE_LINES * filtered);
    if (pass->params->composite) {
        PART(sheet, SNOW_PERSPECTIVE_TILE_LINES * filtered);
        PART(whole, SNOW_PERSPECTIVE_TILE_LINES * sizeof *out->whole);
    }
    snow_grouping_lay_out(&pass->grouping, (size_t)pass->lines * pass->stride,
                          pass->tiles, base, &at, out->spare);
#undef PART
    return at;
}

/* Line 07 for one band of lines: slices from front to back. */
static void draw_slab(void *of, int64_t first, int64_t count,
                      const snow_band *band) {
    perspective_band_task *stroke = of;
    const perspective_pass *pass = stroke->pass;
    uint64_t *unsaturated = stroke->scratch.unsaturated;
    stroke->finished = false;
    stroke->pixels = band->pixels;
    stroke->drawn = band->drawn;
    for (int64_t tile = 0; tile < pass->tiles; tile++)
        unsaturated[tile] = ~UINT64_C(0) >> (64 - stroke->lines);
    bool rising = pass->scaled.height > 0;
    for (int64_t n = 0;
         n < count &&
         (!stroke->finished ||
          snow_any_set(unsaturated, (size_t)pass->tiles)) &&
         !snow_monitor_look(pass->shear_warp->monitor, stroke->worker);
         n++)
        draw_slice(stroke, first + (rising ? n : count - 1 - n));
}

/* Sheets by themselves into one band of lines. */
static void composite_band(perspective_band_task *stroke,
                           const snow_band *band) {
    const perspective_pass *pass = stroke->pass;
    size_t floats = (size_t)stroke->lines * pass->stride;
    memset(band->drawn, 0, (size_t)pass->tiles);
    memset(band->pixels, 0, floats * sizeof *band->pixels);
    draw_slab(stroke, 0, pass->slice_count, band);
    for (size_t n = 0; n < floats; n++)
        band->pixels[n] *= pass->params->share;
}

static void splat_band(void *job, int64_t item, int worker) {
    const perspective_pass *pass = job;
    perspective_band_task stroke = {.pass = pass, .worker = worker};
    lay_out(pass,
            pass->shear_warp->scratch + (size_t)worker * pass->scratch_bytes,
            &stroke.scratch);
    stroke.first_line = (int)item * pass->lines;
    stroke.lines = pass->scaled.v.count - stroke.first_line;
    if (stroke.lines > pass->lines)
        stroke.lines = pass->lines;
    memset(stroke.scratch.zero, 0,
           SNOW_PERSPECTIVE_TILE_COLUMNS * (size_t)pass->channels *
               sizeof(float));
    stroke.shape = (snow_band_shape){pass->tiles, pass->columns, stroke.lines,
                                     pass->channels, pass->stride};
    const snow_band band = {pass->image.pixels +
                                (size_t)stroke.first_line * pass->stride,
                            pass->image.drawn + item * pass->tiles};
    if (pass->params->composite)
        composite_band(&stroke, &band);
    else
        snow_band_draw(&pass->grouping, &pass->image, pass->lazy, &stroke.shape,
                       draw_slab, &stroke, stroke.scratch.spare, &band);
}

/* --- a picture ------------------------------------------------------------ */

/* Lines 02 and 03: tables for this look, light and view. */
static snow_status classify_and_shade(perspective_pass *pass,
                                      snow_stats *stats) {
    snow_shear_warp *s = pass->shear_warp;
    const snow_settings *settings = pass->params->settings;
    bool shaded = settings->shade == SNOW_SHADE_PHONG;
    SNOW_TRY(snow_shear_warp_classify_and_shade(s, pass->params, -1, stats));
    pass->share = (s->key.between ? 0.5 : 1) / settings->opacity_length;
    pass->palette = s->palette.samples;
    pass->gloss = shaded ? s->gloss + 1 : NULL;
    pass->channels = pass->params->channels;
    pass->code_bytes = (size_t)s->quantizer.bytes;
    pass->sample =
        snow_ray_sample_of(settings->isa, s->quantizer.bytes, pass->channels,
                           shaded, s->key.with_gradient_opacity);
    pass->tile = snow_perspective_tile_of(settings->isa, pass->channels);
    pass->windows = snow_decode_fns_of(settings->isa);
    return SNOW_STATUS_OK;
}

static snow_status reserve_buffers(perspective_pass *pass) {
    perspective_scratch unused;
    pass->scratch_bytes = lay_out(pass, NULL, &unused);
    pass->image = (snow_shear_warp_image){.width = pass->scaled.u.count,
                                          .height = pass->scaled.v.count,
                                          .channels = pass->channels,
                                          .stride = pass->stride,
                                          .tile_width = pass->columns,
                                          .tile_height = pass->lines,
                                          .tiles = (int)pass->tiles};
    return snow_shear_warp_make_room(
        pass->shear_warp, pass->scratch_bytes * (size_t)pass->threads,
        &pass->grouping, pass->bands, &pass->image);
}

/* Which slices are drawn, and where they lie. */
static snow_status choose_slices(perspective_pass *pass) {
    const snow_shear_warp_params *params = pass->params;
    bool between = params->settings->quality == SNOW_QUALITY_HIGH;
    pass->slice_count = snow_shear_warp_slices(params);
    pass->voxel_columns = pass->shear_warp->bands.columns;
    pass->voxel_rows = pass->shear_warp->bands.rows;
    pass->first_slice = (double)params->slab.first;
    pass->slice_step = between ? 0.5 : 1;
    memcpy(pass->stored, params->clip.stored, sizeof pass->stored);
    SNOW_TRY(snow_grouping_make(
        pass->shear_warp->context, params->placement->slices, params->slab,
        between ? 2 : 1, pass->slice_count, pass->scaled.height > 0,
        params->settings->deterministic != 0, &pass->grouping));
    pass->lazy = pass->grouping.on || params->volume->is_part;
    return SNOW_STATUS_OK;
}

snow_status snow_shear_warp_perspective_begin(
    snow_shear_warp *s, const snow_shear_warp_params *params, snow_stats *stats,
    snow_shear_warp_image *out) {
    SNOW_TRY(snow_reserve(s->context, &s->pass, &s->pass_capacity, 0,
                          sizeof(perspective_pass)));
    perspective_pass *pass = s->pass;
    *pass = (perspective_pass){.params = params, .shear_warp = s};
    SNOW_TRY(classify_and_shade(pass, stats));
    SNOW_TRY(place_lattice(pass));
    SNOW_TRY(choose_slices(pass));
    snow_shear_warp_warping *warping =
        snow_shear_warp_warping_of(s, params, pass->channels);
    warping->perspective = true;
    warping->scaled = pass->scaled;
    if (pass->scaled.u.count == 0 || pass->scaled.v.count == 0) {
        *out = (snow_shear_warp_image){.channels = params->channels};
        return SNOW_STATUS_OK;
    }
    double mark = snow_seconds();
    SNOW_TRY(place_slices(pass));
    choose_tiles(pass);
    SNOW_TRY(fill_slices(pass));
    SNOW_TRY(reserve_buffers(pass));
    SNOW_TRY(snow_shear_warp_begin_bands(s, params, pass->bands, splat_band));
    *out = pass->image;
    stats->seconds_splat += snow_seconds() - mark;
    return SNOW_STATUS_OK;
}
