/* parallel/frames.c - frames, which own what pictures of one process and of
 * many ranks keep. */
#include "parallel/internal.h"
#include "parallel/load_balance.h"

snow_status snow_frame_new(snow_context *context, snow_frame **out) {
    snow_frame *frame = NULL;
    SNOW_TRY(snow_buffers_new(context, &frame));
    snow_status status = snow_load_balance_new(context, &frame->work);
    if (status == SNOW_STATUS_OK)
        *out = frame;
    else
        snow_buffers_free(frame);
    return status;
}

void snow_frame_free(snow_frame *frame) {
    if (!frame)
        return;
    snow_ranks_free(frame->ranks);
    snow_load_balance_free(frame->context, frame->work);
    snow_buffers_free(frame);
}
