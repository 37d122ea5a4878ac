/* render/shear_warp/shear_warp.c - lines 02 to 06 of shear-warp: the table
 * of colours and the encoding, and when they serve another picture. */
#include "render/shear_warp/shear_warp.h"

#include "classify/count_interesting.h"
#include "classify/gradient_opacity.h"
#include "render/shear_warp/internal.h"
#include "volume/stream.h"

#include <math.h>
#include <string.h>

/* Ranges of interesting natives that are counted while cells are marked. */
#define SEEN_MOST 4

snow_status snow_value_path_new(snow_context *context, snow_value_path **out) {
    if (*out)
        return SNOW_STATUS_OK;
    snow_value_path *path = snow_allocate_clear(context, sizeof *path);
    if (!path)
        return SNOW_STATUS_NO_MEMORY;
    path->context = path->store.context = context;
    path->image = path->images;
    *out = path;
    return SNOW_STATUS_OK;
}

void snow_value_path_free(snow_value_path *path) {
    if (!path)
        return;
    snow_context *context = path->context;
    snow_value_coder_fini(context, &path->coder);
    snow_value_table_fini(context, &path->table);
    snow_value_labels_fini(context, &path->labels);
    snow_value_store_fini(&path->store);
    snow_value_forget_slabs(path);
    snow_release(context, path->kept.slabs);
    snow_release(context, path->sheets);
    snow_release(context, path->places);
    snow_release(context, path->spreads);
    snow_release(context, path->lanes[0]);
    snow_release(context, path->lanes[1]);
    for (int n = 0; n < 2; n++) {
        snow_release(context, path->images[n].plane);
        snow_release(context, path->images[n].drawn);
        snow_release(context, path->images[n].blocks);
        snow_release(context, path->images[n].halved);
    }
    snow_line_batch_fini(&path->batch);
    snow_release(context, path->curve_points);
    snow_release(context, path->lines);
    snow_release(context, path->clips);
    snow_release(context, path->scratch);
    snow_release(context, path);
}

/* --- values -----------------------------------------------------------------
 */

static const snow_slab_cut every_slab = {.step = 1, .clipped = true};

/* What the slabs of a file have together. */
typedef struct measuring {
    snow_data_range *all;
    int threads;
} measuring;

static snow_status measure_slab(const snow_volume *slab, void *user) {
    measuring *m = user;
    snow_data_range here;
    SNOW_TRY(snow_data_range_measure(slab, m->all->log, m->threads, &here));
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
        out->low = known.min;
        out->high = known.max;
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
    const bool log = transfer && transfer->log;
    if (!path->measured_of || path->measured_of != volume->generation ||
        path->measured.log != log) {
        path->measured_of = 0;
        path->measured = (snow_data_range){.log = log};
        SNOW_TRY(measure_range(volume, threads, &path->measured));
        path->measured_of = volume->generation;
    }
    *out = path->measured;
    return transfer && snow_transfer_has_labels(transfer, volume->info.type)
               ? find_labels(path, volume)
               : SNOW_STATUS_OK;
}

void snow_value_set_range(snow_value_path *path, const snow_data_range *range) {
    path->range = *range;
}

static bool has_labels(const snow_value_params *params) {
    return snow_transfer_has_labels(params->transfer,
                                    params->volume->info.type);
}

static snow_status make_table(snow_value_path *path,
                              const snow_value_params *params) {
    const snow_settings *s = params->settings;
    bool high = s->quality == SNOW_QUALITY_HIGH;
    path->op = snow_value_operator_of(s->mode);
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
        .threads = s->threads};
    path->has_labels = s->mode == SNOW_MODE_OVER && has_labels(params);
    if (path->op->hides) {
        path->op->hides(path, &look, s);
        return SNOW_STATUS_OK;
    }
    if (!path->has_labels)
        return snow_value_table_make(path->context, &look, &path->table);
    return snow_value_labels_look(path->context, &look, &path->labels,
                                  &path->table);
}

snow_status snow_value_begin(snow_value_path *path,
                             const snow_value_params *params,
                             snow_stats *stats) {
    double mark = snow_seconds();
    snow_volume_info whole;
    snow_volume_whole(params->volume, &whole);
    SNOW_TRY(snow_value_lattice_make(
        path->context, &whole, params->view, params->placement,
        params->settings->quality, &path->lattice));
    path->reference = params->settings->opacity_length;
    path->longest = 0;
    for (int n = 0; n < 3; n++)
        path->longest += (double)whole.dims[n] * whole.spacing[n];
    if (path->range.low <= path->range.high)
        SNOW_TRY(make_table(path, params));
    snow_status status = snow_value_shows(path)
                             ? snow_value_reserve_image(path, params)
                             : SNOW_STATUS_OK;
    if (snow_value_lacks_room(path, status))
        status = snow_value_reserve_image(path, params);
    SNOW_TRY(status);
    stats->seconds_classify += snow_seconds() - mark;
    return SNOW_STATUS_OK;
}

/* --- the encoding -----------------------------------------------------------
 */

/* Whether the runs that were left out are invisible still. */
static bool shows_no_more(const snow_value_table *table,
                          const snow_value_store *store) {
    for (int n = 0; n < store->run_count; n++) {
        bool hidden = store->runs[n].first > store->runs[n].last;
        for (int m = 0; m < table->run_count; m++)
            hidden |= table->runs[m].first <= store->runs[n].first &&
                      table->runs[m].last >= store->runs[n].last;
        if (!hidden)
            return false;
    }
    return true;
}

/* Labels have no means. */
static bool is_cubic(const snow_value_path *path,
                     const snow_value_params *params) {
    return params->settings->kernel == SNOW_KERNEL_BSPLINE && !path->has_labels;
}

/* The most numbers from one node of a table to the next (docs/model.md, The
 * value model, point 5). */
#define NODE_MOST 256

/* Nodes that are placed by a look move with the length of rays, and with them
 * the ends of invisible runs: shorter ones serve all views. */
static int store_runs(const snow_value_path *path,
                      snow_value_run runs[SNOW_VALUE_RUNS]) {
    const snow_value_table *table = &path->table;
    const int by = path->wavers && table->nodes ? NODE_MOST : 0;
    for (int n = 0; n < table->run_count; n++) {
        runs[n] = table->runs[n];
        if (runs[n].first > 0)
            runs[n].first = (int16_t)(runs[n].first + by);
        if (runs[n].last < SNOW_VALUE_MOST)
            runs[n].last = (int16_t)(runs[n].last - by);
        if (runs[n].first > runs[n].last)
            runs[n] = SNOW_VALUE_NO_RUN;
    }
    return table->run_count;
}

/* In perspective it changes from view to view: steps of it let an encoding
 * serve many. */
static int eye_reach(const snow_value_path *path,
                     const snow_value_params *params) {
    static const int steps[] = {
        1, 2, 3, 4, 6, 8, 12, 16, SNOW_VALUE_REACH_MOST};
    double most = snow_value_eye_reach(&path->lattice, params->placement);
    size_t n = 0;
    while (n + 1 < sizeof steps / sizeof *steps && most > steps[n])
        n++;
    return steps[n]; /* snow_value_eye_fits: there are no more */
}

static int find_reach(const snow_value_path *path,
                      const snow_value_params *params) {
    if (path->lattice.perspective)
        return eye_reach(path, params) + is_cubic(path, params);
    double most = snow_value_lattice_reach(
        &params->volume->info, params->placement, path->lattice.halves);
    /* snow_value_fits: not too much; of a cubic kernel voxels are one farther
     * away */
    return (int)ceil(most * (1 - 1e-5)) + is_cubic(path, params);
}

static bool same_key(const snow_value_key *a, const snow_value_key *b) {
    return a->generation && a->generation == b->generation &&
           a->slice_axis == b->slice_axis &&
           snow_value_same_scale(&a->scale, &b->scale) &&
           a->labels == b->labels && a->cubic == b->cubic &&
           a->encoding == b->encoding;
}

static snow_value_key key_of(const snow_value_path *path,
                             const snow_value_params *params,
                             uint64_t generation) {
    return (snow_value_key){.generation = generation,
                            .slice_axis = params->placement->slice_axis,
                            .scale = path->table.made.scale,
                            .labels = path->has_labels,
                            .cubic = is_cubic(path, params),
                            .encoding = params->settings->encoding};
}

bool snow_value_serves(const snow_value_path *path, const snow_value_key *has,
                       const snow_value_store *store,
                       const snow_value_params *params, uint64_t generation) {
    const snow_value_key key = key_of(path, params, generation);
    return same_key(has, &key) && !(params->shared && store->in_place) &&
           store->reach >= find_reach(path, params) &&
           shows_no_more(&path->table, store);
}

/* The ranges of interesting natives; 0: voxels cannot be counted by them. */
static int find_seen(const snow_value_path *path,
                     const snow_value_params *params,
                     snow_value_natives out[SEEN_MOST]) {
    const snow_value_rule *rule = &path->coder.scale.rule;
    snow_native_range ranges[SEEN_MOST];
    if (!path->coder.ruled || path->coder.scale.clamps ||
        params->volume->is_part ||
        snow_transfer_has_gradient_opacity(params->counted))
        return 0;
    int count = snow_interesting_ranges(
        &params->volume->info, params->counted, params->settings->threshold,
        rule->bottom, rule->top, ranges, SEEN_MOST);
    for (int n = 0; n < count; n++)
        out[n] = (snow_value_natives){
            .first = (uint16_t)ranges[n].first,
            .width = (uint16_t)(ranges[n].last - ranges[n].first)};
    return count > 0 ? count : 0;
}

static snow_status encode_anew(snow_value_path *path,
                               const snow_value_params *params) {
    const snow_settings *s = params->settings;
    snow_value_natives seen[SEEN_MOST];
    snow_value_run runs[SNOW_VALUE_RUNS];
    snow_value_store_params order = {.volume = params->volume,
                                     .placement = params->stored,
                                     .coder = &path->coder,
                                     .runs = runs,
                                     .run_count = store_runs(path, runs),
                                     .holes = path->range.holes,
                                     .reach = find_reach(path, params),
                                     .cubic = is_cubic(path, params),
                                     .encoding = s->encoding,
                                     .isa = s->isa,
                                     .threads = s->threads,
                                     .copied = params->shared,
                                     .seen = seen};
    path->coder.names = path->has_labels ? path->labels.names : NULL;
    path->coder.name_count = path->labels.count;
    SNOW_TRY(snow_value_coder_make(params->volume, &path->table.made.scale,
                                   &path->coder));
    if (snow_value_store_by_natives(&order))
        order.seen_count = find_seen(path, params, seen);
    SNOW_TRY(snow_value_store_encode(&path->store, &order));
    path->interesting = 0;
    for (int64_t n = 0; order.seen_count && n < path->store.band_count; n++)
        path->interesting += path->store.seen[n];
    if (order.seen_count)
        return SNOW_STATUS_OK;
    return snow_count_interesting(params->volume, params->counted, s->threshold,
                                  s->isa, &path->interesting);
}

void snow_value_forget(snow_value_path *path) {
    path->key.generation = 0;
    snow_value_store_fini(&path->store);
}

/* Among ranks, of a part's own slices: neighbours count theirs. */
static void count_bytes(const snow_value_path *path,
                        const snow_value_params *params, snow_stats *stats) {
    uint64_t ea = path->store.ea_bytes, ia = path->store.ia_bytes;
    uint64_t pa = path->store.pa_bytes;
    if (params->shared && params->slab.count)
        snow_value_store_count(&path->store,
                               params->slab.first - params->clip->stored[2],
                               params->slab.count, &ea, &ia, &pa);
    stats->ea_bytes += ea;
    stats->ia_bytes += ia;
    stats->pa_bytes += pa;
}

snow_status snow_value_encode(snow_value_path *path,
                              const snow_value_params *params,
                              snow_stats *stats) {
    const uint64_t generation = params->volume->generation;
    double mark = snow_seconds();
    if (path->range.low > path->range.high)
        return SNOW_STATUS_OK;
    snow_value_take_kept(path, params->volume);
    if (!snow_value_serves(path, &path->key, &path->store, params,
                           generation)) {
        const snow_value_key key = key_of(path, params, generation);
        path->wavers = same_key(&path->key, &key) ||
                       (path->wavers &&
                        snow_value_same_scale(&path->key.scale, &key.scale));
        path->key.generation = 0;
        snow_status status = encode_anew(path, params);
        if (snow_value_lacks_room(path, status))
            status = encode_anew(path, params);
        SNOW_TRY(status);
        path->key = key;
        stats->encoded = 1;
        stats->seconds_encode += snow_seconds() - mark;
    }
    stats->encoding = path->store.encoding;
    stats->interesting = path->interesting;
    count_bytes(path, params, stats);
    return SNOW_STATUS_OK;
}
