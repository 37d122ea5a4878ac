/* formats/bytes/bzip2.h - bytes that are packed by bzip2. */
#ifndef SNOW_FORMATS_BYTES_BZIP2_H
#define SNOW_FORMATS_BYTES_BZIP2_H

#include "io/filters/filters.h"

/* Whether bytes begin a file of bzip2. */
bool snow_looks_bzip2(const void *bytes, size_t size);

/* Declares that from here on the bytes are packed; all later calls return the
 * unpacked ones. Fails where the build lacks libbz2. */
snow_status snow_source_unpack_bzip2(snow_source *source);

#endif
