/* formats/detached/detached.h - voxels behind a header of text, or in files
 * that it names, for NRRD and MetaImage. */
#ifndef SNOW_FORMATS_DETACHED_H
#define SNOW_FORMATS_DETACHED_H

#include "formats/array.h"

typedef enum snow_packing {
    SNOW_PACKING_NONE,
    SNOW_PACKING_GZIP, /* or zlib */
    SNOW_PACKING_BZIP2,
    SNOW_PACKING_HEX, /* two digits for each byte, with blanks anywhere */
    SNOW_PACKING_TEXT /* decimal numbers */
} snow_packing;

/* What a header says of its data, which are in files with the same number of
 * bytes each. */
typedef struct snow_detached {
    snow_type type;
    snow_packing packing;
    bool big_endian;
    bool commas;        /* separate decimal numbers too */
    uint64_t line_skip; /* before the data are unpacked */
    int64_t byte_skip;  /* after that; -1: the data are the last bytes */
    const char *skip;   /* what messages call these bytes */
    bool skips_packed;  /* ... before the data are unpacked */
    enum {
        SNOW_DATA_ATTACHED, /* after the header */
        SNOW_DATA_SINGLE,
        SNOW_DATA_LIST,
        SNOW_DATA_PATTERN
    } place;
    bool finds_gzip; /* the header may not say that files are packed */
    /* Knows data with a header of their own, which are refused with an advice;
     * NULL: they are not looked for. */
    const snow_format *(*find)(const void *bytes, size_t size);
    const char *advice;
    uint64_t count;      /* of files, at least 1 */
    const char *name;    /* file name, names of a list as strings, pattern */
    size_t name_bytes;   /* of the pattern */
    int64_t first, step; /* of the numbers in it */
} snow_detached;

/* Writes the name of a file by a pattern with one %d, %i or %u and perhaps a
 * width, such as slice%03d.raw.  Returns false for any other text, and if there
 * is no room. */
bool snow_detached_name(const char *pattern, size_t length, int64_t number,
                        char *name, size_t size);

/* Makes the volume that `info` describes; without `out` only checks the data
 * after the header, where `source` is.  If values->all is not 0, the voxels do
 * not follow one another, but lie as the array says. */
snow_status snow_detached_read(snow_source *source, const snow_detached *data,
                               const snow_volume_options *options,
                               const snow_array *values, snow_volume_info *info,
                               snow_volume **out);

#endif
