/* formats/bytes/lz4.c - unpacks blocks by liblz4. */
#include "formats/bytes/lz4.h"
#include "formats/features.h"

#if SNOW_HAVE_LZ4

#include <limits.h>
#include <lz4.h>

snow_status snow_lz4_need(snow_context *context) {
    (void)context;
    return SNOW_STATUS_OK;
}

bool snow_lz4_unpack(const void *packed, size_t size, void *out, size_t bytes) {
    return size <= INT_MAX && bytes <= INT_MAX &&
           LZ4_decompress_safe(packed, out, (int)size, (int)bytes) ==
               (int)bytes;
}

#else

snow_status snow_lz4_need(snow_context *context) {
    return snow_fail_unbuilt(context, "LZ4", "liblz4-dev");
}

bool snow_lz4_unpack(const void *packed, size_t size, void *out, size_t bytes) {
    (void)packed, (void)size, (void)out, (void)bytes;
    return false;
}

#endif
