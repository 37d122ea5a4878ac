/* perspective.h - figure 8 of the paper in perspective, by the methods that
 * throw footprints onto the picture itself. */
#ifndef SNOW_PERSPECTIVE_H
#define SNOW_PERSPECTIVE_H

#include "frame.h"

/* Fills the local image of a job whose view is in perspective, the seconds of
 * its stages, and the counts of voxels and bytes.  Errors: SNOW_BAD_USAGE,
 * SNOW_NO_MEMORY. */
snow_status snow_perspective_render(const snow_job *job);

#endif
