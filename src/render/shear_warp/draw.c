/* render/shear_warp/draw.c - lines 07 to 13: the tiles of the image on the
 * lattice.
 */
#include "render/shear_warp/layers.h"
#include "volume/clip_planes.h"

#include <math.h>
#include <string.h>

/* What shines through a pixel that ends: half a step of 8 bits, and less in
 * quality high. */
#define FAINT (0.5 / 255)
#define FAINTER 1e-4

/* --- light ---------------------------------------------------------------- */

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
    const snow_placement *p = params->placement;
    const snow_lights lights = snow_lights_of(p, s);
    double inverse[3][3], half[3];
    double scale = fmin(spacing[0], fmin(spacing[1], spacing[2]));
    snow_matrix_invert3(info->matrix, inverse);
    *light = (snow_value_light){.ambient = (float)s->ambient};
    for (int n = 0; n < lights.count; n++) {
        const int at = lights.head[n];
        light->diffuse[at] = (float)(s->diffuse * lights.share[n]);
        light->specular[at] = (float)(s->specular * lights.share[n]);
        light->head |= lights.head[n];
        light->distant |= !lights.head[n];
        if (lights.head[n])
            continue;
        snow_half_way(lights.to[n], p->back, half);
        project(inverse, p, lights.to[n], scale, light->light);
        project(inverse, p, half, scale, light->half);
    }
    project(inverse, p, p->back, scale, light->eye);
    measure(inverse, p, scale, light->metric);
    light->square =
        light->metric[3] == 0 && light->metric[4] == 0 && light->metric[5] == 0;
    light->bright = s->ambient + s->diffuse > 1;
    light->power = (uint32_t)(s->shininess * (1 << SNOW_VALUE_ROOTS) + 0.5);
    light->least = s->shininess > 0 ? (float)pow(1e-30, 1 / s->shininess) : 0;
    light->least = fmaxf(light->least, 1e-6F);
}

/* The curve is copied, since a look may go before the picture is drawn. */
static snow_status place_fade(const snow_value_params *params,
                              snow_value_path *path) {
    const snow_value_scale14 *scale = &path->table.made.scale;
    const size_t count = params->transfer->gradient_count;
    /* A label's gradient is that of its membership, 0 to 1. */
    const double range = path->has_labels ? 1 : scale->high - scale->low;
    double inverse[3][3];
    if (!count)
        return SNOW_STATUS_OK;
    SNOW_TRY(SNOW_RESERVE(path->context, path->curve_points, 0, count));
    memcpy(path->curve_points, params->transfer->gradients,
           count * sizeof *path->curve_points);
    path->curve = (snow_transfer){.gradients = path->curve_points,
                                  .gradient_count = count};
    snow_matrix_invert3(params->volume->info.matrix, inverse);
    path->fade = (snow_value_fade){
        .transfer = &path->curve,
        .scale = scale,
        .log = (scale->log || scale->linear > 0) && !path->has_labels,
        .share =
            (float)(path->lattice.path / params->settings->opacity_length)};
    measure(inverse, params->placement, range / SNOW_VALUE_MOST / 2,
            path->fade.metric);
    return SNOW_STATUS_OK;
}

/* --- resampled slices and memory ------------------------------------------ */

static snow_status place_resampled(snow_value_path *path,
                                   const snow_value_params *params) {
    const snow_value_lattice *l = &path->lattice;
    size_t resampled_slices = (size_t)l->resampled_count;
    SNOW_TRY(SNOW_RESERVE(path->context, path->resampled_slices, 0,
                          resampled_slices));
    snow_value_place *places = NULL;
    if (!l->perspective) {
        size_t count = resampled_slices * (size_t)l->phases;
        SNOW_TRY(SNOW_RESERVE(path->context, path->places, 0, count));
        places = path->places;
    }
    snow_value_lattice_slices(l, params->placement, path->resampled_slices,
                              places);
    snow_value_move_slices(path, params);
    return l->perspective ? snow_value_place_rays(path, params)
                          : SNOW_STATUS_OK;
}

/* The planes that have cut the volume, whose indices are those of its own
 * voxels. */
static snow_status place_clips(snow_value_path *path,
                               const snow_value_params *params) {
    const snow_clip_planes *clip = params->volume->clip;
    const snow_placement *p = params->placement;
    if (!clip)
        return SNOW_STATUS_OK;
    SNOW_TRY(SNOW_RESERVE(path->context, path->clips, 0, clip->plane_count));
    for (size_t n = 0; n < clip->plane_count; n++) {
        path->clips[n][0] = clip->planes[n][p->u_axis];
        path->clips[n][1] = clip->planes[n][p->v_axis];
        path->clips[n][2] = clip->planes[n][p->slice_axis];
        path->clips[n][3] = clip->planes[n][3];
        for (int axis = 0; axis < 3; axis++)
            path->clips[n][3] +=
                path->clips[n][axis] * (double)params->clip->stored[axis];
    }
    return SNOW_STATUS_OK;
}

/* Returns whether a mask has left a border; those of labels are lit by their
 * own gradients. */
static bool has_border(const snow_value_path *path) {
    return path->range.masked && path->made.store.holes && !path->has_labels;
}

static void describe(snow_value_drawing *job) {
    snow_value_path *path = job->path;
    const snow_value_params *params = &job->params;
    const snow_value_lattice *l = &path->lattice;
    const int64_t voxels[2] = {params->placement->columns,
                               params->placement->rows};
    bool shaded = params->settings->shade == SNOW_SHADE_PHONG;
    bool surface = params->settings->mode == SNOW_MODE_ISO;
    bool fades =
        !surface && snow_transfer_has_gradient_opacity(params->transfer);
    job->splat =
        (snow_value_splat){.store = &path->made.store,
                           .table = &path->table,
                           .light = shaded ? &path->light : NULL,
                           .fade = fades ? &path->fade : NULL,
                           .surface = surface ? &path->surface : NULL,
                           .resampled_slices = path->resampled_slices,
                           .places = path->places,
                           .rays = l->perspective ? &path->rays : NULL,
                           .resampled_count = l->resampled_count,
                           .phases = l->phases,
                           .channels = params->channels,
                           .clips = (const double(*)[4])path->clips,
                           .labels = path->has_labels ? &path->labels : NULL};
    job->splat.leans = shaded && has_border(path);
    job->splat.borders = job->splat.leans;
    for (int n = 0; n < path->layer_count; n++)
        job->splat.borders |= shaded && has_border(path->layers[n]);
    job->splat.labels_nearest = params->settings->quality == SNOW_QUALITY_DRAFT;
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
    snow_value_own(params, &job->splat);
    job->splat.reduction = path->op->reduction;
    job->tile =
        job->splat.reduction == SNOW_VALUE_OVER
            ? snow_value_tile_of(params->settings->isa, params->channels,
                                 shaded || fades, l->perspective)
            : snow_value_projection_of(params->settings->isa,
                                       job->splat.reduction, l->perspective);
    job->splat.floats = path->table.faint || path->layer_count ||
                        job->splat.reduction == SNOW_VALUE_SUM;
    job->scratch_bytes = snow_value_splat_bytes(&job->splat) +
                         snow_value_stack_bytes(path, &job->splat);
    if (params->settings->deterministic)
        job->scratch_bytes += snow_value_node_floats(job) * sizeof(float);
    job->scratch_bytes = snow_align(job->scratch_bytes);
}

/* --- tiles ---------------------------------------------------------------- */

/* Returns where row `row` of a phase of a tile is in a layer; *step leads to
 * the next pixel. */
static float *find_row(const snow_value_drawing *job, int layer, int phase,
                       int64_t column, int64_t row, ptrdiff_t *step) {
    const snow_value_image *image = job->path->image;
    const snow_value_pixels to =
        snow_value_lattice_pixels(&image->lattice, phase);
    const int channels = job->splat.channels;
    const ptrdiff_t stride = (ptrdiff_t)image->stride;
    int64_t x = to.at[0] + column * to.along_u[0] + row * to.along_v[0];
    int64_t y = to.at[1] + column * to.along_u[1] + row * to.along_v[1];
    *step = to.along_u[0] * channels + to.along_u[1] * stride;
    return image->plane + (size_t)layer * image->layer_floats + y * stride +
           x * channels;
}

/* Pixels of a row of a tile to their places, every `step`-th float; or behind
 * what is there. */
static void store_row(const snow_value_drawing *job, const float *pixels,
                      ptrdiff_t step, bool behind, float *out) {
    const int channels = job->splat.channels;
    if (!behind && step == channels) {
        memcpy(out, pixels,
               (size_t)(SNOW_VALUE_COLUMNS * channels) * sizeof *out);
        return;
    }
    for (int n = 0; n < SNOW_VALUE_COLUMNS;
         n++, out += step, pixels += channels)
        if (behind)
            job->path->op->combine(out, pixels, 1);
        else if (channels == 4)
            memcpy(out, pixels, 4 * sizeof *out);
        else
            memcpy(out, pixels, 2 * sizeof *out);
}

/* The same of a phase of a tile; nothing where there are no planes. */
static void store_phase(const snow_value_drawing *job, const void *planes,
                        int phase, int64_t column, int64_t row, bool behind) {
    float pixels[SNOW_VALUE_COLUMNS * 4];
    if (!planes)
        memset(pixels, 0, sizeof pixels);
    for (int r = 0; r < SNOW_VALUE_ROWS; r++) {
        ptrdiff_t step;
        float *out = find_row(job, 0, phase, column, row + r, &step);
        if (planes)
            job->path->op->read(&job->splat, planes, phase, r, pixels);
        store_row(job, pixels, step, behind, out);
    }
}

/* The same ones from there. */
static void load_phase(const snow_value_drawing *job, void *planes, int phase,
                       int64_t column, int64_t row) {
    const int channels = job->splat.channels;
    snow_value_plane *plane = (snow_value_plane *)planes + phase;
    snow_value_faint_plane *floats = (snow_value_faint_plane *)planes + phase;
    for (int r = 0; r < SNOW_VALUE_ROWS; r++) {
        ptrdiff_t step;
        const float *from = find_row(job, 0, phase, column, row + r, &step);
        for (int n = 1; n <= SNOW_VALUE_COLUMNS; n++, from += step)
            for (int c = 0; c < channels; c++) {
                int to = c == channels - 1 ? 3 : c;
                if (job->splat.floats)
                    (*floats)[to][r][n] = from[c];
                else
                    (*plane)[to][r][n] = (int16_t)(from[c] * 32767 + 0.5F);
            }
    }
}

/* Returns whether lines of the picture that are drawn need a tile which lines
 * of it before have not made. Values that are finished have changed. */
static bool is_wanted(const snow_value_drawing *job, int64_t item,
                      int64_t column, int64_t row) {
    snow_value_image *image = job->path->image;
    if (!snow_value_strip_needs(&job->strip, &image->lattice, column, row) ||
        (job->params.more && image->current[item] && !job->path->op->finish))
        return false;
    image->current[item] = 1;
    return true;
}

/* Draws a tile, or clears what an earlier picture has drawn there. */
static void draw_tile(void *of, int64_t item, int worker) {
    const snow_value_drawing *job = of;
    snow_value_image *image = job->path->image;
    const snow_value_lattice *l = &image->lattice;
    int x = (int)(item % image->grid.tiles[0]);
    int y = (int)(item / image->grid.tiles[0]);
    int64_t column = (int64_t)x * SNOW_VALUE_COLUMNS;
    int64_t row = (int64_t)y * SNOW_VALUE_ROWS;
    if (!is_wanted(job, item, column, row))
        return;
    void *scratch = job->path->scratch + (size_t)worker * job->scratch_bytes;
    bool within = column < l->voxels[0] && row < l->voxels[1];
    snow_value_splat splat = job->splat;
    const bool behind = job->params.resumes && image->drawn[item];
    splat.resumes = behind && !job->path->op->combine;
    if (splat.resumes)
        memset(scratch, 0, snow_value_planes_bytes(&splat));
    for (int phase = 0; splat.resumes && phase < l->phases; phase++)
        load_phase(job, scratch, phase, column, row);
    bool drawn =
        within &&
        (job->path->layer_count
             ? snow_value_draw_stack(job, NULL, splat.resumes, x, y, scratch)
             : job->tile(&splat, x, y, scratch));
    if (!drawn && (!image->drawn[item] || behind))
        return;
    image->drawn[item] = drawn;
    for (int phase = 0; phase < l->phases; phase++)
        store_phase(job, drawn ? scratch : NULL, phase, column, row,
                    behind && !splat.resumes);
}

/* The next tile of several threads. */
static void draw_turn(void *of, int64_t item, int worker) {
    const snow_value_drawing *job = of;
    snow_value_turn *turn = &job->path->image->turns[item];
    const double begin = snow_seconds();
    draw_tile(of, turn->tile, worker);
    turn->seconds = (float)(snow_seconds() - begin);
}

/* The same in a layer of a deterministic picture. */
static void draw_layer(const snow_value_drawing *job, int layer, int64_t item,
                       void *scratch, float *pixels) {
    snow_value_image *image = job->path->image;
    const snow_value_lattice *l = &image->lattice;
    int x = (int)(item % image->grid.tiles[0]);
    int y = (int)(item / image->grid.tiles[0]);
    int64_t column = (int64_t)x * SNOW_VALUE_COLUMNS;
    int64_t row = (int64_t)y * SNOW_VALUE_ROWS;
    const size_t channels = (size_t)job->splat.channels;
    unsigned char *flag =
        image->drawn + (size_t)layer * snow_value_tiles(image) + item;
    bool drawn =
        column < l->voxels[0] && row < l->voxels[1] &&
        snow_value_node_tile(job, image->nodes[layer], x, y, scratch, pixels);
    if (!drawn && !*flag)
        return;
    if (!drawn)
        memset(pixels, 0,
               (size_t)l->phases * SNOW_VALUE_ROWS * SNOW_VALUE_COLUMNS *
                   channels * sizeof *pixels);
    *flag = drawn;
    for (int phase = 0; phase < l->phases; phase++)
        for (int r = 0; r < SNOW_VALUE_ROWS; r++) {
            ptrdiff_t step;
            float *out = find_row(job, layer, phase, column, row + r, &step);
            store_row(job, pixels, step, false, out);
            pixels += SNOW_VALUE_COLUMNS * channels;
        }
}

static void draw_layers(void *of, int64_t item, int worker) {
    const snow_value_drawing *job = of;
    char *scratch = job->path->scratch + (size_t)worker * job->scratch_bytes;
    float *pixels =
        (float *)(void *)(scratch + snow_value_splat_bytes(&job->splat) +
                          snow_value_stack_bytes(job->path, &job->splat));
    for (int n = 0; n < job->path->image->grid.layers; n++)
        draw_layer(job, n, item, scratch, pixels);
}

/* --- a picture ------------------------------------------------------------ */

/* Resampled slices and light. */
snow_status snow_value_place_drawing(snow_value_path *path,
                                     const snow_value_params *params) {
    const snow_settings *settings = params->settings;
    snow_value_drawing *job = &path->drawing;
    *job = (snow_value_drawing){.path = path, .params = *params};
    SNOW_TRY(place_resampled(path, params));
    SNOW_TRY(place_clips(path, params));
    if (settings->shade == SNOW_SHADE_PHONG)
        place_light(params, &path->light);
    SNOW_TRY(place_fade(params, path));
    describe(job);
    if (!settings->deterministic)
        job->splat = snow_value_splat_of(job, params->slab);
    return SNOW_STATUS_OK;
}

static snow_work_fn *work_of(const snow_value_params *params) {
    return params->settings->deterministic ? draw_layers : draw_tile;
}

/* All of it. */
static snow_status draw_whole(snow_value_path *path,
                              const snow_value_params *params,
                              snow_stats *stats) {
    double mark = snow_seconds();
    snow_work_fn *work = work_of(params);
    if (work == draw_tile && params->settings->threads > 1) {
        SNOW_TRY(snow_value_order_tiles(path->context, path->image));
        work = draw_turn;
    }
    SNOW_TRY(snow_parallel(path->context, params->settings->threads,
                           (int64_t)snow_value_tiles(path->image), work,
                           &path->drawing));
    snow_value_end_image(path->image);
    snow_lap(&mark, &stats->seconds_splat);
    snow_value_prepare_axis(path, params, stats->seconds_splat);
    stats->kept_bytes = snow_value_axes_bytes(path);
    stats->kept_most = snow_value_axes_most(params->volume);
    snow_lap(&mark, &stats->seconds_encode);
    return SNOW_STATUS_OK;
}

static void end_drawing(void *of) {
    const snow_value_drawing *job = of;
    snow_value_end_image(job->path->image);
}

/* Left to be drawn. */
static snow_status begin_batch(snow_value_path *path,
                               const snow_value_params *params) {
    const snow_value_grid *grid = &path->image->grid;
    const snow_line_batch_params order = {.lines = grid->tiles[1],
                                          .width = grid->tiles[0],
                                          .begin_at = params->begin_at,
                                          .whole = grid->quincunx,
                                          .threads = params->settings->threads,
                                          .draw = work_of(params),
                                          .made = end_drawing,
                                          .job = &path->drawing};
    return snow_line_batch_begin(path->context, &path->batch, &order);
}

snow_status snow_value_draw(snow_value_path *path,
                            const snow_value_params *params, snow_stats *stats,
                            snow_shear_warp_image *out,
                            snow_line_batch **batch) {
    double mark = snow_seconds();
    *out = (snow_shear_warp_image){.channels = params->channels, .layers = 1};
    if (!snow_value_shows(path))
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_value_place_drawing(path, params));
    SNOW_TRY(SNOW_RESERVE(path->context, path->scratch, 0,
                          path->drawing.scratch_bytes *
                              (size_t)params->settings->threads));
    SNOW_TRY(snow_value_describe_image(path, params, out));
    path->drawing.strip = snow_value_strip_of(
        &path->image->lattice, params->lines, params->view->height);
    snow_monitor_next(path->context->monitor, SNOW_STAGE_RENDER, 0, 0.9);
    if (batch) {
        SNOW_TRY(begin_batch(path, params));
        *batch = &path->batch;
    }
    snow_lap(&mark, &stats->seconds_splat);
    return batch ? SNOW_STATUS_OK : draw_whole(path, params, stats);
}

snow_status snow_value_display(snow_value_path *path,
                               const snow_value_params *params,
                               const snow_shear_warp_image *image,
                               float *pixels, snow_stats *stats) {
    const snow_view *view = params->view;
    double mark = snow_seconds();
    if (image->width == 0) {
        memset(pixels, 0,
               (size_t)view->width * (size_t)view->height *
                   (size_t)params->channels * sizeof *pixels);
        return SNOW_STATUS_OK;
    }
    SNOW_TRY(snow_value_show(path, params, pixels));
    stats->seconds_warp += snow_seconds() - mark;
    return SNOW_STATUS_OK;
}
