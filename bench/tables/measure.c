/* bench/tables/measure.c - one row of tables 2 and 3: verified, then timed.
 *
 * The five ways take turns within each run, so that a change of the machine's
 * speed meets them all; the median over the runs is taken for each figure. */
#include "bench.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define IMAGE_SIDE 256 /* of the paper's pictures, section 5.2 */
#define RUNS_MOST 99   /* --runs is held to it */

/* "Tested" is the fair rival: it too skips uninteresting voxels, but has to
 * touch each one to know.  What is left of the gain is the encoding's. */
static const struct {
    snow_method method;
    snow_encoding encoding;
} ways[BENCH_WAYS] = {
    [BENCH_ORIGINAL] = {SNOW_METHOD_ORIGINAL, SNOW_ENCODING_AUTO},
    [BENCH_TESTED] = {SNOW_METHOD_TESTED, SNOW_ENCODING_AUTO},
    [BENCH_CRS] = {SNOW_METHOD_FOOTPRINT, SNOW_ENCODING_CRS},
    [BENCH_BITMAP] = {SNOW_METHOD_FOOTPRINT, SNOW_ENCODING_BITMAP},
    [BENCH_RLE] = {SNOW_METHOD_FOOTPRINT, SNOW_ENCODING_RLE},
};

void bench_way_settings(bench_way way, snow_settings *settings) {
    settings->method = ways[way].method;
    settings->encoding = ways[way].encoding;
}

/* One picture after the other of one row. */
typedef struct bench_run {
    const bench_volume *volume;
    snow_frame *frame;
    snow_view view;
    snow_settings settings;
} bench_run;

/* One voxel per pixel, so that a footprint of K voxels is K x K pixels as in
 * the paper's tables.  Without shading, which every way would pay alike: what
 * is compared is the splatting. */
static snow_status begin_run(snow_context *context, const bench_volume *volume,
                             const bench_options *options, int footprint,
                             bench_run *run) {
    run->volume = volume;
    snow_view_init(&run->view);
    SNOW_TRY(snow_view_from_name(context, "+z", &run->view));
    run->view.width = run->view.height = IMAGE_SIDE;
    run->view.zoom =
        snow_view_zoom_for_voxels(volume->volume, IMAGE_SIDE, IMAGE_SIDE);
    run->view.azimuth = options->azimuth;
    run->view.elevation = options->elevation;
    snow_settings_init(&run->settings);
    run->settings.kernel = options->kernel;
    run->settings.footprint = footprint;
    run->settings.shade = SNOW_SHADE_NONE;
    /* One thread and the same plain loops for all ways, as the paper compared
     * them: the gain is the encoding's alone. */
    run->settings.isa = SNOW_ISA_SCALAR;
    run->settings.threads = 1;
    return snow_frame_new(context, &run->frame);
}

/* Renders one way; the picture's check sum goes to *checksum. */
static snow_status render(bench_run *run, bench_way way, double threshold,
                          uint64_t *checksum) {
    snow_image *image;
    bench_way_settings(way, &run->settings);
    run->settings.threshold = threshold;
    snow_status status = snow_frame_render(run->frame, run->volume->volume,
                                           run->volume->transfer, &run->view,
                                           &run->settings, &image);
    if (status == SNOW_STATUS_OK) {
        *checksum = snow_image_checksum(image);
        snow_image_free(image);
    }
    return status;
}

/* All ways from `first` on give one picture at this threshold.  The original
 * splats every voxel, so it can only agree at threshold 0; the others agree at
 * any. */
static snow_status verify(bench_run *run, bench_way first, double threshold) {
    uint64_t expected = 0, sum;
    for (int way = (int)first; way < BENCH_WAYS; way++) {
        SNOW_TRY(render(run, (bench_way)way, threshold, &sum));
        if (way == (int)first)
            expected = sum;
        if (sum != expected) {
            fprintf(stderr,
                    "snowglass: bench: %s at threshold %g: method %s %s gives "
                    "another picture; nothing is timed\n",
                    run->volume->name, threshold,
                    bench_method_name(ways[way].method),
                    snow_encoding_name(ways[way].encoding));
            return SNOW_STATUS_DIFFERENT;
        }
    }
    return SNOW_STATUS_OK;
}

static int compare_doubles(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The median, since a machine with other work has outliers on one side only. */
double bench_median(double *values, int count) {
    qsort(values, (size_t)count, sizeof *values, compare_doubles);
    return count % 2 ? values[count / 2]
                     : (values[count / 2 - 1] + values[count / 2]) / 2;
}

/* The times of the picture just made, in milliseconds. */
static bench_time times_of(const snow_stats *stats) {
    bool encoded = stats->method == SNOW_METHOD_FOOTPRINT;
    double encode =
        encoded ? stats->seconds_classify + stats->seconds_encode : 0;
    return (bench_time){1e3 * encode, 1e3 * (stats->seconds_frame - encode),
                        1e3 * stats->seconds_frame, 1e3 * stats->cpu_frame};
}

/* Each figure has its own median: a run that was disturbed while encoding may
 * well have splatted undisturbed.  The fields are reached by their offsets, so
 * that the four need one loop. */
static snow_status time_ways(bench_run *run, double threshold, int runs,
                             bench_row *out) {
    static const size_t fields[] = {
        offsetof(bench_time, encode), offsetof(bench_time, splat),
        offsetof(bench_time, frame), offsetof(bench_time, cpu)};
    bench_time times[RUNS_MOST][BENCH_WAYS];
    for (int i = 0; i < runs; i++)
        for (int way = 0; way < BENCH_WAYS; way++) {
            uint64_t sum;
            SNOW_TRY(render(run, (bench_way)way, threshold, &sum));
            const snow_stats *stats = snow_frame_stats(run->frame);
            times[i][way] = times_of(stats);
            out->ea_bytes[way] = stats->ea_bytes;
            out->sparse_ratio = stats->sparse_ratio;
        }
    for (int way = 0; way < BENCH_WAYS; way++)
        for (int f = 0; f < 4; f++) {
            double values[RUNS_MOST];
            for (int i = 0; i < runs; i++)
                memcpy(&values[i], (char *)&times[i][way] + fields[f],
                       sizeof values[i]);
            double middle = bench_median(values, runs);
            memcpy((char *)&out->times[way] + fields[f], &middle,
                   sizeof middle);
        }
    return SNOW_STATUS_OK;
}

/* Verified first, at both thresholds: a time of a wrong picture is worth
 * nothing.  It warms caches and buffers as well. */
snow_status bench_measure(snow_context *context, const bench_volume *volume,
                          const bench_options *options, double threshold,
                          int footprint, bench_row *out) {
    bench_run run;
    SNOW_TRY(begin_run(context, volume, options, footprint, &run));
    snow_status status = verify(&run, BENCH_ORIGINAL, 0);
    if (status == SNOW_STATUS_OK)
        status = verify(&run, BENCH_TESTED, threshold);
    if (status == SNOW_STATUS_OK)
        status = time_ways(&run, threshold, options->runs, out);
    snow_frame_free(run.frame);
    return status;
}

/* Of wall time, encoding included, as the paper counts. */
double bench_gain(const bench_row *row, bench_way way) {
    double original = row->times[BENCH_ORIGINAL].frame;
    return 100 * (original - row->times[way].frame) / original;
}
