/* render/modes/interpolate.h - the value of a volume at a point of a slice's
 * plane: the weighted mean of the voxels around it (model, point 8). */
#ifndef SNOW_RENDER_MODES_INTERPOLATE_H
#define SNOW_RENDER_MODES_INTERPOLATE_H

#include "volume/volume.h"

/* The most voxels of a window along an axis. */
#define SNOW_INTERPOLATE_MOST 128

/* A window of voxels of a slice, within the grid, and its weights. */
typedef struct snow_interpolate_window {
    const snow_volume *volume;
    int axes[3];      /* u, v, slices */
    int64_t first[2]; /* along u and v */
    int count[2];     /* perhaps none */
    int64_t slice;
    double weights[2][SNOW_INTERPOLATE_MOST];
} snow_interpolate_window;

/* The sum of weighted native values, and of the weights, of finite voxels. */
void snow_interpolate(const snow_interpolate_window *probe, double sums[2]);

/* The same mean of gradients of native values in index space; zeros where there
 * is nothing. */
void snow_interpolate_gradient(const snow_interpolate_window *probe,
                               double gradient[3]);

/* --- cubics ----------------------------------------------------------------
 *
 * The usual window: 4 x 4 voxels of a volume without holes, all of them and
 * their neighbours within the grid, under a kernel that needs no wider one.
 * Values are counted from a base near those that are looked for, so that floats
 * are as good as doubles. */
typedef struct snow_cubic_window {
    int64_t at;          /* the window's first voxel */
    float weights[2][4]; /* along u and v; each adds up to 1 */
} snow_cubic_window;

/* The volume as such windows see it. */
typedef struct snow_cubic_grid {
    const void *voxels;
    snow_type type;
    int axes[3];      /* u, v, slices */
    int64_t steps[3]; /* voxels from one to the next along u, v and slices */
    double base;      /* native */
} snow_cubic_grid;

/* A whole number for volumes of them. */
snow_cubic_grid snow_cubic_grid_of(const snow_volume *volume, const int axes[3],
                                   double base);

/* The value less the base; `slices` slices farther, which may be below 0. */
float snow_interpolate_cubic(const snow_cubic_grid *grid,
                             const snow_cubic_window *near, int64_t slices);

/* As snow_interpolate_gradient. */
void snow_interpolate_cubic_gradient(const snow_cubic_grid *grid,
                                     const snow_cubic_window *near,
                                     double gradient[3]);

#endif
