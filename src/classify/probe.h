/* classify/probe.h - the value of a volume at a point of a slice's plane: the
 * weighted mean of the voxels around it (model, point 8). */
#ifndef SNOW_PROBE_H
#define SNOW_PROBE_H

#include "volume/volume.h"

/* The most voxels of a window along an axis. */
#define SNOW_PROBE_MOST 128

/* A window of voxels of a slice, within the grid, and its weights. */
typedef struct snow_probe {
    const snow_volume *volume;
    int axes[3];      /* u, v, slices */
    int64_t first[2]; /* along u and v */
    int count[2];     /* perhaps none */
    int64_t slice;
    double weights[2][SNOW_PROBE_MOST];
} snow_probe;

/* The sum of weighted native values, and of the weights, of finite voxels. */
void snow_probe_value(const snow_probe *probe, double sums[2]);

/* The same mean of gradients of native values in index space; zeros where there
 * is nothing. */
void snow_probe_gradient(const snow_probe *probe, double gradient[3]);

#endif
