/* tests/values/pictures.h - pictures of method shear-warp beside the float64
 * reference of the value model. */
#ifndef SNOW_TEST_VALUE_PICTURES_H
#define SNOW_TEST_VALUE_PICTURES_H

#include "reference/model.h"
#include "values/value_model.h"

/* A scene for each number: all axes and types, spacings, qualities, densities,
 * shades, lights and looks.  Free with value_picture_free. */
#define VALUE_PICTURES 180
reference_scene value_picture_scene(int n);
void value_picture_free(reference_scene *scene);

/* Layers of a scene's structure become labels, 0, 1, 2, 3 and 5. */
void value_picture_name(const reference_scene *scene);

/* Makes holes of voxels of a scene of floats here and there, or of all beyond a
 * surface. */
void value_picture_punch(reference_scene *scene, int n);

/* Cuts a scene by one or two planes through it, which are written to `planes`;
 * voxels with the largest and the smallest value are left. */
void value_picture_clip(value_scene *scene, size_t count, double planes[2][4]);

/* The reference's picture, whose pixels end as those of the method: width *
 * height * 4 doubles. */
double *value_picture_expected(const value_scene *scene);

/* The method's picture of a scene: width * height * 4 floats; free with
 * free(). */
float *value_picture_render(const model_stage *stage, const value_scene *scene);

/* Both; and that the picture has the same bits with any number of threads,
 * encoding and instruction set. */
void value_picture_check(const model_stage *stage, int n,
                         const value_scene *scene);
void value_picture_check_bits(const model_stage *stage, int n,
                              const value_scene *scene);

/* The same of scenes first, first + step and so on, which `scene` makes. */
typedef value_scene value_scene_fn(int n);
void value_pictures_check(int first, int step, value_scene_fn *scene);
void value_pictures_check_bits(int first, int step, value_scene_fn *scene);

/* As value_picture_check, as if the strongest pixel were of 1/8: nothing may
 * hide in faintness. */
void value_picture_check_faint(const model_stage *stage, int n,
                               const value_scene *scene);

/* The test fails, with the scene's number, where a picture is too far from the
 * reference's. */
void value_picture_compare(int n, const reference_scene *scene,
                           const float *picture, const double *expected);

#endif
