/* tests/reference/shear_warp.h - what a picture of the sheared method is,
 * computed slowly.
 *
 * The sheared model in float64 and gather form: every pixel of the slices'
 * lattice (transform/shear.h) meets every slice, sheets are laid over each
 * other there, and the picture looks the result up.  Beside the public records
 * it shares with the library only the stored normals' code and meaning.  It
 * does without early termination, bands, tiles and tables. */
#ifndef SNOW_TEST_SHEARED_H
#define SNOW_TEST_SHEARED_H

#include "reference/model.h"

/* What is rendered, and how true to the data: zeros mean the whole volume as
 * the library stores it. */
typedef struct sheared_options {
    int parts, part;    /* a slab; parts 0: the whole */
    bool exact_normals; /* of double precision, not as codes */
    bool exact_values;  /* wider types' values, not as codes */
    double fine[3];     /* of a level: steps of its volume in its own; else 0 */
} sheared_options;

/* What a rendering came to beside its pixels. */
typedef struct sheared_facts {
    int axis;         /* of the slices: the best one */
    int axes;         /* that the picture is blended of */
    int phases[2];    /* pixels a voxel of the lattice, along u and v */
    int stride[2];    /* voxels a pixel */
    double strongest; /* greatest opacity on a lattice */
} sheared_facts;

/* The scene at the resolution of a level (levels.h): the library's voxels,
 * which tests/volume/test_mipmap.c holds against float64, and what the kernel
 * has to know of them.  Close the volumes made, NULL where there is none. */
#define SHEARED_LEVELS_MOST 8
reference_scene sheared_level(snow_context *context,
                              const reference_scene *scene,
                              const int halvings[3], sheared_options *options,
                              snow_volume *made[SHEARED_LEVELS_MOST]);

/* To which side values of a level lean: where opacities rise, all in all. */
int sheared_lean(const reference_scene *scene);

/* Whether the method can make the picture: a lattice pixel has no more than 30
 * voxels in reach along u or v.  Options may be NULL. */
bool sheared_fits(const reference_scene *scene, const sheared_options *options);

/* The picture: width * height * 4 doubles, premultiplied.  Free with free(). */
double *sheared_render(const reference_scene *scene,
                       const sheared_options *options, sheared_facts *facts);

/* The library's picture of a slab (parts 0: the whole) as width * height * 4
 * floats RGBA, by the method of the settings; free with free().  The test fails
 * unless that succeeds. */
float *sheared_picture(const model_stage *stage, const reference_scene *scene,
                       int parts, int part);

/* Bounds for an unshaded or shaded picture: a quarter of a step of 8 bits, and
 * a whole one where what lies behind opaque pixels may be left out. */
#define SHEARED_BOUND (0.25 / 255)
#define SHEARED_BOUND_OPAQUE (1.0 / 255)

/* What a sweep came to, apart for pictures with opaque lattice pixels and for
 * those that were left to footprints. */
typedef struct sheared_tally {
    int clear, opaque, footprints;
    double clear_most, opaque_most, footprints_most;
    double strongest; /* summed up */
} sheared_tally;

/* Renders both ways and fails the test, with the scene in words, unless the
 * pictures differ by no more than `bound` where nothing is opaque and by
 * SHEARED_BOUND_OPAQUE + bound - SHEARED_BOUND elsewhere; and unless the frame
 * says the right method.  A picture that does not fit has to equal the exact
 * one within 1e-3. */
void sheared_check(const model_stage *stage, const reference_scene *scene,
                   const sheared_options *options, double bound,
                   sheared_tally *tally);

/* Prints a tally under a title; fails the test when next to nothing showed. */
void sheared_report(const char *title, const sheared_tally *tally);

#endif
