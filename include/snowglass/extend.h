/* snowglass/extend.h - for those who extend the library: a transport of
 * messages, or a library over this one, as that of pictures in situ. */
#ifndef SNOWGLASS_EXTEND_H
#define SNOWGLASS_EXTEND_H

#include <snowglass/ranks.h>
#include <stdarg.h>

/* Leaves the message of a failure in a context, and returns `status`. The text
 * is made as by printf, and becomes one line without its end. */
SNOW_API snow_status snow_context_fail(snow_context *context,
    snow_status status, const char *format, ...) SNOW_PRINTF(3, 4);

/* Gives a warning, in the same way. */
SNOW_API void snow_context_warn(snow_context *context, const char *format, ...)
    SNOW_PRINTF(2, 3);

/* Makes a text of `capacity` bytes one line without its end. */
SNOW_API void snow_text_to_line(char *text, size_t capacity);

/* snprintf, vsnprintf and sscanf whose numbers have a point in all locales. */
SNOW_API int snow_text_print(
    char *text, size_t capacity, const char *format, ...) SNOW_PRINTF(3, 4);
SNOW_API int snow_text_vprint(
    char *text, size_t capacity, const char *format, va_list arguments);
SNOW_API int snow_text_scan(const char *text, const char *format, ...);

/* Returns a block of the context's memory, aligned to 64 bytes, or NULL and a
 * message. */
SNOW_API void *snow_context_allocate(snow_context *context, size_t bytes);

/* Gives back a block, or NULL. */
SNOW_API void snow_context_release(snow_context *context, void *block);

/* Makes the block in *block_pointer, or a new one, hold `count` items of `size`
 * bytes, the first `keep` of them as they were. */
SNOW_API snow_status snow_context_reserve(snow_context *context,
    void *block_pointer, uint64_t keep, uint64_t count, size_t size);

/* Returns the limit of snow_context_set_memory_limit, or 0. */
SNOW_API uint64_t snow_context_limit(const snow_context *context);

/* Begins a record, for snow_x_init_sized: zeros, then `defaults` (or NULL), of
 * `known` bytes, as far as `size` reaches. A new field of a record lies behind
 * the old record, not in its padding. */
SNOW_API void snow_record_init(
    void *made, size_t size, const void *defaults, size_t known);

/* Reads a caller's record (or NULL) into `copy`, which holds the defaults.
 * Errors: BAD_USAGE, without a message where `context` is NULL. */
SNOW_API snow_status snow_record_read(snow_context *context, const char *name,
    const void *given, void *copy, size_t known);

/* Fills a caller's record as far as its size reaches. Errors: as above. */
SNOW_API snow_status snow_record_fill(snow_context *context, const char *name,
    const void *made, size_t known, void *out);

/* The same for a record by the name of its type. */
#define SNOW_RECORD_READ(context, record, given, copy) \
    (record##_init(copy),                              \
        snow_record_read((context), #record, (given), (copy), sizeof *(copy)))
#define SNOW_RECORD_FILL(context, record, made, out) \
    snow_record_fill((context), #record, (made), sizeof *(made), (out))

/* A message in flight. `handle` belongs to the transport: NULL once it is done;
 * `bytes` of a received one is then its length. */
typedef struct snow_message {
    void *handle;
    size_t bytes;
} snow_message;

/* Does a piece of work; false: none is left. */
typedef bool snow_idle_fn(void *user);

/* A transport, called by the communicator's thread; after a failure, which
 * leaves a message, only `end` is. The first five and `end` are needed. */
typedef struct snow_comm_ops {
    size_t size;
    /* Start a message, whose bytes stay until it is done, and get ready for one
     * of at most `room` bytes (a longer one is a failure). Those of one tag, 0
     * to 32767, arrive in order; a rank may send to itself. */
    snow_status (*send)(void *self, const void *bytes, size_t count, int to,
        int tag, snow_message *message);
    snow_status (*receive)(void *self, void *bytes, size_t room, int from,
        int tag, snow_message *message);
    /* Wait until one in flight is done, and say which, -1 for none; for all. */
    snow_status (*wait_any)(
        void *self, snow_message *messages, int count, int *which);
    snow_status (*wait_all)(void *self, snow_message *messages, int count);
    /* Seconds of the messages' clock; lets simulated time pass. */
    double (*seconds)(void *self);
    void (*work)(void *self, double seconds);
    /* Waits do pieces of `work` (or NULL) while no message is done. */
    void (*occupy)(void *self, snow_idle_fn *work, void *user);
    void (*progress)(void *self); /* moves messages on, without waiting */
    void (*timeout)(void *self, double seconds); /* snow_comm_set_timeout */
    void (*end)(void *self);                     /* frees self */
    /* Memory that ranks of a node share: all or none (docs/scaling.md). */
    int (*node_of)(void *self, int rank);
    snow_status (*share)(void *self, size_t bytes, void **own);
    const void *(*shared)(void *self, int rank);
    void (*unshare)(void *self);
} snow_comm_ops;
SNOW_RECORD(snow_comm_ops);

/* Makes a communicator over a transport. `ops` is copied. The communicator ends
 * `self` when it is freed; a call that fails does not. Errors: BAD_USAGE
 * (missing functions, a rank not in 0 to ranks - 1). */
SNOW_API snow_status snow_comm_new(snow_context *context,
    const snow_comm_ops *ops, void *self, int rank, int ranks, snow_comm **out);

/* How numbers of ranks become one. */
typedef enum snow_reduce {
    SNOW_REDUCE_SUM,
    SNOW_REDUCE_MIN,
    SNOW_REDUCE_MAX
} snow_reduce;

/* Collective. Reduce `count` numbers, element by element, over all ranks. The
 * result replaces `values`, with the same bits on every rank. */
SNOW_API snow_status snow_comm_reduce_ints(
    snow_comm *comm, int64_t *values, size_t count, snow_reduce by);
SNOW_API snow_status snow_comm_reduce_doubles(
    snow_comm *comm, double *values, size_t count, snow_reduce by);

/* Returns how many voxels a box has. */
SNOW_API int64_t snow_box_voxels(const snow_box *box);

/* Gives what two boxes share; false, and *out untouched, where that is
 * nothing. */
SNOW_API bool snow_box_intersect(
    const snow_box *a, const snow_box *b, snow_box *out);

/* A box's voxels in memory, from its first one; strides are in values. */
typedef struct snow_brick {
    snow_box box;
    const void *voxels;
    int64_t stride[3];
} snow_brick;

/* Copies the part of a brick that is in `box`, which lies in `whole`, to its
 * place in the dense box `whole` (x fastest). Values have 1, 2, 4 or 8
 * bytes. */
SNOW_API void snow_brick_copy(const snow_brick *brick, size_t value,
    const snow_box *box, const snow_box *whole, void *dense);

/* Receives row (y, z) of voxels; with `values` NULL it returns whether it wants
 * that row. */
typedef bool snow_refined_fn(
    void *user, int64_t y, int64_t z, const double *values);

/* Interpolates the voxels of a box from cells of `ratio` voxels, NaN where
 * there is none, in a box of cells that is three wider; `take` gets them row by
 * row. */
SNOW_API snow_status snow_cells_refine(snow_context *context,
    const double *cells, const snow_box *box, const int64_t ratio[3],
    const snow_box *voxels, snow_refined_fn *take, void *user);

/* Adds `count` cells of a row, from place `first` on, to the wider ones of
 * `ratio`: sums to `to`, and the shares of what there is to `to_shares`.
 * `shares` NULL: 1, and 0 of NaN. */
SNOW_API void snow_cells_add(const double *values, const float *shares,
    int64_t first, int64_t count, const int64_t ratio[3], double *to,
    float *to_shares);

/* A plan of moves of voxels between ranks, with its buffers. */
typedef struct snow_voxels snow_voxels;

/* Makes an empty plan. */
SNOW_API snow_status snow_voxels_new(snow_comm *comm, snow_voxels **out);
SNOW_API void snow_voxels_free(snow_voxels *voxels);

/* Drops the plan and its buffers. */
SNOW_API void snow_voxels_clear(snow_voxels *voxels);

/* Collective. Plans what goes where when this rank holds `count` boxes and
 * wants one; any may be empty. Errors, alike on all ranks: BAD_USAGE (boxes
 * that overlap, wanted voxels that nobody holds), those of the transport. */
SNOW_API snow_status snow_voxels_plan(snow_voxels *voxels, const snow_box *held,
    int count, const snow_box *wanted);

/* Collective. Moves voxels of `value` bytes from bricks[n], in held[n], to the
 * wanted box. Errors: those of the transport. */
SNOW_API snow_status snow_voxels_move(
    snow_voxels *voxels, const snow_brick *bricks, size_t value, void *dense);

/* Lets rows and slices of wrapped voxels lie apart: pitch[0] values from row to
 * row, pitch[1] from slice to slice. */
SNOW_API void snow_volume_set_pitch(
    snow_volume *volume, const int64_t pitch[2]);

/* Gives a part the matrix of its whole, exactly; a whole the given matrix. */
SNOW_API snow_status snow_volume_set_whole(
    snow_volume *volume, const snow_volume_info *whole);

/* What the parts of a volume need. */
typedef struct snow_ranks_needs {
    size_t size;
    int64_t layers[3]; /* ghost voxels on either side, for all directions of the
                          camera at the view's zoom, angle and size */
    int slice_axis;    /* of the grid: slices of the view lie across it */
} snow_ranks_needs;
SNOW_RECORD(snow_ranks_needs);

/* Finds what parts need for a view. Errors: as snow_frame_render. */
SNOW_API snow_status snow_ranks_find_needs(snow_context *context,
    const snow_volume_info *whole, const snow_view *view,
    const snow_settings *settings, const snow_look *look,
    snow_ranks_needs *out);

/* Finds whether disjoint boxes have an order from front to back. Errors: as
 * above. */
SNOW_API snow_status snow_ranks_have_order(snow_context *context,
    const snow_volume_info *whole, const snow_view *view, const snow_box *boxes,
    int count, bool *out);

/* Gives the slab of a rank of a deterministic picture, in slices; both are 0
 * where it gets none. */
SNOW_API void snow_ranks_slab(
    int64_t slices, int ranks, int rank, int64_t *first, int64_t *count);

#endif
