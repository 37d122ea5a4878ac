/* image/font.h - a stroke font of our own: ASCII, any size. */
#ifndef SNOW_FONT_H
#define SNOW_FONT_H

#include "image/overlay.h"

/* Width of a line of text whose capitals are 1 high, from the outer borders of
 * its first and its last letter's strokes' middles. */
double snow_font_width(const char *text);

/* Adds a line of text to the shape in hand: (x, y) is where its base line
 * begins, y downwards. */
snow_status snow_font_draw(snow_overlay *overlay, double x, double y,
                           double height, const char *text);

#endif
