/* tests/reference/gather.h - how the reference gathers a sheet: what
 * its pictures of all modes share. */
#ifndef SNOW_TEST_REFERENCE_GATHER_H
#define SNOW_TEST_REFERENCE_GATHER_H

#include "reference/reference.h"

/* What stays the same over all pixels of one picture. */
typedef struct reference_gather {
    const reference_scene *scene;
    const double *samples;
    snow_kernel kernel;
    int support;
    int axis, u_axis, v_axis;  /* of the slices; the two within a slice */
    double *u_width, *v_width; /* per slice: how much the kernel is widened */
    double *u_weights, *v_weights;
} reference_gather;

/* All but the samples. */
void reference_gather_begin(const reference_scene *scene,
                            const reference_camera *camera,
                            reference_gather *out);
void reference_gather_end(reference_gather *gather);

/* Where the ray meets the plane of slice `slice`; false when that is not in
 * front of the eye. */
bool reference_meet_slice(const reference_gather *gather,
                          const reference_ray *ray, int64_t slice, double *u,
                          double *v);

/* The slice position at which opacity passes 1/2 along a ray, NaN where it does
 * not: what a sheet adds grows evenly from half a slice before it to half a
 * slice behind. */
double reference_passes(const reference_gather *gather,
                        const reference_ray *ray);

#endif
