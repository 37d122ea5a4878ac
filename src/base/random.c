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
static snow_status hold_all(snow_source *source, snow_random *random) {
    size_t capacity = 0, used = 0, got;
    do {
        SNOW_TRY(snow_reserve(random->context, &random->bytes, &capacity, used,
                              used + SNOW_LAYER_BYTES));
        SNOW_TRY(snow_source_read(source, random->bytes + used, capacity - used,
                                  &got));
        used += got;
    } while (got);
    random->size = used;
    return snow_source_finish(source);
}

snow_status snow_random_open(snow_source *source, snow_random **out) {
    snow_layer *top = source->top;
    assert(top->taken == 0);
    snow_random *random = snow_allocate_clear(source->context, sizeof *random);
    if (!random)
        return SNOW_NO_MEMORY;
    random->context = source->context;
    if (top->look && top->size >= 0) {
        random->layer = top;
        random->size = (uint64_t)top->size;
    } else {
        snow_status status = hold_all(source, random);
        if (status != SNOW_OK) {
            snow_random_close(random);
            return status;
        }
    }
    *out = random;
    return SNOW_OK;
}

void snow_random_close(snow_random *random) {
    if (random) {
        snow_release(random->context, random->bytes);
        snow_release(random->context, random);
    }
}

uint64_t snow_random_size(const snow_random *random) {
    return random->size;
}

const void *snow_random_held(const snow_random *random) {
    return random->layer ? NULL : random->bytes;
}

size_t snow_random_read(snow_random *random, uint64_t from, void *bytes,
                        size_t size) {
    if (from >= random->size)
        return 0;
    if (size > random->size - from)
        size = (size_t)(random->size - from);
    if (random->layer)
        return random->layer->look(random->layer, from, bytes, size);
    memcpy(bytes, random->bytes + from, size);
    return size;
}
