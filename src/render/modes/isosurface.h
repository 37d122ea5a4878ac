/* render/modes/isosurface.h - mode iso (model, point 8): the first sheet that a
 * ray meets whose value is not below a given one, shaded. */
#ifndef SNOW_RENDER_MODES_ISOSURFACE_H
#define SNOW_RENDER_MODES_ISOSURFACE_H

#include "base/base.h"

#include <snowglass/render.h>

typedef struct snow_iso snow_iso; /* what is kept from picture to picture */

void snow_iso_free(snow_iso *iso);

/* snow_method_iso (render/picture.h) finds them when the frame's ramp is
 * measured, and of a part too: pixels are opaque, and where job->depths are
 * wanted those of pixels without a surface are NaN. */

#endif
