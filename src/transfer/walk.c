/* transfer/walk.c - see walk.h. */
#include "transfer/walk.h"

#include <math.h>
#include <string.h>

/* The fewest voxels that a sampled pass reads, if there are as many. */
#define SAMPLE (INT64_C(1) << 24)

/* Blocks between two questions for a stop. */
#define WATCHED 16

snow_voxel_walk snow_voxel_walk_begin(const snow_histogram *histogram,
                                      const snow_volume *slab, bool log,
                                      snow_histogram_mode histogram_mode) {
    snow_extent part;
    snow_volume_find_extent(slab, &part);
    snow_voxel_walk w = {.volume = slab, .log = log, .box = {.value = 1}};
    w.monitor = histogram->comm ? NULL : histogram->volume->context->monitor;
    memcpy(w.stored, part.stored, sizeof w.stored);
    memcpy(w.box.dims, part.dims, sizeof w.box.dims);
    memcpy(w.box.first, part.first, sizeof w.box.first);
    memcpy(w.box.count, part.count, sizeof w.box.count);
    if (part.count[0] && part.count[1] && part.count[2])
        w.runs = snow_region_runs(&w.box);
    int64_t skip = part.dims[0] * part.dims[1] * part.dims[2] / SAMPLE;
    w.stride = SNOW_WALK_BLOCK;
    if (histogram_mode == SNOW_HISTOGRAM_SAMPLED && skip > 1)
        w.stride *= (uint64_t)skip;
    return w;
}

bool snow_voxel_walk_next_run(snow_voxel_walk *w) {
    if (w->run == w->runs)
        return false;
    const int64_t *dims = w->box.dims, *own = w->volume->info.dims;
    snow_region_run(&w->box, w->run++, &w->at, &w->end);
    int64_t row = (int64_t)w->at / dims[0], x = (int64_t)w->at % dims[0];
    int64_t y = row % dims[1] - w->stored[1], z = row / dims[1] - w->stored[2];
    w->ahead = (z * own[1] + y) * own[0] + x - w->stored[0] - (int64_t)w->at;
    return true;
}

bool snow_voxel_walk_is_stopped(snow_voxel_walk *w) {
    return w->monitor && snow_monitor_look(w->monitor, 0);
}

size_t snow_voxel_walk_next_voxels(snow_voxel_walk *w, int64_t *first) {
    if (w->blocks++ % WATCHED == 0 && snow_voxel_walk_is_stopped(w))
        return 0;
    for (;;) {
        if (w->at >= w->end && !snow_voxel_walk_next_run(w))
            return 0;
        uint64_t offset = w->at % w->stride;
        if (offset < SNOW_WALK_BLOCK) {
            uint64_t count = SNOW_WALK_BLOCK - offset;
            if (count > w->end - w->at)
                count = w->end - w->at;
            *first = (int64_t)w->at + w->ahead;
            w->at += count;
            return (size_t)count;
        }
        w->at += w->stride - offset;
    }
}

size_t snow_voxel_walk_next_block(snow_voxel_walk *w,
                                  double values[SNOW_WALK_BLOCK]) {
    const snow_volume_info *info = &w->volume->info;
    int64_t first = 0;
    size_t count = snow_voxel_walk_next_voxels(w, &first);
    snow_volume_stored(w->volume, first, count, values);
    for (size_t i = 0; i < count; i++)
        values[i] = info->slope * values[i] + info->intercept;
    for (size_t i = 0; i < count && w->log; i++) {
        w->dropped += values[i] <= 0;
        values[i] = values[i] > 0 ? values[i] : (double)NAN;
    }
    return count;
}

snow_status snow_histogram_visit(const snow_histogram *histogram,
                                 snow_histogram_mode histogram_mode,
                                 snow_slab_fn *visit, void *user) {
    static const snow_slab_cut cut = {0};
    const bool sampled =
        histogram_mode == SNOW_HISTOGRAM_SAMPLED && histogram->sample;
    snow_status status =
        sampled ? visit(histogram->sample, user)
                : snow_slabs_visit(histogram->volume, &cut, visit, user);
    if (histogram->comm)
        return histogram->volume->stream && !sampled
                   ? snow_comm_agree_status(histogram->comm, status)
                   : status;
    SNOW_TRY(status);
    return snow_monitor_status(histogram->volume->context->monitor);
}

snow_status snow_histogram_sum(const snow_histogram *histogram,
                               uint64_t *counts, size_t count) {
    if (!histogram->comm)
        return SNOW_STATUS_OK;
    return snow_comm_reduce_ints(histogram->comm, (int64_t *)counts, count,
                                 SNOW_REDUCE_SUM);
}

snow_status snow_histogram_sum_table(const snow_histogram *histogram,
                                     uint64_t *counts) {
    int64_t ends[2] = {0, 1 - SNOW_DIGITS}; /* the first; the last, negated */
    if (!histogram->comm)
        return SNOW_STATUS_OK;
    while (ends[0] < SNOW_DIGITS && !counts[ends[0]])
        ends[0]++;
    while (ends[1] < 0 && !counts[-ends[1]])
        ends[1]++;
    SNOW_TRY(snow_comm_reduce_ints(histogram->comm, ends, 2, SNOW_REDUCE_MIN));
    if (ends[0] == SNOW_DIGITS)
        return SNOW_STATUS_OK;
    return snow_histogram_sum(histogram, counts + ends[0],
                              (size_t)(1 - ends[1] - ends[0]));
}
snow_status snow_histogram_new_tables(const snow_histogram *histogram,
                                      size_t tables, uint64_t **out) {
    *out = snow_allocate_clear(histogram->volume->context,
                               tables * SNOW_DIGITS * sizeof **out);
    snow_status status = *out ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY;
    return histogram->comm ? snow_comm_agree_status(histogram->comm, status)
                           : status;
}
