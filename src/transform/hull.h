/* transform/hull.h - the corners of a set of voxels: before no camera does any
 * of its voxels lie farther out than they do. */
#ifndef SNOW_TRANSFORM_HULL_H
#define SNOW_TRANSFORM_HULL_H

#include "base/base.h"

#include <snowglass/volume.h>

/* Begins as zeros but for the context.  Functions fail with
 * SNOW_STATUS_NO_MEMORY. */
typedef struct snow_hull {
    snow_context *context;
    double (*points)[3], (*spare)[3]; /* voxels of the whole */
    size_t count;
} snow_hull;

/* Adds the first and last columns of all rows of a part, which are of the
 * part's own voxels; of a row that has none the first is behind the last. */
snow_status snow_hull_add(snow_hull *hull, const snow_extent *part,
                          uint32_t (*rows)[2]);
/* When all are added: leaves few points but the corners. */
snow_status snow_hull_end(snow_hull *hull);
void snow_hull_free(snow_hull *hull);

#endif
