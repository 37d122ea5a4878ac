/* annotate/legend.c - explains the colours and lengths of a picture: a colour
 * bar, a scale bar, a line of text. */
#include "image/overlay.h"

#include "transfer/transfer.h"
#include "transform/transform.h"

#include <snowglass/extend.h>
#include <snowglass/overlay.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Smaller pictures than these have no room for bars, and for letters. */
#define BAR_SIDE_LEAST 128
#define NOTE_SIDE_LEAST 64

/* Widths of strokes and of their borders, relative to the letters'
 * height. */
#define STROKE 0.062
#define BORDER 0.08

static double shorter_side(const snow_overlay *overlay) {
    return fmin(overlay->width, overlay->height);
}

double snow_overlay_text_height(const snow_overlay *overlay) {
    return fmax(9, floor(0.036 * shorter_side(overlay) + 0.5));
}

/* The height of the numbers beside bars. */
static double number_height(const snow_overlay *overlay) {
    return fmax(9, floor(0.028 * shorter_side(overlay) + 0.5));
}

static snow_status begin_strokes(snow_overlay *overlay, double height) {
    double radius = fmax(0.7, STROKE * height);
    return snow_overlay_begin(overlay, radius,
                              radius + fmax(1, BORDER * height));
}

/* The base line and the left border are placed at the middle of a pixel, where
 * strokes of small letters are sharp. */
snow_status snow_overlay_text(snow_overlay *overlay, double x, double y,
                              double share_x, double share_y, double height,
                              const char *text) {
    double left = x - share_x * height * snow_font_width(text);
    double base = y + (1 - share_y) * height;
    if (!*text)
        return SNOW_STATUS_OK;
    SNOW_TRY(begin_strokes(overlay, height));
    return snow_font_draw(overlay, floor(left) + 0.5, floor(base) + 0.5, height,
                          text);
}

snow_status snow_overlay_title(snow_overlay *overlay, const char *text) {
    double height = snow_overlay_text_height(overlay);
    if (shorter_side(overlay) < NOTE_SIDE_LEAST)
        return SNOW_STATUS_OK;
    size_t first = overlay->shape_count;
    SNOW_TRY(snow_overlay_text(overlay, 0.8 * height, 0.8 * height, 0, 0,
                               height, text));
    snow_overlay_settle_mirrored(overlay, first, true);
    return SNOW_STATUS_OK;
}

/* The largest number of the form 1, 2 or 5 times a power of ten that is not
 * above a length. */
static double round_below(double length) {
    double ten = pow(10, floor(log10(length)));
    double share = length / ten * (1 + 1e-9);
    return ten * (share >= 5 ? 5 : share >= 2 ? 2 : 1);
}

/* The smallest one that is not below. */
static double round_above(double length) {
    double below = round_below(length);
    if (below >= length * (1 - 1e-9))
        return below;
    return round_below(2.5 * below) > below ? round_below(2.5 * below)
                                            : round_below(2 * below);
}

/* --- the scale bar -------------------------------------------------------- */

/* Uses the unit of a family of units that makes the number 1 to below 1000. */
static void write_length(double length, const char *unit, char *out,
                         size_t size) {
    static const char *const units[] = {"nm", "\xc2\xb5m", "mm", "m"};
    int at = strcmp(unit, "um") == 0 ? 1 : -1;
    for (int i = 0; i < 4; i++)
        if (strcmp(unit, units[i]) == 0)
            at = i;
    for (; at >= 0 && at < 3 && length >= 1000; at++)
        length /= 1000;
    for (; at > 0 && length < 1; at--)
        length *= 1000;
    snprintf(out, size, "%.4g%s%s", length, *unit ? " " : "",
             at < 0 ? unit : units[at]);
}

snow_status snow_overlay_scale_bar(snow_overlay *overlay,
                                   const snow_volume_info *info,
                                   const snow_view *view) {
    snow_context *context = overlay->context;
    snow_camera camera;
    snow_volume_info volume;
    snow_view from;
    char text[64];
    SNOW_TRY(SNOW_RECORD_READ(context, snow_volume_info, info, &volume));
    SNOW_TRY(SNOW_RECORD_READ(context, snow_view, view, &from));
    SNOW_TRY(snow_camera_make(context, &volume, &from, &camera));
    if (camera.distance > 0 || shorter_side(overlay) < BAR_SIDE_LEAST)
        return SNOW_STATUS_OK;
    double height = number_height(overlay);
    double length = round_below(0.3 * overlay->width * camera.pitch);
    double left = floor(height) + 0.5, right = left + length / camera.pitch;
    double y = floor(overlay->height - 1.2 * height) + 0.5,
           tick = 0.35 * height;
    size_t first = overlay->shape_count;
    write_length(length, volume.unit, text, sizeof text);
    SNOW_TRY(begin_strokes(overlay, height));
    SNOW_TRY(snow_overlay_stroke(overlay, left, y, right, y));
    SNOW_TRY(snow_overlay_stroke(overlay, left, y - tick, left, y + tick));
    SNOW_TRY(snow_overlay_stroke(overlay, right, y - tick, right, y + tick));
    /* Above the middle, but within the picture. */
    double half = height * snow_font_width(text) / 2;
    SNOW_TRY(snow_overlay_text(overlay, fmax((left + right) / 2, left + half),
                               y - 0.8 * height, 0.5, 1, height, text));
    snow_overlay_settle_mirrored(overlay, first, true);
    return SNOW_STATUS_OK;
}

/* --- the colour bar ------------------------------------------------------- */

/* The position of the bar, in whole pixels, and what it shows. */
typedef struct color_bar {
    int x0, y0, x1, y1;
    double low, high; /* data values of the lower and the upper end */
    double from, to;  /* the data values that have these colours */
    double opaque;    /* largest opacity in the bar */
    double height;    /* height of the letters */
} color_bar;

/* From the first to the last control point; a single value gets a small
 * range. */
static void span_values(const snow_transfer *t, color_bar *bar) {
    bar->low = fmin(t->colors[0].value, t->opacities[0].value);
    bar->high = fmax(t->colors[t->color_count - 1].value,
                     t->opacities[t->opacity_count - 1].value);
    if (bar->low < bar->high)
        return;
    double half = fmax(0.5, fabs(bar->low) / 10);
    bar->low -= half;
    bar->high += half;
}

static double value_at(const color_bar *bar, double y) {
    return bar->to -
           (y - bar->y0) / (bar->y1 - bar->y0) * (bar->to - bar->from);
}

static double place_of(const color_bar *bar, double value) {
    return bar->y0 +
           (bar->high - value) / (bar->high - bar->low) * (bar->y1 - bar->y0);
}

/* Draws a border, and for each row the colour of its middle. */
static snow_status draw_colors(snow_overlay *overlay, const snow_transfer *t,
                               color_bar *bar) {
    const double left = bar->x0, right = bar->x1, top = bar->y0;
    const double bottom = bar->y1;
    int rows = bar->y1 - bar->y0;
    float *colors = NULL;
    SNOW_TRY(SNOW_RESERVE(overlay->context, colors, 0, 3 * rows));
    for (int n = 0; n < rows; n++) {
        double rgba[4];
        snow_transfer_evaluate(t, value_at(bar, bar->y0 + n + 0.5), rgba);
        for (int c = 0; c < 3; c++)
            colors[3 * n + c] = (float)fmin(fmax(rgba[c], 0), 1);
        bar->opaque = fmax(bar->opaque, rgba[3]);
    }
    snow_status status = begin_strokes(overlay, bar->height);
    const double ends[5][2] = {{left, top},
                               {right, top},
                               {right, bottom},
                               {left, bottom},
                               {left, top}};
    for (int n = 0; n < 4 && status == SNOW_STATUS_OK; n++)
        status = snow_overlay_stroke(overlay, ends[n][0], ends[n][1],
                                     ends[n + 1][0], ends[n + 1][1]);
    if (status == SNOW_STATUS_OK)
        status = snow_overlay_rows(overlay, bar->x0, bar->y0, bar->x1, bar->y1,
                                   colors);
    snow_release(overlay->context, colors);
    return status;
}

/* Draws opacity as a line, relative to the largest: even a dense look seldom
 * has more than a tenth in one voxel. */
static snow_status draw_opacity(snow_overlay *overlay, const snow_transfer *t,
                                const color_bar *bar) {
    double radius = fmax(0.5, STROKE / 1.5 * bar->height), before = 0;
    if (!(bar->opaque > 0))
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_overlay_begin(overlay, radius, radius + fmax(0.7, radius)));
    double inner = bar->x1 - bar->x0 - 2 * radius;
    for (int y = bar->y0; y <= bar->y1; y++) {
        double rgba[4], at = fmin(fmax(y, bar->y0 + 0.5), bar->y1 - 0.5);
        snow_transfer_evaluate(t, value_at(bar, at), rgba);
        double x = bar->x0 + radius + inner * fmin(rgba[3] / bar->opaque, 1);
        if (y > bar->y0)
            SNOW_TRY(snow_overlay_stroke(overlay, before, y - 1, x, y));
        before = x;
    }
    return SNOW_STATUS_OK;
}

/* "-1000", "0.25", "1e+07", with as many digits as the step needs; rounding
 * leaves no -0. */
static void write_tick(double value, double step, char *out, size_t size) {
    if (fabs(value) < step / 1000)
        value = 0;
    double digits = value != 0 ? ceil(log10(fabs(value) / step) + 1.5) : 6;
    snprintf(out, size, "%.*g", (int)fmin(fmax(digits, 6), 15), value);
}

/* The multiples of a step within the bar. */
static double count_ticks(const color_bar *bar, double step, double *first) {
    *first = ceil(bar->low / step - 1e-6);
    return floor(bar->high / step + 1e-6) - *first + 1;
}

/* Ticks are two and a half letters apart, or less if there would be fewer than
 * two. */
static double choose_step(const color_bar *bar) {
    double pixel = (bar->high - bar->low) / (bar->y1 - bar->y0), first;
    double step = round_above(2.5 * bar->height * pixel);
    while (count_ticks(bar, step, &first) < 2 &&
           round_below(0.9 * step) > 1.4 * bar->height * pixel)
        step = round_below(0.9 * step);
    while (count_ticks(bar, step, &first) < 1)
        step = round_below(0.9 * step);
    return step;
}

static snow_status draw_ticks(snow_overlay *overlay, const color_bar *bar) {
    double height = bar->height, left = bar->x0, first;
    double step = choose_step(bar), count = count_ticks(bar, step, &first);
    SNOW_TRY(begin_strokes(overlay, height));
    for (double n = 0; n < count; n++) {
        double y = floor(place_of(bar, (first + n) * step)) + 0.5;
        SNOW_TRY(snow_overlay_stroke(overlay, left - 0.5 * height, y, left, y));
    }
    for (double n = 0; n < count; n++) {
        char text[40];
        write_tick((first + n) * step, step, text, sizeof text);
        SNOW_TRY(snow_overlay_text(overlay, left - 0.9 * height,
                                   place_of(bar, (first + n) * step), 1, 0.5,
                                   height, text));
    }
    return SNOW_STATUS_OK;
}

snow_status snow_overlay_color_bar(snow_overlay *overlay,
                                   const snow_transfer *transfer,
                                   const char *unit, const double range[2]) {
    double height = number_height(overlay);
    if (shorter_side(overlay) < BAR_SIDE_LEAST)
        return SNOW_STATUS_OK;
    color_bar bar = {.height = height};
    bar.x1 = overlay->width - (int)height;
    bar.x0 = bar.x1 - (int)(1.4 * height);
    bar.y1 = overlay->height - (int)(1.2 * height);
    bar.y0 = overlay->height / 2 + (int)(2.8 * height);
    span_values(transfer, &bar);
    bar.from = bar.low;
    bar.to = bar.high;
    if (range && range[0] < range[1]) {
        snow_transfer_domain(transfer, &bar.from, &bar.to);
        bar.low = range[0];
        bar.high = range[1];
    }
    size_t first = overlay->shape_count;
    SNOW_TRY(draw_colors(overlay, transfer, &bar));
    if (!range)
        SNOW_TRY(draw_opacity(overlay, transfer, &bar));
    SNOW_TRY(draw_ticks(overlay, &bar));
    SNOW_TRY(snow_overlay_text(overlay, bar.x1, bar.y0 - 0.8 * height, 1, 1,
                               height, unit ? unit : ""));
    snow_overlay_settle_mirrored(overlay, first, false);
    return SNOW_STATUS_OK;
}
