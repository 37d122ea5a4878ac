/* annotate/color_bar.c - explains the colours of a picture: a bar with ticks
 * and the curve of opacity. */
#include "annotate/strokes.h"
#include "transfer/scale.h"
#include "transfer/transfer.h"

#include <snowglass/extend.h>
#include <snowglass/overlay.h>

#include <stdio.h>
#include <string.h>

/* Of the width, that a name takes at most. */
#define NAME_MOST 0.4

/* Heights of letters that a bar is high, at least. */
#define BAR_LEAST 2

/* The most ticks: of a short scale by decades. */
#define TICKS 64

/* The position of the bar, in whole pixels, and what it shows. */
typedef struct color_bar {
    int x0, y0, x1, y1;
    double low, high; /* data values of the lower and the upper end */
    double from, to;  /* the data values that have these colours */
    snow_scale scale; /* of the values between the ends */
    double opaque;    /* largest opacity in the bar */
    double height;    /* height of the letters */
} color_bar;

/* --- the strip ------------------------------------------------------------ */

/* Widens the strip for a line that ends at a pixel. */
static void widen_strip(snow_overlay *overlay, double right, double height,
                        const char *text) {
    const double left = right - height * snow_font_width(text);
    overlay->strip = fmax(overlay->strip,
                          overlay->width - left + SNOW_STRIP_MARGIN * height);
}

/* The upper and the lower end of the place of bar n of some, from the lowest
 * on. */
static void find_slot(const snow_overlay *overlay, int n, int count,
                      double slot[2]) {
    const double height = snow_number_height(overlay);
    const double low = overlay->height - SNOW_STRIP_BELOW * height;
    const double each = (low - height) / fmax(count, 2);
    slot[1] = low - n * each;
    slot[0] = slot[1] - each;
}

/* The right end of lines in the strip. */
static int right_of(const snow_overlay *overlay) {
    return overlay->width -
           (int)(SNOW_STRIP_MARGIN * snow_number_height(overlay) + 0.5);
}

/* From the first to the last control point; a single value gets a small
 * range. */
static void span_values(const snow_transfer *t, color_bar *bar) {
    bar->low = fmin(t->colors[0].value, t->opacities[0].value);
    bar->high = fmax(t->colors[t->color_count - 1].value,
                     t->opacities[t->opacity_count - 1].value);
    if (bar->low < bar->high)
        return;
    double half = t->log ? bar->low / 2 : fmax(0.5, fabs(bar->low) / 10);
    bar->low -= half;
    bar->high += half;
}

static bool is_linear(const color_bar *bar) {
    return !bar->scale.log && !(bar->scale.linear > 0);
}

static double value_at(const color_bar *bar, double y) {
    double share = (y - bar->y0) / (bar->y1 - bar->y0);
    if (is_linear(bar))
        return bar->to - share * (bar->to - bar->from);
    return snow_between_on(bar->scale, bar->from, bar->to, 1 - share);
}

static double place_of(const color_bar *bar, double value) {
    double share = (bar->high - value) / (bar->high - bar->low);
    if (!is_linear(bar))
        share = 1 - snow_share_on(bar->scale, bar->low, bar->high, value);
    return bar->y0 + share * (bar->y1 - bar->y0);
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
    snow_status status = snow_begin_strokes(overlay, bar->height);
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
    double radius = fmax(0.5, SNOW_STROKE / 1.5 * bar->height), before = 0;
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

/* --- ticks ---------------------------------------------------------------- */

/* The smallest number of the form 1, 2 or 5 times a power of ten that is not
 * below a length. */
static double round_above(double length) {
    double below = snow_round_below(length);
    if (below >= length * (1 - 1e-9))
        return below;
    return snow_round_below(2.5 * below) > below ? snow_round_below(2.5 * below)
                                                 : snow_round_below(2 * below);
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
           snow_round_below(0.9 * step) > 1.4 * bar->height * pixel)
        step = snow_round_below(0.9 * step);
    while (count_ticks(bar, step, &first) < 1)
        step = snow_round_below(0.9 * step);
    return step;
}

/* Values with a number, and strokes without one between them. */
typedef struct bar_ticks {
    double numbers[TICKS], strokes[TICKS];
    int number_count, stroke_count;
    double step; /* between numbers; 0: each is one digit */
} bar_ticks;

/* A number without room beside those before it is a stroke. */
static void add_tick(const color_bar *bar, double value, bool number,
                     bar_ticks *ticks) {
    for (int n = 0; n < ticks->number_count && number; n++)
        number = fabs(place_of(bar, value) - place_of(bar, ticks->numbers[n])) >
                 1.4 * bar->height;
    int *count = number ? &ticks->number_count : &ticks->stroke_count;
    const bool within =
        value >= bar->low * (1 - 1e-9 * copysign(1, bar->low)) &&
        value <= bar->high * (1 + 1e-9 * copysign(1, bar->high));
    if (within && *count < TICKS)
        (number ? ticks->numbers : ticks->strokes)[(*count)++] = value;
}

static void find_even_ticks(const color_bar *bar, bar_ticks *ticks) {
    double first;
    ticks->step = choose_step(bar);
    double count = count_ticks(bar, ticks->step, &first);
    for (double n = 0; n < count; n++)
        add_tick(bar, (first + n) * ticks->step, true, ticks);
}

/* Pixels of the decade that ends at the greatest magnitude. */
static double pixels_of_decade(const color_bar *bar) {
    double top = fmax(fabs(bar->low), fabs(bar->high));
    double side = fabs(bar->high) >= top ? 1 : -1;
    return fabs(place_of(bar, side * top) - place_of(bar, side * top / 10));
}

/* Adds decade `power` on one side of 0: its number, or a stroke where there is
 * no room for all; and what room allows between it and the next. */
static void add_decade(const color_bar *bar, int power, int each, double side,
                       bar_ticks *ticks) {
    double capacity = pixels_of_decade(bar) / bar->height, ten = pow(10, power);
    bool number = power % each == 0;
    add_tick(bar, side * ten, number, ticks);
    for (int n = 2; n < 10 && capacity > 2.5; n++)
        add_tick(bar, side * n * ten,
                 capacity > 8 && (n == 5 || (n == 2 && capacity > 10)), ticks);
}

/* Decades above the least magnitude of the scale, on both sides of 0. */
static void find_decades(const color_bar *bar, bar_ticks *ticks) {
    double least = bar->scale.log ? bar->low : bar->scale.linear;
    double most = fmax(fabs(bar->low), fabs(bar->high));
    int first = (int)floor(log10(least) + (bar->scale.log ? 0 : 1 - 1e-9));
    int last = (int)floor(log10(most) + 1e-9);
    int each = (int)fmax(1, ceil(1.8 * bar->height / pixels_of_decade(bar)));
    if (!bar->scale.log)
        add_tick(bar, 0, true, ticks);
    for (int power = first; power <= last; power++)
        for (double side = -1; side <= 1; side += 2)
            add_decade(bar, power, each, side, ticks);
}

/* A scale with fewer than two numbers by decades gets even ones. */
static void find_ticks(const color_bar *bar, bar_ticks *ticks) {
    *ticks = (bar_ticks){.step = 0};
    if (!is_linear(bar))
        find_decades(bar, ticks);
    if (ticks->number_count >= 2)
        return;
    *ticks = (bar_ticks){.step = 0};
    find_even_ticks(bar, ticks);
}

static snow_status draw_stroke(snow_overlay *overlay, const color_bar *bar,
                               double value, double length) {
    double y = floor(place_of(bar, value)) + 0.5;
    return snow_overlay_stroke(overlay, bar->x0 - length * bar->height, y,
                               bar->x0, y);
}

static snow_status draw_ticks(snow_overlay *overlay, const color_bar *bar) {
    bar_ticks ticks;
    find_ticks(bar, &ticks);
    SNOW_TRY(snow_begin_strokes(overlay, bar->height));
    for (int n = 0; n < ticks.number_count; n++)
        SNOW_TRY(draw_stroke(overlay, bar, ticks.numbers[n], 0.5));
    for (int n = 0; n < ticks.stroke_count; n++)
        SNOW_TRY(draw_stroke(overlay, bar, ticks.strokes[n], 0.25));
    for (int n = 0; n < ticks.number_count; n++) {
        char text[40];
        double value = ticks.numbers[n];
        /* "-1000", "0.25", "1e+07", with as many digits as the step needs;
         * rounding leaves no -0. */
        const double step = ticks.step > 0 ? ticks.step : fabs(value);
        const double shown = fabs(value) < step / 1000 ? 0 : value;
        double digits = shown != 0 ? ceil(log10(fabs(shown) / step) + 1.5) : 6;
        snow_text_print(text, sizeof text, "%.*g",
                        (int)fmin(fmax(digits, 6), 15), shown);
        const double right = bar->x0 - 0.8 * bar->height;
        widen_strip(overlay, right, bar->height, text);
        SNOW_TRY(snow_overlay_text(overlay, right, place_of(bar, value), 1, 0.5,
                                   bar->height, text));
    }
    return SNOW_STATUS_OK;
}

/* --- labels --------------------------------------------------------------- */

/* A square of a colour, and the name left of it. */
static snow_status draw_label(snow_overlay *overlay, const snow_label *label,
                              double height, double y) {
    const int right = right_of(overlay);
    const int left = right - (int)(1.2 * height), top = (int)y;
    const int rows = (int)(1.2 * height);
    float colors[3 * 4096];
    char text[64];
    snprintf(text, sizeof text, "%s", label->name);
    if (!*text)
        snow_text_print(text, sizeof text, "%.9g", label->value);
    snow_font_shorten(NAME_MOST * overlay->width / height - 3, text);
    for (int n = 0; n < 3 * rows; n++)
        colors[n] = (float)label->color[n % 3];
    widen_strip(overlay, left - 0.6 * height, height, text);
    SNOW_TRY(snow_overlay_rows(overlay, left, top, right, top + rows, colors));
    return snow_overlay_text(overlay, left - 0.6 * height, y + rows / 2.0, 1,
                             0.5, height, text);
}

/* Those that are seen, from the lower end of their place on up, as far as it
 * has room. */
static snow_status draw_labels(snow_overlay *overlay, const snow_transfer *t,
                               const double slot[2]) {
    const double height = snow_number_height(overlay), step = 1.7 * height;
    size_t seen = 0, capacity = (size_t)((slot[1] - slot[0]) / step), drawn = 0;
    for (size_t n = 0; n < t->label_count; n++)
        seen += t->labels[n].color[3] > 0;
    size_t rows = seen < capacity ? seen : capacity;
    if (seen && !rows)
        snow_notify(overlay->context,
                    "the picture has no room for the names of the labels");
    double y = slot[1] - step * (double)rows;
    for (size_t n = 0; n < t->label_count && drawn < rows; n++) {
        if (!(t->labels[n].color[3] > 0))
            continue;
        if (++drawn == rows && rows < seen)
            return snow_overlay_text(overlay, right_of(overlay), y, 1, 0,
                                     height, "...");
        SNOW_TRY(draw_label(overlay, &t->labels[n], height, y));
        y += step;
    }
    return SNOW_STATUS_OK;
}

/* --- the bar -------------------------------------------------------------- */

/* Writes a caption in lines that are no wider than the strip, where words
 * allow, and returns the lower end of the last one. */
static snow_status draw_caption(snow_overlay *overlay, const char *caption,
                                double height, double *y) {
    const double edge = SNOW_STRIP_MARGIN * height;
    const double room = fmax(overlay->strip, SNOW_STRIP_LEAST * overlay->width);
    const int right = right_of(overlay);
    char line[256];
    for (const char *at = caption; *at; at += strspn(at, " ")) {
        size_t length = strcspn(at, " ");
        for (size_t next = length; at[next];) {
            next += strspn(at + next, " ");
            next += strcspn(at + next, " ");
            snprintf(line, sizeof line, "%.*s", (int)next, at);
            if (height * snow_font_width(line) > room - 2 * edge)
                break;
            length = next;
        }
        snprintf(line, sizeof line, "%.*s", (int)length, at);
        snow_font_shorten(NAME_MOST * overlay->width / height - 1.2, line);
        widen_strip(overlay, right, height, line);
        SNOW_TRY(snow_overlay_text(overlay, right, *y, 1, 0, height, line));
        *y += 1.5 * height;
        at += length;
    }
    return SNOW_STATUS_OK;
}

snow_status snow_overlay_color_bar(snow_overlay *overlay,
                                   const snow_transfer *transfer,
                                   const char *unit, const double range[2],
                                   int n, int count) {
    double height = snow_number_height(overlay), slot[2];
    if (n < 0 || n >= count)
        return snow_fail(overlay->context, SNOW_STATUS_BAD_USAGE,
                         "there is no color bar %d of %d; count from 0", n,
                         count);
    if (snow_shorter_side(overlay) < SNOW_BAR_SIDE_LEAST)
        return SNOW_STATUS_OK;
    find_slot(overlay, n, count, slot);
    if (transfer->labels && !range) {
        slot[0] = count > 1 ? slot[0] : height;
        return draw_labels(overlay, transfer, slot);
    }
    color_bar bar = {.height = height};
    bar.x1 = right_of(overlay);
    bar.x0 = bar.x1 - (int)(1.2 * height);
    span_values(transfer, &bar);
    bar.from = bar.low;
    bar.to = bar.high;
    if (range && range[0] < range[1]) {
        snow_transfer_domain(transfer, &bar.from, &bar.to);
        bar.low = range[0];
        bar.high = range[1];
    }
    if (!transfer->log || bar.low > 0)
        bar.scale = (snow_scale){transfer->log, transfer->linear};
    const size_t first = overlay->shape_count;
    double y = slot[0];
    SNOW_TRY(draw_caption(overlay, unit ? unit : "", height, &y));
    bar.y0 = (int)(y + height);
    bar.y1 = (int)(slot[1] - height);
    if (bar.y1 - bar.y0 >= BAR_LEAST * height) {
        SNOW_TRY(draw_colors(overlay, transfer, &bar));
        if (!range)
            SNOW_TRY(draw_opacity(overlay, transfer, &bar));
        return draw_ticks(overlay, &bar);
    }
    overlay->shape_count = first;
    snow_notify(overlay->context,
                "the picture has no room for the colour bar%s%s",
                unit && *unit ? " of " : "", unit ? unit : "");
    return SNOW_STATUS_OK;
}
