/* snowglass/extend.h - for libraries over this one, such as that of pictures of
 * running simulations: boxes of voxels, which go from rank to rank, and what a
 * picture by many ranks asks of them.  snowglass.h does not include it. */
#ifndef SNOWGLASS_EXTEND_H
#define SNOWGLASS_EXTEND_H

#include <snowglass/ranks.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The limit of snow_context_set_memory_limit; 0: none. */
SNOW_API uint64_t snow_context_limit(const snow_context *context);

/* --- records (snowglass/context.h) ---------------------------------------- */

/* What snow_x_init_sized does: zeros, `defaults` (NULL: none) as far as `size`
 * reaches, and the size. */
SNOW_API void snow_record_init(void *made, size_t size, const void *defaults,
                               size_t known);

/* Reads a caller's record into `copy` of `known` bytes, which holds the
 * defaults; `given` NULL leaves them. Errors: SNOW_STATUS_BAD_USAGE, with a
 * message unless `context` is NULL; the copy then holds the defaults. A new
 * field lies behind the last byte of the old record, not in its padding. */
SNOW_API snow_status snow_record_read(snow_context *context, const char *name,
                                      const void *given, void *copy,
                                      size_t known);

/* Copies a record of the library into the caller's, as far as that reaches.
 * Errors: as above. */
SNOW_API snow_status snow_record_fill(snow_context *context, const char *name,
                                      const void *made, size_t known,
                                      void *out);

#define SNOW_RECORD_READ(context, record, given, copy) \
    (record##_init(copy),                              \
     snow_record_read((context), #record, (given), (copy), sizeof *(copy)))
#define SNOW_RECORD_FILL(context, record, made, out) \
    snow_record_fill((context), #record, (made), sizeof *(made), (out))

/* --- numbers of all ranks ------------------------------------------------- */

/* Collective, as snow_comm_broadcast is: element by element
 * over all ranks; the result replaces `values` on every rank, and has the same
 * bits there. */
typedef enum snow_reduction { SNOW_SUM, SNOW_MIN, SNOW_MAX } snow_reduction;
SNOW_API snow_status snow_comm_reduce_ints(snow_comm *comm, int64_t *values,
                                           size_t count, snow_reduction by);

SNOW_API snow_status snow_comm_reduce_doubles(snow_comm *comm, double *values,
                                              size_t count, snow_reduction by);

/* --- boxes and voxels ----------------------------------------------------- */

static inline int64_t snow_box_voxels(const snow_box *box) {
    return box->count[0] * box->count[1] * box->count[2];
}

/* What two boxes share; false where that is nothing, with *out untouched. */
static inline bool snow_box_intersect(const snow_box *a, const snow_box *b,
                                      snow_box *out) {
    snow_box shared;
    for (int i = 0; i < 3; i++) {
        int64_t end_a = a->first[i] + a->count[i];
        int64_t end_b = b->first[i] + b->count[i];
        int64_t end = end_a < end_b ? end_a : end_b;
        shared.first[i] = a->first[i] > b->first[i] ? a->first[i] : b->first[i];
        shared.count[i] = end - shared.first[i];
        if (shared.count[i] <= 0)
            return false;
    }
    *out = shared;
    return true;
}

/* A box's voxels as they lie in memory: `voxels` is the first one, strides are
 * counted in values (not bytes) and may be negative. */
typedef struct snow_brick {
    snow_box box;
    const void *voxels;
    int64_t stride[3];
} snow_brick;

/* Copies the part of a brick that lies in `box`, which lies in `whole`, to its
 * place in the dense box `whole` (x fastest).  `value` is the bytes of one, 1,
 * 2, 4 or 8. */
SNOW_API void snow_brick_copy(const snow_brick *brick, size_t value,
                              const snow_box *box, const snow_box *whole,
                              void *dense);

/* A plan, with its buffers. */
typedef struct snow_voxels snow_voxels;

SNOW_API snow_status snow_voxels_new(snow_comm *comm, snow_voxels **out);
SNOW_API void snow_voxels_free(snow_voxels *voxels);

/* Forgets the plan and frees its buffers. */
SNOW_API void snow_voxels_clear(snow_voxels *voxels);

/* Collective.  Plans what goes where when this rank holds `count` boxes and
 * wants one; any of them may be empty.  Statuses are agreed on.  Errors:
 * SNOW_STATUS_BAD_USAGE (boxes that overlap, wanted voxels that nobody holds),
 * SNOW_STATUS_NO_MEMORY; the plan is then empty. */
SNOW_API snow_status snow_voxels_plan(snow_voxels *voxels, const snow_box *held,
                                      int count, const snow_box *wanted);

/* Collective.  Moves voxels of `value` bytes (the same on all ranks) as
 * planned: bricks[n] is what lies in held[n], `dense` the wanted box.  The
 * first call after a plan takes memory, and any with a larger value, upon which
 * statuses are agreed; later ones take none.  Errors: SNOW_STATUS_NO_MEMORY,
 * and those of the transport. */
SNOW_API snow_status snow_voxels_move(snow_voxels *voxels,
                                      const snow_brick *bricks, size_t value,
                                      void *dense);

/* Gives a part the matrix of its whole, exactly: computed from that of the part
 * it would differ by rounding from rank to rank. */
SNOW_API snow_status snow_volume_set_whole(snow_volume *volume,
                                           const snow_volume_info *whole);

/* --- what a picture needs ------------------------------------------------- */

/* Of the parts of a volume. */
typedef struct snow_ranks_needs {
    size_t size;
    int64_t layers[3]; /* ghost voxels on either side, for all directions of the
                          camera at the view's zoom, angle and size */
    int slice_axis;    /* of the grid: slices of the view lie across it */
} snow_ranks_needs;
SNOW_RECORD(snow_ranks_needs);

/* Errors: SNOW_STATUS_BAD_USAGE (view, settings), SNOW_STATUS_BAD_INPUT (a
 * geometry that no float can hold). */
SNOW_API snow_status snow_ranks_find_needs(snow_context *context,
                                           const snow_volume_info *whole,
                                           const snow_view *view,
                                           const snow_settings *settings,
                                           const snow_look *look,
                                           snow_ranks_needs *out);

/* Whether disjoint boxes have an order from front to back: bars that lie in a
 * ring have none.  Errors: as above, SNOW_STATUS_NO_MEMORY. */
SNOW_API snow_status snow_ranks_have_order(snow_context *context,
                                           const snow_volume_info *whole,
                                           const snow_view *view,
                                           const snow_box *boxes, int count,
                                           bool *out);

/* A rank's slab of that many slices, for pictures that are the same for every
 * number of ranks (snow_settings.deterministic): `*count` from `*first` on,
 * both 0 where it gets none. */
SNOW_API void snow_ranks_slab(int64_t slices, int ranks, int rank,
                              int64_t *first, int64_t *count);

#ifdef __cplusplus
}
#endif

#endif
