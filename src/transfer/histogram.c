/* transfer/histogram.c - counts how often values occur, exactly and without a
 * copy of them.
 *
 * All results are counts, minima or maxima.  Each of many ranks computes them
 * for the voxels that it is responsible for, and they are added up.  So all
 * ranks get the same results for the whole volume, to the bit, as one rank
 * would, however it is partitioned.  The same holds for slabs of a volume that
 * stays in its file (volume/stream.h).  Each pass reads them again, except that
 * what sampled passes read is kept after the first one, if there is memory for
 * it. */
#include "transfer/walk.h"

#include <math.h>
#include <string.h>

/* Allocates the sample of a volume that stays in its file, with no more than a
 * quarter of what the limit leaves; without it passes read the file.  Every
 * pass reads rows no longer than two samples completely. */
static void make_own_sample(snow_histogram *histogram) {
    const snow_volume *volume = histogram->volume;
    snow_context *context = volume->context;
    const int64_t *dims = volume->info.dims;
    snow_extent part;
    snow_volume_find_extent(volume, &part);
    /* of other boxes passes read the file, of a part without voxels nothing */
    const bool empty = !part.count[0] || !part.count[1] || !part.count[2];
    if (!empty &&
        (part.count[0] != part.dims[0] || part.count[1] != part.dims[1]))
        return;
    snow_voxel_walk w =
        snow_voxel_walk_begin(histogram, volume, false, SNOW_HISTOGRAM_SAMPLED);
    uint64_t all = (uint64_t)(dims[0] * dims[1] * dims[2]);
    uint64_t rest =
        all % w.stride < SNOW_WALK_BLOCK ? all % w.stride : SNOW_WALK_BLOCK;
    uint64_t count = all / w.stride * SNOW_WALK_BLOCK + rest;
    if (volume->is_part) /* it may begin and end within blocks */
        count += 2 * SNOW_WALK_BLOCK;
    uint64_t bytes = count * snow_type_size(volume->info.type);
    if (context->limit && (context->bytes > context->limit ||
                           bytes > (context->limit - context->bytes) / 4))
        return;
    snow_volume_info info = volume->info;
    info.dims[0] = (int64_t)count;
    info.dims[1] = info.dims[2] = 1;
    if (snow_volume_new(context, &info, &histogram->sample) != SNOW_STATUS_OK)
        histogram->sample = NULL;
}

/* Ranks, which agree in passes that read the file, use samples only where all
 * of them have one. */
static snow_status make_sample(snow_histogram *histogram) {
    if (!histogram->volume->stream)
        return SNOW_STATUS_OK;
    make_own_sample(histogram);
    if (!histogram->comm)
        return SNOW_STATUS_OK;
    int64_t all = histogram->sample != NULL;
    SNOW_TRY(snow_comm_reduce_ints(histogram->comm, &all, 1, SNOW_REDUCE_MIN));
    if (!all) {
        snow_volume_close(histogram->sample);
        histogram->sample = NULL;
    }
    return SNOW_STATUS_OK;
}

/* Adds to the sample what a sampled pass sees of a slab; it has `at` voxels
 * already. */
static void keep_sample(const snow_histogram *histogram,
                        const snow_volume *slab, uint64_t *at) {
    const snow_volume *sample = histogram->sample;
    size_t count, size = snow_type_size(slab->info.type);
    int64_t first = 0;
    snow_voxel_walk w =
        snow_voxel_walk_begin(histogram, slab, false, SNOW_HISTOGRAM_SAMPLED);
    while ((count = snow_voxel_walk_next_voxels(&w, &first))) {
        memcpy((char *)sample->owned + *at * size,
               (const char *)slab->voxels + (uint64_t)first * size,
               count * size);
        *at += count;
    }
}

/* From here on neighbouring numbers of double are whole. */
#define WHOLE_FROM 0x1p52

/* The state of measuring a volume. */
typedef struct measuring {
    snow_histogram *histogram;
    uint64_t sampled; /* number of voxels */
} measuring;

/* `user` points to a measuring. */
static snow_status measure_values(const snow_volume *slab, void *user) {
    measuring *m = user;
    snow_histogram *histogram = m->histogram;
    double values[SNOW_WALK_BLOCK];
    size_t count;
    snow_voxel_walk w = snow_voxel_walk_begin(
        histogram, slab, histogram->scale.log, SNOW_HISTOGRAM_EXACT);
    if (histogram->sample)
        keep_sample(histogram, slab, &m->sampled);
    while ((count = snow_voxel_walk_next_block(&w, values))) {
        for (size_t i = 0; i < count; i++) {
            double value = values[i];
            if (!isfinite(value))
                continue;
            if (!histogram->finite++)
                histogram->min = histogram->max = value;
            if (value < histogram->min) {
                histogram->min = value;
                histogram->at_min = 0;
            }
            histogram->at_min += value == histogram->min;
            if (!histogram->fractions && fabs(value) < WHOLE_FROM)
                histogram->fractions = value != (double)(int64_t)value;
            if (value > histogram->max)
                histogram->max = value;
        }
    }
    histogram->dropped += w.dropped;
    histogram->masked |= slab->masked;
    histogram->clipped |= slab->clip || slab->lost_clip;
    histogram->had_negative |= slab->had_negative;
    return SNOW_STATUS_OK;
}

/* Joins the results of all ranks; one without a finite voxel does not count. */
static snow_status join_measures(snow_histogram *histogram) {
    if (!histogram->comm)
        return SNOW_STATUS_OK;
    double ends[2] = {INFINITY, INFINITY};
    if (histogram->finite) {
        ends[0] = histogram->min;
        ends[1] = -histogram->max;
    }
    SNOW_TRY(
        snow_comm_reduce_doubles(histogram->comm, ends, 2, SNOW_REDUCE_MIN));
    uint64_t counts[7] = {histogram->finite,  0,
                          histogram->dropped, histogram->fractions,
                          histogram->masked,  histogram->had_negative,
                          histogram->clipped};
    if (histogram->finite && histogram->min == ends[0])
        counts[1] = histogram->at_min;
    SNOW_TRY(snow_histogram_sum(histogram, counts, 7));
    histogram->dropped = counts[2];
    histogram->fractions = counts[3] > 0;
    histogram->masked = counts[4] > 0;
    histogram->had_negative = counts[5] > 0;
    histogram->clipped = counts[6] > 0;
    if (counts[0]) {
        histogram->min = ends[0];
        histogram->max = -ends[1];
        histogram->finite = counts[0];
        histogram->at_min = counts[1];
    }
    return SNOW_STATUS_OK;
}

/* What is not known by less is counted; ranks count always. */
static snow_status count_as_needed(snow_histogram *histogram) {
    bool found = false;
    if (!histogram->comm && histogram->need < SNOW_NEED_COUNTS)
        SNOW_TRY(snow_stored_values_range(histogram, &found));
    if (found)
        return SNOW_STATUS_OK;
    histogram->need = SNOW_NEED_COUNTS;
    histogram->finite = 0;
    histogram->min = histogram->max = NAN;
    return snow_stored_values_count(histogram);
}

static void warn_dropped(const snow_histogram *histogram) {
    if (histogram->dropped)
        snow_notify(
            histogram->volume->context,
            "logarithms leave out %llu of %llu voxels, whose values "
            "are 0 or below; symlog shows them",
            (unsigned long long)histogram->dropped,
            (unsigned long long)(histogram->dropped + histogram->finite));
}

snow_status snow_histogram_new(const snow_volume *volume, snow_comm *comm,
                               snow_scale scale, snow_histogram_need need,
                               snow_histogram *out) {
    snow_histogram histogram = {.need = need,
                                .volume = volume,
                                .comm = comm,
                                .min = NAN,
                                .max = NAN,
                                .scale = scale};
    snow_status status;
    if (need == SNOW_NEED_NOTHING) {
        *out = histogram;
        return SNOW_STATUS_OK;
    }
    if (snow_type_size(volume->info.type) <= 2)
        status = count_as_needed(&histogram);
    else {
        histogram.need = SNOW_NEED_COUNTS;
        measuring m = {&histogram, 0};
        status = make_sample(&histogram);
        if (status == SNOW_STATUS_OK)
            status = snow_histogram_visit(&histogram, SNOW_HISTOGRAM_EXACT,
                                          measure_values, &m);
        if (histogram.sample)
            histogram.sample->info.dims[0] = (int64_t)m.sampled;
        if (status == SNOW_STATUS_OK)
            status = join_measures(&histogram);
    }
    if (status != SNOW_STATUS_OK) {
        snow_histogram_free(&histogram);
        return status;
    }
    /* Makes a zero positive: which sign is found first is chance. */
    histogram.min += 0.0;
    histogram.max += 0.0;
    if (histogram.need == SNOW_NEED_COUNTS) {
        /* Stores the range for modes other than over (render/modes/modes.c),
         * which spares them a pass. */
        const int64_t *dims = histogram.volume->info.dims;
        const snow_volume_statistics range = {
            .voxels = dims[0] * dims[1] * dims[2],
            .finite = (int64_t)histogram.finite,
            .min = histogram.min,
            .max = histogram.max};
        if (histogram.volume->stream && !histogram.scale.log && !histogram.comm)
            snow_stream_note_range(histogram.volume, &range);
    }
    warn_dropped(&histogram);
    *out = histogram;
    return SNOW_STATUS_OK;
}

void snow_histogram_free(snow_histogram *histogram) {
    snow_volume_close(histogram->sample);
    snow_release(histogram->volume->context, histogram->counts);
}

/* The bin of a value; -1 outside. */
static int bin_of(snow_scale scale, double value, double low, double high,
                  int bins) {
    if (!(value >= low && value <= high))
        return -1;
    int bin = (int)(snow_share_on(scale, low, high, value) * bins);
    return bin < bins ? bin : bins - 1;
}

/* The state of counting bins. */
typedef struct bin_count {
    const snow_histogram *histogram;
    double low, high;
    int bins;
    uint64_t *counts, all;
} bin_count;

/* `user` points to a bin_count. */
static snow_status count_sampled(const snow_volume *slab, void *user) {
    bin_count *b = user;
    const snow_scale scale = b->histogram->scale;
    double values[SNOW_WALK_BLOCK];
    size_t got;
    snow_voxel_walk w = snow_voxel_walk_begin(b->histogram, slab, scale.log,
                                              SNOW_HISTOGRAM_SAMPLED);
    while ((got = snow_voxel_walk_next_block(&w, values)))
        for (size_t i = 0; i < got; i++) {
            int bin = bin_of(scale, values[i], b->low, b->high, b->bins);
            b->all += isfinite(values[i]) != 0;
            if (bin >= 0)
                b->counts[bin]++;
        }
    return SNOW_STATUS_OK;
}

snow_status snow_count_bins(const snow_histogram *histogram, double low,
                            double high, int bins, uint64_t *counts,
                            uint64_t *all) {
    memset(counts, 0, (size_t)bins * sizeof *counts);
    if (!histogram->counts) {
        bin_count b = {histogram, low, high, bins, counts, 0};
        SNOW_TRY(snow_histogram_visit(histogram, SNOW_HISTOGRAM_SAMPLED,
                                      count_sampled, &b));
        *all = b.all;
        SNOW_TRY(snow_histogram_sum(histogram, counts, (size_t)bins));
        return snow_histogram_sum(histogram, all, 1);
    }
    for (int n = 0; n < SNOW_DIGITS; n++) {
        double value;
        uint64_t count = snow_stored_values_nth(histogram, n, &value);
        int bin = count ? bin_of(histogram->scale, value, low, high, bins) : -1;
        if (bin >= 0)
            counts[bin] += count;
    }
    *all = histogram->finite;
    return SNOW_STATUS_OK;
}
