/* render/exact/exact.h - the methods that splat footprints onto the image
 * itself: original, tested and footprint; figure 8 of the paper, lines 03
 * to 13. */
#ifndef SNOW_RENDER_EXACT_EXACT_H
#define SNOW_RENDER_EXACT_EXACT_H

#include "render/picture.h"

/* The buffers of the stages, kept from picture to picture: a second picture of
 * the same sizes takes no memory.  NULL until needed. */
void snow_exact_free(snow_exact *exact);

/* snow_method_exact fills the local image of a job, and the seconds of its
 * stages.  Errors: SNOW_STATUS_BAD_USAGE, SNOW_STATUS_NO_MEMORY. */

/* Counts of voxels and bytes, once the picture is made.  Errors:
 * SNOW_STATUS_NO_MEMORY. */
snow_status snow_exact_count(snow_exact *exact, const snow_job *job);

#endif
