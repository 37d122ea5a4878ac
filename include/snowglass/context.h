/* snowglass/context.h - where an object's memory and messages come from.
 *
 * The library has no global state: the allocator, the last error message and
 * the count of bytes live in a context that the caller makes first and frees
 * last.  A context and all objects made with it belong to one thread at a
 * time; different contexts are independent.  A context keeps the threads that
 * render (they sleep between pictures) until it is freed; after fork() the
 * child makes its own. */
#ifndef SNOWGLASS_CONTEXT_H
#define SNOWGLASS_CONTEXT_H

#include <snowglass/status.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct snow_context snow_context;

/* --- records ---------------------------------------------------------------
 *
 * Records that a call reads or fills begin with `size` and may grow at their
 * end. Initialise each before its first use, whoever fills it:
 *
 *   snow_view view;
 *   snow_view_init(&view);
 *
 * snow_x_init sets `size` and the default of every field. A record whose
 * defaults are zeros (all but snow_view, snow_settings and snow_recipe) may
 * also be written {.size = sizeof(snow_x), ...}. Fields that are beyond the
 * caller's `size` have their defaults and are not written. A size of 0 is
 * SNOW_STATUS_BAD_USAGE, as is a field that this library does not know, unless
 * it is 0. Records without `size` (points, ranges, boxes) never grow. */
#define SNOW_RECORD(record)                                       \
    SNOW_API void record##_init_sized(record *made, size_t size); \
    static inline void record##_init(record *made) {              \
        record##_init_sized(made, sizeof *made);                  \
    }                                                             \
    struct record

/* The caller's allocator.  `allocate` returns memory aligned as malloc's, or
 * NULL; `release` accepts what `allocate` returned, never NULL.  Neither is
 * called by two threads at once, but threads that render call them too. */
typedef struct snow_allocator {
    void *(*allocate)(void *user, size_t bytes);
    void (*release)(void *user, void *block);
    void *user;
} snow_allocator;

/* Hears remarks that are no errors: what was guessed, bytes after the data,
 * a spacing replaced by 1.  `text` is one line without its end. */
typedef void snow_warning_fn(void *user, const char *text);

/* Makes a context.  `allocator` may be NULL (malloc and free); it is copied.
 * Errors: SNOW_STATUS_NO_MEMORY.  Free with snow_context_free. */
SNOW_API snow_status snow_context_new(const snow_allocator *allocator,
                                      snow_context **out);

/* Frees a context after all objects made with it; NULL is accepted. */
SNOW_API void snow_context_free(snow_context *context);

/* The message of the last call that failed: one line that names the file,
 * what is wrong and what to try; "" before any failure.  Owned by the context,
 * valid until the next failure. */
SNOW_API const char *snow_context_message(const snow_context *context);

/* Sets who hears remarks; NULL (the default) for nobody. */
SNOW_API void snow_context_set_warning(snow_context *context,
                                       snow_warning_fn *notice, void *user);

/* --- stop and progress ---------------------------------------------------- */

/* Whether a picture is to end now (snow_settings.stop): true ends it with
 * SNOW_STATUS_STOPPED.  Called by the thread that called the library and by no
 * other, often, between small parts of the work.  Must not call the library
 * with objects of the same context. */
typedef bool snow_stop_fn(void *user);

/* What a call that takes long is doing.  A picture of a volume that stays in
 * its file reads while it encodes, and reports SNOW_STAGE_ENCODE. */
typedef enum snow_stage {
    SNOW_STAGE_READ = 0, /* a volume is opened, or a phantom made */
    SNOW_STAGE_ENCODE,   /* of a picture: classified, shaded and encoded */
    SNOW_STAGE_RENDER    /* of a picture: all else */
} snow_stage;

/* Hears how far a stage is, as a fraction from 0 to 1 that never falls in one
 * call; returning true ends the call with SNOW_STATUS_STOPPED, unless it is
 * nearly done.  Called as snow_stop_fn, at most 20 times a second, and not at
 * all for what is done in less than 1/20 s.  A stage that was reported and is
 * done reports 1 in the end. */
typedef bool snow_progress_fn(void *user, snow_stage stage, double fraction);

/* Sets who hears of progress; NULL (the default) for nobody. */
SNOW_API void snow_context_set_progress(snow_context *context,
                                        snow_progress_fn *progress, void *user);

/* --- for those who extend the library, as by a transport (comm.h) --------- */

/* Leaves a message of a failure and returns `status`; tells the listener a
 * remark, if there is one.  Text as of printf, one line without its end. */
SNOW_API snow_status snow_context_fail(snow_context *context,
                                       snow_status status, const char *format,
                                       ...) SNOW_PRINTF(3, 4);
SNOW_API void snow_context_warn(snow_context *context, const char *format, ...)
    SNOW_PRINTF(2, 3);

/* A block of the context's memory, aligned to 64, or NULL and a message that
 * gives the size; NULL is accepted by the other. */
SNOW_API void *snow_context_allocate(snow_context *context, size_t bytes);
SNOW_API void snow_context_release(snow_context *context, void *block);

/* --- figures -------------------------------------------------------------- */

/* The most bytes that objects of this context may hold together from now on; 0:
 * as many as there are.  What would exceed it fails with SNOW_STATUS_NO_MEMORY.
 */
SNOW_API void snow_context_set_memory_limit(snow_context *context,
                                            uint64_t bytes);

/* Bytes that objects of this context hold now, and the most they ever held. */
SNOW_API uint64_t snow_context_bytes(const snow_context *context);
SNOW_API uint64_t snow_context_peak_bytes(const snow_context *context);

/* Bytes that this context has read from files so far, packed ones as they are
 * packed. */
SNOW_API uint64_t snow_context_bytes_read(const snow_context *context);

#ifdef __cplusplus
}
#endif
#endif
