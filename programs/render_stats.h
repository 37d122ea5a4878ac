/* render_stats.h - the figures of one picture, for --stats and -v. */
#ifndef RENDER_STATS_H
#define RENDER_STATS_H

#include <jansson.h>
#include <snowglass/snowglass.h>

/* Seconds that the tool itself measures, beside those of the frame: `begin` of
 * the steady clock, `look` for making the transfer function, which the figures
 * count as classification. */
typedef struct render_times {
    double begin;
    double read, look, write, total;
} render_times;

typedef struct render_report {
    const snow_volume_info *volume;
    const snow_stats *stats;
    uint64_t peak; /* bytes; of ranks the most that one had */
    double load;   /* of ranks: most interesting voxels by their mean */
    const snow_settings *settings;
    const snow_image *image;
    const render_times *times;
} render_report;

/* The object of --stats; its keys are a promise to scripts. */
json_t *stats_json(const render_report *report);

/* The same in three lines on standard error. */
void tell_stats(const render_report *report);

#endif
