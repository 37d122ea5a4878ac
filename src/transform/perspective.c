/* transform/perspective.c - the eye of a perspective view in index space. */
#include "transform/perspective.h"
#include "base/vec3.h"

#include <math.h>

/* The columns of `out` are the dual vectors of m's rows. */
static bool invert(double m[3][3], double out[3][3]) {
    double dual[3];
    snow_cross(m[1], m[2], dual);
    const double volume = snow_dot(m[0], dual);
    for (int i = 0; i < 3; i++) {
        snow_cross(m[(i + 1) % 3], m[(i + 2) % 3], dual);
        for (int j = 0; j < 3; j++) {
            out[j][i] = dual[j] / volume;
            if (!isfinite(out[j][i]))
                return false;
        }
    }
    return true;
}

/* The world step of one voxel along u, v and across slices, in components
 * right, down and forward: camera[part][axis]. */
static void carry_to_camera(const snow_volume_info *info,
                            const snow_placement *p, double camera[3][3]) {
    const int axes[3] = {p->u_axis, p->v_axis, p->slice_axis};
    for (int n = 0; n < 3; n++) {
        double step[3];
        for (int i = 0; i < 3; i++)
            step[i] = info->matrix[i][axes[n]];
        camera[0][n] = snow_dot(step, p->right);
        camera[1][n] = -snow_dot(step, p->up);
        camera[2][n] = -snow_dot(step, p->back);
    }
}

bool snow_perspective_place(const snow_volume_info *info, const snow_camera *at,
                            snow_placement *p) {
    double pitch = at->pitch, distance = at->distance;
    double camera[3][3], steps[3][3];
    snow_perspective eye;
    carry_to_camera(info, p, camera);
    if (!isfinite(distance) || !isfinite(pitch) || !invert(camera, steps))
        return false;
    const double middle[3] = {(double)(p->columns - 1) / 2,
                              (double)(p->rows - 1) / 2,
                              (double)(p->slices - 1) / 2};
    const double *half = at->target;
    for (int i = 0; i < 3; i++) {
        eye.middle[i] = middle[i];
        eye.at[i] = middle[i] - at->middle[0] * steps[i][0] +
                    at->middle[1] * steps[i][1] -
                    (distance - at->middle[2]) * steps[i][2];
        eye.ray[i][1] = pitch * steps[i][0];
        eye.ray[i][2] = pitch * steps[i][1];
        eye.ray[i][0] = distance * steps[i][2] - half[0] * eye.ray[i][1] -
                        half[1] * eye.ray[i][2];
        eye.pixel[0][i] =
            distance / pitch * camera[0][i] + half[0] * camera[2][i];
        eye.pixel[1][i] =
            distance / pitch * camera[1][i] + half[1] * camera[2][i];
        eye.pixel[2][i] = camera[2][i];
        for (int j = 0; j < 3; j++)
            eye.metric[i][j] = camera[0][i] * camera[0][j] +
                               camera[1][i] * camera[1][j] +
                               camera[2][i] * camera[2][j];
    }
    p->perspective = true;
    p->eye = eye;
    return true;
}

bool snow_perspective_sees(const snow_perspective *eye, const double step[3],
                           double pixel[2]) {
    double depth = snow_dot(eye->pixel[2], step);
    if (!(depth > 0))
        return false;
    pixel[0] = snow_dot(eye->pixel[0], step) / depth;
    pixel[1] = snow_dot(eye->pixel[1], step) / depth;
    return isfinite(pixel[0]) && isfinite(pixel[1]);
}

/* u = eu + (k - ek) ray_u / ray_k, and so for v; derivatives by x and y. */
void snow_perspective_pixel_width(const snow_placement *p, double slice,
                                  double width[2]) {
    const snow_perspective *eye = &p->eye;
    double height = slice - eye->at[2];
    const double step[3] = {eye->middle[0] - eye->at[0],
                            eye->middle[1] - eye->at[1], height};
    double pixel[2] = {0, 0}, ray[3];
    snow_perspective_sees(eye, step, pixel); /* all points of the boxes are */
    snow_perspective_ray(eye, pixel[0], pixel[1], ray);
    for (int axis = 0; axis < 2; axis++) {
        double by[2];
        for (int n = 0; n < 2; n++)
            by[n] = (eye->ray[axis][n + 1] * ray[2] -
                     eye->ray[2][n + 1] * ray[axis]) /
                    (ray[2] * ray[2]);
        width[axis] = fabs(height) * hypot(by[0], by[1]);
    }
}

double snow_perspective_path(const snow_perspective *eye, double u, double v,
                             double slice) {
    double height = slice - eye->at[2];
    const double step[3] = {u - eye->at[0], v - eye->at[1], height};
    const double carried[3] = {snow_dot(eye->metric[0], step),
                               snow_dot(eye->metric[1], step),
                               snow_dot(eye->metric[2], step)};
    return sqrt(snow_dot(carried, step)) / fabs(height);
}

int64_t snow_perspective_nth_slice(const snow_perspective *eye, int64_t first,
                                   int64_t count, int64_t n) {
    double split = ceil(eye->at[2]) - (double)first;
    int64_t below = split > 0 ? count : 0;
    if (split > 0 && split < (double)count)
        below = (int64_t)split;
    return first + (n < below ? below - 1 - n : n);
}
