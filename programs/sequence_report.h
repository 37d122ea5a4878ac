/* sequence_report.h - what is told of a sequence: how far it is, and figures.
 */
#ifndef SEQUENCE_REPORT_H
#define SEQUENCE_REPORT_H

#include "options.h"
#include "render_stats.h"

/* A line that is written over on a terminal, and every 10 s elsewhere. */
typedef struct sequence_progress {
    const options *asked;
    double begin, last; /* of the first frame, of the last line */
    int64_t count;      /* of all frames */
    int64_t rendered;   /* since the beginning */
} sequence_progress;

void sequence_progress_begin(sequence_progress *progress, const options *asked,
                             int64_t count);

/* Frame `index` is done, rendered now or kept. */
void sequence_progress_step(sequence_progress *progress, int64_t index,
                            bool rendered);

void sequence_progress_end(sequence_progress *progress);

/* Seconds of the frames that were rendered. */
typedef struct sequence_figures {
    double *seconds; /* of each, rendering only */
    int64_t rendered, kept;
    snow_stats sums; /* seconds of all stages, added up */
} sequence_figures;

/* False without memory. */
bool sequence_figures_begin(sequence_figures *figures, int64_t count);
void sequence_figures_add(sequence_figures *figures, const snow_stats *stats);
void sequence_figures_end(sequence_figures *figures);

/* The object of --stats: that of the last picture, with the seconds of all of
 * them; `report->image` may be NULL where none was rendered. */
json_t *sequence_stats_json(const sequence_figures *figures,
                            const render_report *report, int ranks);

/* "120 frames, 41.2 a second" in one line, for -v. */
void sequence_tell(const sequence_figures *figures, const render_times *times);

#endif
