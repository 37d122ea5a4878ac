/* formats/uneven/uneven.h - grids whose coordinates along some axes are not
 * evenly spaced: they are resampled to even ones.
 *
 *     file   |-|-|--|---|-----|----------|      coordinates, rising or falling
 *     even   |-|-|-|-|-|-|-|-|-|-|-|-|-|-|      as fine as their smallest step
 *
 * The node nearest to a line of the file has its values, so that none is lost;
 * between such nodes values are linear between neighbours of the file, or those
 * of the nearest line where they are codes.  If nodes are too few, some lines
 * fall together.  Every box of the even grid is read of the file's voxels
 * around it, so that slabs and crops serve a large file. */
#ifndef SNOW_FORMATS_UNEVEN_H
#define SNOW_FORMATS_UNEVEN_H

#include "formats/format.h"

typedef struct snow_uneven {
    int64_t count[3];       /* voxels of the file */
    const double *at[3];    /* coordinates of all of them; NULL: an even axis */
    const double *moved[3]; /* where they are on the grid that `at` makes, if
                               that is elsewhere; NULL: at `at` */
    int64_t even[3];        /* voxels of the even grid */
    double step[3]; /* of the even grid, along uneven axes; may be below 0;
                       its first voxel is at[i][0] */
    bool codes;     /* values between two of the file mean nothing */
} snow_uneven;

/* Returns whether coordinates are finite, and rise or fall throughout, not over
 * next to nothing. */
bool snow_uneven_fits(const double *coordinates, int64_t count);

/* Returns whether any axis is uneven. */
bool snow_uneven_any(const snow_uneven *grid);

/* Chooses `even` and `step`, and notes what is resampled, with the units of the
 * coordinates (or ""), also in info->storage; integers are codes unless the
 * caller says otherwise. */
void snow_uneven_plan(snow_context *context, snow_uneven *grid,
                      const char *const units[3], snow_volume_info *info);

/* Reads a box of the file's own voxels, as the crop of the options says; where
 * `out` is NULL only the sizes are checked. */
typedef snow_status snow_uneven_fn(void *user,
                                   const snow_volume_options *options,
                                   snow_volume_info *info, snow_volume **out);

/* Reads the box of the options of the even grid; without uneven axes it is
 * `read` alone.  info->dims are those of the
 * even grid, and become those of the box; info->type is that of the file's
 * voxels; type, slope and intercept become those of what `read` makes.  Errors:
 * SNOW_STATUS_BAD_USAGE (the box), SNOW_STATUS_NO_MEMORY, those of `read`. */
snow_status snow_uneven_read(snow_context *context, const snow_uneven *grid,
                             const snow_volume_options *options,
                             snow_uneven_fn *read, void *user,
                             snow_volume_info *info, snow_volume **out);

#endif
