/* bench/chart.h - line charts as SVG, without any library. */
#ifndef SNOW_BENCH_CHART_H
#define SNOW_BENCH_CHART_H

#include <snowglass/status.h>
#include <stdbool.h>

#define CHART_LINES 10
#define CHART_POINTS 16
#define CHART_PANELS 3
#define CHART_TICKS 12

/* Points from left to right; y above 0. */
typedef struct chart_line {
    int count;
    double x[CHART_POINTS], y[CHART_POINTS];
} chart_line;

typedef struct chart_panel {
    char title[64];
    chart_line lines[CHART_LINES];
} chart_panel;

/* Panels side by side over one y axis, which is logarithmic, with one legend.
 * Text is UTF-8; what XML does not like in it is escaped. */
typedef struct chart_plot {
    const char *title;    /* above */
    const char *notes[2]; /* small, below */
    const char *x_label, *y_label;
    bool x_log;
    int tick_count; /* of x; the first and the last bound the axis */
    double ticks[CHART_TICKS];
    int line_count;
    const char *names[CHART_LINES]; /* of the lines, for the legend */
    int panel_count;
    chart_panel panels[CHART_PANELS];
} chart_plot;

/* Whether a chart can be written to this path: nothing is there, and its
 * folder can be written.  If not, stderr was told; SNOW_STATUS_BAD_OUTPUT. */
snow_status chart_check(const char *path);

/* Writes it aside and renames it.  Errors: SNOW_STATUS_BAD_OUTPUT, told on
 * stderr. */
snow_status chart_write(const chart_plot *chart, const char *path);

#endif
