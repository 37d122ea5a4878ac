/* warp/perspective.c - lines of the picture in perspective.
 *
 * Along a line of the picture both coordinates in the intermediate image are
 * quotients of linear functions with the same denominator: one division a
 * pixel. */
#include "warp/empty.h"

#include <math.h>
#include <string.h>

#define CHUNK 16 /* pixels that are warped or skipped together */

/* Narrows [*low, *high] to the numbers x with zero + x * slope >= 0. */
static void cut_below(double zero, double slope, double *low, double *high) {
    double root = -zero / slope;
    if (slope > 0)
        *low = fmax(*low, root);
    else if (slope < 0)
        *high = fmin(*high, root);
    else if (!(zero >= 0))
        *high = *low - 1;
}

/* The pixels of a line whose place is within the intermediate image, rounding
 * included: its border is wider than half a pixel. */
static void cut_line(const snow_intermediate_view *plane, double line[3][2],
                     int before, double *low, double *high) {
    const int sides[2] = {plane->width, plane->height};
    cut_below(line[2][0], line[2][1], low, high);
    for (int i = 0; i < 2; i++) {
        double least = before + 0.5, most = sides[i] - 2.5 - before;
        cut_below(line[i][0] - least * line[2][0],
                  line[i][1] - least * line[2][1], low, high);
        cut_below(most * line[2][0] - line[i][0],
                  most * line[2][1] - line[i][1], low, high);
    }
}

static inline void place_pixel(double line[3][2], int x, int64_t place[2]) {
    double scale = 0x1p32 / (line[2][0] + x * line[2][1]);
    place[0] = (int64_t)((line[0][0] + x * line[0][1]) * scale);
    place[1] = (int64_t)((line[1][0] + x * line[1][1]) * scale);
}

/* Pixels x .. x + count - 1 of a line, within the intermediate image. */
static void warp_run(const snow_blocks *blocks, double line[3][2],
                     snow_warp_places_fn *warp, int x, int count,
                     float *pixels) {
    const snow_intermediate_view *plane = blocks->plane;
    int64_t places[CHUNK][2];
    place_pixel(line, x, places[0]);
    place_pixel(line, x + count - 1, places[count - 1]);
    if (!snow_blocks_drawn(blocks, places[0], places[count - 1])) {
        memset(pixels, 0, (size_t)(count * plane->channels) * sizeof *pixels);
        return;
    }
    for (int n = 1; n < count - 1; n++)
        place_pixel(line, x + n, places[n]);
    warp(plane, (const int64_t(*)[2])places, count, pixels);
}

/* Pixels first .. last of a line, at least one, in chunks. */
static void warp_runs(const snow_intermediate_view *plane, double line[3][2],
                      snow_warp_places_fn *warp, int first, int last,
                      float *pixels) {
    const snow_blocks blocks = snow_blocks_of(plane);
    for (int x = first; x <= last; x += CHUNK)
        warp_run(&blocks, line, warp, x,
                 last - x + 1 < CHUNK ? last - x + 1 : CHUNK,
                 pixels + (size_t)(x * plane->channels));
}

void snow_warp_row_perspective(const snow_intermediate_view *plane,
                               const snow_perspective_shear *scaled,
                               snow_filter filter, snow_warp_places_fn *warp,
                               int y, int from, int to, float *pixels) {
    double line[3][2], low = from, high = to - 1;
    for (int i = 0; i < 3; i++) {
        line[i][1] = scaled->warp[i][1];
        line[i][0] = scaled->warp[i][0] + 0.5 * line[i][1] +
                     (y + 0.5) * scaled->warp[i][2];
    }
    cut_line(plane, line, filter == SNOW_CATMULL_ROM ? 1 : 0, &low, &high);
    int first, last;
    if (snow_clear_outside(from, to, low, high, plane->channels, pixels, &first,
                           &last))
        warp_runs(plane, line, warp, first, last, pixels);
}
