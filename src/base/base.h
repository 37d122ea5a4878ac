/* base/base.h - what every stage stands on: contexts, errors, checked sizes,
 * memory, time.  Knows nothing of volumes and pictures. */
#ifndef SNOW_BASE_H
#define SNOW_BASE_H

#include <pthread.h>
#include <snowglass/context.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Leaves a function when a call in it fails and there is nothing to undo. */
#define SNOW_TRY(call)                        \
    do {                                      \
        snow_status snow_try_status = (call); \
        if (snow_try_status != SNOW_OK)       \
            return snow_try_status;           \
    } while (0)

#define SNOW_MESSAGE_BYTES 10240

struct snow_context {
    snow_allocator allocator;
    pthread_mutex_t lock;   /* of bytes, peak and message: the threads of one
                               picture allocate */
    snow_notice_fn *notice; /* NULL: nobody listens */
    void *notice_user;
    uint64_t bytes, peak;   /* held now; the most ever held */
    uint64_t limit;         /* of bytes; 0: none */
    struct snow_pool *pool; /* threads (base/parallel.h), NULL until needed */
    uint64_t serials;       /* given out so far, to tell objects apart */
    uint64_t bytes_read;    /* from files */
    void *spare;            /* a block that the next volume may take for its
                               voxels (volume/stream.c); NULL: none */
    size_t spare_bytes;
    char message[SNOW_MESSAGE_BYTES];
};

/* Sets the context's message and returns `status`, so that a failing function
 * ends with `return snow_fail(...)`.  The text is one line without its end:
 * what is wrong; what to try. */
snow_status snow_fail(snow_context *context, snow_status status,
                      const char *format, ...) SNOW_PRINTF(3, 4);

/* Puts "prefix: " before the message of a failure below and passes its status
 * on: each layer adds what it knows (the name of the file, say). */
snow_status snow_fail_within(snow_context *context, snow_status status,
                             const char *format, ...) SNOW_PRINTF(3, 4);

/* Tells the listener, if there is one. */
void snow_notify(snow_context *context, const char *format, ...)
    SNOW_PRINTF(2, 3);

/* --- memory -------------------------------------------------------------- */

/* A block of `bytes` bytes (0 counts as 1) aligned to 64, or NULL and a
 * message that gives the size.  Contents are undefined, unless `clear`. */
void *snow_allocate(snow_context *context, size_t bytes);
void *snow_allocate_clear(snow_context *context, size_t bytes);

/* The same for an array whose size is checked against overflow. */
void *snow_allocate_array(snow_context *context, uint64_t count, size_t size);

/* Makes `*block` hold at least `bytes`, growing by half again so that a run of
 * appends costs linear time; its first `keep` bytes stay.  `*capacity` is the
 * block's size in bytes, 0 with a NULL block.  On failure nothing changes. */
snow_status snow_reserve(snow_context *context, void *block_pointer,
                         size_t *capacity, size_t keep, size_t bytes);

/* Frees a block of any of these; NULL is accepted. */
void snow_release(snow_context *context, void *block);

/* --- checked sizes -------------------------------------------------------- */

/* a * b or a + b into *out; false when it does not fit. */
bool snow_mul_u64(uint64_t a, uint64_t b, uint64_t *out);
bool snow_add_u64(uint64_t a, uint64_t b, uint64_t *out);

/* --- time ------------------------------------------------------------------
 */

/* Seconds of a steady clock, and of this process' processor time; only
 * differences mean something. */
double snow_seconds(void);
double snow_cpu_seconds(void);
double snow_thread_seconds(void); /* of the calling thread */

/* --- text ------------------------------------------------------------------
 */

/* Numbers of untrusted text: the whole of `text` must be one number in range
 * (blanks around it are accepted).  False otherwise, with *out untouched.
 * parse_double takes nan and inf too, no hexadecimal numbers, and has a point
 * before the decimals in every locale. */
bool snow_parse_int64(const char *text, int64_t *out);
bool snow_parse_double(const char *text, double *out);

/* Copies a number with `point`, the locale's sign, in place of its point.
 * False where it does not fit into `room` bytes, has that sign already, or is
 * hexadecimal. */
bool snow_localize_number(const char *text, const char *point, char *out,
                          size_t room);

/* True when `text` ends with `suffix`, letters of either case. */
bool snow_has_suffix(const char *text, const char *suffix);

/* True when two names are one for people: letters of either case, dashes and
 * underscores left out ("CT_Bone" is "ct-bone"), but for a sign in front ("-x"
 * is not "x"). */
bool snow_same_name(const char *a, const char *b);

#endif
