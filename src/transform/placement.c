/* transform/placement.c - the placement of a volume before the camera: the
 * slice axis, the order of slices, and the affine map from voxels to pixels. */
#include "base/vec3.h"
#include "transform/perspective.h"

#include <math.h>
#include <string.h>

/* Pixels wider than this many voxels along an axis are rejected: distances in
 * voxels are floats in the inner loops. */
#define WIDEST_PIXEL 1e9

/* Two axes whose cosines differ by less than this are equally good. */
#define AXIS_TIE 1e-6

/* Voxels by which the next slice is shifted at most, where another axis has a
 * smaller shear. */
#define SHEAR_MOST 8

/* Column `axis` of the matrix: the world step from one voxel to the next. */
static void step_of(const snow_volume_info *info, int axis, double step[3]) {
    for (int i = 0; i < 3; i++)
        step[i] = info->matrix[i][axis];
}

double snow_volume_radius(const snow_volume_info *info) {
    double farthest = 0;
    for (int corner = 0; corner < 4; corner++) {
        double sum[3] = {0, 0, 0};
        for (int axis = 0; axis < 3; axis++) {
            double half = (double)info->dims[axis] / 2;
            double sign = corner >> axis & 1 ? -half : half;
            for (int i = 0; i < 3; i++)
                sum[i] += sign * info->matrix[i][axis];
        }
        farthest = fmax(farthest, snow_length(sum));
    }
    return farthest;
}

void snow_slice_normal(const snow_volume_info *info, int axis,
                       double normal[3]) {
    double a[3], b[3];
    step_of(info, (axis + 1) % 3, a);
    step_of(info, (axis + 2) % 3, b);
    snow_cross(a, b, normal);
    snow_normalize(normal);
}

/* The axis whose slices face the viewer most.  Flat voxels, seen from their
 * side, would shift by many voxels from such a slice to the next: then it is
 * the axis whose slices a ray crosses most often. */
static int choose_axis(const snow_volume_info *info, const double back[3]) {
    double best = -1, crossed[3];
    int chosen = 2, densest = 2;
    for (int axis = 2; axis >= 0; axis--) {
        /* The absolute cosine between the line of sight and the normal of the
         * slices along an axis. */
        double normal[3], step[3];
        snow_slice_normal(info, axis, normal);
        step_of(info, axis, step);
        double cosine = fabs(snow_dot(normal, back));
        crossed[axis] = cosine / fabs(snow_dot(normal, step));
        if (cosine > best + AXIS_TIE) {
            best = cosine;
            chosen = axis;
        }
        if (crossed[axis] > crossed[densest])
            densest = axis;
    }
    return crossed[densest] > SHEAR_MOST * crossed[chosen] ? densest : chosen;
}

static void place_slices(const snow_volume_info *info,
                         const snow_camera *camera, snow_placement *p) {
    double pitch = camera->pitch;
    p->pitch = pitch;
    double *steps[3];
    steps[p->u_axis] = p->step_u;
    steps[p->v_axis] = p->step_v;
    steps[p->slice_axis] = p->step_slice;
    p->origin[0] = camera->target[0] + camera->middle[0] / pitch;
    p->origin[1] = camera->target[1] - camera->middle[1] / pitch;
    for (int axis = 0; axis < 3; axis++) {
        double step[3];
        step_of(info, axis, step);
        /* Maps a world step to pixels. */
        steps[axis][0] = snow_dot(step, p->right) / pitch;
        steps[axis][1] = -snow_dot(step, p->up) / pitch;
        for (int i = 0; i < 2; i++)
            p->origin[i] -= steps[axis][i] * ((double)info->dims[axis] - 1) / 2;
    }
}

static bool invert_slice_map(snow_placement *p) {
    double determinant =
        p->step_u[0] * p->step_v[1] - p->step_v[0] * p->step_u[1];
    if (!(fabs(determinant) > 0) || !isfinite(determinant) ||
        !isfinite(1 / determinant))
        return false;
    p->inverse[0][0] = p->step_v[1] / determinant;
    p->inverse[0][1] = -p->step_v[0] / determinant;
    p->inverse[1][0] = -p->step_u[1] / determinant;
    p->inverse[1][1] = p->step_u[0] / determinant;
    for (int axis = 0; axis < 2; axis++)
        if (!(hypot(p->inverse[axis][0], p->inverse[axis][1]) < WIDEST_PIXEL))
            return false;
    return true;
}

/* The camera of a view, and a placement that is otherwise empty. */
static snow_status place_camera(snow_context *context,
                                const snow_volume_info *info,
                                const snow_view *view, snow_camera *camera,
                                snow_placement *p) {
    SNOW_TRY(snow_camera_make(context, info, view, camera));
    *p = (snow_placement){.width = view->width, .height = view->height};
    memcpy(p->right, camera->right, sizeof p->right);
    memcpy(p->up, camera->up, sizeof p->up);
    memcpy(p->back, camera->back, sizeof p->back);
    return SNOW_STATUS_OK;
}

static snow_status place_volume(snow_context *context,
                                const snow_volume_info *info,
                                const snow_view *view,
                                const snow_camera *camera, int slice_axis,
                                snow_placement *p) {
    p->slice_axis = slice_axis;
    p->u_axis = p->slice_axis == 0 ? 1 : 0;
    p->v_axis = p->slice_axis == 2 ? 1 : 2;
    p->columns = info->dims[p->u_axis];
    p->rows = info->dims[p->v_axis];
    p->slices = info->dims[p->slice_axis];
    /* Sets the ray's length between two slice planes, and which side is near.
     */
    double normal[3], step[3];
    snow_slice_normal(info, p->slice_axis, normal);
    step_of(info, p->slice_axis, step);
    double distance = snow_dot(normal, step);
    double cosine = snow_dot(normal, p->back);
    p->path = fabs(distance / cosine);
    p->nearest_first = distance * cosine < 0;
    place_slices(info, camera, p);
    bool fits = isfinite(p->path) && isfinite(p->origin[0]) &&
                isfinite(p->origin[1]) && invert_slice_map(p);
    if (fits && view->fov > 0)
        fits = snow_perspective_place(info, camera, p);
    if (fits)
        return SNOW_STATUS_OK;
    return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                     "voxels of %gx%gx%g cannot be shown at zoom %g: they are "
                     "too flat or too large; give the volume another --spacing",
                     info->spacing[0], info->spacing[1], info->spacing[2],
                     view->zoom);
}

snow_status snow_placement_make(snow_context *context,
                                const snow_volume_info *info,
                                const snow_view *view, snow_placement *out) {
    snow_placement p;
    snow_camera camera;
    SNOW_TRY(place_camera(context, info, view, &camera, &p));
    int slice_axis = choose_axis(info, p.back);
    SNOW_TRY(place_volume(context, info, view, &camera, slice_axis, &p));
    *out = p;
    return SNOW_STATUS_OK;
}
