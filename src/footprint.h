/* footprint.h - the methods that throw footprints onto the image itself:
 * original, tested and footprint; figure 8 of the paper, lines 03 to 13. */
#ifndef SNOW_FOOTPRINT_H
#define SNOW_FOOTPRINT_H

#include "frame.h"

/* The buffers of the stages, kept from picture to picture: a second picture of
 * the same sizes takes no memory. */
typedef struct snow_exact snow_exact;

/* Errors: SNOW_NO_MEMORY. */
snow_status snow_exact_new(snow_context *context, snow_exact **out);
void snow_exact_free(snow_exact *exact);

/* Fills the local image of a job, and the seconds of its stages.  Errors:
 * SNOW_BAD_USAGE, SNOW_NO_MEMORY. */
snow_status snow_exact_render(snow_exact *exact, const snow_job *job);

/* Counts of voxels and bytes, once the picture is made.  Errors:
 * SNOW_NO_MEMORY. */
snow_status snow_exact_count(snow_exact *exact, const snow_job *job);

#endif
