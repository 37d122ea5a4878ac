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

#endif
