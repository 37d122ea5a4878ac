/* formats/metaimage/metaimage.h - the parsed header of a MetaImage file. */
#ifndef SNOW_FORMATS_METAIMAGE_METAIMAGE_H
#define SNOW_FORMATS_METAIMAGE_METAIMAGE_H

#include "formats/detached/detached.h"

/* Size of a value of the header, including a file's name. */
#define METAIMAGE_VALUE_BYTES 1024

typedef struct metaimage_header {
    snow_volume_info info;
    int axes;         /* NDims, 1 to 4 */
    int64_t dims[4];  /* 1 beyond `axes` */
    int64_t channels; /* values of each voxel */
    snow_detached data;
    char file[METAIMAGE_VALUE_BYTES]; /* ElementDataFile */
} metaimage_header;

/* True if the bytes begin with a key of MetaImage. */
bool metaimage_probe(const unsigned char *bytes, size_t size);

/* Reads the header's lines, up to and including ElementDataFile.  Errors:
 * SNOW_STATUS_BAD_INPUT, SNOW_STATUS_NO_MEMORY. */
snow_status metaimage_read_header(snow_source *source, metaimage_header *out);

/* The name of a scalar type in MetaImage ("MET_SHORT"), NULL if there is
 * none. */
const char *metaimage_type_name(snow_type type);

#endif
