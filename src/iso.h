/* iso.h - mode iso (model, point 8): the first sheet that a ray meets whose
 * value is not below a given one, shaded. */
#ifndef SNOW_ISO_H
#define SNOW_ISO_H

#include "base/base.h"

#include <snowglass/render.h>

struct snow_job;
typedef struct snow_iso snow_iso; /* what is kept from picture to picture */

void snow_iso_free(snow_iso *iso);

/* As snow_modes_render, when the frame's ramp is measured, and of a part too: a
 * local image, whose pixels are opaque.  With settings.depth, frame->depth is
 * filled too. */
snow_status snow_iso_render(snow_frame *frame, struct snow_job *job,
                            snow_image **out);

#endif
