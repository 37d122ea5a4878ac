/* formats/hdf5/blocks.h - grids of refinement in HDF5: blocks of cells on
 * levels, which are shown as those of formats/amr are.
 *
 *   blocks.c       leaves of a tree, of one size in cells, that fill the domain
 *   tables.c       the numbers that say where they are
 *   flash.c        those of FLASH
 *   athena.c       those of Athena++
 *   overlapping.c  boxes of VTKHDF, of any size, the finer ones over others */
#ifndef SNOW_FORMATS_HDF5_BLOCKS_H
#define SNOW_FORMATS_HDF5_BLOCKS_H

#include "formats/amr/amr.h"
#include "formats/hdf5/hdf5.h"

#if SNOW_HAVE_HDF5

/* A block, and where it is among all of its level. */
typedef struct hdf5_leaf {
    int level;
    int64_t at[3], row; /* row: its number in the data sets */
} hdf5_leaf;

/* Leaves halve each other's cells, but along axes of one cell. */
typedef struct hdf5_leaves {
    snow_context *context;
    const hdf5_file *file;
    const snow_volume_options *options;
    snow_volume_info *info;
    hdf5_set set;     /* of the values; its id is -1 until it is open */
    int axis;         /* of it, which counts blocks */
    hsize_t variable; /* where it is an axis before that */
    int64_t cells[3], ghosts[3]; /* of a block; around it */
    int64_t blocks[3];           /* that level 0 would have */
    hdf5_leaf *leaves;
    size_t count;
    amr_grid grid; /* corner and size are set by who finds leaves */
} hdf5_leaves;

/* Finds the leaves if the file is of this kind, and the data set that is asked
 * for one of its fields.  Errors: SNOW_STATUS_BAD_INPUT, SNOW_STATUS_BAD_USAGE,
 * SNOW_STATUS_NO_MEMORY. */
snow_status snow_hdf5_find_flash(hdf5_leaves *all, bool *found);
snow_status snow_hdf5_find_athena(hdf5_leaves *all, bool *found);

/* Makes room for `count` leaves, and numbers their levels from the coarsest one
 * on, once they are set. */
snow_status snow_hdf5_make_leaves(hdf5_leaves *all, hsize_t count);
int snow_hdf5_number_levels(hdf5_leaves *all);

/* Opens a data set of these many axes if there is one; false else. */
bool snow_hdf5_open_set(const hdf5_file *file, const char *path, int axes,
                        hdf5_set *out);

/* All numbers of a data set of `rows` rows, 0 for any, and so many axes.  The
 * caller releases them.  Errors: SNOW_STATUS_BAD_INPUT, SNOW_STATUS_NO_MEMORY.
 */
snow_status snow_hdf5_read_table(snow_context *context, const hdf5_file *file,
                                 const char *path, int axes, hsize_t rows,
                                 hdf5_set *sizes, double **out);

/* Reads a grid of refinement if the file has one, and what is asked for is of
 * it. */
snow_status snow_hdf5_read_leaves(snow_context *context, const hdf5_file *file,
                                  const snow_volume_options *options,
                                  snow_volume_info *info, snow_volume **out,
                                  bool *found);
snow_status snow_hdf5_read_overlapping(snow_context *context,
                                       const hdf5_file *file,
                                       const snow_volume_options *options,
                                       snow_volume_info *info,
                                       snow_volume **out, bool *found);

#endif
#endif
