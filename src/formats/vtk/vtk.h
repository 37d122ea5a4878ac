/* formats/vtk/vtk.h - what the two formats of VTK's image data share: vtk.c
 * reads the legacy format, vti*.c the XML format. */
#ifndef SNOW_FORMATS_VTK_VTK_H
#define SNOW_FORMATS_VTK_VTK_H

#include "formats/array.h"

/* A grid of points; point (i, j, k) is at origin + direction * (spacing *
 * (first + (i, j, k))). */
typedef struct vtk_grid {
    int64_t first[3]; /* index of the first point */
    int64_t points[3];
    double origin[3], spacing[3];
    double direction[3][3]; /* columns: the directions of the axes */
} vtk_grid;

/* An array of values in a file. */
typedef struct vtk_array {
    char name[256];
    bool cells; /* a value for each cell between points, otherwise for each
                   point */
    snow_type type;
    int64_t channels;
} vtk_array;

vtk_grid snow_vtk_grid_default(void);

/* Sets sizes, type and matrix of an array on the grid.  Cells are half a step
 * from the points, and one fewer of them on an axis with more than one point.
 * Errors: SNOW_STATUS_BAD_INPUT if they are empty or too many. */
snow_status snow_vtk_describe(snow_context *context, const vtk_grid *grid,
                              const vtk_array *array, snow_volume_info *info);

/* Decodes names in files, "%20" for a blank. */
void snow_vtk_decode_name(char *name);

#endif
