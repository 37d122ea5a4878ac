/* render/modes/modes.h - pictures other than over (model, sections 9 and V10):
 * mip, minip, mean, sum.
 *
 * They are over's pictures of another look.  The identity transfer function is
 * one whose grey is the data value itself, carried from the volume's own range
 * to 0 to 1, and whose opacity is 1 for every finite voxel, so that
 * classification, the three encodings and splatting serve as they are, and a
 * sheet's pixel is (weighted values, weights).  composite/over.h has how sheets
 * become a local image of such pairs; here they become colours or data values.
 */
#ifndef SNOW_RENDER_MODES_MODES_H
#define SNOW_RENDER_MODES_MODES_H

#include "base/base.h"

#include <snowglass/render.h>
#include <stdbool.h>

/* Kept for as long as volume and mode stay. */
typedef struct snow_identity_transfer {
    uint64_t generation; /* of the volume; 0: of none */
    struct snow_identity_kind {
        bool inverted; /* 1 is the smallest value: of minip */
        bool steps;    /* voxels below `least` are left out: of iso */
        double least;
    } kind;
    bool whole; /* every voxel is finite */
    bool empty; /* none is */
    double low, high;
    snow_transfer *transfer;
} snow_identity_transfer;

/* Colours of values from one end of a range to the other. */
#define SNOW_MODE_COLORS 256
typedef struct snow_mode_colors {
    double from, range;
    float rgb[SNOW_MODE_COLORS + 1][3];
    bool nonlinear[SNOW_MODE_COLORS]; /* a control point is near: look there */
} snow_mode_colors;

void snow_identity_transfer_fini(snow_identity_transfer *identity);

struct snow_job;

/* Finds the range of a job's volume, unless that is known. */
snow_status snow_identity_transfer_measure(struct snow_job *job,
                                           snow_identity_transfer *identity);

/* Makes it that of a whole that the job's volume is a part of.  Errors:
 * SNOW_STATUS_BAD_INPUT (a range beyond that of float). */
snow_status snow_identity_transfer_widen(snow_context *context,
                                         snow_identity_transfer *identity,
                                         double low, double high, bool whole);

/* For mode iso, when it is measured: the voxels not below its value. */
snow_status snow_identity_transfer_above(struct snow_job *job,
                                         snow_identity_transfer *identity);

/* The job whose local image are the pairs of a picture, when the range is
 * measured.  It lasts as long as the frame's identity transfer function. */
snow_status snow_modes_value_weight(snow_frame *frame, struct snow_job *job,
                                    struct snow_job *pairs);

/* A picture of the pairs of all pixels. */
snow_status snow_modes_paint(snow_frame *frame, const struct snow_job *job,
                             float *pairs, snow_image **out);

#endif
