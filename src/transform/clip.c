/* transform/clip.c - see clip.h.
 *
 * From slice to slice a border moves over the pixels in one direction only,
 * even with rounding, since each operation from slice number to pixel is
 * monotone. */
#include "transform/clip.h"

#include "base/vec3.h"
#include "volume/volume.h"

#include <math.h>
#include <string.h>

void snow_clip_make(const snow_volume *volume, const snow_placement *whole,
                    snow_clip *out) {
    const int axes[3] = {whole->u_axis, whole->v_axis, whole->slice_axis};
    snow_extent part;
    *out = (snow_clip){0};
    snow_volume_find_extent(volume, &part);
    bool none = !part.count[0] || !part.count[1] || !part.count[2];
    for (int n = 0; n < 3; n++) {
        out->stored[n] = part.stored[axes[n]];
        out->size[n] = volume->info.dims[axes[n]];
        out->first[n] = none ? out->stored[n] : part.first[axes[n]];
        out->count[n] = none ? 0 : part.count[axes[n]];
    }
    for (int n = 0; n < 2 && !none; n++) {
        int64_t end = out->first[n] + out->count[n];
        bool at_start = out->first[n] == 0;
        bool at_end = end == part.dims[axes[n]];
        out->low[n] = at_start ? -INFINITY : (double)out->first[n] - 0.5;
        out->high[n] = at_end ? INFINITY : (double)end - 0.5;
        out->cuts = out->cuts || !at_start || !at_end;
    }
}

void snow_clip_placement(const snow_clip *clip, const snow_placement *whole,
                         snow_placement *out) {
    snow_placement p = *whole;
    const double *steps[3] = {whole->step_u, whole->step_v, whole->step_slice};
    p.columns = clip->size[0];
    p.rows = clip->size[1];
    p.slices = clip->size[2];
    for (int n = 0; n < 3; n++) {
        for (int i = 0; i < 2; i++)
            p.origin[i] += (double)clip->stored[n] * steps[n][i];
        p.eye.at[n] -= (double)clip->stored[n];
        p.eye.middle[n] -= (double)clip->stored[n];
    }
    *out = p;
}

/* --- the picture ---------------------------------------------------------- */

/* The shift of a ray along u or v from slice to slice, negated. */
static double slope_of(const snow_placement *p, int axis) {
    const double *row = p->inverse[axis];
    return row[0] * p->step_slice[0] + row[1] * p->step_slice[1];
}

/* Grid position where the ray through a point of the picture meets a slice. */
static double position_of(const snow_placement *p, int axis, double slice,
                          double x, double y) {
    if (!p->perspective) {
        const double *row = p->inverse[axis];
        double zero = row[0] * (x - p->origin[0]) + row[1] * (y - p->origin[1]);
        return zero - slice * slope_of(p, axis);
    }
    double ray[3];
    snow_perspective_ray(&p->eye, x, y, ray);
    return p->eye.at[axis] + (slice - p->eye.at[2]) * (ray[axis] / ray[2]);
}

void snow_clip_pixels(const snow_clip *clip, const snow_placement *whole,
                      int64_t slice, int x, int y, int count, int channels,
                      float *pixels) {
    size_t pixel = (size_t)channels;
    for (int n = 0; n < count; n++) {
        bool own = true;
        for (int axis = 0; axis < 2; axis++) {
            double at =
                position_of(whole, axis, (double)slice, x + n + 0.5, y + 0.5);
            own = own && at >= clip->low[axis] && at < clip->high[axis];
        }
        if (!own)
            memset(pixels + (size_t)n * pixel, 0, pixel * sizeof *pixels);
    }
}

void snow_clip_viewer(const snow_placement *p, snow_viewer *out) {
    const int axes[3] = {p->u_axis, p->v_axis, p->slice_axis};
    double away = p->nearest_first ? 1 : -1;
    const double along[3] = {-slope_of(p, 0) * away, -slope_of(p, 1) * away,
                             away};
    *out = (snow_viewer){.perspective = p->perspective};
    for (int n = 0; n < 3; n++) {
        out->along[axes[n]] = along[n];
        out->eye[axes[n]] = p->eye.at[n];
    }
}

/* --- cut faces ------------------------------------------------------------ */

float snow_clip_flatness(const snow_clip_planes *clip,
                         const snow_viewer *viewer, const double at[3]) {
    double along[3], flat = 0;
    for (int axis = 0; axis < 3; axis++)
        along[axis] = viewer->perspective ? at[axis] - viewer->eye[axis]
                                          : viewer->along[axis];
    snow_normalize(along);
    for (size_t n = 0; clip && n < clip->plane_count; n++) {
        const double *plane = clip->planes[n];
        double below = plane[3] - snow_dot(plane, at);
        double deeper = -snow_dot(plane, along);
        if (deeper > 0)
            flat = fmax(flat, 2 - below / deeper / SNOW_FLAT_DEPTH);
    }
    return (float)fmin(flat, 1);
}
