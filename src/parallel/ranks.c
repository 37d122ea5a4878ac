/* parallel/ranks.c - what a frame keeps for pictures by many ranks. */
#include "parallel/internal.h"

void snow_in_flight_end(snow_in_flight *f) {
    snow_context *context = f->ranks->context;
    if (f->picture.drawing)
        snow_line_batch_end(f->picture.drawing);
    f->picture.drawing = NULL;
    snow_image_free(f->gathered);
    f->gathered = NULL;
    snow_release(context, f->bytes);
    f->bytes = NULL;
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

void snow_ranks_free(snow_ranks *r) {
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
    uint64_t count = (uint64_t)r->ranks;
    bool fine =
        (r->parts = snow_allocate_array(context, count, sizeof *r->parts)) &&
        (r->boxes = snow_allocate_array(context, count, sizeof *r->boxes)) &&
        (r->order = snow_allocate_array(context, count, sizeof *r->order)) &&
        (r->firsts = snow_allocate_array(context, count, sizeof *r->firsts)) &&
        (r->counts = snow_allocate_array(context, count, sizeof *r->counts)) &&
        (r->offsets =
             snow_allocate_array(context, count, sizeof *r->offsets)) &&
        (r->messages = snow_allocate_array(context, 4 * count + 16,
                                           sizeof *r->messages)) &&
        (r->pictures = snow_allocate_array(context, SNOW_PICTURES_MOST,
                                           sizeof *r->pictures));
    return fine ? snow_combiner_new(r->comm, &r->combiner)
                : SNOW_STATUS_NO_MEMORY;
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
    snow_ranks_free(frame->ranks);
    frame->ranks = NULL;
    snow_status status = snow_comm_agree_status(comm, new_ranks(frame, comm));
    if (status != SNOW_STATUS_OK) {
        snow_ranks_free(frame->ranks);
        frame->ranks = NULL;
    }
    return status;
}
