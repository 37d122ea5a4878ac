/* movie_report.c - prints the progress and the figures of a sequence. */
#include "movie/movie_report.h"
#include "run/log.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Seconds between two lines, for a log and for a terminal. */
#define LINE_SECONDS 10
#define ALWAYS_SECONDS 1
#define LIVE_SECONDS 0.2

void movie_progress_begin(movie_progress *progress, const options *opts,
                          int64_t count) {
    double now = seconds_now();
    *progress = (movie_progress){
        .opts = opts, .begin = now, .last = now, .count = count};
}

/* "1:02:03", "2:03" or "4 s". */
static void write_time(double seconds, char *out, size_t size) {
    int64_t whole = (int64_t)(seconds + 0.5);
    if (whole >= 3600)
        snprintf(out, size, "%" PRId64 ":%02d:%02d", whole / 3600,
                 (int)(whole / 60 % 60), (int)(whole % 60));
    else if (whole >= 60)
        snprintf(out, size, "%d:%02d min", (int)(whole / 60),
                 (int)(whole % 60));
    else
        snprintf(out, size, "%d s", (int)whole);
}

/* Frames that were kept cost nothing, and say nothing of the rest. */
static void write_line(const movie_progress *progress, int64_t index,
                       double now, char *out, size_t size) {
    double taken = now - progress->begin;
    double rate = taken > 0 ? (double)progress->rendered / taken : 0;
    int64_t left = progress->count - index - 1;
    char rest[32];
    int used = snprintf(out, size, "frame %" PRId64 " of %" PRId64, index + 1,
                        progress->count);
    if (rate <= 0 || used < 0)
        return;
    write_time((double)left / rate, rest, sizeof rest);
    snprintf(out + used, size - (size_t)used, ", %.3g a second, %s left", rate,
             rest);
}

void movie_progress_step(movie_progress *p, int64_t index, bool rendered) {
    double now = seconds_now();
    bool live = progress_is_live();
    char line[160];
    p->rendered += rendered;
    const bool always = strcmp(p->opts->progress, "always") == 0;
    const double pause = live     ? LIVE_SECONDS
                         : always ? ALWAYS_SECONDS
                                  : LINE_SECONDS;
    if (!progress_is_wanted(p->opts) || now - p->last < pause)
        return;
    p->last = now;
    *line = 0;
    if (live)
        progress_bar((double)(index + 1) / (double)p->count, line, sizeof line);
    size_t bar = strlen(line);
    write_line(p, index, now, line + bar, sizeof line - bar);
    if (live)
        progress(p->opts, line);
    else
        say("%s", line);
}

void movie_progress_end(movie_progress *p) {
    progress(p->opts, NULL);
}

bool movie_figures_begin(movie_figures *figures, int64_t count) {
    *figures = (movie_figures){
        .seconds = calloc((size_t)count, sizeof *figures->seconds)};
    return figures->seconds != NULL;
}

void movie_figures_add(movie_figures *figures, const render_report *report) {
    const snow_stats *stats = report->stats;
    snow_stats *sums = &figures->sums;
    figures->seconds[figures->rendered++] = stats->seconds_frame;
    sums->seconds_classify += stats->seconds_classify;
    sums->seconds_shade += stats->seconds_shade;
    sums->seconds_encode += stats->seconds_encode;
    sums->seconds_splat += stats->seconds_splat;
    sums->seconds_composite += stats->seconds_composite;
    sums->seconds_warp += stats->seconds_warp;
    figures->combine += report->combine;
    figures->gather += report->gather;
    sums->seconds_frame += stats->seconds_frame;
}

void movie_figures_end(movie_figures *figures) {
    free(figures->seconds);
    figures->seconds = NULL;
}

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Sorts a copy: the list itself keeps the order of the frames.  0 without
 * frames. */
static double median(const double *values, int64_t count) {
    double *sorted = malloc((size_t)count * sizeof *sorted + 1);
    double middle = 0;
    if (sorted && count) {
        memcpy(sorted, values, (size_t)count * sizeof *sorted);
        qsort(sorted, (size_t)count, sizeof *sorted, by_size);
        middle = (sorted[(count - 1) / 2] + sorted[count / 2]) / 2;
    }
    free(sorted);
    return middle;
}

/* Stages are summed over the frames, so that they add up to the total; `frame`
 * is the median of one frame. */
static void set_seconds(json_t *seconds, const movie_figures *figures,
                        const render_times *times) {
    const snow_stats *sums = &figures->sums;
    const struct {
        const char *key;
        double seconds;
    } rows[] = {{"classify", times->look + sums->seconds_classify},
                {"shade", sums->seconds_shade},
                {"encode", sums->seconds_encode},
                {"splat", sums->seconds_splat},
                {"composite", sums->seconds_composite},
                {"warp", sums->seconds_warp},
                {"combine", figures->combine},
                {"gather", figures->gather},
                {"frame", median(figures->seconds, figures->rendered)},
                {"total", times->total}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        json_object_set_new(seconds, rows[i].key, json_number(rows[i].seconds));
    json_object_set_new(
        seconds, "frames",
        json_vector(figures->seconds, (size_t)figures->rendered));
}

json_t *movie_stats_json(const movie_figures *figures,
                         const render_report *report, int ranks) {
    json_t *object = report->image ? stats_json(report) : json_object();
    json_t *seconds = json_object_get(object, "seconds");
    json_t *frames = json_object();
    if (!seconds) {
        seconds = json_object();
        json_object_set_new(object, "version", json_string(snow_version()));
        json_object_set_new(object, "seconds", seconds);
    }
    json_object_set_new(object, "ranks", json_integer(ranks));
    set_seconds(seconds, figures, report->times);
    json_object_set_new(frames, "rendered", json_integer(figures->rendered));
    json_object_set_new(frames, "kept", json_integer(figures->kept));
    json_object_set_new(object, "frames", frames);
    return object;
}

void movie_report(const movie_figures *figures, const render_times *times) {
    double frame = median(figures->seconds, figures->rendered);
    say("frames: %" PRId64 " rendered, %" PRId64
        " kept; %.4f s each (median), %.3f s in all; writing took %.3f s in "
        "parallel; total %.3f s",
        figures->rendered, figures->kept, frame, figures->sums.seconds_frame,
        times->write, times->total);
}
