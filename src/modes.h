/* modes.h - pictures other than over (model, point 8): mip, minip, mean, sum.
 *
 * They are over's pictures of another look.  A ramp is a transfer function
 * whose grey is the data value itself, carried from the volume's own range to 0
 * to 1, and whose opacity says which voxels there are:
 *
 *   every finite one  opacity 1: for the exact methods, whose sheets add up
 *                     weights beside weighted values
 *   those above 0     for the sheared method, which knows what the weights of
 *                     a whole grid add up to: a voxel of value 0 adds nothing
 *
 * so that classification, the three encodings and splatting serve as they are,
 * and a sheet's pixel is (weighted values, weights).  composite/reduce.h tells
 * how sheets become a local image of such pairs; here they become colours, or
 * values in data units. */
#ifndef SNOW_MODES_H
#define SNOW_MODES_H

#include "base/base.h"

#include <snowglass/render.h>

/* Kept for as long as volume and mode stay. */
typedef struct snow_ramp {
    uint64_t serial; /* of the volume; 0: of none */
    bool falls;      /* 1 is the smallest value: of minip */
    bool sparse;     /* voxels of 0 are left out */
    bool whole;      /* every voxel is finite */
    double low, high;
    snow_transfer *transfer;
} snow_ramp;

void snow_ramp_fini(snow_ramp *ramp);

struct snow_job;

/* A picture in a mode other than over; of lines 03 to 20 what differs.  As
 * snow_frame_render_slab, for a job that is begun. */
snow_status snow_modes_render(snow_frame *frame, struct snow_job *job,
                              snow_image **out);

#endif
