/* formats/vtk/vti.h - the parts of the VTI reader, private to vti*.c.
 *
 *   vti_header.c  the XML text up to the requested array -> vti_header
 *   vti_data.c    the array's bytes -> voxels
 *
 * After "VTK XML Formats" (docs.vtk.org) and vtkXMLDataParser. */
#ifndef SNOW_FORMATS_VTK_VTI_H
#define SNOW_FORMATS_VTK_VTI_H

#include "formats/vtk/vtk.h"

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
    uint64_t offset; /* of appended data */
    bool raw;        /* appended data are not base64 */
    bool big_endian;
    int count_bytes; /* size of the counts before the data: 4 or 8 */
    bool packed;     /* as blocks of zlib */
} vti_header;

/* Reads the text and leaves the source at the requested array's numbers, or at
 * the appended data.  Errors: SNOW_STATUS_BAD_INPUT, SNOW_STATUS_BAD_USAGE (no
 * such array). */
snow_status snow_vti_read_header(snow_source *source,
                                 const snow_volume_options *options,
                                 vti_header *header);

/* Makes the volume from the source's position after the header. */
snow_status snow_vti_read_data(snow_source *source, const vti_header *header,
                               const snow_volume_options *options,
                               int64_t channel, snow_volume_info *info,
                               snow_volume **out);

#endif
