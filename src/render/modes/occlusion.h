/* render/modes/occlusion.h - light from all around that what is near takes away
 * (docs/model.md). */
#ifndef SNOW_RENDER_MODES_OCCLUSION_H
#define SNOW_RENDER_MODES_OCCLUSION_H

#include "render/picture.h"

/* Collective.  Darkens the colours of a picture that has its depths by
 * settings.occlusion.  Errors: `status`; no memory; those of reading slabs. */
snow_status snow_occlude(snow_picture *picture, snow_status status);

#endif
