/* splat/kernel.h - reconstruction kernels along one grid axis (model, point 7).
 *
 * A kernel b has a support of K voxels.  Where a pixel is wider than a voxel
 * it is widened by a factor w (anti-aliasing after Swan et al. 1997):
 *
 *   w = sqrt(1 + max(0, rho^2 - 1) / (12 V))
 *
 * with V the kernel's variance and rho the pixel's extent along the axis in
 * voxels.  The weight of a voxel at distance t is b(t / w), divided by its sum
 * over all integer shifts of t: weights add up to 1 anywhere inside.
 *
 *   name     b(t), |t| <= K/2             V        default K
 *   bspline  B-spline of order K          K / 12   4 (cubic)
 *   tent     1 - 2 |t| / K                K^2/24   2
 *   gauss    exp(-t^2 / 2 s^2), s = K/8   K^2/64   4
 *   box      1                            K^2/12   2
 *
 * The support is half open: distances within 1e-5 of an edge count as on it,
 * so that rounding does not decide at grid-aligned views. */
#ifndef SNOW_KERNEL_H
#define SNOW_KERNEL_H

#include "base/base.h"

#include <snowglass/render.h>

#define SNOW_FOOTPRINT_MOST 9

/* Most voxels in reach along an axis that weights by phase are made for. */
#define SNOW_PHASE_TAPS_MOST 64

/* A kernel of one view and grid axis. */
typedef struct snow_taper {
    snow_kernel kernel;
    int support; /* K, voxels */
    double half; /* w K / 2: half the widened support, voxels */
    double wide; /* w */
} snow_taper;

/* The support that a kernel has when none is asked for. */
int snow_kernel_default_support(snow_kernel kernel);

/* A kernel for pixels that are `rho` voxels wide along the axis. */
snow_taper snow_taper_make(snow_kernel kernel, int support, double rho);

/* The same for voxels that are means of others (levels.h), whose step is `fine`
 * of theirs, 1 or less.  The variance of a mean and of its kernel together is
 * that of the kernel on the others, if it can be:
 *
 *   w = sqrt(max(1, fine^2 + (rho^2 - 1) / (12 V)))
 */
snow_taper snow_taper_make_level(snow_kernel kernel, int support, double rho,
                                 double fine);

/* Whether distance t (voxels) lies in the half-open support, and a distance
 * beyond which none does. */
bool snow_taper_covers(const snow_taper *taper, double t);
double snow_taper_reach(const snow_taper *taper);

/* The weight of a voxel at distance t, in double: the definition. */
double snow_taper_weight(const snow_taper *taper, double t);

/* In gather form: the voxels in reach of a point at grid position u are i to
 * i + taps - 1 with i = floor(s), s = u + reach; its phase is s - i.  How many
 * voxels are in reach at most, `reach`, and their weights at a phase of 0 to 1
 * (not for the box, nor above SNOW_PHASE_TAPS_MOST voxels). */
int snow_taper_taps(const snow_taper *taper);
double snow_taper_phase_reach(const snow_taper *taper);
void snow_taper_phase(const snow_taper *taper, double phase, double *weights);

/* Weights of the voxels at first, first + 1 ... for a point at `t`, all in one:
 * what snow_taper_weight gives, but for rounding.  None but these may be in
 * reach; there are SNOW_PHASE_TAPS_MOST at most. */
void snow_taper_spread(const snow_taper *taper, double t, int first, int count,
                       float *weights);

/* The weight as a table: cell c spans the distances from c / scale - shift and
 * holds the weight at its beginning and the rise to its end.  Smooth kernels
 * are met to about 1e-5 of their peak, and kinks at 0 and at the ends fall
 * between cells.  Where a widened tent or cut Gauss gains or loses a voxel in
 * reach its weight has a kink or small jump within a cell: 4e-4 at most.  Not
 * for the box, which jumps. */
typedef struct snow_taper_cell {
    float weight, rise;
} snow_taper_cell;

typedef struct snow_taper_table {
    snow_taper_cell *cells;
    float shift;     /* half the support and a margin of empty cells, voxels */
    float scale;     /* cells per voxel */
    size_t capacity; /* of cells, bytes */
    snow_taper made_for;
} snow_taper_table;

/* Whether two tapers are one. */
bool snow_taper_same(const snow_taper *a, const snow_taper *b);

/* Makes the table unless it is made for this kernel already; the record begins
 * as zeros.  Errors: SNOW_NO_MEMORY.  Free with snow_release(context,
 * table->cells). */
snow_status snow_taper_table_make(snow_context *context,
                                  const snow_taper *taper,
                                  snow_taper_table *table);

/* The weight at t by the table; |t| may pass the support by a few EDGE. */
static inline float snow_taper_look_up(const snow_taper_table *table, float t) {
    float place = (t + table->shift) * table->scale;
    int cell = (int)place;
    snow_taper_cell c = table->cells[cell];
    return c.weight + (place - (float)cell) * c.rise;
}

/* The weight of a box in closed form: one over the number of voxels whose
 * support holds the point. */
float snow_taper_box(const snow_taper *taper, double t);

#endif
