/* formats/vtk/vtk.h - what the formats of VTK's image data and rectilinear
 * grids share: vtk.c reads the legacy format, vti*.c the XML format. */
#ifndef SNOW_FORMATS_VTK_VTK_H
#define SNOW_FORMATS_VTK_VTK_H

#include "formats/array.h"
#include "formats/cf.h"

/* A grid of points; point (i, j, k) is at origin + direction * (spacing *
 * (first + (i, j, k))). */
typedef struct vtk_grid {
    int64_t first[3]; /* index of the first point */
    int64_t points[3];
    double origin[3], spacing[3];
    double direction[3][3]; /* columns: the directions of the axes */
    bool rectilinear;       /* the points have coordinates instead: */
    double *coordinates[3]; /* of the points along each axis; NULL: not read */
    cf_axis axes[3];        /* of the values, once they were described */
    snow_uneven uneven;
} vtk_grid;

/* An array of values in a file. */
typedef struct vtk_array {
    char name[256];
    bool cells;   /* a value for each cell between points, otherwise for each
                     point */
    bool vectors; /* of space, says the file */
    snow_type type;
    int64_t channels;
} vtk_array;

vtk_grid snow_vtk_grid_default(void);

/* Frees the coordinates. */
void snow_vtk_release(snow_context *context, vtk_grid *grid);

/* Sets sizes, type and matrix of an array on the grid, and its name.  Cells are
 * half a step from the points, and one fewer of them on an axis with more than
 * one point.  Of an uneven grid the sizes become those of the even one
 * (formats/uneven/uneven.h); grid->uneven has those of the array.
 * Errors: SNOW_STATUS_BAD_INPUT if they are empty or too many, or coordinates
 * are none; SNOW_STATUS_NO_MEMORY. */
snow_status snow_vtk_describe(snow_context *context, vtk_grid *grid,
                              const vtk_array *array,
                              const snow_volume_options *options,
                              snow_volume_info *info);
snow_status snow_vtk_place_rectilinear(snow_context *context, vtk_grid *grid,
                                       bool cells,
                                       const snow_volume_options *options,
                                       snow_volume_info *info);

/* A row of numbers in a file, from the source's position on: in text, or in
 * bytes. */
typedef struct vtk_line {
    const char *what; /* for messages */
    int64_t count;
    bool text, big_endian;
    snow_type type;
} vtk_line;

/* Reads them into a block that the caller releases.  Errors: as reading;
 * SNOW_STATUS_BAD_INPUT (more than any axis has). */
snow_status snow_vtk_read_line(snow_source *source, const vtk_line *line,
                               double **out);

/* Returns whether bytes begin an XML file of VTK, of a type unless that is
 * NULL. */
bool snow_vtk_probe_xml(const unsigned char *bytes, size_t size,
                        const char *type);

/* What an XML file of another type is, and what to do with it, as the end of a
 * message. */
const char *snow_vtk_other(const char *type);

/* Decodes names in files, "%20" for a blank. */
void snow_vtk_decode_name(char *name);

#endif
