/* tests/reference/reference.c - the reference's picture: rays, sheets, over.
 *
 * Points 5 and 7 of the model in their plainest form: every pixel visits every
 * slice, and every slice is interpolated anew. */
#include "reference/gather.h"

#include <math.h>
#include <stdlib.h>

typedef reference_gather gather;

static int64_t voxel_offset(const int64_t dims[3], const int64_t at[3]) {
    return (at[2] * dims[1] + at[1]) * dims[0] + at[0];
}

bool reference_meet_slice(const gather *g, const reference_ray *ray,
                          int64_t slice, double *u, double *v) {
    double t = ((double)slice - ray->start[g->axis]) / ray->step[g->axis];
    *u = ray->start[g->u_axis] + t * ray->step[g->u_axis];
    *v = ray->start[g->v_axis] + t * ray->step[g->v_axis];
    return isfinite(t) && (g->scene->view.fov == 0 || t > 0);
}

/* The sheet of one slice where the ray meets it. */
static void gather_sheet(const gather *g, const reference_ray *ray,
                         int64_t slice, double sheet[4]) {
    const int64_t *dims = g->scene->info.dims;
    double u, v;
    int64_t u0, u1, v0, v1;
    for (int c = 0; c < 4; c++)
        sheet[c] = 0;
    if (!reference_meet_slice(g, ray, slice, &u, &v))
        return;
    reference_weights(g->kernel, g->support, g->u_width[slice], u,
                      dims[g->u_axis], g->u_weights, &u0, &u1);
    if (u0 > u1)
        return;
    reference_weights(g->kernel, g->support, g->v_width[slice], v,
                      dims[g->v_axis], g->v_weights, &v0, &v1);
    for (int64_t j = v0; j <= v1; j++) {
        for (int64_t i = u0; i <= u1; i++) {
            int64_t at[3];
            at[g->axis] = slice;
            at[g->u_axis] = i;
            at[g->v_axis] = j;
            const double *sample = g->samples + 4 * voxel_offset(dims, at);
            double weight = g->u_weights[i] * g->v_weights[j];
            for (int c = 0; c < 4; c++)
                sheet[c] += weight * sample[c];
        }
    }
}

/* Porter and Duff's over on premultiplied colours. */
static void lay_over(const double front[4], const double back[4],
                     double out[4]) {
    double through = 1 - front[3];
    for (int c = 0; c < 4; c++)
        out[c] = front[c] + through * back[c];
}

static void gather_pixel(const gather *g, const reference_ray *ray,
                         double pixel[4]) {
    int64_t count = g->scene->info.dims[g->axis];
    /* Along the ray indices grow or fall: that is the order of slices. */
    bool rising = ray->step[g->axis] > 0;
    for (int64_t n = 0; n < count; n++) {
        double sheet[4];
        gather_sheet(g, ray, rising ? n : count - 1 - n, sheet);
        lay_over(pixel, sheet, pixel);
    }
}

double reference_passes(const gather *g, const reference_ray *ray) {
    int64_t count = g->scene->info.dims[g->axis];
    double step = ray->step[g->axis] > 0 ? 1 : -1, pixel[4] = {0};
    for (int64_t n = 0; n < count; n++) {
        double sheet[4], before = pixel[3];
        int64_t slice = step > 0 ? n : count - 1 - n;
        gather_sheet(g, ray, slice, sheet);
        lay_over(pixel, sheet, pixel);
        if (pixel[3] >= 0.5)
            return (double)slice +
                   step * ((0.5 - before) / (pixel[3] - before) - 0.5);
    }
    return (double)NAN;
}

/* How many voxels a pixel is wide along each axis of a slice: by how much
 * (u, v) moves from a bit to the left of the pixel position at which the
 * slice's middle is seen to a bit to the right, and from above to below. */
static void widen_kernel(gather *g, const reference_camera *camera,
                         int64_t slice) {
    const double bit = 1e-3;
    double middle[3], pixel[2], u[4], v[4];
    for (int n = 0; n < 3; n++)
        middle[n] = (double)(g->scene->info.dims[n] - 1) / 2;
    middle[g->axis] = (double)slice;
    reference_project(g->scene, camera, middle, pixel);
    for (int n = 0; n < 4; n++) {
        double x = n == 0 ? -bit : n == 1 ? bit : 0;
        double y = n == 2 ? -bit : n == 3 ? bit : 0;
        reference_ray ray =
            reference_ray_at(g->scene, camera, pixel[0] + x, pixel[1] + y);
        reference_meet_slice(g, &ray, slice, &u[n], &v[n]);
    }
    g->u_width[slice] = reference_widening(
        g->kernel, g->support, hypot(u[1] - u[0], u[3] - u[2]) / (2 * bit));
    g->v_width[slice] = reference_widening(
        g->kernel, g->support, hypot(v[1] - v[0], v[3] - v[2]) / (2 * bit));
}

void reference_gather_begin(const reference_scene *scene,
                            const reference_camera *camera, gather *g) {
    *g = (gather){.scene = scene};
    g->kernel = scene->settings.kernel;
    g->support = reference_support(&scene->settings);
    g->axis = reference_slice_axis(scene, camera);
    g->u_axis = g->axis == 0 ? 1 : 0;
    g->v_axis = g->axis == 2 ? 1 : 2;
    size_t slices = (size_t)scene->info.dims[g->axis];
    g->u_width = calloc(slices, sizeof(double));
    g->v_width = calloc(slices, sizeof(double));
    for (int64_t slice = 0; slice < scene->info.dims[g->axis]; slice++)
        widen_kernel(g, camera, slice);
    g->u_weights = calloc((size_t)scene->info.dims[g->u_axis], sizeof(double));
    g->v_weights = calloc((size_t)scene->info.dims[g->v_axis], sizeof(double));
}

void reference_gather_end(gather *g) {
    free(g->u_width);
    free(g->v_width);
    free(g->u_weights);
    free(g->v_weights);
}

double *reference_render(const reference_scene *scene) {
    reference_camera camera;
    gather g;
    reference_camera_of(scene, &camera);
    reference_gather_begin(scene, &camera, &g);
    double *samples = reference_samples(scene, &camera, g.axis);
    g.samples = samples;
    int width = scene->view.width, height = scene->view.height;
    double *pixels = calloc((size_t)width * (size_t)height * 4, sizeof(double));
    for (int y = 0; y < height; y++) {
        for (int x = 0; x < width; x++) {
            reference_ray ray =
                reference_ray_at(scene, &camera, x + 0.5, y + 0.5);
            size_t at = (size_t)y * (size_t)width + (size_t)x;
            gather_pixel(&g, &ray, pixels + 4 * at);
        }
    }
    reference_gather_end(&g);
    free(samples);
    return pixels;
}
