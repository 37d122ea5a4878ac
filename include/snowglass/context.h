/* snowglass/context.h - memory, messages and threads of all objects.
 *
 * The library has no global state. A context holds the allocator, the last
 * message, a count of bytes, and the threads that render. It is made first and
 * freed last, after all objects that were made with it.
 *
 * Threads. A context and all its objects belong to one thread at a time, const
 * ones too: drawing a volume takes memory and threads of the volume's context.
 * All objects of one call belong to one context. Different contexts are
 * independent, and may be used at once. A server whose threads draw one volume
 * gives each thread a context, in which it wraps the same voxels
 * (snow_volume_voxels, snow_volume_wrap, snow_volume_freeze); the volume that
 * owns them is closed last. After fork() the threads are made anew. */
#ifndef SNOWGLASS_CONTEXT_H
#define SNOWGLASS_CONTEXT_H

#include <snowglass/status.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Declares a record that a call reads or fills. It begins with `size` and may
 * grow at its end in a later version. Call snow_x_init(&x) first, which sets
 * `size` and all defaults. Where the defaults are zeros (in all records but
 * snow_view, snow_settings and snow_recipe), {.size = sizeof(snow_x), ...} does
 * the same. Fields beyond `size` get their defaults, and are not written. A
 * size of 0 and an unknown field that is not 0 are BAD_USAGE.
 *
 * Other records have no `size`, and stay as they are for a minor version; so do
 * records with a size that lie within another one (snow_recipe.settings,
 * snow_slice_place.view), and arrays of records. */
#define SNOW_RECORD(record)                                       \
    SNOW_API void record##_init_sized(record *made, size_t size); \
    static inline void record##_init(record *made) {              \
        record##_init_sized(made, sizeof *made);                  \
    }                                                             \
    struct record

typedef struct snow_context snow_context;
typedef struct snow_comm snow_comm; /* snowglass/comm.h */

/* The caller's memory. `allocate` returns memory aligned as malloc's, or NULL
 * where there is none. Threads that render call both, one at a time. */
typedef struct snow_allocator {
    void *(*allocate)(void *user, size_t bytes);
    void (*release)(void *user, void *block);
    void *user;
} snow_allocator;

/* Makes a context. `allocator` is copied; NULL stands for the C library's. */
SNOW_API snow_status snow_context_new(
    const snow_allocator *allocator, snow_context **out);

/* Frees a context, after the objects that were made with it. */
SNOW_API void snow_context_free(snow_context *context);

/* Returns the message of the last call that failed, one line without its end,
 * or "" before any. The text stays until the next call that fails. Where
 * `context` is NULL, since there was no memory for it, the message says so. */
SNOW_API const char *snow_context_message(const snow_context *context);

/* Receives a warning, one line: what was guessed or left out. It is called by
 * the thread that called the library, and must not call that with the same
 * context. */
typedef void snow_warning_fn(void *user, const char *text);

/* Sets who receives warnings; NULL: nobody, the default. */
SNOW_API void snow_context_set_warning(
    snow_context *context, snow_warning_fn *warning, void *user);

/* Returns whether a picture is to end now, with STOPPED (snow_settings.stop).
 * It is called often, by the thread that called the library, and must not call
 * the library with the same context. */
typedef bool snow_stop_fn(void *user);

/* What a long call is doing. Slabs of a file that is drawn out of core are read
 * in SNOW_STAGE_ENCODE. */
typedef enum snow_stage {
    SNOW_STAGE_READ = 0, /* a volume is opened, made or measured */
    SNOW_STAGE_ENCODE,   /* of a picture: classify, shade and encode */
    SNOW_STAGE_RENDER,   /* of a picture: all else */
    SNOW_STAGE_WRITE     /* a volume or a picture is saved */
} snow_stage;

/* Receives the progress of a long stage, which rises to 1. It returns true to
 * end the call with STOPPED. It is called as a snow_stop_fn is, at most 20
 * times a second. */
typedef bool snow_progress_fn(void *user, snow_stage stage, double fraction);

/* Sets who receives progress; NULL: nobody, the default. */
SNOW_API void snow_context_set_progress(
    snow_context *context, snow_progress_fn *progress, void *user);

/* Sets the most bytes that the context's objects may hold together; 0, the
 * default: no limit. A call that needs more returns NO_MEMORY. */
SNOW_API void snow_context_set_memory_limit(
    snow_context *context, uint64_t bytes);

/* Return the bytes that the context's objects hold now, and the most that they
 * ever held. */
SNOW_API uint64_t snow_context_bytes(const snow_context *context);
SNOW_API uint64_t snow_context_peak_bytes(const snow_context *context);

/* Returns how many bytes were read of files, as they are stored there. */
SNOW_API uint64_t snow_context_bytes_read(const snow_context *context);

#endif
