/* render/buffers.h - what a frame keeps from picture to picture. */
#ifndef SNOW_RENDER_BUFFERS_H
#define SNOW_RENDER_BUFFERS_H

#include "render/job.h"

/* A frame without what many ranks need (parallel/internal.h).  Errors:
 * SNOW_STATUS_NO_MEMORY. */
snow_status snow_buffers_new(snow_context *context, snow_frame **out);
void snow_buffers_free(snow_frame *frame);

#endif
