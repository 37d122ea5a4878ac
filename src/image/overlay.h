/* image/overlay.h - shapes over a picture, drawn into its rows. */
#ifndef SNOW_OVERLAY_H
#define SNOW_OVERLAY_H

#include "base/base.h"

#include <snowglass/image.h>

/* A shape: strokes that share one halo, or a rectangle whose rows have
 * colours. */
typedef struct snow_shape {
    bool filled;   /* a rectangle */
    size_t first;  /* index of its numbers; strokes: x0 y0 x1 y1 each, */
    size_t count;  /* for a rectangle: red green blue of each row */
    double radius; /* of strokes and of their dark border */
    double halo;
    double box[4]; /* x0 y0 x1 y1: bounds of the pixels it can touch */
} snow_shape;

struct snow_overlay {
    snow_context *context;
    int width, height;
    bool grey;               /* no shape has a colour */
    const snow_image *below; /* the picture that hides edges, or NULL */
    double strip;            /* pixels at the right that bars take */
    bool boxes;              /* letters that the font lacks were noted */
    snow_shape *shapes;
    size_t shape_count;
    float *numbers;
    size_t number_count;
};

/* Begins a shape of strokes; the following strokes belong to it. */
snow_status snow_overlay_begin(snow_overlay *overlay, double radius,
                               double halo);
snow_status snow_overlay_stroke(snow_overlay *overlay, double x0, double y0,
                                double x1, double y1);

/* Adds a rectangle from pixel (x0, y0) up to, not including, (x1, y1), with
 * three numbers of 0 to 1 for each of its rows, from the top. */
snow_status snow_overlay_rows(snow_overlay *overlay, int x0, int y0, int x1,
                              int y1, const float *colors);

/* Whether shapes from `first` on cover some of the first `before` ones. */
bool snow_overlay_meets(const snow_overlay *overlay, size_t first,
                        size_t before);

/* --- font.c: a stroke font of any size: letters of UTF-8 ---

 * Width of a line of text whose capitals are 1 high, between the middles of the
 * outermost strokes of its first and last letter. */
double snow_font_width(const char *text);

/* Returns whether it has all letters of a text of several lines. */
bool snow_font_has(const char *text);

/* Ends a text that is wider with "...". */
void snow_font_shorten(double width, char *text);

/* Adds a line of text to the current shape: (x, y) is the beginning of its base
 * line, y downwards. */
snow_status snow_font_draw(snow_overlay *overlay, double x, double y,
                           double height, const char *text);

/* --- overlay.c ---

 * Draws the shapes on `count` pixels from (x, y) on: premultiplied, 2 or 4
 * channels; dark on `light`.  NaN becomes a number where a shape covers it. */
void snow_overlay_draw(const snow_overlay *overlay, bool light, int y, int x,
                       int count, int channels, float *pixels);

#endif
