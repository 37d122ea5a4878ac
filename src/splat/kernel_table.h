/* splat/kernel_table.h - a kernel's weights by phase: the weights of the voxels
 * around a point, for splatting in gather form (splat/gather.h).
 *
 *   i .. i + taps - 1   the voxels in reach of a point at grid position u
 *   i = floor(s), s = u + reach, and the phase is s - i, 0 to 1
 *
 *   phase 0      | w0 w1 w2 w3 |    a row of the table for each of `cells`
 *   phase 1/cells| w0 w1 w2 w3 |    phases and one beyond; weights in between
 *   ...          |             |    are linear
 *
 * If each weight is a single cubic of the phase (B-splines up to order 4 and
 * tents of even support, not widened), its coefficients are stored too, and
 * replace the table.
 *
 * The weights of a point are all terms of its sum over integer shifts, so they
 * are divided by their own sum (model, point 7). */
#ifndef SNOW_SPLAT_KERNEL_TABLE_H
#define SNOW_SPLAT_KERNEL_TABLE_H

#include "splat/kernel.h"

typedef struct snow_kernel_table {
    float *weights;     /* cells + 2 rows of `padded` floats */
    int taps;           /* voxels in reach at most */
    int padded;         /* taps rounded up to 4; the rest have weight 0 */
    int cells;          /* phases per voxel */
    double reach;       /* as above, voxels */
    bool cubic;         /* taps <= 4, and the cubics below are the weights */
    float cubics[4][4]; /* [voxel][power of the phase] */
    snow_scaled_kernel made_for;
} snow_kernel_table;

/* Returns whether a kernel can be tabulated like this: boxes jump, and a
 * kernel that reaches more than SNOW_PHASE_TAPS_MOST voxels would need a long
 * row for each phase. */
bool snow_kernel_table_serve(const snow_scaled_kernel *scaled_kernel);

/* Makes the table unless it is for this kernel already; its memory is reused.
 * The record begins as zeros. Errors: SNOW_STATUS_NO_MEMORY. */
snow_status snow_kernel_table_make(snow_context *context,
                                   const snow_scaled_kernel *scaled_kernel,
                                   snow_kernel_table *phases);
void snow_kernel_table_fini(snow_context *context, snow_kernel_table *phases);

#endif
