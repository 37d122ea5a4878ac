/* base/context.c - contexts, their messages, and all allocation.
 *
 * Every block carries a header of one alignment unit in front, so that its size
 * is known when it is freed and the context can tell what it holds:
 *
 *   raw ... | header { raw, bytes } pad | block, aligned to 64 ...
 */
#include "base/base.h"
#include "base/parallel.h"

#include <assert.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ALIGNMENT 64

typedef struct block_header {
    void *raw;    /* what the allocator returned */
    size_t bytes; /* asked for by the caller */
} block_header;

static_assert(sizeof(block_header) <= ALIGNMENT, "the header fits its unit");

static void *malloc_allocate(void *user, size_t bytes) {
    (void)user;
    return malloc(bytes);
}

static void malloc_release(void *user, void *block) {
    (void)user;
    free(block);
}

snow_status snow_context_new(const snow_allocator *allocator,
                             snow_context **out) {
    static const snow_allocator standard = {malloc_allocate, malloc_release,
                                            NULL};
    if (!allocator)
        allocator = &standard;
    snow_context *context =
        allocator->allocate(allocator->user, sizeof *context);
    if (!context)
        return SNOW_NO_MEMORY;
    *context = (snow_context){.allocator = *allocator};
    if (pthread_mutex_init(&context->lock, NULL)) {
        allocator->release(allocator->user, context);
        return SNOW_NO_MEMORY;
    }
    *out = context;
    return SNOW_OK;
}

void snow_context_free(snow_context *context) {
    if (context) {
        snow_pool_free(context);
        snow_allocator allocator = context->allocator;
        pthread_mutex_destroy(&context->lock);
        allocator.release(allocator.user, context);
    }
}

const char *snow_context_message(const snow_context *context) {
    return context->message;
}

void snow_context_set_notice(snow_context *context, snow_notice_fn *notice,
                             void *user) {
    context->notice = notice;
    context->notice_user = user;
}

void snow_context_set_limit(snow_context *context, uint64_t bytes) {
    context->limit = bytes;
}

uint64_t snow_context_bytes(const snow_context *context) {
    return context->bytes;
}

uint64_t snow_context_peak_bytes(const snow_context *context) {
    return context->peak;
}

uint64_t snow_context_bytes_read(const snow_context *context) {
    return context->bytes_read;
}

const char *snow_status_text(snow_status status) {
    switch (status) {
#define STATUS_TEXT(name, value, text) \
    case SNOW_##name:                  \
        return text;
        SNOW_STATUS_MAP(STATUS_TEXT)
#undef STATUS_TEXT
    }
    return "unknown status";
}

/* Names and libraries' texts may hold anything; a terminal must not obey it. */
static void keep_to_one_line(char *text) {
    for (; *text; text++)
        if ((unsigned char)*text < 0x20 || *text == 0x7f)
            *text = '?';
}

static void set_message(snow_context *context, const char *format,
                        va_list arguments) {
    pthread_mutex_lock(&context->lock);
    vsnprintf(context->message, sizeof context->message, format, arguments);
    keep_to_one_line(context->message);
    pthread_mutex_unlock(&context->lock);
}

snow_status snow_fail(snow_context *context, snow_status status,
                      const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    set_message(context, format, arguments);
    va_end(arguments);
    return status;
}

snow_status snow_context_fail(snow_context *context, snow_status status,
                              const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    set_message(context, format, arguments);
    va_end(arguments);
    return status;
}

snow_status snow_fail_within(snow_context *context, snow_status status,
                             const char *format, ...) {
    char below[SNOW_MESSAGE_BYTES];
    memcpy(below, context->message, sizeof below);
    va_list arguments;
    va_start(arguments, format);
    set_message(context, format, arguments);
    va_end(arguments);
    size_t at = strlen(context->message);
    /* What does not fit any more is cut off at the end. */
    if (at + 3 < sizeof context->message)
        snprintf(context->message + at, sizeof context->message - at, ": %.*s",
                 (int)(sizeof context->message - at - 3), below);
    return status;
}

static void tell(snow_context *context, const char *format, va_list arguments) {
    char text[SNOW_MESSAGE_BYTES];
    vsnprintf(text, sizeof text, format, arguments);
    keep_to_one_line(text);
    context->notice(context->notice_user, text);
}

void snow_notify(snow_context *context, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    if (context->notice)
        tell(context, format, arguments);
    va_end(arguments);
}

void snow_context_remark(snow_context *context, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    if (context->notice)
        tell(context, format, arguments);
    va_end(arguments);
}

static block_header *header_of(void *block) {
    return (block_header *)(void *)((char *)block - ALIGNMENT);
}

/* Whether so many bytes more are allowed; the context is locked. */
static bool may_hold(const snow_context *context, size_t bytes) {
    return !context->limit || (bytes <= context->limit &&
                               context->bytes <= context->limit - bytes);
}

/* A block from the caller's allocator, which need not be safe for threads. */
static void *allocate_counted(snow_context *context, size_t bytes,
                              size_t with_header, uint64_t *held) {
    pthread_mutex_lock(&context->lock);
    void *raw = NULL;
    if (may_hold(context, bytes))
        raw = context->allocator.allocate(context->allocator.user, with_header);
    if (raw)
        context->bytes += bytes;
    if (context->bytes > context->peak)
        context->peak = context->bytes;
    *held = context->bytes;
    pthread_mutex_unlock(&context->lock);
    return raw;
}

void *snow_allocate(snow_context *context, size_t bytes) {
    size_t extra = 2 * ALIGNMENT;
    uint64_t held = 0;
    char *raw = NULL;
    if (bytes <= SIZE_MAX - extra)
        raw = allocate_counted(context, bytes, bytes + extra, &held);
    if (!raw) {
        snow_fail(
            context, SNOW_NO_MEMORY,
            "no memory for %zu bytes more (%llu are held%s); %s", bytes,
            (unsigned long long)held, context->limit ? " under a limit" : "",
            context->limit ? "raise it or take a smaller volume"
                           : "close other programs or take a smaller volume");
        return NULL;
    }
    char *block = raw + extra - (uintptr_t)raw % ALIGNMENT;
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
    uint64_t bytes;
    if (!snow_mul_u64(count, size, &bytes) || bytes > SIZE_MAX) {
        snow_fail(context, SNOW_NO_MEMORY,
                  "%llu times %zu bytes are more than an address can reach; "
                  "take a smaller volume or picture",
                  (unsigned long long)count, size);
        return NULL;
    }
    return snow_allocate(context, (size_t)bytes);
}

snow_status snow_reserve(snow_context *context, void *block_pointer,
                         size_t *capacity, size_t keep, size_t bytes) {
    if (bytes <= *capacity)
        return SNOW_OK;
    size_t wanted = *capacity + *capacity / 2;
    if (wanted < bytes)
        wanted = bytes;
    void *grown = snow_allocate(context, wanted);
    if (!grown)
        return SNOW_NO_MEMORY;
    void *old;
    memcpy(&old, block_pointer, sizeof old);
    if (keep)
        memcpy(grown, old, keep);
    snow_release(context, old);
    memcpy(block_pointer, &grown, sizeof grown);
    *capacity = wanted;
    return SNOW_OK;
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

void *snow_context_allocate(snow_context *context, size_t bytes) {
    return snow_allocate(context, bytes);
}

void snow_context_release(snow_context *context, void *block) {
    snow_release(context, block);
}
