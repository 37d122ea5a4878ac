/* render/raycast/raycast.h - method raycast: the truth that the other methods
 * are compared with.
 *
 * Values are interpolated (field.h), and what they look like comes after: each
 * ray is walked in small equal steps from where it enters the field to where it
 * leaves it, exactly.
 *
 *           enter                      leave
 *   ray  -----|--.--|--.--|--.--|--.--|------>    step = (leave - enter) / n
 *                samples in the middle of steps (over), or at their ends
 *
 * A step is at most 1/2, 1/4 or 1/16 of the smallest spacing in quality draft,
 * normal and high.  There is no encoding and no approximation for the sake of
 * speed; what cannot be seen is skipped only where that changes nothing.
 *
 * In mode iso a ray may be walked by parts, from front to back: each looks at
 * the ends of steps next to its own voxels, which are the same ends for all,
 * and what the parts before have met stays. */
#ifndef SNOW_RENDER_RAYCAST_H
#define SNOW_RENDER_RAYCAST_H

#include "classify/classify.h"
#include "render/picture.h"
#include "render/raycast/field.h"

/* What all rays of a picture share. */
typedef struct snow_raycast_pass snow_raycast_pass;

/* A ray: index position (x, y, z) start + t * along, t in world units. */
typedef struct snow_ray {
    double start[3], along[3];
    double enter, leave; /* of the field; enter < leave */
    double step;
    int64_t steps;
    int64_t first, last; /* ends of steps that may be of the part at hand */
} snow_ray;

/* What a thread keeps from sample to sample. */
typedef struct snow_raycast_eye {
    snow_field_window near, sides[6];
    snow_shader shader; /* of the present ray */
    double gradients[3][SNOW_SHADE_BLOCK];
    struct snow_raycast_eye *layers; /* windows of these */
} snow_raycast_eye;

/* A ray becomes a pixel of the local image, which holds zeros; *depth, NULL
 * where it is not asked for, holds NaN. */
typedef void snow_raycast_fn(const snow_raycast_pass *pass, const snow_ray *ray,
                             snow_raycast_eye *eye, float *pixel, float *depth);

struct snow_raycast_pass {
    const snow_job *job;
    const snow_transfer *transfer; /* of the picture, in every mode */
    snow_field field;
    snow_raycast_fn *cast;
    snow_shader shader;
    snow_viewer viewer; /* as the stored voxels see it */
    bool shaded, gradient_factors;
    bool labels, nearest; /* numbers that name things (field.h) */
    double step;          /* the longest, in world units */
    bool cut;             /* the volume is a part of one: */
    int64_t own[3][2];    /* its first and last voxels */
    double depth[4];      /* of index position (x, y, z), and a constant */
    /* Values that a window must reach to be seen, in the field's units. */
    double visible[2];
    /* Of mode iso, with the surface's colour: */
    double isovalue;
    float rgb[3];
    /* Layers drawn with it, of mode over. */
    struct snow_raycast_pass *layers;
    int layer_count;
    bool mixes; /* as a layer: with the one before it */
    /* The other modes take a value as (value - from) / range. */
    double from, range;
};

snow_raycast_fn snow_raycast_over, snow_raycast_iso, snow_raycast_largest,
    snow_raycast_sum;

/* Index position at t. */
static inline void snow_ray_at(const snow_ray *ray, double t, double at[3]) {
    for (int axis = 0; axis < 3; axis++)
        at[axis] = ray->start[axis] + t * ray->along[axis];
}

/* How many steps from `at` on stay between the same voxels, at least 1. */
int64_t snow_ray_skip(const snow_ray *ray, const double at[3]);

/* How much of the light at a position is that of cut faces. */
float snow_raycast_flatness(const snow_raycast_pass *pass, const double at[3]);

/* The depth of a picture at t. */
float snow_raycast_depth(const snow_raycast_pass *pass, const snow_ray *ray,
                         double t);

/* Fills the values from which on a look, or a surface, is seen at all. */
void snow_raycast_see_look(snow_raycast_pass *pass);

#endif
