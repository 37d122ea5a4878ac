/* io/seekable.c - random access to a source's bytes.
 *
 * A source that supports it is not copied: a file of any size costs only the
 * bytes that are requested. */
#include "io/seekable.h"
#include "io/source_internal.h"

#include <assert.h>
#include <string.h>

struct snow_seekable {
    snow_context *context;
    snow_filter_stage *filter; /* read in place; NULL if the bytes are held */
    unsigned char *bytes;      /* held */
    uint64_t size;
};

/* Reads all bytes of the source into a block that grows with them, as their
 * number is known only at the end. */
static snow_status hold_all(snow_source *source, snow_seekable *store) {
    size_t used = 0, got;
    do {
        SNOW_TRY(SNOW_RESERVE(store->context, store->bytes, used,
                              used + SNOW_FILTER_BYTES));
        SNOW_TRY(snow_source_read(source, store->bytes + used,
                                  snow_block_bytes(store->bytes) - used, &got));
        used += got;
    } while (got);
    store->size = used;
    return snow_source_finish(source);
}

snow_status snow_seekable_open(snow_source *source, snow_seekable **out) {
    snow_filter_stage *top = source->top;
    assert(top->taken == 0);
    snow_seekable *store = snow_allocate_clear(source->context, sizeof *store);
    if (!store)
        return SNOW_STATUS_NO_MEMORY;
    store->context = source->context;
    if (top->look && top->size >= 0) {
        store->filter = top;
        store->size = (uint64_t)top->size;
    } else {
        snow_status status = hold_all(source, store);
        if (status != SNOW_STATUS_OK) {
            snow_seekable_close(store);
            return status;
        }
    }
    *out = store;
    return SNOW_STATUS_OK;
}

void snow_seekable_close(snow_seekable *store) {
    if (store) {
        snow_release(store->context, store->bytes);
        snow_release(store->context, store);
    }
}

uint64_t snow_seekable_size(const snow_seekable *store) {
    return store->size;
}

const void *snow_seekable_held(const snow_seekable *store) {
    return store->filter ? NULL : store->bytes;
}

size_t snow_seekable_read(snow_seekable *store, uint64_t from, void *bytes,
                          size_t size) {
    if (from >= store->size)
        return 0;
    if (size > store->size - from)
        size = (size_t)(store->size - from);
    if (store->filter)
        return store->filter->look(store->filter, from, bytes, size);
    memcpy(bytes, store->bytes + from, size);
    return size;
}
