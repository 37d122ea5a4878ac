/* render/shear_warp/shear_warp.c - lines 02 to 05 of shear-warp: the range of
 * the values and the table of colours. */
#include "render/shear_warp/shear_warp.h"

#include "render/shear_warp/layers.h"

#include <math.h>

snow_status snow_value_path_new(snow_context *context, snow_value_path **out) {
    if (*out)
        return SNOW_STATUS_OK;
    snow_value_path *path = snow_allocate_clear(context, sizeof *path);
    if (!path)
        return SNOW_STATUS_NO_MEMORY;
    path->context = path->made.store.context = context;
    path->image = path->images;
    *out = path;
    return SNOW_STATUS_OK;
}

void snow_value_path_free(snow_value_path *path) {
    if (!path)
        return;
    snow_context *context = path->context;
    snow_quantizer_fini(context, &path->quantizer);
    snow_value_table_fini(context, &path->table);
    snow_value_labels_fini(context, &path->labels);
    snow_value_store_fini(&path->made.store);
    snow_value_forget_axes(path);
    snow_value_forget_slabs(path);
    void *const blocks[] = {path->kept.slabs,   path->resampled_slices,
                            path->places,       path->spreads,
                            path->lanes[0],     path->lanes[1],
                            path->curve_points, path->lines,
                            path->clips,        path->scratch};
    for (size_t n = 0; n < sizeof blocks / sizeof *blocks; n++)
        snow_release(context, blocks[n]);
    for (int n = 0; n < 2; n++) {
        snow_release(context, path->images[n].plane);
        snow_release(context, path->images[n].drawn);
        snow_release(context, path->images[n].current);
        snow_release(context, path->images[n].blocks);
        snow_release(context, path->images[n].turns);
        snow_release(context, path->images[n].halved);
    }
    snow_line_batch_fini(&path->batch);
    for (int n = 0; n < SNOW_LAYERS_MAX; n++)
        snow_value_path_free(path->layers[n]);
    snow_release(context, path);
}

/* --- values --------------------------------------------------------------- */

static const snow_slab_cut every_slab = {.clipped = true};

/* What the slabs of a file have together. */
typedef struct measuring {
    snow_data_range *all;
    int threads;
} measuring;

static snow_status measure_slab(const snow_volume *slab, void *user) {
    measuring *m = user;
    snow_data_range here;
    SNOW_TRY(snow_data_range_measure(
        slab, (snow_scale){m->all->log, m->all->linear}, m->threads, &here));
    m->all->low = fmin(m->all->low, here.low);
    m->all->high = fmax(m->all->high, here.high);
    m->all->holes |= here.holes;
    return SNOW_STATUS_OK;
}

/* The statistics of a file serve, unless they leave out anything. */
static snow_status measure_range(const snow_volume *volume, int threads,
                                 snow_data_range *out) {
    measuring m = {out, threads};
    if (volume->stream && !out->log) {
        snow_volume_statistics known;
        SNOW_TRY(snow_volume_range(volume, &known));
        out->low = snow_place_of(out->linear, known.min);
        out->high = snow_place_of(out->linear, known.max);
        if (known.finite == known.voxels)
            return SNOW_STATUS_OK;
    }
    out->low = INFINITY;
    out->high = -INFINITY;
    return snow_slabs_visit(volume, &every_slab, measure_slab, &m);
}

static snow_status name_slab(const snow_volume *slab, void *user) {
    return snow_value_labels_add(slab, user);
}

static snow_status find_labels(snow_value_path *path,
                               const snow_volume *volume) {
    if (path->labels_of && path->labels_of == volume->generation)
        return SNOW_STATUS_OK;
    path->labels_of = 0;
    path->labels.count = 0;
    SNOW_TRY(snow_slabs_visit(volume, &every_slab, name_slab, &path->labels));
    path->labels_of = volume->generation;
    return SNOW_STATUS_OK;
}

snow_status snow_value_measure(snow_value_path *path, const snow_volume *volume,
                               const snow_transfer *transfer, int threads,
                               snow_data_range *out) {
    if (!path->measured_of || path->measured_of != volume->generation ||
        !snow_data_range_is_of(&path->measured, transfer)) {
        path->measured_of = 0;
        path->measured =
            (snow_data_range){.log = transfer && transfer->log,
                              .linear = transfer ? transfer->linear : 0,
                              .masked = volume->masked};
        SNOW_TRY(measure_range(volume, threads, &path->measured));
        path->measured_of = volume->generation;
    }
    *out = path->measured;
    return transfer && snow_transfer_has_labels(transfer, &volume->info)
               ? find_labels(path, volume)
               : SNOW_STATUS_OK;
}

void snow_value_set_range(snow_value_path *path, const snow_data_range *range) {
    path->range = *range;
}

static snow_status make_table(snow_value_path *path,
                              const snow_value_params *params) {
    const snow_settings *s = params->settings;
    bool high = s->quality == SNOW_QUALITY_HIGH;
    const snow_value_look look = {
        .transfer = params->transfer,
        .scale = snow_value_scale_of(&path->range,
                                     path->op->hides ? NULL : params->transfer,
                                     &params->volume->info),
        .threshold = s->threshold,
        .exponent = path->lattice.path / s->opacity_length,
        .nodes = high ? 256 : 129,
        .steps = high ? 64 : 16,
        .placed = s->shade == SNOW_SHADE_PHONG ||
                  snow_transfer_has_gradient_opacity(params->transfer),
        .threads = s->threads,
        .isa = s->isa};
    path->has_labels =
        s->mode == SNOW_MODE_OVER &&
        snow_transfer_has_labels(params->transfer, &params->volume->info);
    if (path->op->hides) {
        path->op->hides(path, &look, s);
        return SNOW_STATUS_OK;
    }
    if (!path->has_labels)
        return snow_value_table_make(path->context, &look, &path->table);
    return snow_value_labels_look(path->context, &look, &path->labels,
                                  &path->table);
}

snow_status snow_value_begin_values(snow_value_path *path,
                                    const snow_value_params *params) {
    snow_volume_info whole;
    path->op = snow_value_operator_of(params->settings->mode);
    snow_volume_whole(params->volume, &whole);
    SNOW_TRY(snow_value_lattice_make(
        path->context, &whole, params->view, params->placement,
        params->settings->quality, &path->lattice));
    path->reference = params->settings->opacity_length;
    path->longest = 0;
    for (int n = 0; n < 3; n++)
        path->longest += (double)whole.dims[n] * whole.spacing[n];
    return snow_value_has_values(path) ? make_table(path, params)
                                       : SNOW_STATUS_OK;
}

snow_status snow_value_begin(snow_value_path *path,
                             const snow_value_params *params,
                             snow_stats *stats) {
    double mark = snow_seconds();
    SNOW_TRY(snow_value_begin_values(path, params));
    snow_status status = snow_value_shows(path)
                             ? snow_value_reserve_image(path, params)
                             : SNOW_STATUS_OK;
    if (snow_value_lacks_memory(path, status))
        status = snow_value_reserve_image(path, params);
    SNOW_TRY(status);
    stats->seconds_classify += snow_seconds() - mark;
    return SNOW_STATUS_OK;
}
