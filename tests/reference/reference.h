/* tests/reference/reference.h - what a correct picture is, computed slowly.
 *
 * A float64 transcription of the rendering model in gather form: for each
 * pixel, for each slice, the ray through the pixel's centre meets the slice at
 * grid position (u, v); there the sheet is the weighted sum of the voxels in
 * reach, and sheets are laid over each other.  It shares no code with the
 * library, only the public records, so that an error has to be made twice, in
 * two ways, to pass unseen. */
#ifndef SNOW_TEST_REFERENCE_H
#define SNOW_TEST_REFERENCE_H

#include <snowglass/render.h>

/* Everything that decides a picture.  Arrays are the caller's. */
typedef struct reference_scene {
    snow_volume_info info; /* dims, type, matrix, slope, intercept count */
    const void *voxels;    /* x fastest, of info.type */
    bool masked;           /* NaN is what a mask has left out */
    const snow_color_point *colors;
    size_t color_count;
    const snow_opacity_point *opacities;
    size_t opacity_count;
    bool log; /* points are joined by the logarithms of values */
    const snow_opacity_point *gradients; /* the gradient opacity */
    size_t gradient_count;               /* 0: none */
    snow_view view;
    snow_settings settings; /* method and encoding do not matter here */
} reference_scene;

/* The camera after its turns: a right-handed frame of unit vectors in the
 * world, where `back` points from the target to the camera. */
typedef struct reference_camera {
    double right[3], up[3], back[3];
    double target[3]; /* middle of the voxel boxes, or what is looked at */
    double radius;    /* from their middle to the farthest corner of a box */
    double distance;  /* of the eye from the target; 0: parallel */
    double pitch;     /* world length of a pixel's side, at the target */
} reference_camera;

void reference_camera_of(const reference_scene *scene, reference_camera *out);

/* A ray in index space: position = start + t * step, where t counts world
 * length away from the camera.  `x`, `y` are image points (pixel centres lie
 * at one half).  In perspective it starts at the eye, and only t > 0 is seen;
 * a parallel one starts in the plane of the target and has no beginning. */
typedef struct reference_ray {
    double start[3], step[3];
} reference_ray;

reference_ray reference_ray_at(const reference_scene *scene,
                               const reference_camera *camera, double x,
                               double y);

/* The image point at which an index position is seen. */
void reference_project(const reference_scene *scene,
                       const reference_camera *camera, const double index[3],
                       double pixel[2]);

/* How far an index position lies behind the plane of the target. */
double reference_behind(const reference_scene *scene,
                        const reference_camera *camera, const double index[3]);

/* The scalar product. */
double reference_dot(const double a[3], const double b[3]);

/* Rows of the inverse of the matrix' linear part. */
void reference_inverse(const double matrix[4][4], double inverse[3][3]);

/* The index axis that slices are taken along (model, section 5), and how far
 * the ray through an index position runs from one slice to the next (d of
 * section 6). */
int reference_slice_axis(const reference_scene *scene,
                         const reference_camera *camera);
double reference_slice_step(const reference_scene *scene,
                            const reference_camera *camera, int axis,
                            const double index[3]);

/* The kernel b(t / w) before normalisation, widened by `w`; the support in
 * voxels that the settings mean; and the factor w for pixels that are `rho`
 * voxels wide (point 7).  A box is [-wK/2, wK/2) and Gauss' cut the same; a
 * distance within 1e-5 voxels of an edge counts as on it, so that rounding does
 * not decide. */
double reference_kernel(snow_kernel kernel, int support, double w, double t);
int reference_support(const snow_settings *settings);
double reference_widening(snow_kernel kernel, int support, double rho);

/* Weights of grid positions 0 to count - 1 for a sample at `u`: b((u - i) / w)
 * over its sum for all integers i, also those outside the grid.  `*first` and
 * `*last` enclose the weights that are not 0 (first > last when none is). */
void reference_weights(snow_kernel kernel, int support, double w, double u,
                       int64_t count, double *weights, int64_t *first,
                       int64_t *last);

/* The native value of voxel (i, j, k), NaN outside the grid; colour and opacity
 * at a data value, straight. */
double reference_native(const reference_scene *scene, int64_t i, int64_t j,
                        int64_t k);
void reference_classify(const reference_scene *scene, double value,
                        double rgba[4]);

/* That of a smooth membership: the sum of bells, `reach` voxels to either side,
 * over the voxels that are members.  `sides`: none is beyond the grid, else
 * what is beyond is as the nearest voxel inside.  Along an axis of one voxel
 * nothing changes. */
typedef bool reference_member_fn(const void *user, const int64_t voxel[3]);
void reference_membership_gradient(const int64_t dims[3], int reach, bool sides,
                                   reference_member_fn *is_member,
                                   const void *user, const double at[3],
                                   double gradient[3]);

/* The gradient at a voxel in index space, of native values; and the gradient
 * opacity where it is such a one. */
void reference_gradient(const reference_scene *scene, const int64_t at[3],
                        double gradient[3]);
double reference_fade(const reference_scene *scene, const double gradient[3]);

/* Phong's model of a normal of any length, zeros if there is none, and a unit
 * vector to the eye: ambient and diffuse light, and specular light. */
void reference_light(const snow_settings *settings,
                     const reference_camera *camera, const double normal[3],
                     const double eye[3], double lit[2]);

/* Phong's model at a point whose gradient in index space is `gradient`. */
void reference_shade(const reference_scene *scene,
                     const reference_camera *camera, const double gradient[3],
                     double rgb[3]);

/* The samples that are splatted: (shaded c a', a') of every voxel, four
 * doubles each, zeros for uninteresting ones.  Free with free(). */
double reference_opacity_length(const reference_scene *scene);
double *reference_samples(const reference_scene *scene,
                          const reference_camera *camera, int axis);

/* The picture: width * height * 4 doubles, premultiplied.  Free with free(). */
double *reference_render(const reference_scene *scene);

/* The picture as a projection: width * height * 4 doubles of mip and minip; of
 * mean and sum width * height in data units, NaN where the ray misses. */
double *reference_mode(const reference_scene *scene);

/* The depth of a picture in mode over: width * height doubles, NaN where there
 * is none. */
double *reference_depth(const reference_scene *scene);

#endif
