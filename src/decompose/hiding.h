/* decompose/hiding.h - how much of a slab its own front hides, by optical
 * depths along some of the rays.
 *
 * Nothing is drawn behind nearly opaque pixels (M. Levoy, 1990), so that the
 * slices of a slab cost less behind others of it than each by itself: a cost
 * that depends on where the slab begins.  Rays are some voxels apart; each has
 * a sample in every slice, at the voxel next to it.
 *
 *     slices   0  1  2  3  4  5  6  7        # opaque
 *     ray ->   .  #  #  #  #  #  .  .        one slab: a sample is drawn
 *              .  # |#  #  # |#  .  .        three: one in each
 *
 * A part of all samples comes from each rank; their sum is that of all. */
#ifndef SNOW_DECOMPOSE_HIDING_H
#define SNOW_DECOMPOSE_HIDING_H

#include "decompose/order.h"

typedef struct snow_hiding {
    snow_viewer viewer;
    double length;   /* of a ray from slice to slice, in that of opacities */
    int axes[3];     /* of the grid: along a row, from row to row, of slices */
    int64_t dims[3]; /* along these */
    int64_t rays[2]; /* of a slice */
    double first[2], step[2]; /* where they meet the middle slice, in voxels */
    int64_t *depths; /* of samples, four to a number: of rays, of slices */
} snow_hiding;

/* For a grid whose slices lie along `axis`; nothing hides anything yet.  To be
 * freed in any case.  Errors: SNOW_STATUS_NO_MEMORY. */
snow_status snow_hiding_new(snow_context *context, const int64_t dims[3],
                            int axis, const snow_viewer *viewer, double length,
                            snow_hiding *out);
void snow_hiding_free(snow_context *context, snow_hiding *hiding);

/* The numbers in `depths`, to be summed over all ranks. */
size_t snow_hiding_words(const snow_hiding *hiding);

/* Along which of the rays on direction `on` (0: of a row, 1: from row to row)
 * voxel `at` of a slice lies; -1: none. */
int64_t snow_hiding_ray(const snow_hiding *hiding, int on, int64_t slice,
                        int64_t at);

/* The opacity of a sample, which is noted once. */
void snow_hiding_add(snow_hiding *hiding, const int64_t ray[2], int64_t slice,
                     double opacity);

/* The starts of parts slabs (`parts` + 1 of them) of at most `longest` slices
 * whose dearest one is about as cheap as possible. Slices cost sums[n + 1] -
 * sums[n] unless something hides them, and a span of samples as much as `span`
 * of them.  Errors: SNOW_STATUS_NO_MEMORY. */
snow_status snow_hiding_cut(snow_context *context, const snow_hiding *hiding,
                            const int64_t *sums, int span, int64_t longest,
                            int parts, int64_t *starts);

#endif
