/* tests/shear_warp/formulas.h - small volumes by a formula, whose pictures can
 * be computed by hand. */
#ifndef SNOW_TEST_SHEAR_WARP_FORMULAS_H
#define SNOW_TEST_SHEAR_WARP_FORMULAS_H

#include "shear_warp/scenes.h"

#define QUALITIES 3
extern const snow_quality qualities[QUALITIES]; /* rising */

/* The value at an index position. */
typedef double formula_fn(const double at[3]);

/* A white, unshaded scene of 49x41 pixels from +z with spacings of 1 by method
 * shear-warp, whose opacity is `opacity` everywhere. */
warp_scene formula_scene(const int64_t dims[3], formula_fn *formula,
                         double opacity);

/* Gives the axes other lengths in the world. */
void formula_scene_space(warp_scene *scene, const double spacing[3]);

/* Points the camera at side 0, 1 or 2: +x, +y or +z. */
void formula_scene_look(warp_scene *scene, int side, double azimuth,
                        double elevation, double fov);

/* One of 60 poses that see every pair of axis and projection, at no special
 * angle, in each quality. */
#define FORMULA_POSES 60
void formula_scene_pose(warp_scene *scene, int number);

/* The colour in the middle of the picture, of a single small pixel. */
void formula_scene_middle(const warp_scene *scene, double rgba[4]);

#endif
