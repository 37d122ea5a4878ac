/* decompose/ray_grid.h - how much of each slice of a slab is drawn, predicted
 * from a coarse volume of opacities.
 *
 * Pixels that nothing shines through any more are not drawn (early ray
 * termination), and each rank begins at the front of its own slab.  So what a
 * slice costs depends on where its slab begins:
 *
 *   eye -->   front of the slab
 *             |..##########|     # interesting, . not
 *              drawn: the first of the #, until their pixels are opaque
 *
 * The grid has, for each cell of voxels, how many are interesting and how much
 * of a pixel they make opaque.  Rays go from cell to cell along the slices'
 * axis, aside by the shear of the view. */
#ifndef SNOW_DECOMPOSE_RAY_GRID_H
#define SNOW_DECOMPOSE_RAY_GRID_H

#include "decompose/partition.h"

/* The rays of a view, and what an opacity takes from a pixel. */
typedef struct snow_ray_view {
    int axes[3];     /* of the volume: along u, along v, along the slices */
    double slope[2]; /* voxels along u and v from one slice to the next */
    double path;     /* of a ray between two slices, in lengths of an opacity */
    bool nearest_first; /* slice 0 is the nearest to the viewer */
} snow_ray_view;

/* Steps of the opacity of a voxel in the table. */
#define SNOW_RAY_STEPS 256

typedef struct snow_ray_grid {
    snow_ray_view view;
    int64_t dims[3], cell[3], cells[3]; /* along u, v, slices: voxels, voxels of
                                           a cell, cells */
    int64_t step;   /* of the slices along z of the volume that are counted */
    uint32_t whole; /* of a cell's sum: what closes all rays */
    uint32_t closes[SNOW_RAY_STEPS]; /* of a pixel, of `whole` */
    int64_t *sums; /* u fastest; of each cell interesting voxels in the upper,
                      what they close in the lower 32 bits.  The caller's */
} snow_ray_grid;

/* Cells for a volume; sums are not set. */
void snow_ray_grid_make(const snow_ray_view *view, const int64_t dims[3],
                        int64_t step, snow_ray_grid *out);
size_t snow_ray_grid_cells(const snow_ray_grid *grid);

/* Returns where a voxel's cell is, by its index along an axis of the volume:
 * the sum of those of three. */
int64_t snow_ray_grid_place(const snow_ray_grid *grid, int axis, int64_t voxel);

/* What an interesting voxel adds to the sum of its cell. */
static inline int64_t snow_ray_grid_word(const snow_ray_grid *grid,
                                         float opacity) {
    const int step = (int)(opacity * (SNOW_RAY_STEPS - 1) + 0.5F);
    return (INT64_C(1) << 32) + grid->closes[step];
}

/* The state of a prediction; the sums of the grid are known by then. */
typedef struct snow_ray_walk {
    const snow_ray_grid *grid;
    float span;             /* what one costs, in voxels */
    float *drawn, *closing; /* of each cell: the share of its voxels that is
                                 interesting; what a slice of it closes, of 1 */
    float *closed;  /* of the rays that are in the layer, by its cells */
    double side[2]; /* how far aside, in cells, they have moved there */
} snow_ray_walk;

/* Errors: SNOW_STATUS_NO_MEMORY.  Free in any case. */
snow_status snow_ray_walk_new(snow_context *context, const snow_ray_grid *grid,
                              int span, snow_ray_walk *out);
void snow_ray_walk_free(snow_context *context, snow_ray_walk *walk);

/* What is drawn of each of the slices first .. first + count - 1, of all that
 * would be if nothing hid anything, where they are one slab: shares[0] is of
 * the first of them. */
void snow_ray_walk_slab(snow_ray_walk *walk, int64_t first, int64_t count,
                        double *shares);

/* Slabs by counts with rays, which cost what is drawn of them: of several cuts
 * that whose most expensive slab costs least.  Errors: SNOW_STATUS_NO_MEMORY.
 */
snow_status snow_partition_by_rays(snow_context *context,
                                   const snow_block_counts *counts, int ranks,
                                   snow_box *boxes);

#endif
