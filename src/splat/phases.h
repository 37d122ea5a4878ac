/* splat/phases.h - a kernel's weights by phase: what the voxels around a point
 * weigh there, for splatting in gather form (splat/gather.h).
 *
 *   i .. i + taps - 1   the voxels in reach of a point at grid position u
 *   i = floor(s), s = u + reach, and the phase is s - i, 0 to 1
 *
 *   phase 0      | w0 w1 w2 w3 |    a row of the table for each of `cells`
 *   phase 1/cells| w0 w1 w2 w3 |    phases and one beyond; weights in between
 *   ...          |             |    are linear
 *
 * Where each weight is one cubic of the phase (B-splines up to order 4 and
 * tents of even support, not widened) its coefficients are kept as well, and
 * serve without the table.
 *
 * The weights of a point are all that its sum over integer shifts consists of,
 * so they are divided by their own sum (model, point 7). */
#ifndef SNOW_PHASES_H
#define SNOW_PHASES_H

#include "splat/kernel.h"

typedef struct snow_phases {
    float *weights;     /* cells + 2 rows of `padded` floats */
    size_t capacity;    /* bytes */
    int taps;           /* voxels in reach at most */
    int padded;         /* taps rounded up to 4; the rest weighs 0 */
    int cells;          /* phases per voxel */
    double reach;       /* as above, voxels */
    bool cubic;         /* taps <= 4, and the cubics below are the weights */
    float cubics[4][4]; /* [voxel][power of the phase] */
    snow_taper made_for;
} snow_phases;

/* Whether a kernel can be tabulated so: boxes jump, and a kernel that reaches
 * more than SNOW_PHASE_TAPS_MOST voxels would need a long row for each phase.
 */
bool snow_phases_serve(const snow_taper *taper);

/* Makes the table unless it is made for this kernel already; the memory is
 * kept.  The record begins as zeros.  Errors: SNOW_NO_MEMORY. */
snow_status snow_phases_make(snow_context *context, const snow_taper *taper,
                             snow_phases *phases);
void snow_phases_fini(snow_context *context, snow_phases *phases);

#endif
