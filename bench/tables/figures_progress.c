/* bench/tables/figures_progress.c - how far a figure is and how long it takes
 * yet, on stderr: a line that changes on a terminal, elsewhere one every 10 s.
 *
 * Runs of the original take several times as long as those of the encodings, so
 * what is left is counted by way; a way that was not measured yet is taken to
 * be as fast as the fastest. */
#include "figures.h"
#include "run/log.h"

#include <stdio.h>

/* Seconds between two reports: on a terminal, elsewhere. */
#define LIVE_SECONDS 0.5
#define LINE_SECONDS 10

void figure_progress_begin(figure_progress *p, int figure, int runs) {
    *p = (figure_progress){.figure = figure, .begin = seconds_now()};
    for (int way = 0; way < FIGURE_WAYS; way++)
        p->left[way] = FIGURE_VOLUMES * FIGURE_CLUSTERS * FIGURE_NODES * runs;
}

double figure_progress_clock(void) {
    return seconds_now();
}

/* Of one run, in seconds; that of the fastest way if this one has none. */
static double mean_of(const figure_progress *p, int way) {
    double least = 0;
    if (p->done[way])
        return p->seconds[way] / p->done[way];
    for (int other = 0; other < FIGURE_WAYS; other++) {
        double mean =
            p->done[other] ? p->seconds[other] / p->done[other] : least;
        least = least == 0 || mean < least ? mean : least;
    }
    return least;
}

double figure_progress_left(const figure_progress *p) {
    double left = 0;
    for (int way = 0; way < FIGURE_WAYS; way++)
        left += p->left[way] * mean_of(p, way);
    return left;
}

/* "40 s", "12 min" */
static void write_time(double seconds, char out[32]) {
    if (seconds < 100)
        snprintf(out, 32, "%.0f s", seconds);
    else
        snprintf(out, 32, "%.0f min", seconds / 60);
}

void figure_progress_step(figure_progress *p, int way, double seconds,
                          const char *what, int nodes) {
    bool live = progress_is_live();
    double now = seconds_now(), taken = now - p->begin;
    char spent[32], left[32];
    p->left[way]--;
    p->done[way]++;
    p->seconds[way] += seconds;
    if (p->told > 0 && now - p->told < (live ? LIVE_SECONDS : LINE_SECONDS))
        return;
    p->told = now;
    double rest = figure_progress_left(p);
    write_time(taken, spent);
    write_time(rest, left);
    fprintf(stderr,
            "%ssnowglass: bench figure%d: %s, %s, %d node%s: %.0f %%, %s, "
            "about %s left%s",
            live ? "\r\033[K" : "", p->figure, what, figure_way_names[way],
            nodes, nodes > 1 ? "s" : "", 100 * taken / (taken + rest), spent,
            left, live ? "" : "\n");
}

void figure_progress_end(const figure_progress *p) {
    if (p->told > 0 && progress_is_live())
        fputs("\r\033[K", stderr);
}
