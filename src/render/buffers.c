/* render/buffers.c - what a frame keeps from picture to picture. */
#include "render/job.h"

#include "image/image.h"
#include "render/exact/exact.h"

void snow_buffers_free(snow_frame *frame) {
    snow_exact_free(frame->exact);
    for (int n = 0; n < SNOW_GROUP_RANKS; n++)
        snow_release(frame->context, frame->spare[n]);
    snow_release(frame->context, frame->layer);
    snow_identity_transfer_fini(&frame->identity);
    snow_value_path_free(frame->value_path);
    snow_image_free(frame->depth);
    snow_release(frame->context, frame);
}

const snow_image *snow_frame_depth(const snow_frame *frame) {
    return frame->depth;
}

SNOW_RECORD_OF_ZEROS(snow_stats);
SNOW_RECORD_OF_ZEROS(snow_ranks_stats);

const snow_stats *snow_frame_stats(const snow_frame *frame) {
    return &frame->stats;
}

const snow_ranks_stats *snow_frame_ranks_stats(const snow_frame *frame) {
    return &frame->ranks_stats;
}
