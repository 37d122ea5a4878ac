/* base/memory.c - all allocation, and sizes that do not overflow.
 *
 * Every block is preceded by a header of one alignment unit, so that its size
 * is known: whoever lets it grow asks for it, and the context counts its
 * memory:
 *
 *   raw ... | header { raw, bytes } pad | block, aligned to 64 ...
 */
#include "base/base.h"
#include "base/clear.h"
#include "base/monitor.h"

#include <assert.h>
#include <string.h>

typedef struct block_header {
    void *raw;    /* what the allocator returned */
    size_t bytes; /* asked for by the caller */
} block_header;

static_assert(sizeof(block_header) <= SNOW_ALIGNMENT,
              "the header fits its unit");

static block_header *header_of(const void *block) {
    return (block_header *)((uintptr_t)block - SNOW_ALIGNMENT);
}

/* Returns whether so many bytes more are allowed; the context is locked. */
static bool may_hold(const snow_context *context, size_t bytes) {
    return !context->limit || (bytes <= context->limit &&
                               context->bytes <= context->limit - bytes);
}

/* The context is locked. */
static void count(snow_context *context, size_t bytes) {
    context->bytes += bytes;
    if (context->bytes > context->peak)
        context->peak = context->bytes;
}

/* A block from the caller's allocator, which need not be safe for threads. */
static void *allocate_counted(snow_context *context, size_t bytes,
                              size_t with_header, uint64_t *held) {
    pthread_mutex_lock(&context->lock);
    void *raw = NULL;
    if (may_hold(context, bytes))
        raw = context->allocator.allocate(context->allocator.user, with_header);
    if (raw)
        count(context, bytes);
    *held = context->bytes;
    pthread_mutex_unlock(&context->lock);
    return raw;
}

/* The message about so many bytes that there are not. */
static snow_status fail_memory(snow_context *context, size_t bytes,
                               uint64_t held) {
    return snow_fail(
        context, SNOW_STATUS_NO_MEMORY,
        "out of memory: %zu bytes more are needed (%llu are "
        "allocated%s); %s",
        bytes, (unsigned long long)held, context->limit ? " under a limit" : "",
        context->limit ? "raise it or use a smaller volume"
                       : "close other programs or use a smaller volume");
}

void *snow_allocate(snow_context *context, size_t bytes) {
    size_t extra = 2 * SNOW_ALIGNMENT;
    uint64_t held = 0;
    char *raw = NULL;
    if (bytes <= SIZE_MAX - extra)
        raw = allocate_counted(context, bytes, bytes + extra, &held);
    if (!raw) {
        (void)fail_memory(context, bytes, held);
        return NULL;
    }
    char *block = raw + extra - (uintptr_t)raw % SNOW_ALIGNMENT;
    *header_of(block) = (block_header){raw, bytes};
    return block;
}

void *snow_allocate_clear(snow_context *context, size_t bytes) {
    void *block = snow_allocate(context, bytes);
    if (block)
        memset(block, 0, bytes);
    return block;
}

void *snow_allocate_array(snow_context *context, uint64_t count, size_t size) {
    void *block = NULL;
    (void)snow_reserve(context, &block, 0, count, size);
    return block;
}

size_t snow_block_bytes(const void *block) {
    return block ? header_of(block)->bytes : 0;
}

snow_status snow_reserve(snow_context *context, void *block_pointer,
                         uint64_t keep, uint64_t count, size_t size) {
    uint64_t bytes;
    if (!snow_mul_u64(count, size, &bytes) || bytes > SIZE_MAX)
        return snow_fail(context, SNOW_STATUS_NO_MEMORY,
                         "%llu times %zu bytes exceed the address space; use a "
                         "smaller volume or picture",
                         (unsigned long long)count, size);
    void *old;
    memcpy(&old, block_pointer, sizeof old);
    size_t capacity = snow_block_bytes(old);
    if (old && bytes <= capacity)
        return SNOW_STATUS_OK;
    size_t wanted = capacity + capacity / 2;
    if (wanted < bytes)
        wanted = (size_t)bytes;
    void *grown = snow_allocate(context, wanted);
    if (!grown)
        return SNOW_STATUS_NO_MEMORY;
    if (keep)
        memcpy(grown, old, (size_t)keep * size);
    snow_release(context, old);
    memcpy(block_pointer, &grown, sizeof grown);
    return SNOW_STATUS_OK;
}

void snow_release(snow_context *context, void *block) {
    if (!block)
        return;
    block_header header = *header_of(block);
    pthread_mutex_lock(&context->lock);
    context->bytes -= header.bytes;
    context->allocator.release(context->allocator.user, header.raw);
    pthread_mutex_unlock(&context->lock);
}

snow_status snow_memory_count(snow_context *context, size_t bytes) {
    pthread_mutex_lock(&context->lock);
    const uint64_t held = context->bytes;
    const bool may = may_hold(context, bytes);
    if (may)
        count(context, bytes);
    pthread_mutex_unlock(&context->lock);
    return may ? SNOW_STATUS_OK : fail_memory(context, bytes, held);
}

void snow_memory_forget(snow_context *context, size_t bytes) {
    pthread_mutex_lock(&context->lock);
    context->bytes -= bytes;
    pthread_mutex_unlock(&context->lock);
}

/* --- clear.h -------------------------------------------------------------- */

/* Bytes between two questions for a stop. */
#define PIECE ((size_t)1 << 20)

snow_status snow_clear(snow_context *context, void *block, size_t bytes) {
    char *at = block;
    while (bytes && !snow_monitor_look(context->monitor, 0)) {
        const size_t piece = bytes < PIECE ? bytes : PIECE;
        memset(at, 0, piece);
        at += piece;
        bytes -= piece;
    }
    return snow_monitor_status(context->monitor);
}

/* --- checked sizes -------------------------------------------------------- */

bool snow_mul_u64(uint64_t a, uint64_t b, uint64_t *out) {
    if (b && a > UINT64_MAX / b)
        return false;
    *out = a * b;
    return true;
}

bool snow_add_u64(uint64_t a, uint64_t b, uint64_t *out) {
    if (a > UINT64_MAX - b)
        return false;
    *out = a + b;
    return true;
}

int64_t snow_last_up_to(const int64_t *numbers, int64_t low, int64_t high,
                        int64_t most) {
    while (low < high) {
        int64_t middle = high - (high - low) / 2;
        if (numbers[middle] <= most)
            low = middle;
        else
            high = middle - 1;
    }
    return low;
}
