/* render_stats.h - the figures of one picture, for --stats and -v. */
#ifndef RENDER_STATS_H
#define RENDER_STATS_H

#include <jansson.h>
#include <snowglass/snowglass.h>

/* Seconds that the tool measures itself, besides those of the frame: `begin` on
 * the monotonic clock, `look` for making the transfer function, which counts as
 * classification. */
typedef struct render_times {
    double begin;
    double read, look, write, total;
} render_times;

typedef struct render_report {
    const snow_volume_info *volume;
    const snow_stats *stats;
    double combine, gather; /* seconds of stages of several ranks */
    uint64_t peak;          /* bytes; for ranks the maximum */
    double load; /* ranks: most interesting voxels, divided by the mean */
    const snow_settings *settings;
    const snow_image *image;
    const render_times *times;
} render_report;

/* The object of --stats; scripts rely on its keys. */
json_t *stats_json(const render_report *report);

/* Prints the same in a few lines on standard error. */
void log_stats(const render_report *report);

#endif
