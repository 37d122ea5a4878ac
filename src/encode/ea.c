/* encode/ea.c - EA, the bytes that say which voxels are there: how the schemes
 * append to it. */
#include "encode/encode.h"

snow_status snow_sparse_grow_ea(snow_sparse *s, size_t size) {
    SNOW_TRY(SNOW_RESERVE(s->context, s->ea, s->ea_bytes,
                          s->ea_bytes + size + SNOW_EA_MARGIN));
    memset(s->ea + s->ea_bytes, 0, size + SNOW_EA_MARGIN);
    s->ea_bytes += size;
    return SNOW_STATUS_OK;
}
