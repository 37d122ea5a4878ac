/* tests/values/scenes.h - small volumes of float64 by a formula, for the laws
 * of the value model. */
#ifndef SNOW_TEST_VALUE_SCENES_H
#define SNOW_TEST_VALUE_SCENES_H

#include "support/support.h"
#include "values/value_model.h"

#define VALUE_QUALITIES 3
extern const snow_quality value_qualities[VALUE_QUALITIES]; /* rising */

/* The value at an index position. */
typedef double value_formula(const double at[3]);

/* A white, unshaded scene of 48x40 pixels from +z with spacings of 1 whose
 * opacity is `opacity` everywhere.  Free with value_scene_free. */
value_scene value_scene_of(const int64_t dims[3], value_formula *formula,
                           double opacity);
void value_scene_free(value_scene *scene);

/* The voxels, to be changed. */
double *value_scene_voxels(const value_scene *scene);

/* Gives the axes other lengths in the world. */
void value_scene_space(value_scene *scene, double x, double y, double z);

/* Points the camera at side 0, 1 or 2: +x, +y or +z. */
void value_scene_look(value_scene *scene, int side, double azimuth,
                      double elevation, double fov);

/* The scene's own plan; the test fails where there is none. */
value_plan value_scene_plan(const value_scene *scene);

/* The world length of a ray in the box of voxels, by the ray's direction to the
 * eye and a point of it, both in the order of the plan's axes. */
double value_scene_chord(const value_plan *plan, const value_ray *ray);

#endif
