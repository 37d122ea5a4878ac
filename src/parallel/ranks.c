/* parallel/ranks.c - what a frame keeps for pictures by many ranks. */
#include "decompose/order.h"
#include "parallel/internal.h"

#include <string.h>

void snow_in_flight_end(snow_in_flight *f) {
    snow_context *context = f->ranks->context;
    if (f->picture.drawing)
        snow_line_batch_end(f->picture.drawing);
    f->picture.drawing = NULL;
    snow_volume_close(f->held);
    f->held = NULL;
    snow_image_free(f->gathered);
    f->gathered = NULL;
    SNOW_DROP(context, f->bytes);
}

/* Pictures that nobody has asked for end here. */
static void end_in_flight(snow_ranks *r) {
    for (int n = 0; n < r->in_flight; n++) {
        snow_in_flight *f = snow_in_flight_at(r, n);
        snow_in_flight_end(f);
        snow_image_free(f->picture.image);
        snow_image_free(f->picture.depth);
        snow_image_free(f->picture.near);
    }
    if (r->drawn)
        snow_comm_occupy(r->comm, NULL, NULL);
}

static void free_ranks(snow_ranks *r) {
    if (!r)
        return;
    snow_context *context = r->context;
    end_in_flight(r);
    void *const blocks[] = {r->parts,    r->boxes,   r->order, r->firsts,
                            r->counts,   r->offsets, r->sent,  r->came,
                            r->messages, r->region,  r->lines, r->images,
                            r->runs,     r->packed,  r->rows,  r->pictures};
    for (size_t n = 0; n < sizeof blocks / sizeof *blocks; n++)
        snow_release(context, blocks[n]);
    snow_combiner_free(r->combiner);
    snow_release(context, r);
}

static snow_status take_arrays(snow_ranks *r) {
    snow_context *context = r->context;
    SNOW_TRY(SNOW_RESERVE(context, r->parts, 0, r->ranks));
    SNOW_TRY(SNOW_RESERVE(context, r->boxes, 0, r->ranks));
    SNOW_TRY(SNOW_RESERVE(context, r->order, 0, r->ranks));
    SNOW_TRY(SNOW_RESERVE(context, r->firsts, 0, r->ranks));
    SNOW_TRY(SNOW_RESERVE(context, r->counts, 0, r->ranks));
    SNOW_TRY(SNOW_RESERVE(context, r->offsets, 0, r->ranks));
    SNOW_TRY(SNOW_RESERVE(context, r->messages, 0, 4 * r->ranks + 16));
    SNOW_TRY(SNOW_RESERVE(context, r->pictures, 0, SNOW_PICTURES_MOST));
    return snow_combiner_new(r->comm, &r->combiner);
}

static snow_status new_ranks(snow_frame *frame, snow_comm *comm) {
    snow_ranks *r = snow_allocate_clear(frame->context, sizeof *r);
    if (!r)
        return SNOW_STATUS_NO_MEMORY;
    r->context = frame->context;
    r->comm = comm;
    r->rank = snow_comm_rank(comm);
    r->ranks = snow_comm_size(comm);
    r->begin_at = (double)(r->rank + 1) / r->ranks;
    frame->ranks = r;
    return take_arrays(r);
}

snow_status snow_ranks_of(snow_frame *frame, snow_comm *comm) {
    if (frame->ranks && frame->ranks->comm == comm)
        return SNOW_STATUS_OK;
    free_ranks(frame->ranks);
    frame->ranks = NULL;
    snow_status status = snow_comm_agree_status(comm, new_ranks(frame, comm));
    if (status != SNOW_STATUS_OK) {
        free_ranks(frame->ranks);
        frame->ranks = NULL;
    }
    return status;
}

/* --- the order of parts --------------------------------------------------- */

snow_status snow_ranks_put_in_order(snow_ranks *r,
                                    const snow_placement *placement) {
    snow_viewer viewer = {0};
    snow_clip_viewer(placement, &viewer);
    if (r->ordered && r->ordered == r->generation &&
        viewer.perspective == r->viewer.perspective &&
        memcmp(viewer.eye, r->viewer.eye, sizeof viewer.eye) == 0 &&
        memcmp(viewer.along, r->viewer.along, sizeof viewer.along) == 0)
        return SNOW_STATUS_OK;
    r->ordered = 0;
    SNOW_TRY(
        snow_order_boxes(r->context, r->boxes, r->ranks, &viewer, r->order));
    r->viewer = viewer;
    r->ordered = r->generation;
    return SNOW_STATUS_OK;
}

/* --- frames, of one process and of many ranks ----------------------------- */

snow_status snow_frame_new(snow_context *context, snow_frame **out) {
    snow_frame *frame = snow_allocate_clear(context, sizeof *frame);
    if (!frame)
        return SNOW_STATUS_NO_MEMORY;
    frame->context = context;
    *out = frame;
    return SNOW_STATUS_OK;
}

void snow_frame_free(snow_frame *frame) {
    if (!frame)
        return;
    free_ranks(frame->ranks);
    snow_buffers_free(frame);
}
