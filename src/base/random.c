/* base/random.c - a source's bytes in any order.
 *
 * What can be looked into is not copied: a file of any size costs nothing but
 * the bytes that are asked for. */
#include "base/random.h"
#include "base/source_parts.h"

#include <assert.h>
#include <string.h>

struct snow_random {
    snow_context *context;
    snow_layer *layer;    /* looked into; NULL where the bytes are held */
    unsigned char *bytes; /* held */
    uint64_t size;
};

/* All bytes of the source, in a block that grows with them: how many there are
 * is known at the end. */
static snow_status hold_all(snow_source *source, snow_random *store) {
    size_t capacity = 0, used = 0, got;
    do {
        SNOW_TRY(snow_reserve(store->context, &store->bytes, &capacity, used,
                              used + SNOW_LAYER_BYTES));
        SNOW_TRY(snow_source_read(source, store->bytes + used, capacity - used,
                                  &got));
        used += got;
    } while (got);
    store->size = used;
    return snow_source_finish(source);
}

snow_status snow_random_open(snow_source *source, snow_random **out) {
    snow_layer *top = source->top;
    assert(top->taken == 0);
    snow_random *store = snow_allocate_clear(source->context, sizeof *store);
    if (!store)
        return SNOW_NO_MEMORY;
    store->context = source->context;
    if (top->look && top->size >= 0) {
        store->layer = top;
        store->size = (uint64_t)top->size;
    } else {
        snow_status status = hold_all(source, store);
        if (status != SNOW_OK) {
            snow_random_close(store);
            return status;
        }
    }
    *out = store;
    return SNOW_OK;
}

void snow_random_close(snow_random *store) {
    if (store) {
        snow_release(store->context, store->bytes);
        snow_release(store->context, store);
    }
}

uint64_t snow_random_size(const snow_random *store) {
    return store->size;
}

const void *snow_random_held(const snow_random *store) {
    return store->layer ? NULL : store->bytes;
}

size_t snow_random_read(snow_random *store, uint64_t from, void *bytes,
                        size_t size) {
    if (from >= store->size)
        return 0;
    if (size > store->size - from)
        size = (size_t)(store->size - from);
    if (store->layer)
        return store->layer->look(store->layer, from, bytes, size);
    memcpy(bytes, store->bytes + from, size);
    return size;
}
