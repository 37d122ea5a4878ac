/* render/ghosts.c - how many layers of its neighbours' voxels a part needs.
 *
 * A part that owns voxels a to b along an axis makes the samples of sheets at
 * grid positions [a - 1/2, b + 1/2) (section 4 of the paper, with boxes in the
 * place of slabs).  A kernel that reaches h voxels sums voxels down to
 * a - 1/2 - h, and a gradient, of shading or of opacity, takes one more:
 *
 *        a - 3   a - 2   a - 1 |  a    a + 1
 *          o       o       o   |  *      *        h = 2: layers a - 1, a - 2,
 *         grad   <------ h --->                   and a - 3 with shading
 *
 * Along the slice axis footprints do not reach.  A pixel wider than a voxel
 * widens the kernel, and how wide it is depends on the view.  What values need
 * is said with layers_beside and layers_across, rays of surfaces with
 * layers_of_rays. */
#include "render/ghosts.h"

#include "base/vec3.h"
#include "render/job.h"
#include "render/shear_warp/lattice.h"
#include "splat/kernel.h"
#include "transform/shear_perspective.h"

#include <math.h>
#include <string.h>

/* What is asked. */
typedef struct question {
    snow_context *context;
    const snow_volume_info *whole;
    const snow_view *view;
    const snow_settings *settings; /* resolved */
    int gradients;                 /* of voxels are wanted: how far they look */
} question;

static void at_least(int64_t *layers, double wanted, int64_t most) {
    if (wanted >= (double)most) /* perhaps far beyond what an integer holds */
        *layers = most;
    else if (wanted > (double)*layers)
        *layers = (int64_t)wanted;
}

/* A cubic kernel reaches one voxel more, in the plane and across it. */
static int cubic(const question *q) {
    return q->settings->kernel == SNOW_KERNEL_BSPLINE;
}

/* How a picture is made: values are splatted where encodings provide for the
 * view; else, and for depths, footprints are, or rays of surfaces walked. */
typedef struct ways {
    bool values, footprints, rays;
} ways;

static ways ways_of(const question *q, bool fits) {
    bool iso = q->settings->mode == SNOW_MODE_ISO;
    bool values = fits && q->settings->method == SNOW_METHOD_SHEAR_WARP;
    bool others = !values || q->settings->depth;
    return (ways){values, others && !iso, others && iso};
}

/* Layers along an axis that lies in the slices, whose pixels are `width` voxels
 * wide; from slice to slice rays go `slope` voxels aside. */
static double layers_beside(const question *q, ways by, double ratio,
                            double width, double slope) {
    /* Rays look from one end of a step to the one before, half a voxel away at
     * most. */
    double values = 0, footprints = 0;
    double rays = by.rays ? 1 + cubic(q) + q->gradients : 0;
    /* Gradients of values look so far in the plane: in perspective a voxel and
     * a half, and no less than the samples of the last sheet are apart, which
     * is `ratio` times as far from the eye as the first. */
    double plane = q->gradients;
    if (q->gradients && q->view->fov != 0)
        plane = fmax(plane + 1, fmin(ceil(ratio), SNOW_VALUE_SPREAD_MOST));
    if (by.values)
        values =
            1 + cubic(q) + plane + fmin(ceil(slope), SNOW_VALUE_REACH_MOST);
    if (by.footprints) {
        snow_scaled_kernel kernel = snow_scaled_kernel_make(
            q->settings->kernel, q->settings->footprint, width);
        footprints =
            floor(snow_scaled_kernel_reach(&kernel) + 0.5) + q->gradients;
    }
    return fmax(fmax(values, footprints), rays);
}

/* Those across slices: of values, the other sheet of a slab. */
static double layers_across(const question *q, ways by) {
    if (by.values || by.rays)
        return 1 + cubic(q) + q->gradients;
    return q->gradients;
}

/* The widest pixel on any slice of a placement, voxels along u and v. */
static void widest_pixel(const snow_placement *p, double width[2]) {
    for (int axis = 0; axis < 2; axis++)
        width[axis] = hypot(p->inverse[axis][0], p->inverse[axis][1]);
    if (!p->perspective)
        return;
    width[0] = width[1] = 0;
    for (int64_t n = 0; n < 2 * p->slices - 1; n++) {
        double here[2];
        snow_perspective_pixel_width(p, (double)n / 2, here);
        for (int axis = 0; axis < 2; axis++)
            width[axis] = fmax(width[axis], here[axis]);
    }
}

/* How many voxels rays go aside along u and v from slice to slice, at most; in
 * parallel projection no less than those of any view along this axis where axes
 * are at right angles, so that a part serves all of them; in perspective, for
 * values, those of rays that meet the volume. */
static void widest_slope(const question *q, const snow_placement *p,
                         double slope[2]) {
    const double *spacing = q->whole->spacing;
    const int axes[2] = {p->u_axis, p->v_axis};
    for (int axis = 0; axis < 2; axis++)
        slope[axis] = p->perspective
                          ? snow_value_eye_slope(p, axis)
                          : fmax(fabs(p->inverse[axis][0] * p->step_slice[0] +
                                      p->inverse[axis][1] * p->step_slice[1]),
                                 spacing[p->slice_axis] / spacing[axes[axis]]);
}

/* The view's own needs, with slices along one axis. */
static void ask_placement(const question *q, const snow_placement *p,
                          int64_t layers[3]) {
    const int64_t *dims = q->whole->dims;
    const int axes[2] = {p->u_axis, p->v_axis};
    const ways by = ways_of(q, snow_value_fits(q->whole, p, q->settings));
    double width[2], slope[2];
    double ratio = p->perspective ? snow_perspective_shear_ratio(p) : 1;
    widest_pixel(p, width);
    widest_slope(q, p, slope);
    for (int n = 0; n < 2; n++)
        at_least(&layers[axes[n]],
                 layers_beside(q, by, ratio, width[n], slope[n]),
                 dims[axes[n]] - 1);
    at_least(&layers[p->slice_axis], layers_across(q, by),
             dims[p->slice_axis] - 1);
}

static snow_status ask_view(const question *q, int64_t layers[3]) {
    snow_placement p;
    SNOW_TRY(snow_placement_make(q->context, q->whole, q->view, &p));
    ask_placement(q, &p, layers);
    return SNOW_STATUS_OK;
}

/* --- every turn -----------------------------------------------------------
 *
 * On slices of unit normal n, a pixel of pitch s seen along d (|d| = 1) is
 *
 *   s |d x (g x n)| / |d . n|   <=   s |g x n| / |d . n|
 *
 * voxels wide along a grid axis whose index has the world gradient g, and so
 * many times that as the slice is farther than the target.  The slice axis is
 * the one of the largest |d . n|, which is at least the least of max |d . n|
 * over all d; for axes at right angles 1 / sqrt 3. */

/* A lower bound of max |d . n| over the axes, for every unit vector d: that is
 * at least |N d| / sqrt 3, with the normals as N's rows, and |d| = |N^-1 N d|
 * is at most |N^-1| |N d|.  The norm is Frobenius' but for right angles, where
 * N turns only. */
static double least_cosine(double gradients[3][3]) {
    double normals[3][3], skew = 0, square = 0;
    memcpy(normals, gradients, sizeof normals);
    for (int n = 0; n < 3; n++)
        snow_normalize(normals[n]);
    for (int n = 0; n < 3; n++)
        skew = fmax(skew, fabs(snow_dot(normals[n], normals[(n + 1) % 3])));
    if (skew < 1e-6)
        return 0.999 / sqrt(3.0);
    double cross[3], volume;
    snow_cross(normals[1], normals[2], cross);
    volume = snow_dot(normals[0], cross);
    for (int n = 0; n < 3; n++) {
        snow_cross(normals[(n + 1) % 3], normals[(n + 2) % 3], cross);
        square += snow_dot(cross, cross) / (volume * volume);
    }
    return 1 / sqrt(3 * square);
}

/* The largest |g x n| of an axis, n being normal to slices along another. */
static double steepest(double gradients[3][3], int axis) {
    double most = 0;
    for (int other = 1; other < 3; other++) {
        double normal[3], cross[3];
        memcpy(normal, gradients[(axis + other) % 3], sizeof normal);
        snow_normalize(normal);
        snow_cross(gradients[axis], normal, cross);
        most = fmax(most, snow_length(cross));
    }
    return most;
}

/* How many voxels along an axis rays go aside from slice to slice at most: of
 * |g . d| / |h . d|, where h is the gradient of the slices' index. */
static double steepest_slope(double gradients[3][3], int axis, double slant) {
    double most = 0;
    for (int other = 1; other < 3; other++)
        most = fmax(most,
                    snow_length(gradients[axis]) /
                        (snow_length(gradients[(axis + other) % 3]) * slant));
    return most;
}

/* The largest ratio of the distances of the farthest and the nearest slice from
 * the eye; infinite where it may be beside the volume. */
static double largest_ratio(const question *q, const snow_camera *camera,
                            double gradients[3][3]) {
    double most = 1;
    double height = camera->distance * least_cosine(gradients) -
                    snow_length(camera->middle);
    for (int axis = 0; axis < 3 && camera->distance > 0; axis++) {
        double slices = fmax((double)(q->whole->dims[axis] - 1), 1);
        double half = slices / 2 / snow_length(gradients[axis]);
        most = fmax(most, height > half ? (height + half) / (height - half)
                                        : INFINITY);
    }
    return most;
}

/* Returns whether encodings provide for every turn (snow_value_fits). */
static bool every_turn_fits(const question *q, double gradients[3][3],
                            double ratio, double slant) {
    double reach = 0;
    for (int axis = 0; axis < 3; axis++) {
        reach = fmax(reach, steepest_slope(gradients, axis, slant));
        for (int other = 0; other < 3; other++)
            reach = fmax(reach, q->whole->spacing[axis] /
                                    q->whole->spacing[other] * (1 + 1e-6));
    }
    return ratio <= SNOW_VALUE_SPREAD_MOST &&
           ceil(reach) + fmax(1, ceil(ratio) - 1) + cubic(q) <=
               SNOW_VALUE_REACH_MOST;
}

static snow_status ask_all(const question *q, int64_t layers[3]) {
    double gradients[3][3]; /* of the indices: their directions are the slices'
                               normals */
    snow_placement checked;
    snow_camera camera;
    SNOW_TRY(snow_placement_make(q->context, q->whole, q->view, &checked));
    SNOW_TRY(snow_camera_make(q->context, q->whole, q->view, &camera));
    if (!snow_matrix_invert3(q->whole->matrix, gradients))
        return snow_fail(q->context, SNOW_STATUS_BAD_INPUT,
                         "the volume's matrix cannot be inverted");
    /* The volume stays within a sphere about the target. */
    double reach = snow_length(camera.middle) + snow_volume_radius(q->whole);
    double spread = camera.distance > 0 ? reach / camera.distance : 0;
    /* How obliquely a slice may be seen: the least |d . n|; 0 where there is no
     * bound.  A ray that meets the volume leaves the line of sight by an angle
     * whose sine is `spread` at most. */
    double cosine = least_cosine(gradients);
    double angle = acos(fmax(cosine, 0)) + asin(fmin(spread, 1));
    double slant = angle < 1.57 ? cos(angle) : 0;
    double pitch = camera.pitch * (1 + spread);
    double ratio = largest_ratio(q, &camera, gradients);
    ways by = ways_of(q, true);
    by.footprints |= !every_turn_fits(q, gradients, ratio, slant);
    for (int axis = 0; axis < 3; axis++) {
        double width =
            slant > 0 ? pitch * steepest(gradients, axis) / slant : INFINITY;
        double slope = steepest_slope(gradients, axis, slant);
        double wanted = by.footprints && !(width < 1e9)
                            ? 1e9
                            : layers_beside(q, by, ratio, width, slope);
        int64_t most = q->whole->dims[axis] - 1;
        at_least(&layers[axis], fmax(wanted, layers_across(q, by)), most);
    }
    return SNOW_STATUS_OK;
}

/* Those of labels are smooth. */
static int reach_of(int slopes, const snow_settings *settings) {
    if (!(slopes & SNOW_SLOPES_FADE) && settings->shade != SNOW_SHADE_PHONG)
        return 0;
    return slopes & SNOW_SLOPES_WIDE && settings->mode == SNOW_MODE_OVER ? 2
                                                                         : 1;
}

snow_status snow_ghosts_needed(snow_context *context,
                               const snow_volume_info *whole,
                               const snow_view *view,
                               const snow_settings *settings, int slopes,
                               bool any_turn, int64_t layers[3]) {
    snow_settings resolved = *settings;
    int64_t found[3] = {0, 0, 0};
    SNOW_TRY(snow_settings_resolve(context, whole, &resolved));
    question q = {context, whole, view, &resolved, reach_of(slopes, &resolved)};
    SNOW_TRY(any_turn ? ask_all(&q, found) : ask_view(&q, found));
    memcpy(layers, found, sizeof found);
    return SNOW_STATUS_OK;
}

/* --- parts ---------------------------------------------------------------- */

static snow_status check_layers(snow_context *context,
                                const snow_volume *volume,
                                const int64_t layers[3]) {
    const char names[] = "xyz";
    snow_extent part;
    snow_volume_find_extent(volume, &part);
    for (int axis = 0; axis < 3; axis++) {
        int64_t below = part.first[axis] - part.stored[axis];
        int64_t end = part.first[axis] + part.count[axis];
        int64_t above = part.stored[axis] + volume->info.dims[axis] - end;
        int64_t few = below < above ? below : above;
        bool enough_below = below >= layers[axis] || part.stored[axis] == 0;
        bool enough_above =
            above >= layers[axis] || end + above == part.dims[axis];
        if (!enough_below || !enough_above)
            return snow_fail(
                context, SNOW_STATUS_BAD_USAGE,
                "this view needs %lld layers of ghost voxels along %c, but a "
                "part of the volume has %lld; make the parts for this view, or "
                "with more layers",
                (long long)layers[axis], names[axis], (long long)few);
    }
    return SNOW_STATUS_OK;
}

/* A part without voxels of its own makes no samples. */
snow_status snow_ghosts_check(snow_context *context, const snow_volume *volume,
                              const snow_view *view,
                              const snow_settings *settings, int slopes) {
    int64_t layers[3] = {0, 0, 0};
    snow_volume_info whole;
    snow_extent part;
    snow_volume_whole(volume, &whole);
    snow_volume_find_extent(volume, &part);
    if (!part.count[0] || !part.count[1] || !part.count[2])
        return SNOW_STATUS_OK;
    question q = {context, &whole, view, settings, reach_of(slopes, settings)};
    SNOW_TRY(ask_view(&q, layers));
    return check_layers(context, volume, layers);
}
