/* base/base.h - the foundation of every stage: contexts, errors, checked sizes,
 * memory, time. It does not depend on volumes and pictures. */
#ifndef SNOW_BASE_H
#define SNOW_BASE_H

#include <pthread.h>
#include <snowglass/extend.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Returns from a function with the status of a failed call, if nothing needs to
 * be undone. */
#define SNOW_TRY(call)                         \
    do {                                       \
        snow_status snow_try_status = (call);  \
        if (snow_try_status != SNOW_STATUS_OK) \
            return snow_try_status;            \
    } while (0)

#define SNOW_MESSAGE_BYTES 10240

typedef struct snow_monitor snow_monitor; /* monitor.h */

/* Blocks of voxels that a file is packed in, each of which is unpacked as a
 * whole; of a box, `cut` of the first block's lie before it.  Sizes of 0: there
 * are no blocks. */
typedef struct snow_file_blocks {
    int64_t size[3], cut[3];
} snow_file_blocks;

struct snow_context {
    snow_allocator allocator;
    pthread_mutex_t lock; /* of bytes, peak and message: several threads of a
                             picture allocate */
    snow_warning_fn *warning; /* NULL: no warnings */
    void *warning_user;
    uint64_t bytes, peak;   /* allocated now; the most so far */
    uint64_t limit;         /* of bytes; 0: none */
    struct snow_pool *pool; /* threads (thread_pool.h), NULL until needed */
    double shared, longest; /* seconds of batches by one thread, and of the
                               longest item of each, so far */
    uint64_t generations;  /* number of generations given out, which distinguish
                              objects */
    uint64_t bytes_read;   /* from files */
    snow_monitor *monitor; /* of the call or picture at work; NULL: none */
    snow_progress_fn *progress; /* NULL: none */
    void *progress_user;
    double progress_due; /* time of its next call */
    void *spare;         /* a block that the next volume may use for its voxels
                            (volume/stream.c); NULL: none */
    bool leaves_clipped; /* a volume is opened for whom values next to clip
                            planes are nothing */
    snow_file_blocks blocks; /* of the file that was looked at last, if its
                                reader says so */
    bool inflates; /* and whether that is a stream of gzip or zlib, in which a
                      voxel is reached by unpacking all before it */
    char lost[SNOW_MESSAGE_BYTES / 2]; /* what could not be looked up or read
                                          of the file that is being opened
                                          (io/lookup.h); "": nothing */
    char message[SNOW_MESSAGE_BYTES];
};

/* What extensions call, by the library's own names (snowglass/context.h).  A
 * failing function ends with `return snow_fail(...)`, whose text is one line:
 * what is wrong: the limit; what to do. */
#define snow_fail snow_context_fail
#define snow_notify snow_context_warn
#define snow_allocate snow_context_allocate
#define snow_release snow_context_release
#define snow_reserve snow_context_reserve

/* Writes why stat, open or read has failed by an errno, and what to do: "No such
 * file or directory; check the name and the permissions". */
void snow_explain(int number, char *out, size_t size);

/* Refuses a path that is NULL. */
snow_status snow_need_path(snow_context *context, const char *path);

/* Puts "prefix: " before the message of a failure in a called function and
 * returns its status: each caller adds what it knows (the name of the
 * file, say). */
snow_status snow_fail_within(snow_context *context, snow_status status,
                             const char *format, ...) SNOW_PRINTF(3, 4);

/* Puts "path: " before the message of a failure in a file, unless it begins
 * with that already, and passes its status on. */
snow_status snow_fail_in_file(snow_context *context, snow_status status,
                              const char *path);

/* --- memory --------------------------------------------------------------- */

/* Does what snow_allocate does, but of zeros. */
void *snow_allocate_clear(snow_context *context, size_t bytes);

/* The same for an array; its size is checked for overflow. */
void *snow_allocate_array(snow_context *context, uint64_t count, size_t size);

/* snow_reserve for a pointer to items of their own type. */
#define SNOW_RESERVE(context, block, keep, count)                        \
    snow_reserve(context, &(block), (uint64_t)(keep), (uint64_t)(count), \
                 sizeof *(block))

/* Counts memory that the allocator does not give, as if it did; forgets it.
 * Errors: SNOW_STATUS_NO_MEMORY (the limit). */
snow_status snow_memory_count(snow_context *context, size_t bytes);
void snow_memory_forget(snow_context *context, size_t bytes);

/* The size of a block; 0 for NULL. */
size_t snow_block_bytes(const void *block);

/* The next multiple of what all blocks are aligned to. */
#define SNOW_ALIGNMENT 64
static inline size_t snow_align(size_t bytes) {
    return (bytes + SNOW_ALIGNMENT - 1) / SNOW_ALIGNMENT * SNOW_ALIGNMENT;
}

/* Releases a block and forgets it. */
#define SNOW_DROP(context, block) \
    (snow_release(context, block), (void)((block) = NULL))

/* --- checked sizes -------------------------------------------------------- */

/* a * b or a + b into *out; false when it does not fit. */
bool snow_mul_u64(uint64_t a, uint64_t b, uint64_t *out);
bool snow_add_u64(uint64_t a, uint64_t b, uint64_t *out);

/* The last of the places `low` to `high` whose number is at most `most`; `low`
 * if none is.  Numbers rise. */
int64_t snow_last_up_to(const int64_t *numbers, int64_t low, int64_t high,
                        int64_t most);

/* --- records -------------------------------------------------------------- */

/* Defines the initialiser of a record that grows at its end
 * (snowglass/extend.h) and whose defaults are zeros. */
#define SNOW_RECORD_OF_ZEROS(record)                      \
    void record##_init_sized(record *made, size_t size) { \
        snow_record_init(made, size, NULL, sizeof *made); \
    }                                                     \
    struct record

/* --- time ----------------------------------------------------------------- */

/* Seconds of a monotonic clock, and of this process' processor time; only
 * differences are meaningful. */
double snow_seconds(void);
double snow_cpu_seconds(void);
double snow_thread_seconds(void); /* of the calling thread */

/* Adds the seconds since *mark to a total, and moves the mark. */
static inline void snow_lap(double *mark, double *total) {
    double now = snow_seconds();
    *total += now - *mark;
    *mark = now;
}

/* --- text ----------------------------------------------------------------- */

/* Parses numbers in untrusted text: the whole of `text` must be one number in
 * range (blanks around it are accepted). Returns false otherwise, with *out
 * unchanged. snow_parse_double also accepts nan and inf, rejects hexadecimal
 * numbers, and uses a decimal point in every locale. */
bool snow_parse_int64(const char *text, int64_t *out);
bool snow_parse_double(const char *text, double *out);

/* Bytes of the letter of UTF-8 that a text begins with, 0: of none; and whether
 * it is a control character, which a terminal must not see. */
size_t snow_letter_bytes(const char *text, bool *control);

/* True if `text` ends with `suffix`, ignoring case. */
bool snow_has_suffix(const char *text, const char *suffix);

/* True if two names are equal to people: ignoring case, dashes and underscores
 * ("CT_Bone" is "ct-bone"), except for a leading sign ("-x" is not "x").  NULL
 * equals no name. */
bool snow_same_name(const char *a, const char *b);

/* Metres in a degree of a sphere as large as the earth (6,371 km). */
#define SNOW_DEGREE 111195.0

#endif
