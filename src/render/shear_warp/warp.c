/* render/shear_warp/warp.c - shear-warp's last step: the intermediate
 * image, or the lines of it that a processor was given by the exchange (section
 * 4 of the paper), to the picture.
 *
 * Each pixel of the picture is warped by the processor that has the line of the
 * intermediate image which the pixel falls on.  Along a line of the picture
 * that line only rises or only falls, so that a processor's pixels are a run.
 */
#include "render/shear_warp/intermediate.h"
#include "render/shear_warp/warping.h"

#include <math.h>
#include <string.h>

void snow_shear_warp_warp(const snow_shear_warp_warping *w, int y, int from,
                          int to, float *spare, float *pixels) {
    if (w->line)
        w->line(w, y, from, to, spare, pixels);
    else if (w->perspective)
        snow_warp_row_perspective(&w->plane, &w->scaled, w->filter, w->places,
                                  y, from, to, pixels);
    else
        snow_warp_row(&w->plane, &w->shear, w->filter, w->warp, y, from, to,
                      pixels);
}

/* --- pieces --------------------------------------------------------------- */

void snow_shear_warp_clear(const snow_shear_warp_image *image, int layer,
                           int x0, int y0, int x1, int y1) {
    size_t block = (size_t)(image->tile_width * image->channels);
    for (int y = y0; y < y1; y++) {
        int first = y * image->tile_height, left = image->height - first;
        int lines = left < image->tile_height ? left : image->tile_height;
        float *pixels = image->pixels + (size_t)layer * image->layer_floats +
                        (size_t)first * image->stride;
        const unsigned char *drawn = image->drawn +
                                     (size_t)layer * image->layer_tiles +
                                     (size_t)y * (size_t)image->tiles;
        for (int x = x0; x < x1; x++)
            for (int n = 0; !drawn[x] && n < lines; n++)
                memset(pixels + (size_t)n * image->stride + (size_t)x * block,
                       0, block * sizeof *pixels);
    }
}

void snow_shear_warp_put_lines(const snow_shear_warp_image *image, int first,
                               int count, const float *pixels) {
    size_t floats = (size_t)(image->width * image->channels);
    size_t block = (size_t)(image->tile_width * image->channels);
    for (int line = first; line < first + count; line++, pixels += floats) {
        unsigned char *drawn =
            image->drawn + line / image->tile_height * image->tiles;
        memcpy(image->pixels + (size_t)line * image->stride, pixels,
               floats * sizeof *pixels);
        for (size_t x = 0; x * block < floats; x++) {
            size_t left = floats - x * block;
            size_t end = x * block + (left < block ? left : block);
            for (size_t n = x * block; n < end && !drawn[x]; n++)
                drawn[x] = pixels[n] != 0;
        }
    }
}

/* Returns where pixel x of a line of the picture falls in the intermediate
 * image. */
static double line_of_place(const snow_shear_warp_warping *w, int x, int y) {
    if (!w->perspective)
        return floor(w->shear.start[1] + x * w->shear.along_x[1] +
                     y * w->shear.along_y[1]);
    const double *row = w->scaled.warp[1], *depth = w->scaled.warp[2];
    double across = x + 0.5, down = y + 0.5;
    return floor((row[0] + across * row[1] + down * row[2]) /
                 (depth[0] + across * depth[1] + down * depth[2]));
}

/* One that is a mean may reach lines of the image from outside. */
static double line_of_pixel(const snow_shear_warp_warping *w, int x, int y) {
    double line = line_of_place(w, x, y);
    return w->line ? fmin(fmax(line, 0), w->plane.height - 1) : line;
}

/* In perspective: the pixels of a line that see the plane of the image, which
 * are a run. */
static void seeing_pixels(const snow_shear_warp_warping *w, int y,
                          int range[2]) {
    range[0] = 0;
    range[1] = w->width;
    if (!w->perspective)
        return;
    const double *depth = w->scaled.warp[2];
    double zero = depth[0] + (y + 0.5) * depth[2];
    while (range[0] < range[1] && !(zero + (range[0] + 0.5) * depth[1] > 0))
        range[0]++;
    while (range[0] < range[1] && !(zero + (range[1] - 0.5) * depth[1] > 0))
        range[1]--;
}

/* Narrows low .. high to a few pixels around that at which line `line` begins,
 * which follows from the map where there is no perspective. */
static void narrow(const snow_shear_warp_warping *w, int y, bool rising,
                   int line, int *low, int *high) {
    const double along = w->shear.along_x[1];
    const double at =
        (line - w->shear.start[1] - y * w->shear.along_y[1]) / along;
    if (w->perspective || w->line || !(at > *low && at < *high))
        return;
    const int middle = (int)at, before = middle > *low ? middle - 1 : *low;
    const int behind = middle + 2 < *high ? middle + 2 : *high - 1;
    if ((line_of_pixel(w, before, y) >= line) != rising)
        *low = before + 1;
    if ((line_of_pixel(w, behind, y) >= line) == rising)
        *high = behind;
}

/* The first pixel of `seen` that falls on line `line` or beyond, where lines
 * rise; where they fall, on one before it. */
static int first_pixel(const snow_shear_warp_warping *w, int y,
                       const int seen[2], bool rising, int line) {
    int low = seen[0], high = seen[1];
    narrow(w, y, rising, line, &low, &high);
    while (low < high) {
        int middle = low + (high - low) / 2;
        if ((line_of_pixel(w, middle, y) >= line) == rising)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

/* Borders are found from the line alone, so that two who share one agree. */
void snow_shear_warp_pixels_of(const snow_shear_warp_image *image, int y,
                               int first, int end, int range[2]) {
    const snow_shear_warp_warping *w = image->warping;
    int seen[2];
    seeing_pixels(w, y, seen);
    range[0] = range[1] = seen[0];
    if (seen[0] >= seen[1] || first >= end)
        return;
    bool rising =
        line_of_pixel(w, seen[0], y) <= line_of_pixel(w, seen[1] - 1, y);
    range[0] = first_pixel(w, y, seen, rising, rising ? first : end);
    range[1] = first_pixel(w, y, seen, rising, rising ? end : first);
}
