/* render/shear_warp/lines.c - the tiles of the image on the lattice that some
 * lines of the picture need.
 *
 *     picture                 image on the lattice
 *     +-----------+           . . . . . . . . .
 *     |           |           . . . . # # # . .     # needed
 *     |###########| lines     . . # # # # . . .
 *     |           |           # # # # . . . . .
 *     +-----------+           # # . . . . . . .
 *
 * The inverse of the warp maps a tile, and the pixels around it that the warp
 * reads with it, back into the picture. */
#include "render/shear_warp/internal.h"

#include "base/vec3.h"

#include <math.h>

/* Lines of the picture by which a tile may miss the strip: a pixel's places lie
 * half a pixel around its middle. */
#define LINES_SPARE 2

/* What the warp reads around a place, with some to spare. */
#define PIXELS_SPARE 5

/* Where the picture's (1, x, y) falls in the image: rows that make (w, w a, w
 * b). */
static void place_rows(const snow_value_lattice *l, double rows[3][3]) {
    const snow_shear *s = &l->shear;
    for (int n = 0; n < 3; n++) {
        rows[0][n] = l->perspective ? l->scaled.warp[2][n] : n == 0;
        for (int axis = 0; axis < 2; axis++)
            rows[1 + axis][n] = l->perspective ? l->scaled.warp[axis][n]
                                : n == 0       ? s->start[axis]
                                : n == 1       ? s->along_x[axis]
                                               : s->along_y[axis];
    }
}

snow_value_strip snow_value_strip_of(const snow_value_lattice *l,
                                     const int lines[2], int height) {
    snow_value_strip strip = {.low = lines[0] - LINES_SPARE,
                              .high = lines[1] + LINES_SPARE,
                              .border = PIXELS_SPARE + (2 << l->halvings)};
    double rows[3][3], columns[3][3];
    place_rows(l, rows);
    for (int n = 0; n < 3; n++)
        snow_cross(rows[(n + 1) % 3], rows[(n + 2) % 3], columns[n]);
    double det = 0;
    for (int n = 0; n < 3; n++)
        det += rows[0][n] * columns[0][n];
    strip.whole = (lines[0] <= 0 && lines[1] >= height) || det == 0;
    for (int n = 0; n < 3 && !strip.whole; n++) {
        strip.depth[n] = columns[n][0] / det;
        strip.line[n] = columns[n][2] / det;
    }
    return strip;
}

/* In perspective: a tile that is not all before the eye counts as needed. */
bool snow_value_strip_needs(const snow_value_strip *strip,
                            const snow_value_lattice *l, int64_t column,
                            int64_t row) {
    const snow_value_pixels to = snow_value_lattice_pixels(l, 0);
    double low = INFINITY, high = -INFINITY;
    for (int corner = 0; corner < 16 && !strip->whole; corner++) {
        double u = (double)column + (corner & 1 ? SNOW_VALUE_COLUMNS : 0);
        double v = (double)row + (corner & 2 ? SNOW_VALUE_ROWS : 0);
        double a = (double)to.at[0] + u * (double)to.along_u[0] +
                   v * (double)to.along_v[0] +
                   (corner & 4 ? strip->border : -strip->border);
        double b = (double)to.at[1] + u * (double)to.along_u[1] +
                   v * (double)to.along_v[1] +
                   (corner & 8 ? strip->border : -strip->border);
        double depth =
            strip->depth[0] + a * strip->depth[1] + b * strip->depth[2];
        double line = strip->line[0] + a * strip->line[1] + b * strip->line[2];
        if (!(depth > 0))
            return true;
        low = fmin(low, line / depth);
        high = fmax(high, line / depth);
    }
    return strip->whole || (low <= strip->high && high >= strip->low);
}
