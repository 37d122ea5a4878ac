/* volume/refine.h - cells that are several voxels wide, as the voxels.
 *
 *     cells    |   a   |   b   |   c   |   d   |   e   |    values at centres
 *     voxels   | | | | | | | | |v| | | | | | | | | | | |    v: from a, b, c, d
 *
 * Along one axis after another a voxel has the cubic through the four centres
 * around it, but never more than the most of these four, nor less than the
 * least: steps stay steps.  Beyond the last cell values go on as they did,
 * where that is smooth.  A voxel of a cell without a value has none.  The
 * function is that of snowglass/extend.h. */
#ifndef SNOW_VOLUME_REFINE_H
#define SNOW_VOLUME_REFINE_H

#include "base/base.h"

/* Cells before and behind its own that a voxel depends on. */
#define SNOW_REFINE_REACH 3

#endif
