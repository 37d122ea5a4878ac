/* tests/shear_warp/scenes.h - scenes that method shear-warp and method raycast
 * both draw: one volume or several, cut by planes. */
#ifndef SNOW_TEST_SHEAR_WARP_SCENES_H
#define SNOW_TEST_SHEAR_WARP_SCENES_H

#include "reference/model.h"

#define SCENE_PLANES 2

/* A scene and what the reference of splatting does not know. */
typedef struct warp_scene {
    reference_scene base;
    const struct warp_scene *front; /* a volume on the same grid, or NULL */
    bool mixes;                     /* that is a channel, not a layer */
    double planes[SCENE_PLANES][4]; /* a x + b y + c z > d is cut off */
    size_t plane_count;
    double symlog; /* linear up to it, logarithms beyond; 0: none */
} warp_scene;

/* The picture by the method that the settings name, which must be the one that
 * draws it: width * height * 4 floats.  A pixel of modes mean and sum is its
 * value, 0, 0 and whether there is one.  Free with free(). */
float *warp_scene_render(const model_stage *stage, const warp_scene *scene);

/* Frees voxels. */
void warp_scene_free(warp_scene *scene);

/* Whether pixels are data values. */
bool warp_scene_has_values(const warp_scene *scene);

/* Stores a data value as the native value of a voxel. */
void warp_scene_store(const reference_scene *scene, size_t at, double value);

/* Cuts by planes through shares of the volume's sides. */
void warp_scene_cut(warp_scene *scene, size_t planes);

/* The world position at shares of the volume's sides. */
void warp_scene_place(const reference_scene *scene, const double share[3],
                      double out[3]);

/* --- scenes with noise ---------------------------------------------------- */

/* A scene of 44x36 pixels for each number: all axes and types, spacings,
 * qualities, densities, shades, lights and looks.  Every fifth from the third
 * on is of floats. */
#define NOISY_SCENES 180
warp_scene noisy_scene(int n);

/* From an eye: fields of view from narrow to wide, cameras off the volume's
 * middle, and near to it. */
warp_scene noisy_scene_from_an_eye(int n);

/* Layers of a scene's structure become labels, 0, 1, 2, 3 and 5. */
void noisy_scene_name(const reference_scene *scene);

/* Makes holes of voxels of floats here and there, or beyond a surface. */
void noisy_scene_punch(reference_scene *scene, int n);

#endif
