/* movie_report.h - progress and figures of a sequence. */
#ifndef MOVIE_REPORT_H
#define MOVIE_REPORT_H

#include "options/options.h"
#include "picture/render_stats.h"

/* A line that is overwritten on a terminal, and printed every 10 s
 * elsewhere. */
typedef struct movie_progress {
    const options *opts;
    double begin, last; /* times of the first frame and of the last line */
    int64_t count;      /* number of all frames */
    int64_t rendered;   /* frames rendered since the beginning */
} movie_progress;

void movie_progress_begin(movie_progress *progress, const options *opts,
                          int64_t count);

/* Frame `index` is done, rendered now or kept. */
void movie_progress_step(movie_progress *progress, int64_t index,
                         bool rendered);

void movie_progress_end(movie_progress *progress);

/* Seconds of the frames that were rendered. */
typedef struct movie_figures {
    double *seconds; /* of each, rendering only */
    int64_t rendered, kept;
    snow_stats sums; /* seconds of all stages, added up */
    double combine, gather;
} movie_figures;

/* Returns false if out of memory. */
bool movie_figures_begin(movie_figures *figures, int64_t count);
void movie_figures_add(movie_figures *figures, const render_report *report);
void movie_figures_end(movie_figures *figures);

/* The object of --stats: that of the last picture, with the seconds of all
 * frames; `report->image` may be NULL if none was rendered. */
json_t *movie_stats_json(const movie_figures *figures,
                         const render_report *report, int ranks);

/* Prints "120 frames, 41.2 a second" in one line, for -v. */
void movie_report(const movie_figures *figures, const render_times *times);

#endif
