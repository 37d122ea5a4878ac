/* transfer/walk.h - passes over the voxels that a rank is responsible for, in
 * blocks of data values or in runs of native ones. */
#ifndef SNOW_TRANSFER_WALK_H
#define SNOW_TRANSFER_WALK_H

#include "base/monitor.h"
#include "transfer/look.h"
#include "volume/stream.h"

#define SNOW_WALK_BLOCK 1024

/* Values of 16 bits: stored values, and digits of longer keys. */
#define SNOW_DIGIT_BITS 16
#define SNOW_DIGITS (1 << SNOW_DIGIT_BITS)

/* A snow_voxel_walk over the voxels that this rank is responsible for, in the
 * order of the whole volume, in contiguous runs. */
typedef struct snow_voxel_walk {
    const snow_volume *volume;
    bool log;        /* values that are not above 0 become NaN */
    snow_region box; /* of the whole volume, in voxels */
    int64_t stored[3];
    int64_t runs, run; /* number of runs; index of the next one */
    uint64_t at, end;  /* of the current run: voxels of the whole volume */
    int64_t ahead; /* from a voxel of the whole volume to its place in memory */
    uint64_t dropped;      /* values that became NaN */
    uint64_t stride;       /* distance of sampled blocks in the whole volume */
    snow_monitor *monitor; /* that may end it; NULL: none, or of ranks */
    unsigned blocks;       /* so far */
} snow_voxel_walk;

/* Walks over a slab of the histogram's volume, or of its sample. */
snow_voxel_walk snow_voxel_walk_begin(const snow_histogram *histogram,
                                      const snow_volume *slab, bool log,
                                      snow_histogram_mode histogram_mode);

/* Finds the next run, from `at` to `end`; false if none is left.  Linear
 * indices of the voxels in memory follow one another, too. */
bool snow_voxel_walk_next_run(snow_voxel_walk *walk);

/* Returns whether the caller wants the pass to end, which snow_histogram_visit
 * returns then. Ranks end together, behind their passes. */
bool snow_voxel_walk_is_stopped(snow_voxel_walk *walk);

/* Finds the next voxels, up to SNOW_WALK_BLOCK, that a sampled block has in the
 * run: their number, 0 at the end or where it is stopped, and the place in
 * memory of the first. */
size_t snow_voxel_walk_next_voxels(snow_voxel_walk *walk, int64_t *first);

/* Their data values. */
size_t snow_voxel_walk_next_block(snow_voxel_walk *walk,
                                  double values[SNOW_WALK_BLOCK]);

/* Makes one pass over all slabs of a volume, each with a walk of its own, or
 * over the sample.  Ranks whose voxels stay in their file agree on the
 * status; in memory it cannot fail but by a stop, which ends no pass of ranks.
 */
snow_status snow_histogram_visit(const snow_histogram *histogram,
                                 snow_histogram_mode histogram_mode,
                                 snow_slab_fn *visit, void *user);

/* Adds up what all ranks have counted. */
snow_status snow_histogram_sum(const snow_histogram *histogram,
                               uint64_t *counts, size_t count);

/* The same for a table of SNOW_DIGITS counts, most of which are often zero:
 * only those between the first and the last that any rank uses are sent. */
snow_status snow_histogram_sum_table(const snow_histogram *histogram,
                                     uint64_t *counts);

/* Allocates `tables` of SNOW_DIGITS counts, zeros; ranks agree on status. */
snow_status snow_histogram_new_tables(const snow_histogram *histogram,
                                      size_t tables, uint64_t **out);

/* --- stored_values.c: 8 and 16 bit types ---

 * Collective. Counts voxels by their native value, and sets the range. */
snow_status snow_stored_values_count(snow_histogram *histogram);

/* Finds the range alone. Data values rise or fall with stored values, so that
 * their extremes are those of the stored values.  *found is false where the
 * smallest and largest value that count (finite, and above 0 on a logarithmic
 * scale) are others. */
snow_status snow_stored_values_range(snow_histogram *histogram, bool *found);

/* The n-th counted value in the order of data values (reversed if the slope is
 * negative), and its count. */
uint64_t snow_stored_values_nth(const snow_histogram *histogram, int n,
                                double *value);

/* The value of a rank, from 0, among the counted ones. */
double snow_stored_values_quantile(const snow_histogram *histogram,
                                   uint64_t rank);

#endif
