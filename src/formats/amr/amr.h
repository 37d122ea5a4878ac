/* formats/amr/amr.h - grids of adaptive mesh refinement: boxes of cells on
 * several levels, each of which divides the cells of the one below.
 *
 *     level 0   |       |       |       |       |     cells of all levels are
 *     level 1           |   |   |   |   |             read as one even grid of
 *     level 2                   | | | |               the finest level's
 *     grid      | | | | | | | | | | | | | | | | |
 *
 *   grid.c      levels and boxes -> the even grid, and what info says of them
 *   gather.c    cells of all levels -> voxels of a box of it
 *   plotfile.c  folders of AMReX: the header, the boxes of a level by boxes.c,
 *               their values by fab.c
 *   vth.c       .vth of VTK, which names a .vti for each box
 *   words.c     numbers in text between parentheses and commas
 *
 * A voxel is of the finest cell around it, its leaf.  Cells below finer ones
 * are not read; what stands in their place are the means of these.  Files of
 * HDF5 have such grids too (formats/hdf5/blocks.h). */
#ifndef SNOW_FORMATS_AMR_AMR_H
#define SNOW_FORMATS_AMR_AMR_H

#include "formats/ascii.h"

#define AMR_MOST_LEVELS 24
#define AMR_MOST_BOXES 4000000
#define AMR_MOST_COMPONENTS 100000

/* Cells of a level; `box` counts them from the corner of the grid. */
typedef struct amr_box {
    int level;
    snow_box box;
} amr_box;

/* Reads a part of box `number`, which has cells of its level. */
typedef snow_status amr_read_fn(void *user, size_t number, const snow_box *part,
                                snow_volume **out);

typedef struct amr_grid {
    snow_context *context;
    int levels;                        /* that are in the file */
    int64_t ratio[AMR_MOST_LEVELS][3]; /* cells of a level in one of the level
                                          below; of level 0: 1 */
    int64_t cells[3];                  /* of level 0 */
    double corner[3], size[3];         /* of the grid; of a cell of level 0 */
    snow_type type;
    amr_box *boxes; /* of any order; released by snow_amr_free */
    size_t count;
    amr_read_fn *read;
    void *user;
    bool leaves; /* there are no cells below finer ones: those beyond the level
                    of the voxels are read as its cells, from means */
    int finest;  /* the level of the voxels */
} amr_grid;

/* Whether the cells of all levels can be counted: to be called before boxes are
 * added.  Errors: SNOW_STATUS_BAD_INPUT. */
snow_status snow_amr_check(const amr_grid *grid);

/* Adds a box, which must lie in the grid.  Errors: SNOW_STATUS_BAD_INPUT,
 * SNOW_STATUS_NO_MEMORY. */
snow_status snow_amr_add(amr_grid *grid, int level, const snow_box *box);
void snow_amr_free(amr_grid *grid);

/* Cells of a level in the whole grid. */
void snow_amr_cells(const amr_grid *grid, int level, int64_t out[3]);

/* Chooses the level of the voxels, and of leaves makes boxes beyond it boxes of
 * it; sets sizes, type, matrix and storage.
 * Errors: SNOW_STATUS_BAD_INPUT (few boxes for such a grid). */
snow_status snow_amr_describe(amr_grid *grid,
                              const snow_volume_options *options,
                              snow_volume_info *info);

/* Reads the box of the options.  info is as described.  Errors:
 * SNOW_STATUS_BAD_USAGE (the box), SNOW_STATUS_NO_MEMORY, those of `read`. */
snow_status snow_amr_read(const amr_grid *grid,
                          const snow_volume_options *options,
                          snow_volume_info *info, snow_volume **out);

/* The numbers of "((0,0,0) (31,31,31) (0,0,0))", as in formats/ascii.h. */
static inline int snow_amr_numbers(const char *text, double *out, int most) {
    return snow_text_reals(text, ",()", out, most);
}

static inline int snow_amr_integers(const char *text, int64_t *out, int most) {
    return snow_text_integers(text, ",()", out, most);
}

/* A line that is not what it should be; reads the next one, of up to `bytes`.
 * Errors: SNOW_STATUS_BAD_INPUT. */
snow_status snow_amr_refuse(snow_context *context, const char *line,
                            const char *what);
snow_status snow_amr_line(snow_source *source, char *line, size_t bytes,
                          const char *what);

/* --- plotfile.c, boxes.c, fab.c ------------------------------------------- */

#define AMR_NAME_BYTES 1024

/* Opens a file of a plotfile by its name in the folder. */
typedef snow_status amr_open_fn(void *user, const char *name,
                                snow_source **out);

/* Where the values of a box are: a FAB, one component after another. */
typedef struct amr_fab {
    size_t name;         /* of its file, in a block of names */
    int64_t offset, end; /* of the file; or where its next FAB begins */
    double low, high;    /* of the component, without ghosts; NaN: not known */
} amr_fab;

/* What all FABs of a level have alike. */
typedef struct amr_fabs {
    int64_t components;
    bool bare; /* they have no headers, and these are of all */
    snow_type type;
    bool big_endian;
} amr_fabs;

typedef struct amr_plotfile {
    snow_context *context;
    amr_open_fn *open;
    void *user;
    amr_grid grid;
    int axes; /* 1 to 3 */
    int64_t components, component;
    char name[64]; /* of the component */
    double time;
    int64_t first[AMR_MOST_LEVELS][3]; /* of a level's cells: the corner */
    int64_t ghosts[AMR_MOST_LEVELS][3];
    amr_fabs level[AMR_MOST_LEVELS];
    amr_fab *fabs; /* one for each box */
    char *names;
    size_t names_used;
} amr_plotfile;

/* Reads the boxes of a level from its file "Level_0/Cell_H".  Errors:
 * SNOW_STATUS_BAD_INPUT, SNOW_STATUS_NO_MEMORY. */
snow_status snow_plotfile_read_boxes(amr_plotfile *file, int level,
                                     const char *name);

/* Takes the type from the numbers of a header, as IEEE 754 has it; how many
 * are used. */
bool snow_plotfile_take_type(const int64_t *numbers, int count, int *used,
                             snow_type *type, bool *big_endian);

/* Finds the type of the values of a box; reads a part of it (amr_read_fn).
 * Errors: SNOW_STATUS_BAD_INPUT, SNOW_STATUS_NO_MEMORY. */
snow_status snow_plotfile_type(const amr_plotfile *file, size_t number,
                               snow_type *out);
snow_status snow_plotfile_read_box(void *user, size_t number,
                                   const snow_box *part, snow_volume **out);

/* Reads a plotfile whose Header is at its first byte. */
snow_status snow_plotfile_read(snow_source *header, amr_open_fn *open,
                               void *user, const snow_volume_options *options,
                               snow_volume_info *info, snow_volume **out);

/* The path of the Header in a folder that is a plotfile, in a block that the
 * caller releases; NULL where it is none. */
snow_status snow_plotfile_header(snow_context *context, const char *path,
                                 char **out);

#endif
