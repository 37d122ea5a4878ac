/* frame.h - the top of the library, for its own tests. */
#ifndef SNOW_FRAME_H
#define SNOW_FRAME_H

#include "render/picture.h"

/* Renders by one process; where `bytes` are wanted and the method has written
 * them, *image is NULL. */
snow_status snow_frame_render_alone(snow_frame *frame,
                                    const snow_request *request,
                                    const snow_bytes *bytes,
                                    snow_image **image);

/* Renders the slab `part` of `parts` (decompose/slab.h) of the slices that the
 * volume answers for, in the place where it lies in the whole picture. */
static inline snow_status
snow_frame_render_slab(snow_frame *frame, const snow_volume *volume,
                       const snow_transfer *transfer, const snow_view *view,
                       const snow_settings *settings, int parts, int part,
                       snow_image **out) {
    const snow_request request = {volume,   transfer, view,
                                  settings, parts,    part};
    return snow_frame_render_alone(frame, &request, NULL, out);
}

#endif
