/* fuzz/support/capped.h - what the fuzz targets of the volume readers share: an
 * allocator that gives no more than CAP bytes, and one look at an input. */
#ifndef SNOW_FUZZ_CAPPED_H
#define SNOW_FUZZ_CAPPED_H

#include <snowglass/snowglass.h>
#include <stdint.h>
#include <stdlib.h>

#define CAP ((size_t)64 << 20)

typedef union capped_block {
    size_t bytes;
    max_align_t alignment;
} capped_block;

static void *capped_allocate(void *user, size_t bytes) {
    size_t *held = user;
    if (bytes > CAP - *held)
        return NULL;
    capped_block *block = malloc(bytes + sizeof *block);
    if (!block)
        return NULL;
    block->bytes = bytes;
    *held += bytes;
    return block + 1;
}

static void capped_release(void *user, void *memory) {
    capped_block *block = (capped_block *)memory - 1;
    *(size_t *)user -= block->bytes;
    free(block);
}

static void ignore_warning(void *user, const char *text) {
    (void)user;
    (void)text;
}

/* A context over this allocator, and its end: stops the program when memory
 * stays behind. */
static inline snow_context *capped_context(size_t *held) {
    snow_allocator allocator = {capped_allocate, capped_release, held};
    snow_context *context;
    *held = 0;
    if (snow_context_new(&allocator, &context) != SNOW_STATUS_OK)
        abort();
    snow_context_set_warning(context, ignore_warning, NULL);
    return context;
}

static inline void capped_end(snow_context *context, const size_t *held) {
    if (snow_context_bytes(context))
        abort();
    snow_context_free(context);
    if (*held)
        abort();
}

/* Measures and closes what was opened.  Stops the program when a failure comes
 * without a message of one line, or memory stays behind. */
static inline void capped_finish(snow_context *context, const size_t *held,
                                 snow_status status, snow_volume *volume) {
    if (status == SNOW_STATUS_OK) {
        snow_volume_statistics measures = {.size = sizeof measures};
        uint64_t counts[16];
        snow_volume_get_statistics(volume, &measures);
        snow_volume_histogram(volume, -10, 1000, 16, counts);
        if (measures.finite > measures.voxels)
            abort();
        snow_volume_close(volume);
    } else if (volume || !*snow_context_message(context))
        abort();
    for (const char *at = snow_context_message(context); *at; at++)
        if (*at == '\n')
            abort();
    capped_end(context, held);
}

/* The bytes as a volume. */
static inline void look_at(const char *name, const uint8_t *bytes, size_t size,
                           const snow_volume_options *options) {
    size_t held;
    snow_context *context = capped_context(&held);
    snow_volume *volume = NULL;
    snow_status status =
        snow_volume_open_memory(context, name, bytes, size, options, &volume);
    capped_finish(context, &held, status, volume);
}

#endif
