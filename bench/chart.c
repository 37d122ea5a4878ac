/* bench/chart.c - charts of measured times: panels side by side, logarithmic
 * times upwards, a legend to the right.
 *
 *   margin | panel | gap | panel | gap | panel | legend
 *
 * All lengths are SVG units (pixels at 100 %).  Lines differ by colour, by mark
 * and by dashes, so that they are told apart on any printer and by any eye;
 * the colours are those of Okabe and Ito (2008). */
#include "chart.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define LEFT 86
#define TOP 92
#define PANEL_WIDTH 330
#define PANEL_HEIGHT 400
#define GAP 44
#define LEGEND_WIDTH 230
#define BELOW 106
#define LEGEND_LINE 27
#define PATH_BYTES 4096

static const struct style {
    const char *color, *dash;
} styles[CHART_LINES] = {
    {"#000000", ""},    {"#7f7f7f", "7 4"}, {"#0072b2", ""}, {"#56b4e9", "7 4"},
    {"#009e73", "2 4"}, {"#e69f00", ""},    {"#d55e00", ""}, {"#cc79a7", "7 4"},
    {"#8c6d00", "2 4"}, {"#004c3f", ""},
};

/* The y axis: from 10^low to 10^high, both multiples of a third, so that its
 * ends are near 1, 2 or 5. */
typedef struct plot_axes {
    const chart_plot *chart;
    double low, high; /* logarithms of y */
} plot_axes;

static void put_text(FILE *file, const char *text) {
    for (; *text; text++) {
        if (*text == '&')
            fputs("&amp;", file);
        else if (*text == '<')
            fputs("&lt;", file);
        else if (*text == '>')
            fputs("&gt;", file);
        else if ((unsigned char)*text >= ' ')
            fputc(*text, file);
    }
}

static void put_label(FILE *file, double x, double y, const char *attributes,
                      const char *text) {
    fprintf(file, "<text x=\"%.1f\" y=\"%.1f\" %s>", x, y, attributes);
    put_text(file, text);
    fputs("</text>\n", file);
}

static void put_rule(FILE *file, double x1, double y1, double x2, double y2,
                     const char *color) {
    fprintf(file,
            "<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" "
            "stroke=\"%s\"/>\n",
            x1, y1, x2, y2, color);
}

static double panel_left(int panel) {
    return LEFT + panel * (PANEL_WIDTH + GAP);
}

/* Where a value lies, as a distance from the panel's left side. */
static double place_x(const chart_plot *chart, double x) {
    double low = chart->ticks[0], high = chart->ticks[chart->tick_count - 1];
    double part = chart->x_log ? log(x / low) / log(high / low)
                               : (x - low) / (high - low);
    return part * PANEL_WIDTH;
}

static double place_y(const plot_axes *axes, double y) {
    double part = (log10(y) - axes->low) / (axes->high - axes->low);
    return TOP + (1 - part) * PANEL_HEIGHT;
}

/* The range of all points, widened to thirds of decades; 1 to 10 when there
 * are none. */
static plot_axes find_axes(const chart_plot *chart) {
    double low = INFINITY, high = -INFINITY;
    for (int p = 0; p < chart->panel_count; p++)
        for (int n = 0; n < chart->line_count; n++)
            for (int i = 0; i < chart->panels[p].lines[n].count; i++) {
                double y = log10(chart->panels[p].lines[n].y[i]);
                low = y < low ? y : low;
                high = y > high ? y : high;
            }
    if (!(low <= high))
        low = 0.1, high = 0.9;
    low = floor(3 * low - 0.1) / 3;
    high = ceil(3 * high + 0.1) / 3;
    return (plot_axes){chart, low, high};
}

/* Lines across at 1, 2 and 5 of each decade, with their numbers left of the
 * first panel. */
static void put_y_ticks(FILE *file, const plot_axes *axes, int panel) {
    static const double steps[] = {1, 2, 5};
    double left = panel_left(panel);
    for (int decade = (int)floor(axes->low); decade <= axes->high; decade++)
        for (int i = 0; i < 3; i++) {
            double value = steps[i] * pow(10, decade);
            char text[32];
            if (log10(value) < axes->low - 1e-9 ||
                log10(value) > axes->high + 1e-9)
                continue;
            double y = place_y(axes, value);
            put_rule(file, left, y, left + PANEL_WIDTH, y,
                     i ? "#ececec" : "#c8c8c8");
            snprintf(text, sizeof text, "%g", value);
            if (panel == 0)
                put_label(file, left - 8, y + 5, "text-anchor=\"end\"", text);
        }
}

static void put_x_ticks(FILE *file, const plot_axes *axes, int panel) {
    const chart_plot *chart = axes->chart;
    double bottom = TOP + PANEL_HEIGHT;
    for (int i = 0; i < chart->tick_count; i++) {
        double x = panel_left(panel) + place_x(chart, chart->ticks[i]);
        char text[32];
        put_rule(file, x, TOP, x, bottom, "#ececec");
        put_rule(file, x, bottom, x, bottom + 5, "#404040");
        snprintf(text, sizeof text, "%g", chart->ticks[i]);
        put_label(file, x, bottom + 21, "text-anchor=\"middle\"", text);
    }
}

/* A mark of the n-th line: circle, square, diamond, triangle in turn. */
static void put_mark(FILE *file, int line, double x, double y) {
    const char *color = styles[line].color;
    if (line % 4 == 0) {
        fprintf(file, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"4\" fill=\"%s\"/>\n",
                x, y, color);
        return;
    }
    char shape[96];
    snprintf(shape, sizeof shape,
             line % 4 == 1   ? "M%.1f %.1fm-4 -4h8v8h-8z"
             : line % 4 == 2 ? "M%.1f %.1fm0 -5.5l5.5 5.5l-5.5 5.5l-5.5 -5.5z"
                             : "M%.1f %.1fm0 -5.5l5 9h-10z",
             x, y);
    fprintf(file, "<path d=\"%s\" fill=\"%s\"/>\n", shape, color);
}

static void begin_line(FILE *file, int line) {
    fprintf(file,
            "<polyline fill=\"none\" stroke=\"%s\" stroke-width=\"2\" "
            "stroke-dasharray=\"%s\" points=\"",
            styles[line].color,
            *styles[line].dash ? styles[line].dash : "none");
}

static void put_line(FILE *file, const plot_axes *axes, int panel, int line) {
    const chart_line *points = &axes->chart->panels[panel].lines[line];
    double left = panel_left(panel);
    begin_line(file, line);
    for (int i = 0; i < points->count; i++)
        fprintf(file, "%.1f,%.1f ", left + place_x(axes->chart, points->x[i]),
                place_y(axes, points->y[i]));
    fputs("\"/>\n", file);
    for (int i = 0; i < points->count; i++)
        put_mark(file, line, left + place_x(axes->chart, points->x[i]),
                 place_y(axes, points->y[i]));
}

static void put_panel(FILE *file, const plot_axes *axes, int panel) {
    const chart_plot *chart = axes->chart;
    double left = panel_left(panel);
    put_y_ticks(file, axes, panel);
    put_x_ticks(file, axes, panel);
    fprintf(file,
            "<rect x=\"%.1f\" y=\"%d\" width=\"%d\" height=\"%d\" "
            "fill=\"none\" stroke=\"#404040\"/>\n",
            left, TOP, PANEL_WIDTH, PANEL_HEIGHT);
    put_label(file, left + PANEL_WIDTH / 2.0, TOP - 12,
              "text-anchor=\"middle\" font-weight=\"bold\"",
              chart->panels[panel].title);
    put_label(file, left + PANEL_WIDTH / 2.0, TOP + PANEL_HEIGHT + 46,
              "text-anchor=\"middle\"", chart->x_label);
    for (int line = 0; line < chart->line_count; line++)
        put_line(file, axes, panel, line);
}

/* Lines without a point in any panel are not named. */
static void put_legend(FILE *file, const chart_plot *chart) {
    double x = panel_left(chart->panel_count), y = TOP + 14;
    for (int line = 0; line < chart->line_count; line++) {
        int points = 0;
        for (int p = 0; p < chart->panel_count; p++)
            points += chart->panels[p].lines[line].count;
        if (!points)
            continue;
        begin_line(file, line);
        fprintf(file, "%.1f,%.1f %.1f,%.1f\"/>\n", x, y, x + 40, y);
        put_mark(file, line, x + 20, y);
        put_label(file, x + 50, y + 5, "", chart->names[line]);
        y += LEGEND_LINE;
    }
}

static void put_chart(FILE *file, const chart_plot *chart) {
    plot_axes axes = find_axes(chart);
    double width = panel_left(chart->panel_count) + LEGEND_WIDTH;
    double height = TOP + PANEL_HEIGHT + BELOW;
    fprintf(file,
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" "
            "height=\"%.0f\" viewBox=\"0 0 %.0f %.0f\" "
            "font-family=\"DejaVu Sans, Verdana, Arial, sans-serif\" "
            "font-size=\"15\" fill=\"#202020\">\n"
            "<rect width=\"%.0f\" height=\"%.0f\" fill=\"#ffffff\"/>\n",
            width, height, width, height, width, height);
    put_label(file, LEFT, 36, "font-size=\"20\" font-weight=\"bold\"",
              chart->title);
    for (int panel = 0; panel < chart->panel_count; panel++)
        put_panel(file, &axes, panel);
    fprintf(file, "<g transform=\"translate(24 %d) rotate(-90)\">\n",
            TOP + PANEL_HEIGHT / 2);
    put_label(file, 0, 0, "text-anchor=\"middle\"", chart->y_label);
    fputs("</g>\n", file);
    put_legend(file, chart);
    for (int i = 0; i < 2; i++)
        put_label(file, LEFT, height - 30 + 18 * i,
                  "font-size=\"12\" fill=\"#606060\"", chart->notes[i]);
    fputs("</svg>\n", file);
}

/* --- the file ------------------------------------------------------------- */

static snow_status fail_output(const char *path, const char *why) {
    fprintf(stderr, "snowglass: bench: %s: %s\n", path, why);
    return SNOW_STATUS_BAD_OUTPUT;
}

snow_status chart_check(const char *path) {
    struct stat what;
    char folder[PATH_BYTES];
    const char *slash = strrchr(path, '/');
    if (lstat(path, &what) == 0)
        return fail_output(path, "exists; give another name");
    snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash - path) + 1 : 1,
             slash ? path : ".");
    if (access(folder, W_OK | X_OK) != 0)
        return fail_output(path, strerror(errno));
    return SNOW_STATUS_OK;
}

/* link fails where a file has come into being meanwhile, which is kept. */
snow_status chart_write(const chart_plot *chart, const char *path) {
    char aside[PATH_BYTES];
    int length = snprintf(aside, sizeof aside, "%s.snow-XXXXXX", path);
    if (length < 0 || (size_t)length >= sizeof aside)
        return fail_output(path, "the name is too long");
    int handle = mkstemp(aside);
    FILE *file = handle < 0 ? NULL : fdopen(handle, "w");
    if (!file)
        return fail_output(path, strerror(errno));
    put_chart(file, chart);
    bool good = !ferror(file) && fchmod(handle, 0644) == 0;
    good = fclose(file) == 0 && good && link(aside, path) == 0;
    snow_status status =
        good ? SNOW_STATUS_OK : fail_output(path, strerror(errno));
    unlink(aside);
    return status;
}
