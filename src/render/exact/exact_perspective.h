/* render/exact/exact_perspective.h - figure 8 of the paper in perspective, by
 * the methods that splat footprints onto the picture itself. */
#ifndef SNOW_RENDER_EXACT_EXACT_PERSPECTIVE_H
#define SNOW_RENDER_EXACT_EXACT_PERSPECTIVE_H

#include "render/picture.h"

/* What a frame keeps of a picture that failed; NULL is accepted. */
void snow_exact_eye_free(snow_context *context, snow_exact_eye *eye);

#endif
