/* transform/shear_perspective.c - the geometry of the intermediate image in
 * perspective.
 */
#include "transform/shear_perspective.h"

#include <math.h>

/* The limit is that of transform/shear.c. */
#define LONGEST_SIDE (1 << 20)
#define BORDER 4

double snow_perspective_shear_ratio(const snow_placement *p) {
    double ends[2];
    /* Heights of the first and the last slice above the eye. */
    ends[0] = -p->eye.at[2];
    ends[1] = (double)(p->slices - 1) - p->eye.at[2];
    double near = fmin(fabs(ends[0]), fabs(ends[1]));
    double far = fmax(fabs(ends[0]), fabs(ends[1]));
    if (!(ends[0] * ends[1] > 0) || near < 1)
        return INFINITY;
    return far / near;
}

/* The picture's range along an axis; infinite if it shows the eye's plane. */
static void visible_range(const snow_placement *p, double height, int axis,
                          double range[2]) {
    double low = INFINITY, high = -INFINITY;
    for (int corner = 0; corner < 4; corner++) {
        double ray[3];
        snow_perspective_ray(&p->eye, corner & 1 ? p->width : 0,
                             corner & 2 ? p->height : 0, ray);
        if (!(ray[2] * height > 0)) {
            range[0] = -INFINITY;
            range[1] = INFINITY;
            return;
        }
        double at = p->eye.at[axis] + height * ray[axis] / ray[2];
        low = fmin(low, at);
        high = fmax(high, at);
    }
    range[0] = low;
    range[1] = high;
}

static bool make_axis(const snow_placement *p,
                      const snow_perspective_shear *scaled, int axis,
                      const double covered[2],
                      snow_perspective_shear_axis *out) {
    double seen[2];
    visible_range(p, scaled->height, axis, seen);
    /* The warp reads two pixels beyond the pixel of its place. */
    double from = fmax(covered[0] / out->pitch, seen[0] / out->pitch - 3);
    double to = fmin(covered[1] / out->pitch, seen[1] / out->pitch + 3);
    out->eye = p->eye.at[axis];
    out->count = 0;
    out->first = 0;
    if (!(from <= to))
        return true;
    double first = floor(from) - BORDER;
    double count = ceil(to) + BORDER - first + 1;
    if (!(count <= LONGEST_SIDE) || !(fabs(first) < 1e9))
        return false;
    out->first = (int64_t)first;
    out->count = (int)count;
    return true;
}

/* u = eu + height ray_u / ray_k; warp[2] has the sign of the visible side. */
static void place_warp(const snow_placement *p,
                       snow_perspective_shear *scaled) {
    const snow_perspective_shear_axis *axes[2] = {&scaled->u, &scaled->v};
    double side = scaled->height > 0 ? 1 : -1;
    for (int n = 0; n < 3; n++) {
        double ray_k = side * p->eye.ray[2][n];
        for (int i = 0; i < 2; i++) {
            double zero =
                axes[i]->eye / axes[i]->pitch - (double)axes[i]->first;
            scaled->warp[i][n] = zero * ray_k + side * scaled->height /
                                                    axes[i]->pitch *
                                                    p->eye.ray[i][n];
        }
        scaled->warp[2][n] = ray_k;
    }
}

snow_status snow_perspective_shear_cover(snow_context *context,
                                         const snow_placement *p, double height,
                                         const double pitch[2],
                                         double covered[2][2],
                                         snow_perspective_shear *out) {
    snow_perspective_shear scaled = {
        .u = {.pitch = pitch[0]}, .v = {.pitch = pitch[1]}, .height = height};
    if (!make_axis(p, &scaled, 0, covered[0], &scaled.u) ||
        !make_axis(p, &scaled, 1, covered[1], &scaled.v))
        return snow_fail(
            context, SNOW_STATUS_BAD_USAGE,
            "the intermediate image is too large: the limit is 1048576 pixels "
            "a side; use the method footprint or a smaller zoom");
    place_warp(p, &scaled);
    *out = scaled;
    return SNOW_STATUS_OK;
}
