/* formats/vtk/vti.h - the parts of the reader of VTK's XML files of image data
 * and rectilinear grids, private to vti*.c.
 *
 *   vti_survey.c  the time and the coordinates, wherever they stand
 *   vti_header.c  the XML text up to the requested array -> vti_header
 *   vti_data.c    the array's bytes -> voxels
 *   vti_tail.c    the tags behind them
 *   vti_pieces.c  the same of each piece, where there are several
 *
 * After "VTK XML Formats" (docs.vtk.org) and vtkXMLDataParser. */
#ifndef SNOW_FORMATS_VTK_VTI_H
#define SNOW_FORMATS_VTK_VTI_H

#include "formats/vtk/vtk.h"
#include "io/filters/filters.h"
#include "io/seekable.h"

typedef enum vti_form {
    VTI_ASCII,   /* numbers in the element */
    VTI_BINARY,  /* base64 in the element */
    VTI_APPENDED /* after the other elements, as base64 or raw bytes */
} vti_form;

/* What the text says about the array that is read. */
typedef struct vti_header {
    vtk_grid grid;
    vtk_array array;
    vti_form form;
    uint64_t numbers; /* where they begin, or appended data do */
    uint64_t offset;  /* of appended data */
    bool raw;         /* appended data are not base64 */
    bool big_endian;
    int count_bytes; /* size of the counts before the data: 4 or 8 */
    bool packed;     /* as blocks of zlib, or those of: */
    snow_unpack_block_fn *unpack; /* NULL: zlib */
    bool in_pieces; /* the first piece is not the whole: there is no array */
    bool one_piece; /* set before: the first piece is all that is wanted */
} vti_header;

/* "x0 x1 y0 y1 z0 z1", the first and last index on each axis; false for
 * anything else. */
bool snow_vti_take_extent(const char *value, int64_t first[3],
                          int64_t points[3]);

/* What the first element says of the form of all numbers; what an array's
 * element says, false if that is invalid. */
void snow_vti_file_form(vti_header *header, const char **attributes);
bool snow_vti_keep_array(vti_header *header, const char **attributes,
                         const char *name, bool cells);

/* The small arrays of a file: its time, NaN if there is none; the coordinates
 * of a rectilinear grid, which the caller releases whatever the status. */
typedef struct vti_small {
    double time;
    double *coordinates[3];
} vti_small;

/* Reads them beside the source, of which nothing was read yet.  Errors:
 * SNOW_STATUS_BAD_INPUT, SNOW_STATUS_NO_MEMORY. */
snow_status snow_vti_survey(snow_source *source, snow_seekable *bytes,
                            bool rectilinear, vti_small *out);

/* Leaves the source, which stands at an array's numbers in an element or at its
 * offset of the appended data, at their bytes, and checks that there are
 * `needed`. */
snow_status snow_vti_begin_numbers(snow_source *source,
                                   const vti_header *header, uint64_t needed);

/* Reads the text and leaves the source at the requested array's numbers, or at
 * the appended data.  `header` is set before but for grid.rectilinear, which
 * says what the file must hold.  Errors: SNOW_STATUS_BAD_INPUT,
 * SNOW_STATUS_BAD_USAGE (no such array). */
snow_status snow_vti_read_header(snow_source *source,
                                 const snow_volume_options *options,
                                 vti_header *header);

/* Makes the volume from the source's position after the header. */
snow_status snow_vti_read_data(snow_source *source, const vti_header *header,
                               const snow_volume_options *options,
                               int64_t channel, snow_volume_info *info,
                               snow_volume **out);

/* Reads the values, from the source's beginning; nothing where the header says
 * that they are in pieces. */
snow_status snow_vti_read_values(snow_source *source, vti_header *header,
                                 const vti_small *small,
                                 const snow_volume_options *options,
                                 snow_volume_info *info, snow_volume **out);

/* Makes the volume of the pieces of a file, whose grid `whole` has.  Errors:
 * SNOW_STATUS_BAD_INPUT, SNOW_STATUS_NO_MEMORY, those of reading. */
snow_status snow_vti_read_pieces(snow_source *source, snow_seekable *bytes,
                                 const vti_header *whole,
                                 const vti_small *small,
                                 const snow_volume_options *options,
                                 snow_volume_info *info, snow_volume **out);

/* Checks the tags behind an array that was read.  Errors:
 * SNOW_STATUS_BAD_INPUT, SNOW_STATUS_NO_MEMORY. */
snow_status snow_vti_check_tail(snow_source *source, snow_seekable *bytes,
                                const vti_header *header);

#endif
