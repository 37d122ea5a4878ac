/* tests/reference/camera.c - the reference's camera, rays and slices.
 *
 * Points 1, 2, 5 and 6 of the model. */
#include "reference/reference.h"

#include <math.h>

double reference_dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* Turns `a` towards `b`, and `b` away from where `a` was. */
static void turn(double a[3], double b[3], double degrees) {
    double angle = degrees * acos(-1.0) / 180;
    for (int n = 0; n < 3; n++) {
        double from = a[n], to = b[n];
        a[n] = cos(angle) * from + sin(angle) * to;
        b[n] = cos(angle) * to - sin(angle) * from;
    }
}

static void world_of(const double matrix[4][4], const double index[3],
                     double world[3]) {
    for (int r = 0; r < 3; r++)
        world[r] = reference_dot(matrix[r], index) + matrix[r][3];
}

double reference_behind(const reference_scene *scene,
                        const reference_camera *camera, const double index[3]) {
    double world[3];
    world_of(scene->info.matrix, index, world);
    for (int n = 0; n < 3; n++)
        world[n] -= camera->target[n];
    return -reference_dot(world, camera->back);
}

static void measure_boxes(const snow_volume_info *info,
                          reference_camera *camera) {
    double middle[3];
    for (int n = 0; n < 3; n++)
        middle[n] = (double)(info->dims[n] - 1) / 2;
    world_of(info->matrix, middle, camera->target);
    camera->radius = 0;
    for (int corner = 0; corner < 8; corner++) {
        double index[3], world[3];
        for (int n = 0; n < 3; n++)
            index[n] = (corner >> n & 1) ? (double)info->dims[n] - 0.5 : -0.5;
        world_of(info->matrix, index, world);
        for (int n = 0; n < 3; n++)
            world[n] -= camera->target[n];
        camera->radius =
            fmax(camera->radius, sqrt(reference_dot(world, world)));
    }
}

/* The direction from what is looked at to where the camera stands; its length
 * is returned. */
static double place_back(const snow_view *view, reference_camera *out) {
    double step[3];
    for (int n = 0; n < 3; n++)
        step[n] = view->position[n] - out->target[n];
    double length = sqrt(reference_dot(step, step));
    for (int n = 0; n < 3; n++)
        out->back[n] = step[n] / length;
    return length;
}

/* Right is across the direction that is meant to be up and the line of sight,
 * up then across these. */
static void place_up(const double view_up[3], reference_camera *out) {
    cross(view_up, out->back, out->right);
    double length = sqrt(reference_dot(out->right, out->right));
    for (int n = 0; n < 3; n++)
        out->right[n] /= length;
    cross(out->back, out->right, out->up);
}

void reference_camera_of(const reference_scene *scene, reference_camera *out) {
    const snow_view *view = &scene->view;
    double length = 0;
    measure_boxes(&scene->info, out); /* the radius is the boxes' always */
    for (int n = 0; n < 3; n++) {
        out->back[n] = view->back[n];
        out->up[n] = view->up[n];
        if (view->has_target)
            out->target[n] = view->target[n];
    }
    if (view->has_position)
        length = place_back(view, out);
    bool along_z = hypot(out->back[0], out->back[1]) < 1e-6;
    cross(out->up, out->back, out->right);
    if (view->has_view_up)
        place_up(view->view_up, out);
    else if (view->has_position)
        place_up(along_z ? (double[]){0, 1, 0} : (double[]){0, 0, 1}, out);
    turn(out->back, out->right, view->azimuth);
    turn(out->back, out->up, view->elevation);
    turn(out->up, out->right, view->roll);
    int side = view->width < view->height ? view->width : view->height;
    out->pitch = 2 * out->radius / (view->zoom * side);
    out->distance = 0;
    if (view->fov == 0)
        return;
    /* The field of view spans the shorter side at the target's distance. */
    double half = view->fov / 2 * acos(-1.0) / 180;
    out->distance = length > 0 ? length : out->radius / sin(half);
    out->pitch = 2 * out->distance * tan(half) / (view->zoom * side);
}

/* The world position of an image point in the plane of the target. */
static void image_point(const reference_scene *scene,
                        const reference_camera *camera, double x, double y,
                        double world[3]) {
    double right = (x - scene->view.width / 2.0) * camera->pitch;
    double down = (y - scene->view.height / 2.0) * camera->pitch;
    for (int n = 0; n < 3; n++)
        world[n] =
            camera->target[n] + right * camera->right[n] - down * camera->up[n];
}

static void eye_of(const reference_camera *camera, double eye[3]) {
    for (int n = 0; n < 3; n++)
        eye[n] = camera->target[n] + camera->distance * camera->back[n];
}

void reference_project(const reference_scene *scene,
                       const reference_camera *camera, const double index[3],
                       double pixel[2]) {
    double world[3], from[3], scale = 1;
    world_of(scene->info.matrix, index, world);
    for (int n = 0; n < 3; n++)
        from[n] = world[n] - camera->target[n];
    if (camera->distance > 0) /* similar triangles */
        scale = camera->distance /
                (camera->distance - reference_dot(from, camera->back));
    pixel[0] = scene->view.width / 2.0 +
               scale * reference_dot(from, camera->right) / camera->pitch;
    pixel[1] = scene->view.height / 2.0 -
               scale * reference_dot(from, camera->up) / camera->pitch;
}

void reference_inverse(const double matrix[4][4], double inverse[3][3]) {
    double column[3][3];
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            column[c][r] = matrix[r][c];
    for (int n = 0; n < 3; n++) {
        cross(column[(n + 1) % 3], column[(n + 2) % 3], inverse[n]);
        double volume = reference_dot(inverse[n], column[n]);
        for (int r = 0; r < 3; r++)
            inverse[n][r] /= volume;
    }
}

reference_ray reference_ray_at(const reference_scene *scene,
                               const reference_camera *camera, double x,
                               double y) {
    double inverse[3][3], point[3], from[3], along[3], length = 0;
    image_point(scene, camera, x, y, point);
    for (int n = 0; n < 3; n++) {
        from[n] = point[n];
        along[n] = -camera->back[n];
    }
    if (camera->distance > 0) {
        eye_of(camera, from);
        for (int n = 0; n < 3; n++)
            along[n] = point[n] - from[n];
        length = sqrt(reference_dot(along, along));
        for (int n = 0; n < 3; n++)
            along[n] /= length;
    }
    for (int n = 0; n < 3; n++)
        from[n] -= scene->info.matrix[n][3];
    reference_inverse(scene->info.matrix, inverse);
    reference_ray ray;
    for (int n = 0; n < 3; n++) {
        ray.start[n] = reference_dot(inverse[n], from);
        ray.step[n] = reference_dot(inverse[n], along);
    }
    return ray;
}

/* |cosine| of the view direction and the normal of slices along `axis`: a row
 * of the inverse matrix is the direction in which that index grows fastest,
 * which is the normal of the planes where it is constant. */
static double slice_cosine(const reference_scene *scene,
                           const reference_camera *camera, int axis) {
    double inverse[3][3];
    reference_inverse(scene->info.matrix, inverse);
    const double *normal = inverse[axis];
    return fabs(reference_dot(normal, camera->back)) /
           sqrt(reference_dot(normal, normal));
}

int reference_slice_axis(const reference_scene *scene,
                         const reference_camera *camera) {
    double cosine[3], crossed[3], best = 0, inverse[3][3];
    int facing = 2, densest = 2;
    reference_inverse(scene->info.matrix, inverse);
    for (int n = 0; n < 3; n++) {
        cosine[n] = slice_cosine(scene, camera, n);
        best = fmax(best, cosine[n]);
        crossed[n] = fabs(reference_dot(inverse[n], camera->back));
    }
    while (facing > 0 && cosine[facing] < best - 1e-6)
        facing--;
    for (int n = 0; n < 2; n++)
        densest = crossed[n] > crossed[densest] ? n : densest;
    return crossed[densest] > 8 * crossed[facing] ? densest : facing;
}

double reference_slice_step(const reference_scene *scene,
                            const reference_camera *camera, int axis,
                            const double index[3]) {
    double inverse[3][3], along[3], eye[3], world[3];
    reference_inverse(scene->info.matrix, inverse);
    const double *normal = inverse[axis];
    eye_of(camera, eye);
    world_of(scene->info.matrix, index, world);
    for (int n = 0; n < 3; n++)
        along[n] = camera->distance > 0 ? world[n] - eye[n] : -camera->back[n];
    /* The slices' distance is one over the normal's length. */
    double cosine =
        fabs(reference_dot(normal, along)) /
        sqrt(reference_dot(normal, normal) * reference_dot(along, along));
    return 1 / (sqrt(reference_dot(normal, normal)) * cosine);
}
