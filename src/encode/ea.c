/* encode/ea.c - EA, the bytes that say which voxels are there: how the schemes
 * append to it. */
#include "encode/encode.h"

snow_status snow_sparse_grow_ea(snow_sparse *s, size_t size) {
    SNOW_TRY(snow_reserve(s->context, &s->ea, &s->ea_capacity, s->ea_bytes,
                          s->ea_bytes + size + SNOW_EA_MARGIN));
    memset(s->ea + s->ea_bytes, 0, size + SNOW_EA_MARGIN);
    s->ea_bytes += size;
    return SNOW_STATUS_OK;
}

snow_status snow_sparse_open_ea(snow_sparse *s, size_t most,
                                unsigned char **at) {
    SNOW_TRY(snow_reserve(s->context, &s->ea, &s->ea_capacity, s->ea_bytes,
                          s->ea_bytes + most + SNOW_EA_MARGIN));
    *at = s->ea + s->ea_bytes;
    return SNOW_STATUS_OK;
}

void snow_sparse_close_ea(snow_sparse *s, const unsigned char *end) {
    s->ea_bytes = (size_t)(end - s->ea);
    /* What a walk reads beyond the end is masked away, but must be there. */
    snow_store_word(s->ea + s->ea_bytes, 0);
}
