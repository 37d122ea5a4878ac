/* base/context.c - contexts and their messages. */
#define _DEFAULT_SOURCE 1 /* madvise */
#include "base/clear.h"
#include "base/thread_pool.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef __linux__
#include <sys/mman.h>
#endif

/* Large blocks ask for huge pages: a volume in pages of 4 KiB costs a fault for
 * each and misses of the TLB at every slice. */
#define HUGE_PAGE ((size_t)2 << 20)

static void *malloc_allocate(void *user, size_t bytes) {
    (void)user;
#ifdef MADV_HUGEPAGE
    void *block;
    if (bytes >= HUGE_PAGE) {
        if (posix_memalign(&block, HUGE_PAGE, bytes) != 0)
            return NULL;
        (void)madvise(block, bytes, MADV_HUGEPAGE); /* may be refused */
        return block;
    }
#endif
    return malloc(bytes);
}

/* A huge page is cleared as a whole when it is touched, which takes up to five
 * milliseconds in a virtual machine whose host has to find it. */
void snow_memory_by_pages(const snow_context *context, void *block,
                          size_t bytes) {
#ifdef MADV_NOHUGEPAGE
    const size_t page = 4096, at = (size_t)(uintptr_t)block;
    const size_t first = at / page + 1, end = (at + bytes) / page;
    if (context->allocator.allocate == malloc_allocate && first < end)
        (void)madvise((char *)block + (first * page - at), (end - first) * page,
                      MADV_NOHUGEPAGE);
#else
    (void)context;
    (void)block;
    (void)bytes;
#endif
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
        return SNOW_STATUS_NO_MEMORY;
    *context = (snow_context){.allocator = *allocator,
                              .lock = PTHREAD_MUTEX_INITIALIZER};
    *out = context;
    return SNOW_STATUS_OK;
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
    return context ? context->message
                   : snow_status_description(SNOW_STATUS_NO_MEMORY);
}

void snow_context_set_warning(snow_context *context, snow_warning_fn *warning,
                              void *user) {
    context->warning = warning;
    context->warning_user = user;
}

void snow_context_set_progress(snow_context *context,
                               snow_progress_fn *progress, void *user) {
    context->progress = progress;
    context->progress_user = user;
}

void snow_context_set_memory_limit(snow_context *context, uint64_t bytes) {
    context->limit = bytes;
}

uint64_t snow_context_limit(const snow_context *context) {
    return context->limit;
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

const char *snow_status_description(snow_status status) {
    switch (status) {
#define STATUS_TEXT(name, value, text) \
    case SNOW_STATUS_##name:           \
        return text;
        SNOW_STATUS_MAP(STATUS_TEXT)
#undef STATUS_TEXT
    }
    return "unknown status";
}

snow_status snow_need_path(snow_context *context, const char *path) {
    return path ? SNOW_STATUS_OK
                : snow_fail(context, SNOW_STATUS_BAD_USAGE,
                            "the path is NULL; give one, or \"-\"");
}

static void set_message(snow_context *context, const char *format,
                        va_list arguments) {
    pthread_mutex_lock(&context->lock);
    snow_text_vprint(context->message, sizeof context->message, format,
                     arguments);
    snow_text_to_line(context->message, sizeof context->message);
    pthread_mutex_unlock(&context->lock);
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
    /* Text that does not fit is truncated at the end. */
    if (at + 3 < sizeof context->message)
        snprintf(context->message + at, sizeof context->message - at, ": %.*s",
                 (int)(sizeof context->message - at - 3), below);
    return status;
}

snow_status snow_fail_in_file(snow_context *context, snow_status status,
                              const char *path) {
    const char *message = context->message;
    size_t length = strlen(path);
    if (length &&
        (strncmp(message, path, length) != 0 || message[length] != ':'))
        snow_fail_within(context, status, "%s", path);
    return status;
}

void snow_context_warn(snow_context *context, const char *format, ...) {
    char text[SNOW_MESSAGE_BYTES];
    va_list arguments;
    if (!context->warning)
        return;
    va_start(arguments, format);
    snow_text_vprint(text, sizeof text, format, arguments);
    va_end(arguments);
    snow_text_to_line(text, sizeof text);
    context->warning(context->warning_user, text);
}
