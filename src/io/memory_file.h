/* io/memory_file.h - a file in memory, for libraries that write at any
 * position. */
#ifndef SNOW_IO_MEMORY_FILE_H
#define SNOW_IO_MEMORY_FILE_H

#include "base/base.h"

#include <string.h>

typedef struct snow_memory_file {
    snow_context *context;
    unsigned char *bytes;
    size_t size;
} snow_memory_file;

/* Writes bytes at a position; a gap after the end is filled with zeros. */
static inline snow_status snow_memory_file_put(snow_memory_file *store,
                                               uint64_t at, const void *bytes,
                                               size_t size) {
    if (at > SIZE_MAX / 2 || size > SIZE_MAX / 2 - at)
        return snow_fail(store->context, SNOW_STATUS_NO_MEMORY,
                         "the file is too large for memory; write less data");
    size_t end = (size_t)at + size;
    if (end > store->size) {
        SNOW_TRY(SNOW_RESERVE(store->context, store->bytes, store->size, end));
        if (at > store->size)
            memset(store->bytes + store->size, 0, (size_t)at - store->size);
        store->size = end;
    }
    memcpy(store->bytes + at, bytes, size);
    return SNOW_STATUS_OK;
}

static inline void snow_memory_file_free(snow_memory_file *store) {
    snow_release(store->context, store->bytes);
    *store = (snow_memory_file){.context = store->context};
}

#endif
