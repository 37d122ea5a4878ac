/* render/shear_warp/encoding.c - line 06 of shear-warp: what the encoding is
 * of, and when it serves another picture. */
#include "render/shear_warp/layers.h"

#include "classify/count_interesting.h"
#include "classify/gradient_opacity.h"

#include <math.h>

/* Returns whether the intervals that were left out are invisible still. */
static bool shows_no_more(const snow_value_table *table,
                          const snow_value_store *store) {
    for (int n = 0; n < store->interval_count; n++) {
        bool hidden = store->intervals[n].first > store->intervals[n].last;
        for (int m = 0; m < table->interval_count; m++)
            hidden |= table->intervals[m].first <= store->intervals[n].first &&
                      table->intervals[m].last >= store->intervals[n].last;
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

/* Quantized values by which ends of intervals seldom move. */
#define NODE_OFTEN 32

/* Nodes that are placed by a look move with the length of rays, and with them
 * the ends of transparent intervals: shorter ones serve all views. */
static int
store_intervals(const snow_value_path *path, bool spare,
                snow_transparent_interval intervals[SNOW_VALUE_RUNS]) {
    const snow_value_table *table = &path->table;
    const int by = !table->nodes ? 0
                   : spare       ? SNOW_VALUE_NODE_MOST
                                 : NODE_OFTEN;
    for (int n = 0; n < table->interval_count; n++) {
        intervals[n] = table->intervals[n];
        if (intervals[n].first > 0)
            intervals[n].first = (int16_t)(intervals[n].first + by);
        if (intervals[n].last < SNOW_VALUE_MOST)
            intervals[n].last = (int16_t)(intervals[n].last - by);
        if (intervals[n].first > intervals[n].last)
            intervals[n] = SNOW_VALUE_NO_RUN;
    }
    return table->interval_count;
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
        &params->volume->info, params->placement, params->settings->quality);
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

/* Returns whether its voxels may go before the picture is drawn: the caller's,
 * which no picture of many ranks can hold. */
static bool is_left(const snow_value_params *params) {
    return params->shared && !params->volume->owned;
}

snow_value_key snow_value_key_of(const snow_value_path *path,
                                 const snow_value_params *params,
                                 uint64_t generation) {
    return (snow_value_key){.generation = generation,
                            .slice_axis = params->placement->slice_axis,
                            .scale = path->table.made.scale,
                            .labels = path->has_labels,
                            .cubic = is_cubic(path, params),
                            .encoding = params->settings->encoding};
}

bool snow_value_fits_key(const snow_value_path *path,
                         const snow_value_encoding *has,
                         const snow_value_params *params, uint64_t generation) {
    const snow_value_key key = snow_value_key_of(path, params, generation);
    return same_key(&has->key, &key) &&
           !(is_left(params) && has->store.in_place) &&
           has->store.reach >= find_reach(path, params) &&
           shows_no_more(&path->table, &has->store);
}

bool snow_value_serves(const snow_value_path *path,
                       const snow_value_encoding *has,
                       const snow_value_params *params, uint64_t generation) {
    return snow_value_fits_key(path, has, params, generation) &&
           !snow_value_store_left(&has->store);
}

/* The ranges of interesting stored values; 0: none can be counted. */
static int find_seen(const snow_value_path *path,
                     const snow_value_params *params,
                     snow_value_stored_range out[SNOW_VALUE_SEEN]) {
    const snow_fixed_quantizer *fixed = &path->quantizer.scale.fixed;
    snow_native_range ranges[SNOW_VALUE_SEEN];
    if (!path->quantizer.is_fixed || path->quantizer.scale.clamps ||
        params->volume->is_part ||
        snow_transfer_has_gradient_opacity(params->counted))
        return 0;
    int count = snow_interesting_ranges(
        &params->volume->info, params->counted, params->settings->threshold,
        fixed->bottom, fixed->top, ranges, SNOW_VALUE_SEEN);
    for (int n = 0; n < count; n++)
        out[n] = (snow_value_stored_range){
            .first = (uint16_t)ranges[n].first,
            .width = (uint16_t)(ranges[n].last - ranges[n].first)};
    return count > 0 ? count : 0;
}

snow_status snow_value_order_make(snow_value_path *path,
                                  const snow_value_params *params, bool spare,
                                  snow_value_order *out) {
    const snow_settings *s = params->settings;
    path->quantizer.names = path->has_labels ? path->labels.names : NULL;
    path->quantizer.name_count = path->labels.count;
    SNOW_TRY(snow_quantizer_make(params->volume, &path->table.made.scale,
                                 &path->quantizer));
    out->params = (snow_value_store_params){
        .volume = params->volume,
        .placement = params->stored,
        .quantizer = &path->quantizer,
        .intervals = out->intervals,
        .interval_count = store_intervals(path, spare, out->intervals),
        .holes = path->range.holes,
        .reach = find_reach(path, params),
        .cubic = is_cubic(path, params),
        .encoding = s->encoding,
        .isa = s->isa,
        .threads = s->threads,
        .copied = is_left(params),
        .seen = out->seen};
    if (snow_value_store_by_stored(&out->params))
        out->params.seen_count = find_seen(path, params, out->seen);
    return SNOW_STATUS_OK;
}

/* The interesting voxels of the encoding, of the look that it was made for. */
static snow_status count_interesting(snow_value_path *path,
                                     const snow_value_params *params) {
    const snow_settings *s = params->settings;
    const snow_value_store *store = &path->made.store;
    path->made.interesting = 0;
    for (int64_t n = 0; store->counted_ranges && n < store->band_count; n++)
        path->made.interesting += store->seen[n];
    if (store->counted_ranges)
        return SNOW_STATUS_OK;
    return snow_count_interesting(params->volume, params->counted, s->threshold,
                                  s->isa, s->threads, &path->made.interesting);
}

/* What is left of an encoding that serves; else all of it. */
static snow_status encode_anew(snow_value_path *path,
                               const snow_value_params *params,
                               const snow_value_key *key) {
    snow_value_order order;
    snow_value_store *store = &path->made.store;
    SNOW_TRY(snow_value_order_make(path, params, path->wavers, &order));
    bool begun =
        snow_value_fits_key(path, &path->made, params, key->generation);
    path->made.key.generation = 0;
    SNOW_TRY(begun ? snow_value_store_go_on(store, &order.params,
                                            snow_value_store_left(store))
                   : snow_value_store_encode(store, &order.params));
    SNOW_TRY(count_interesting(path, params));
    path->made.key = *key;
    return SNOW_STATUS_OK;
}

/* Another axis, another volume, or a look that shows more. */
static snow_status encode_part(snow_value_path *path,
                               const snow_value_params *params,
                               const snow_value_key *key) {
    path->wavers = same_key(&path->made.key, key) ||
                   (path->wavers &&
                    snow_value_same_scale(&path->made.key.scale, &key->scale));
    snow_status status = encode_anew(path, params, key);
    return snow_value_lacks_memory(path, status)
               ? encode_anew(path, params, key)
               : status;
}

void snow_value_forget(snow_value_path *path) {
    path->made.key.generation = 0;
    snow_value_store_fini(&path->made.store);
    snow_value_forget_axes(path);
}

/* Among ranks, of a part's own slices: neighbours count theirs. */
static void count_bytes(const snow_value_path *path,
                        const snow_value_params *params, snow_stats *stats) {
    const snow_value_store *store = &path->made.store;
    uint64_t ea = store->ea_bytes, ia = store->ia_bytes, pa = store->pa_bytes;
    if (params->shared && params->slab.count)
        snow_value_store_count(store,
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
    if (!snow_value_has_values(path))
        return SNOW_STATUS_OK;
    snow_value_take_kept(path, params->volume);
    if (!snow_value_serves(path, &path->made, params, generation))
        snow_value_change_axis(path, params);
    if (!snow_value_serves(path, &path->made, params, generation)) {
        const snow_value_key key = snow_value_key_of(path, params, generation);
        SNOW_TRY(encode_part(path, params, &key));
        stats->encoded = 1;
    }
    if (path->made.interesting < 0)
        SNOW_TRY(count_interesting(path, params));
    stats->seconds_encode += snow_seconds() - mark;
    stats->encoding = path->made.store.encoding;
    stats->interesting = path->made.interesting;
    count_bytes(path, params, stats);
    return SNOW_STATUS_OK;
}
