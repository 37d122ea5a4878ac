/* formats/bytes/packed.h - bytes that are packed by bzip2, and blocks of LZ4,
 * of Zarr and VTK. */
#ifndef SNOW_FORMATS_BYTES_PACKED_H
#define SNOW_FORMATS_BYTES_PACKED_H

#include "io/filters/filters.h"

/* Whether bytes begin a file of bzip2. */
bool snow_looks_bzip2(const void *bytes, size_t size);

/* Declares that from here on the bytes are packed; all later calls return the
 * unpacked ones. Fails where the build lacks libbz2. */
snow_status snow_source_unpack_bzip2(snow_source *source);

/* Fails where the build lacks liblz4. */
snow_status snow_lz4_need(snow_context *context);

/* Unpacks a block to exactly `bytes` bytes; false if it has not these. */
bool snow_lz4_unpack(const void *packed, size_t size, void *out, size_t bytes);

#endif
