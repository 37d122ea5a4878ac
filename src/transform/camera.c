/* transform/camera.c - the camera of a view (model, section 2), given by name
 * and angles, or by points in world space.
 *
 * All positions are relative to the target, which is shown in the middle of the
 * picture. */
#include "base/vec3.h"
#include "transform/transform.h"

#include <math.h>
#include <string.h>

#define RADIAN 0.017453292519943295769 /* pi / 180 */

/* Sine of the angle below which two directions count as parallel. */
#define ALONG 1e-6

int snow_view_room(const snow_view *view) {
    return view->width - (int)(view->strip * view->width + 0.5);
}

static snow_status check_numbers(snow_context *context, const snow_view *view) {
    if (view->width < 1 || view->width > 32768 || view->height < 1 ||
        view->height > 32768)
        return snow_fail(
            context, SNOW_STATUS_BAD_USAGE,
            "invalid image size %dx%d: each side must be 1 to 32768 pixels",
            view->width, view->height);
    if (!(view->strip >= 0 && view->strip <= 0.5))
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "invalid strip of %g of the width for a legend: must "
                         "be 0 to 0.5",
                         view->strip);
    if (!(view->zoom > 0) || !isfinite(view->zoom))
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "invalid zoom %g: must be a number above 0",
                         view->zoom);
    if (view->fov != 0 &&
        !(view->fov >= SNOW_FOV_MIN && view->fov <= SNOW_FOV_MAX))
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "invalid field of view of %g degrees: must be %g to "
                         "%g, or 0 for a parallel projection",
                         view->fov, SNOW_FOV_MIN, (double)SNOW_FOV_MAX);
    if (!isfinite(view->azimuth) || !isfinite(view->elevation) ||
        !isfinite(view->roll))
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "a camera angle is not a finite number");
    return SNOW_STATUS_OK;
}

/* The vector from the target to the middle of the voxel boxes. */
static void middle_from_target(const snow_volume_info *info,
                               const snow_view *view, double step[3]) {
    for (int i = 0; i < 3; i++) {
        step[i] = 0;
        if (!view->has_target)
            continue;
        step[i] = info->matrix[i][3] - view->target[i];
        for (int axis = 0; axis < 3; axis++)
            step[i] +=
                info->matrix[i][axis] * ((double)info->dims[axis] - 1) / 2;
    }
}

/* The vector from the target, or the middle, to the position: `back`, and its
 * length. */
static snow_status look_back(snow_context *context,
                             const snow_volume_info *info,
                             const snow_view *view, snow_camera *out) {
    snow_view aimed = *view;
    double step[3];
    aimed.has_target = true; /* with the position as target */
    memcpy(aimed.target, view->position, sizeof aimed.target);
    middle_from_target(info, &aimed, step);
    for (int i = 0; i < 3; i++)
        out->back[i] =
            view->has_target ? view->position[i] - view->target[i] : -step[i];
    out->distance = snow_length(out->back);
    if (!(out->distance > 1e-9 * snow_volume_radius(info)) ||
        !isfinite(out->distance))
        return snow_fail(
            context, SNOW_STATUS_BAD_USAGE,
            "the camera's position is %s: they must differ; move one of them",
            view->has_target ? "its target"
                             : "the middle of the volume, its target");
    snow_normalize(out->back);
    return SNOW_STATUS_OK;
}

/* The component of `view_up` perpendicular to the line of sight. */
static bool straighten(const double view_up[3], const double back[3],
                       double up[3]) {
    double length = snow_length(view_up), unit[3];
    if (!(length > 0) || !isfinite(length))
        return false;
    for (int i = 0; i < 3; i++)
        unit[i] = view_up[i] / length;
    double along = snow_dot(unit, back);
    for (int i = 0; i < 3; i++)
        up[i] = unit[i] - along * back[i];
    if (!(snow_length(up) > ALONG))
        return false;
    snow_normalize(up);
    return true;
}

static snow_status look_up(snow_context *context, const snow_view *view,
                           snow_camera *out) {
    static const double z[3] = {0, 0, 1}, y[3] = {0, 1, 0};
    if (view->has_view_up) {
        if (straighten(view->view_up, out->back, out->up))
            return SNOW_STATUS_OK;
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "invalid up vector %g,%g,%g: must be finite, not zero "
                         "and not parallel to the line of sight",
                         view->view_up[0], view->view_up[1], view->view_up[2]);
    }
    if (!view->has_position)
        memcpy(out->up, view->up, sizeof out->up);
    else if (!straighten(z, out->back, out->up))
        straighten(y, out->back, out->up);
    return SNOW_STATUS_OK;
}

/* Distance and pitch. The cone of the default field of view touches the sphere
 * of radius R, and is R / cos(fov / 2) wide at the target. */
static void measure_distance(const snow_volume_info *info,
                             const snow_view *view, snow_camera *out) {
    double side = view->zoom * fmin(snow_view_room(view), view->height);
    double radius = snow_volume_radius(info), half = view->fov / 2 * RADIAN;
    if (view->fov > 0 && view->has_position) {
        out->pitch = 2 * out->distance * tan(half) / side;
        return;
    }
    out->distance = view->fov > 0 ? radius / sin(half) : 0;
    out->pitch = 2 * radius / side / cos(half);
}

/* A voxel beside or behind the eye has no place in the picture. The default eye
 * is farther than R from the middle, in front of all voxels. */
static snow_status check_front(snow_context *context,
                               const snow_volume_info *info,
                               const snow_camera *camera) {
    double nearest = camera->distance - camera->middle[2];
    for (int axis = 0; axis < 3; axis++) {
        double step[3];
        for (int i = 0; i < 3; i++)
            step[i] = info->matrix[i][axis];
        nearest -=
            fabs(snow_dot(step, camera->back)) * (double)info->dims[axis] / 2;
    }
    if (camera->distance == 0 || nearest > 1e-6 * camera->distance)
        return SNOW_STATUS_OK;
    return snow_fail(
        context, SNOW_STATUS_BAD_USAGE,
        "a part of the volume is beside or behind the camera, which is %g from "
        "its target; move it %g farther away, or use a parallel projection",
        camera->distance, -nearest + 1e-3 * camera->distance);
}

snow_status snow_camera_make(snow_context *context,
                             const snow_volume_info *info,
                             const snow_view *view, snow_camera *out) {
    snow_camera c = {.distance = 0};
    double middle[3];
    SNOW_TRY(check_numbers(context, view));
    if (!(fabs(snow_length(view->back) - 1) <= 1e-6) ||
        !(fabs(snow_length(view->up) - 1) <= 1e-6) ||
        !(fabs(snow_dot(view->back, view->up)) <= 1e-6))
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "invalid view: back and up must be perpendicular unit "
                         "vectors; begin with snow_view_from_name");
    bool good = true;
    for (int i = 0; i < 3; i++)
        good = good && (!view->has_position || isfinite(view->position[i])) &&
               (!view->has_target || isfinite(view->target[i]));
    if (!good)
        return snow_fail(
            context, SNOW_STATUS_BAD_USAGE,
            "invalid camera: position and target must be finite numbers");
    memcpy(c.back, view->back, sizeof c.back);
    if (view->has_position)
        SNOW_TRY(look_back(context, info, view, &c));
    SNOW_TRY(look_up(context, view, &c));
    snow_cross(c.up, c.back, c.right);
    snow_frame_turn(c.right, c.up, c.back, view->azimuth, view->elevation,
                    view->roll);
    measure_distance(info, view, &c);
    middle_from_target(info, view, middle);
    c.middle[0] = snow_dot(middle, c.right);
    c.middle[1] = snow_dot(middle, c.up);
    c.middle[2] = snow_dot(middle, c.back);
    c.target[0] = snow_view_room(view) / 2.0;
    c.target[1] = view->height / 2.0;
    SNOW_TRY(check_front(context, info, &c));
    *out = c;
    return SNOW_STATUS_OK;
}

/* --- places and pixels ---------------------------------------------------- */

/* The middle of the voxel boxes. */
static void middle_of(const snow_volume_info *info, double middle[3]) {
    for (int i = 0; i < 3; i++) {
        middle[i] = info->matrix[i][3];
        for (int axis = 0; axis < 3; axis++)
            middle[i] +=
                info->matrix[i][axis] * ((double)info->dims[axis] - 1) / 2;
    }
}

void snow_camera_point(const snow_camera *camera, const snow_volume_info *info,
                       const double place[3], double point[3]) {
    const double *frame[3] = {camera->right, camera->up, camera->back};
    double middle[3], from[3];
    middle_of(info, middle);
    for (int i = 0; i < 3; i++)
        from[i] = place[i] - middle[i];
    for (int i = 0; i < 3; i++)
        point[i] = camera->middle[i] + snow_dot(frame[i], from);
}

void snow_camera_place(const snow_camera *camera, const snow_volume_info *info,
                       const double point[3], double place[3]) {
    const double *frame[3] = {camera->right, camera->up, camera->back};
    middle_of(info, place);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            place[i] += frame[k][i] * (point[k] - camera->middle[k]);
}

void snow_camera_pixel(const snow_camera *camera, const double point[3],
                       double pixel[2]) {
    double scale = 1 / camera->pitch;
    if (camera->distance > 0)
        scale *= camera->distance / (camera->distance - point[2]);
    pixel[0] = camera->target[0] + scale * point[0];
    pixel[1] = camera->target[1] - scale * point[1];
}

/* Whether a point is seen from the eye; not where it is no number. */
static bool is_in_front(const snow_camera *camera, double back) {
    return camera->distance > 0 ? back < camera->distance : isfinite(back);
}

/* The world's length of a pixel's side there; NaN where nothing is seen. */
static double pixel_length(const snow_camera *camera, double back) {
    if (!is_in_front(camera, back))
        return NAN;
    return camera->distance > 0
               ? camera->pitch * (camera->distance - back) / camera->distance
               : camera->pitch;
}

/* The camera of records of a caller. */
static snow_status read_camera(snow_context *context,
                               const snow_volume_info *given,
                               const snow_view *view, snow_volume_info *info,
                               snow_camera *out) {
    snow_view from;
    SNOW_TRY(SNOW_RECORD_READ(context, snow_volume_info, given, info));
    SNOW_TRY(SNOW_RECORD_READ(context, snow_view, view, &from));
    return snow_camera_make(context, info, &from, out);
}

snow_status snow_view_world_to_pixel(snow_context *context,
                                     const snow_volume_info *info,
                                     const snow_view *view,
                                     const double *places, size_t count,
                                     double *pixels) {
    snow_volume_info volume;
    snow_camera camera;
    SNOW_TRY(read_camera(context, info, view, &volume, &camera));
    for (size_t n = 0; n < 3 * count; n += 3) {
        double point[3];
        snow_camera_point(&camera, &volume, places + n, point);
        snow_camera_pixel(&camera, point, pixels + n);
        pixels[n + 2] = -point[2];
        for (int i = 0; i < 3 && !is_in_front(&camera, point[2]); i++)
            pixels[n + (size_t)i] = NAN;
    }
    return SNOW_STATUS_OK;
}

snow_status snow_view_pixel_to_world(snow_context *context,
                                     const snow_volume_info *info,
                                     const snow_view *view,
                                     const double *pixels, size_t count,
                                     double *places) {
    snow_volume_info volume;
    snow_camera camera;
    SNOW_TRY(read_camera(context, info, view, &volume, &camera));
    for (size_t n = 0; n < 3 * count; n += 3) {
        double point[3] = {0, 0, -pixels[n + 2]};
        const double length = pixel_length(&camera, point[2]);
        point[0] = length * (pixels[n] - camera.target[0]);
        point[1] = length * (camera.target[1] - pixels[n + 1]);
        snow_camera_place(&camera, &volume, point, places + n);
    }
    return SNOW_STATUS_OK;
}
