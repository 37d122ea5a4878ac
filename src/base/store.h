/* base/store.h - a file in memory, for libraries that write here and there. */
#ifndef SNOW_STORE_H
#define SNOW_STORE_H

#include "base/base.h"

#include <string.h>

typedef struct snow_store {
    snow_context *context;
    unsigned char *bytes;
    size_t size, room;
} snow_store;

/* Writes bytes at a place; what lies between the end and it becomes 0. */
static inline snow_status snow_store_put(snow_store *store, uint64_t at,
                                         const void *bytes, size_t size) {
    if (at > SIZE_MAX / 2 || size > SIZE_MAX / 2 - at)
        return snow_fail(store->context, SNOW_NO_MEMORY,
                         "a file of more bytes than memory can have");
    size_t end = (size_t)at + size;
    if (end > store->size) {
        SNOW_TRY(snow_reserve(store->context, &store->bytes, &store->room,
                              store->size, end));
        if (at > store->size)
            memset(store->bytes + store->size, 0, (size_t)at - store->size);
        store->size = end;
    }
    memcpy(store->bytes + at, bytes, size);
    return SNOW_OK;
}

static inline void snow_store_free(snow_store *store) {
    snow_release(store->context, store->bytes);
    *store = (snow_store){.context = store->context};
}

#endif
