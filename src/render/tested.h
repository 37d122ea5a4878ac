/* render/tested.h - tested splatting, a method for the bench: original
 * splatting that asks each voxel for its opacity, and leaves out those up to
 * the threshold.  The encodings of section 3.2 are compared with it, since they
 * know these voxels without asking.  Users have no use for it, so that the
 * public enum and the names of methods lack it. */
#ifndef SNOW_RENDER_TESTED_H
#define SNOW_RENDER_TESTED_H

#include <snowglass/render.h>

#define SNOW_METHOD_TESTED ((snow_method)(SNOW_METHOD_RAYCAST + 1))

#endif
