/* volume/vti.h - the parts of the VTI reader; for vti*.c alone.
 *
 *   vti_header.c  the XML text up to the wanted array -> vti_header
 *   vti_data.c    the array's bytes -> voxels
 *
 * After "VTK XML Formats" (docs.vtk.org) and vtkXMLDataParser. */
#ifndef SNOW_VTI_H
#define SNOW_VTI_H

#include "volume/vtk.h"

typedef enum vti_form {
    VTI_ASCII,   /* numbers in the element */
    VTI_BINARY,  /* base64 in the element */
    VTI_APPENDED /* behind the rest, base64 or bytes as they are */
} vti_form;

/* What the text says of the array that is read. */
typedef struct vti_header {
    vtk_grid grid;
    vtk_array array;
    vti_form form;
    uint64_t offset; /* of appended data */
    bool raw;        /* appended data are no base64 */
    bool big_endian;
    int count_bytes; /* of the numbers before the data: 4 or 8 */
    bool packed;     /* as blocks of zlib */
} vti_header;

/* Reads the text and leaves the source at the wanted array's numbers, or at the
 * appended data.  Errors: SNOW_BAD_INPUT, SNOW_BAD_USAGE (no such array). */
snow_status snow_vti_read_header(snow_source *source,
                                 const snow_volume_options *options,
                                 vti_header *header);

/* Makes the volume from where the header left the source. */
snow_status snow_vti_read_data(snow_source *source, const vti_header *header,
                               const snow_volume_options *options,
                               int64_t channel, snow_volume_info *info,
                               snow_volume **out);

#endif
