/* image/font.h - a stroke font: ASCII, any size. */
#ifndef SNOW_FONT_H
#define SNOW_FONT_H

#include "image/overlay.h"

/* Width of a line of text whose capitals are 1 high, between the middles of the
 * outermost strokes of its first and last letter. */
double snow_font_width(const char *text);

/* Adds a line of text to the current shape: (x, y) is the beginning of its base
 * line, y downwards. */
snow_status snow_font_draw(snow_overlay *overlay, double x, double y,
                           double height, const char *text);

#endif
