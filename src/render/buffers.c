/* render/buffers.c - what a frame keeps from picture to picture. */

#include "render/picture.h"

void snow_buffers_free(snow_frame *frame) {
    snow_footprint_buffers_free(frame->footprint);
    for (int n = 0; n < SNOW_GROUP_RANKS; n++)
        snow_release(frame->context, frame->spare[n]);
    snow_release(frame->context, frame->layer);
    snow_identity_transfer_fini(&frame->identity);
    snow_value_path_free(frame->value_path);
    snow_image_free(frame->depth);
    snow_layers_drop(frame, 0);
    snow_release(frame->context, frame);
}

snow_status snow_frame_set_layers(snow_frame *frame, const snow_layer *layers,
                                  int count) {
    if (count < 0 || count > SNOW_LAYERS_MAX)
        return snow_fail(frame->context, SNOW_STATUS_BAD_USAGE,
                         "%d layers; up to %d are drawn with a volume", count,
                         SNOW_LAYERS_MAX);
    for (int n = 0; n < count; n++)
        frame->layers[n] = layers[n];
    frame->layer_count = count;
    snow_layers_drop(frame, count);
    return SNOW_STATUS_OK;
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
