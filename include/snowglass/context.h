/* snowglass/context.h - memory and messages of all objects.
 *
 * The library has no global state: allocator, last error message, count of
 * bytes and the threads that render live in a context, made first and freed
 * last. It and all objects made with it belong to one thread at a time;
 * different ones are independent. After fork() threads are made anew. */
#ifndef SNOWGLASS_CONTEXT_H
#define SNOWGLASS_CONTEXT_H

#include <snowglass/status.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Records that a call reads or fills begin with `size` and may grow at their
 * end. Call snow_x_init(&x) first, which sets `size` and all defaults. Where
 * these are zeros (all but snow_view, snow_settings, snow_recipe), {.size =
 * sizeof(snow_x), ...} will do. Fields beyond `size` get their defaults and are
 * not written. BAD_USAGE: a size of 0, an unknown field that is not 0. */
#define SNOW_RECORD(record)                                       \
    SNOW_API void record##_init_sized(record *made, size_t size); \
    static inline void record##_init(record *made) {              \
        record##_init_sized(made, sizeof *made);                  \
    }                                                             \
    struct record

typedef struct snow_context snow_context;

/* Memory aligned as malloc's, or NULL. Threads that render call it in turn. */
typedef struct snow_allocator {
    void *(*allocate)(void *user, size_t bytes);
    void (*release)(void *user, void *block);
    void *user;
} snow_allocator;

/* `allocator` is copied; NULL: the C library's. Free a context last. */
SNOW_API snow_status snow_context_new(
    const snow_allocator *allocator, snow_context **out);
SNOW_API void snow_context_free(snow_context *context);

/* The message of the last call that failed, one line; "" before any. NULL,
 * where there was no memory for a context: says so. */
SNOW_API const char *snow_context_message(const snow_context *context);

/* Receives warnings (a guess, bytes after the data), one line each; or NULL. */
typedef void snow_warning_fn(void *user, const char *text);
SNOW_API void snow_context_set_warning(
    snow_context *context, snow_warning_fn *warning, void *user);

/* Whether a picture is to end now, with STOPPED (snow_settings.stop). Called
 * often, by the thread that called the library; not for the same context. */
typedef bool snow_stop_fn(void *user);

/* What a long call is doing; slabs of a file are read in SNOW_STAGE_ENCODE. */
typedef enum snow_stage {
    SNOW_STAGE_READ = 0, /* a volume is opened, made or measured */
    SNOW_STAGE_ENCODE,   /* of a picture: classify, shade and encode */
    SNOW_STAGE_RENDER,   /* of a picture: all else */
    SNOW_STAGE_WRITE     /* a volume or a picture is saved */
} snow_stage;

/* Receives the progress of a long stage, rising to 1; true ends the call with
 * STOPPED. Called as snow_stop_fn, at most 20 times a second. Or NULL. */
typedef bool snow_progress_fn(void *user, snow_stage stage, double fraction);
SNOW_API void snow_context_set_progress(
    snow_context *context, snow_progress_fn *progress, void *user);

/* The most bytes that its objects may hold together; 0: no limit. */
SNOW_API void snow_context_set_memory_limit(snow_context *, uint64_t bytes);

/* Bytes its objects hold, the most ever held, and bytes read, as stored. */
SNOW_API uint64_t snow_context_bytes(const snow_context *context);
SNOW_API uint64_t snow_context_peak_bytes(const snow_context *context);
SNOW_API uint64_t snow_context_bytes_read(const snow_context *context);

#endif
