/* slabs.h - what is made of a volume that stays in its file (volume/stream.h)
 * slab by slab, each of which is rendered as a part of the volume: surfaces,
 * depths of over, and modes by the exact method.  Nothing of it is kept, so
 * that each picture reads the file. */
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

/* The pairs of a mode (modes.h) by footprints, added to those of frame->layer;
 * but for rounding the same as of the volume in memory. */
snow_status snow_slabs_pairs(snow_frame *frame, const struct snow_job *job);

#endif
