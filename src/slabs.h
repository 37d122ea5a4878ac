/* slabs.h - what is made of a volume that stays in its file (volume/stream.h)
 * slab by slab, each of which is rendered as a part of the volume: surfaces,
 * depths of over, and the pictures of the exact methods.  Nothing of it is
 * kept, so that each picture reads the file. */
#ifndef SNOW_SLABS_H
#define SNOW_SLABS_H

#include "base/base.h"

#include <snowglass/render.h>

struct snow_job;

/* As snow_iso_render, with the same bits as of the volume in memory. */
snow_status snow_slabs_iso(snow_frame *frame, struct snow_job *job,
                           snow_image **out);

/* As snow_depth_over; but for rounding the same as of the volume in memory. */
snow_status snow_slabs_depth(snow_frame *frame, const struct snow_job *job);

/* As snow_job_render_exact, on top of what job->pixels hold; but for rounding
 * the same as of the volume in memory.  Errors: those of it, and
 * SNOW_NO_MEMORY where the picture is to be deterministic. */
snow_status snow_slabs_exact(snow_frame *frame, const struct snow_job *job);

#endif
