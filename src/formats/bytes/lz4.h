/* formats/bytes/lz4.h - blocks of LZ4, of Zarr and VTK. */
#ifndef SNOW_FORMATS_BYTES_LZ4_H
#define SNOW_FORMATS_BYTES_LZ4_H

#include "base/base.h"

/* Fails where the build lacks liblz4. */
snow_status snow_lz4_need(snow_context *context);

/* Unpacks a block to exactly `bytes` bytes; false if it has not these. */
bool snow_lz4_unpack(const void *packed, size_t size, void *out, size_t bytes);

#endif
