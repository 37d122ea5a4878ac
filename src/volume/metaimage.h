/* volume/metaimage.h - a MetaImage header as the reader needs it. */
#ifndef SNOW_METAIMAGE_H
#define SNOW_METAIMAGE_H

#include "volume/volume.h"

/* Room for a value of the header, a file's name among them. */
#define METAIMAGE_VALUE_BYTES 1024

typedef struct metaimage_header {
    snow_volume_info info;
    int axes;        /* NDims, 1 to 4 */
    int64_t dims[4]; /* 1 beyond `axes` */
    bool text;       /* the voxels are decimal numbers */
    bool compressed; /* as a zlib or gzip stream */
    bool big_endian;
    int64_t header_size; /* bytes before the voxels; -1: voxels end the file */
    char data[METAIMAGE_VALUE_BYTES]; /* ElementDataFile */
} metaimage_header;

/* True when the bytes begin with a key of MetaImage. */
bool metaimage_probe(const unsigned char *bytes, size_t size);

/* Takes the header's lines, through ElementDataFile, from a source.
 * Errors: SNOW_BAD_INPUT, SNOW_NO_MEMORY. */
snow_status metaimage_read_header(snow_source *source, metaimage_header *out);

/* Name of a scalar type in MetaImage ("MET_SHORT"), NULL when there is none. */
const char *metaimage_type_name(snow_type type);

#endif
