/* render/value/draw.c - lines 07 to 13: the tiles of the image on the lattice.
 */
#include "base/thread_pool.h"
#include "classify/classify.h"
#include "classify/gradient_opacity.h"
#include "render/value/internal.h"
#include "volume/clip_planes.h"

#include <math.h>
#include <string.h>

/* A side of the blocks of a quincunx, pixels. */
#define BLOCK 64

/* What shines through a pixel that ends: half a step of 8 bits, and less in
 * quality high. */
#define FAINT (0.5 / 255)
#define FAINTER 1e-4

typedef struct draw_job {
    snow_value_path *path;
    snow_value_splat splat;
    snow_value_tile_fn *tile;
    size_t stride; /* floats of a line of the plane */
    size_t scratch_bytes;
} draw_job;

/* --- light ------------------------------------------------------------------
 */

/* n . x for a world vector x, times |g|: a factor for each of gu, gv, gp. */
static void project(double inverse[3][3], const snow_placement *p,
                    const double x[3], double scale, float out[3]) {
    const int axes[3] = {p->u_axis, p->v_axis, p->slice_axis};
    for (int n = 0; n < 3; n++) {
        double sum = 0;
        for (int i = 0; i < 3; i++)
            sum += inverse[axes[n]][i] * x[i];
        out[n] = (float)(sum * scale);
    }
}

/* |g|^2 of a gradient in index space, by factors for products of its parts. */
static void measure(double inverse[3][3], const snow_placement *p, double scale,
                    float out[6]) {
    const int axes[3] = {p->u_axis, p->v_axis, p->slice_axis};
    const int pairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
    for (int n = 0; n < 6; n++) {
        const double *a = inverse[axes[pairs[n][0]]];
        const double *b = inverse[axes[pairs[n][1]]];
        double sum = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        out[n] = (float)(sum * scale * scale * (n < 3 ? 1 : 2));
    }
}

static void place_light(const snow_value_params *params,
                        snow_value_light *light) {
    const snow_settings *s = params->settings;
    const snow_volume_info *info = &params->volume->info;
    const double *spacing = info->spacing;
    double inverse[3][3], to[3], half[3];
    double scale = fmin(spacing[0], fmin(spacing[1], spacing[2]));
    snow_matrix_invert3(info->matrix, inverse);
    bool seen = snow_light_of(params->placement, s, to, half);
    project(inverse, params->placement, to, scale, light->light);
    project(inverse, params->placement, half, scale, light->half);
    project(inverse, params->placement, params->placement->back, scale,
            light->eye);
    measure(inverse, params->placement, scale, light->metric);
    light->head = memcmp(light->light, light->eye, sizeof light->eye) == 0 &&
                  memcmp(light->half, light->eye, sizeof light->eye) == 0;
    light->square =
        light->metric[3] == 0 && light->metric[4] == 0 && light->metric[5] == 0;
    light->ambient = (float)s->ambient;
    light->diffuse = (float)s->diffuse;
    light->specular = seen ? (float)s->specular : 0;
    light->bright = s->ambient + s->diffuse > 1;
    light->power = (uint32_t)(s->shininess * (1 << SNOW_VALUE_ROOTS) + 0.5);
    light->least = s->shininess > 0 ? (float)pow(1e-30, 1 / s->shininess) : 0;
    light->least = fmaxf(light->least, 1e-6F);
}

static void place_fade(const snow_value_params *params, snow_value_path *path) {
    const snow_value_scale14 *scale = &path->table.made.scale;
    double inverse[3][3];
    snow_matrix_invert3(params->volume->info.matrix, inverse);
    path->fade =
        (snow_value_fade){.transfer = params->transfer,
                          .scale = scale,
                          .share = (float)(path->lattice.path /
                                           params->settings->opacity_length)};
    measure(inverse, params->placement,
            (scale->high - scale->low) / SNOW_VALUE_MOST / 2,
            path->fade.metric);
}

/* --- sheets and memory ------------------------------------------------------
 */

static snow_status place_sheets(snow_value_path *path,
                                const snow_value_params *params) {
    const snow_value_lattice *l = &path->lattice;
    size_t sheets = (size_t)l->sheet_count;
    SNOW_TRY(snow_reserve(path->context, &path->sheets, &path->sheets_capacity,
                          0, sheets * sizeof *path->sheets));
    snow_value_place *places = NULL;
    if (!l->perspective) {
        size_t count = sheets * (size_t)l->phases;
        SNOW_TRY(snow_reserve(path->context, &path->places,
                              &path->places_capacity, 0,
                              count * sizeof *path->places));
        places = path->places;
    }
    snow_value_lattice_sheets(l, params->placement, path->sheets, places);
    return l->perspective ? snow_value_place_rays(path, params)
                          : SNOW_STATUS_OK;
}

/* The planes that have cut the volume. */
static snow_status place_clips(snow_value_path *path,
                               const snow_value_params *params) {
    const snow_clip_planes *clip = params->volume->clip;
    const snow_placement *p = params->placement;
    if (!clip)
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_reserve(path->context, &path->clips, &path->clips_capacity, 0,
                          clip->plane_count * sizeof *path->clips));
    for (size_t n = 0; n < clip->plane_count; n++) {
        path->clips[n][0] = clip->planes[n][p->u_axis];
        path->clips[n][1] = clip->planes[n][p->v_axis];
        path->clips[n][2] = clip->planes[n][p->slice_axis];
        path->clips[n][3] = clip->planes[n][3];
    }
    return SNOW_STATUS_OK;
}

static void describe(snow_value_path *path, const snow_value_params *params,
                     draw_job *job) {
    const snow_value_lattice *l = &path->lattice;
    const int64_t voxels[2] = {params->placement->columns,
                               params->placement->rows};
    bool shaded = params->settings->shade == SNOW_SHADE_PHONG;
    bool fades = snow_transfer_has_gradient_opacity(params->transfer);
    job->splat = (snow_value_splat){.store = &path->store,
                                    .table = &path->table,
                                    .light = shaded ? &path->light : NULL,
                                    .fade = fades ? &path->fade : NULL,
                                    .sheets = path->sheets,
                                    .places = path->places,
                                    .rays = l->perspective ? &path->rays : NULL,
                                    .sheet_count = l->sheet_count,
                                    .phases = l->phases,
                                    .channels = params->channels,
                                    .clips = (const double(*)[4])path->clips};
    if (params->volume->clip)
        job->splat.clip_count = params->volume->clip->plane_count;
    bool high = params->settings->quality == SNOW_QUALITY_HIGH;
    job->splat.closed = (int16_t)(32767 * (1 - (high ? FAINTER : FAINT)));
    for (int axis = 0; axis < 2; axis++) {
        job->splat.first[axis] = l->first[axis];
        job->splat.cells[axis] = l->voxels[axis];
        job->splat.low[axis] = voxels[axis] == 1 ? -0.5 : 0;
        job->splat.high[axis] =
            voxels[axis] == 1 ? 0.5 : (double)(voxels[axis] - 1);
    }
    job->tile = snow_value_tile_of(params->settings->isa, params->channels,
                                   shaded || fades, l->perspective);
}

static int wanted_tiles(int64_t cells, int side) {
    return (int)((cells + side - 1) / side);
}

/* The grid of a picture: the one before, if its tiles have room there. */
static bool keep_grid(const draw_job *job, snow_value_grid *grid) {
    const snow_value_lattice *l = &job->path->lattice;
    const snow_value_grid *has = &job->path->grid;
    *grid = (snow_value_grid){
        .cells = {l->cells[0], l->cells[1]},
        .tiles = {wanted_tiles(l->voxels[0], SNOW_VALUE_COLUMNS),
                  wanted_tiles(l->voxels[1], SNOW_VALUE_ROWS)},
        .channels = job->splat.channels,
        .quincunx = l->quincunx};
    bool keep =
        has->channels == grid->channels && has->quincunx == grid->quincunx &&
        has->cells[0] == grid->cells[0] && has->cells[1] == grid->cells[1];
    for (int axis = 0; axis < 2; axis++)
        keep = keep && has->tiles[axis] >= grid->tiles[axis] &&
               has->tiles[axis] <= 2 * grid->tiles[axis] + 4;
    for (int axis = 0; axis < 2; axis++)
        grid->tiles[axis] = keep ? has->tiles[axis] : grid->tiles[axis] + 2;
    return keep;
}

/* A plane of all tiles, which are empty where a new one is made. */
static snow_status reserve_plane(draw_job *job, int threads) {
    snow_value_path *path = job->path;
    snow_value_lattice *l = &path->lattice;
    snow_value_grid grid;
    bool keep = keep_grid(job, &grid);
    size_t width =
        (size_t)grid.tiles[0] * SNOW_VALUE_COLUMNS * (size_t)l->cells[0];
    size_t height =
        (size_t)grid.tiles[1] * SNOW_VALUE_ROWS * (size_t)l->cells[1];
    if (l->quincunx) { /* cell (0, 0) is at the left, half way down */
        snow_value_lattice_move(l, 1, (double)height - l->top);
        l->top = (int)height;
        width = height = width + height + 1;
        l->width = l->height = (int)width;
    }
    job->stride = width * (size_t)grid.channels;
    path->grid.tiles[0] = 0; /* until it is cleared */
    SNOW_TRY(snow_reserve(path->context, &path->plane, &path->plane_capacity, 0,
                          job->stride * (height + 1) * sizeof *path->plane));
    size_t tiles = (size_t)grid.tiles[0] * (size_t)grid.tiles[1];
    SNOW_TRY(snow_reserve(path->context, &path->drawn, &path->drawn_capacity,
                          keep ? tiles : 0, tiles));
    if (!keep) {
        memset(path->plane, 0,
               job->stride * (height + 1) * sizeof *path->plane);
        memset(path->drawn, 0, tiles);
    }
    path->grid = grid;
    job->scratch_bytes = snow_value_splat_bytes(&job->splat);
    return snow_reserve(path->context, &path->scratch, &path->scratch_capacity,
                        0, job->scratch_bytes * (size_t)threads);
}

/* --- tiles ------------------------------------------------------------------
 */

/* Pixels of a phase of a tile to their places. */
static void store_phase(const draw_job *job, const void *planes, int phase,
                        int64_t column, int64_t row) {
    const bool faint = job->splat.table->faint;
    const snow_value_plane *plane = (const snow_value_plane *)planes + phase;
    const snow_value_faint_plane *floats =
        (const snow_value_faint_plane *)planes + phase;
    const snow_value_lattice *l = &job->path->lattice;
    const snow_value_pixels to = snow_value_lattice_pixels(l, phase);
    const int channels = job->splat.channels;
    const ptrdiff_t stride = (ptrdiff_t)job->stride;
    const ptrdiff_t step = to.along_u[0] * channels + to.along_u[1] * stride;
    for (int r = 0; r < SNOW_VALUE_ROWS; r++) {
        int64_t x =
            to.at[0] + column * to.along_u[0] + (row + r) * to.along_v[0];
        int64_t y =
            to.at[1] + column * to.along_u[1] + (row + r) * to.along_v[1];
        float *out = job->path->plane + y * stride + x * channels;
        float pixels[SNOW_VALUE_COLUMNS][4];
        for (int c = 0; c < 4; c++)
            for (int n = 0; n < SNOW_VALUE_COLUMNS; n++)
                pixels[n][c] =
                    faint ? (*floats)[c][r][n + 1]
                          : (float)(*plane)[c][r][n + 1] * (1.0F / 32767);
        if (channels == 4)
            for (int n = 0; n < SNOW_VALUE_COLUMNS; n++, out += step)
                memcpy(out, pixels[n], sizeof pixels[n]);
        else
            for (int n = 0; n < SNOW_VALUE_COLUMNS; n++, out += step) {
                out[0] = pixels[n][0];
                out[1] = pixels[n][3];
            }
    }
}

/* Draws a tile, or clears what an earlier picture has drawn there. */
static void draw_tile(void *of, int64_t item, int worker) {
    const draw_job *job = of;
    snow_value_path *path = job->path;
    const snow_value_lattice *l = &path->lattice;
    int x = (int)(item % path->grid.tiles[0]);
    int y = (int)(item / path->grid.tiles[0]);
    int64_t column = (int64_t)x * SNOW_VALUE_COLUMNS;
    int64_t row = (int64_t)y * SNOW_VALUE_ROWS;
    void *room = path->scratch + (size_t)worker * job->scratch_bytes;
    bool within = column < l->voxels[0] && row < l->voxels[1];
    bool drawn = within && job->tile(&job->splat, x, y, room);
    if (!drawn && !path->drawn[item])
        return;
    if (!drawn)
        memset(room, 0, snow_value_planes_bytes(&job->splat));
    path->drawn[item] = drawn;
    for (int phase = 0; phase < l->phases; phase++)
        store_phase(job, room, phase, column, row);
}

/* --- blocks of a quincunx --------------------------------------------------
 */

/* Marks the blocks that a drawn tile may reach. */
static void mark_blocks(const draw_job *job, int blocks, int64_t x, int64_t y) {
    const snow_value_lattice *l = &job->path->lattice;
    const snow_value_pixels cell = snow_value_lattice_pixels(l, 0);
    int64_t left = x * SNOW_VALUE_COLUMNS, top = y * SNOW_VALUE_ROWS;
    int64_t right = left + SNOW_VALUE_COLUMNS, bottom = top + SNOW_VALUE_ROWS;
    int64_t a0 = left * cell.along_u[0] + top * cell.along_v[0];
    int64_t a1 = right * cell.along_u[0] + bottom * cell.along_v[0];
    int64_t b0 = left * cell.along_u[1] + bottom * cell.along_v[1] + l->top;
    int64_t b1 = right * cell.along_u[1] + top * cell.along_v[1] + l->top;
    b0 = b0 > 0 ? b0 : 0;
    a1 = a1 < l->width - 1 ? a1 : l->width - 1;
    b1 = b1 < l->height - 1 ? b1 : l->height - 1;
    for (int64_t b = b0 / BLOCK; b <= b1 / BLOCK; b++)
        for (int64_t a = a0 / BLOCK; a <= a1 / BLOCK; a++)
            job->path->blocks[b * blocks + a] = 1;
}

static snow_status find_blocks(const draw_job *job, int blocks) {
    snow_value_path *path = job->path;
    size_t count = (size_t)blocks * (size_t)blocks;
    SNOW_TRY(snow_reserve(path->context, &path->blocks, &path->blocks_capacity,
                          0, count));
    memset(path->blocks, 0, count);
    for (int y = 0; y < path->grid.tiles[1]; y++)
        for (int x = 0; x < path->grid.tiles[0]; x++)
            if (path->drawn[y * path->grid.tiles[0] + x])
                mark_blocks(job, blocks, x, y);
    return SNOW_STATUS_OK;
}

/* The image as the warp takes it. */
static snow_status view_image(const draw_job *job,
                              snow_intermediate_view *image) {
    const snow_value_lattice *l = &job->path->lattice;
    int blocks = l->width / BLOCK + 1;
    *image = (snow_intermediate_view){
        .pixels = job->path->plane,
        .stride = job->stride,
        .width = l->width,
        .height = l->height,
        .channels = job->splat.channels,
        .drawn = job->path->drawn,
        .block_width = SNOW_VALUE_COLUMNS * l->cells[0],
        .block_height = SNOW_VALUE_ROWS * l->cells[1],
        .blocks = job->path->grid.tiles[0]};
    if (!l->quincunx)
        return SNOW_STATUS_OK;
    SNOW_TRY(find_blocks(job, blocks));
    image->drawn = job->path->blocks;
    image->block_width = image->block_height = BLOCK;
    image->blocks = blocks;
    return SNOW_STATUS_OK;
}

/* --- a picture --------------------------------------------------------------
 */

static snow_status draw_image(draw_job *job, int threads,
                              snow_intermediate_view *image) {
    snow_context *context = job->path->context;
    const int *tiles = job->path->grid.tiles;
    snow_monitor_next(context->monitor, SNOW_STAGE_RENDER, 0, 0.9);
    SNOW_TRY(snow_parallel(context, threads, (int64_t)tiles[0] * tiles[1],
                           draw_tile, job));
    return view_image(job, image);
}

snow_status snow_value_draw(snow_value_path *path,
                            const snow_value_params *params, float *pixels,
                            snow_stats *stats) {
    const snow_view *view = params->view;
    draw_job job = {.path = path};
    snow_intermediate_view image;
    double mark = snow_seconds();
    if (path->lattice.empty || path->range.low > path->range.high) {
        memset(pixels, 0,
               (size_t)view->width * (size_t)view->height *
                   (size_t)params->channels * sizeof *pixels);
        return SNOW_STATUS_OK;
    }
    SNOW_TRY(place_sheets(path, params));
    SNOW_TRY(place_clips(path, params));
    if (params->settings->shade == SNOW_SHADE_PHONG)
        place_light(params, &path->light);
    place_fade(params, path);
    describe(path, params, &job);
    SNOW_TRY(reserve_plane(&job, params->settings->threads));
    SNOW_TRY(draw_image(&job, params->settings->threads, &image));
    double drawn = snow_seconds();
    stats->seconds_splat += drawn - mark;
    SNOW_TRY(snow_value_show(path, params, &image, pixels));
    stats->seconds_warp += snow_seconds() - drawn;
    return SNOW_STATUS_OK;
}
