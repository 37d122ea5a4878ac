/* tests/reference/raycast.h - the ray caster that says how a volume looks: the
 * field that its values are samples of, classified after interpolation (Levoy
 * 1988).  Written from docs/model.md, section 9, without code of the library.
 *
 * Every sample of every ray is computed, whatever it is worth. */
#ifndef SNOW_TEST_REFERENCE_RAYCAST_H
#define SNOW_TEST_REFERENCE_RAYCAST_H

#include "reference/reference.h"

/* What is cast beside a scene, whose settings name mode, kernel, quality,
 * threshold, light and iso value. */
typedef struct reference_cast {
    const reference_scene *scene;
    bool labels; /* values are the numbers of things */
    const double (
        *planes)[4]; /* of the world: a x + b y + c z > d is cut off */
    int plane_count;
    const struct reference_cast *next; /* another channel, in mode over */
} reference_cast;

/* Values are those of the field at an index position, up to one voxel beyond
 * its ends; NaN in a hole. */
double reference_field(const reference_cast *cast, const double at[3]);

/* The picture: width * height * 4 doubles, premultiplied; of modes mean and sum
 * width * height data values, NaN where a ray finds none.  `depth`, width *
 * height doubles, may be NULL.  Free with free(). */
double *reference_cast_rays(const reference_cast *cast, double *depth);

#endif
