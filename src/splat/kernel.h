/* splat/kernel.h - reconstruction kernels along one grid axis (model, section
 * 7).
 *
 * A kernel b has a support of K voxels.  If a pixel is wider than a voxel, the
 * kernel is widened by a factor w (anti-aliasing after Swan et al. 1997):
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
 * The support is half open: distances within 1e-5 of an edge count as on it, so
 * that rounding has no effect in grid-aligned views. */
#ifndef SNOW_KERNEL_H
#define SNOW_KERNEL_H

#include "base/base.h"

#include <snowglass/render.h>

#define SNOW_FOOTPRINT_MOST 9

/* A kernel of one view and grid axis. */
typedef struct snow_scaled_kernel {
    snow_kernel kernel;
    int support; /* K, voxels */
    double half; /* w K / 2: half the widened support, voxels */
    double wide; /* w */
} snow_scaled_kernel;

/* The default support of a kernel. */
int snow_kernel_default_support(snow_kernel kernel);

/* A kernel for pixels that are `rho` voxels wide along the axis: wider by w =
 * sqrt(1 + max(0, rho^2 - 1) / (12 V)), V being its variance. */
snow_scaled_kernel snow_scaled_kernel_make(snow_kernel kernel, int support,
                                           double rho);

/* Returns whether distance t (voxels) is within the half-open support, and a
 * distance beyond which none is. */
bool snow_scaled_kernel_covers(const snow_scaled_kernel *scaled_kernel,
                               double t);
double snow_scaled_kernel_reach(const snow_scaled_kernel *scaled_kernel);

/* The weight of a voxel at distance t, in double precision: the definition. */
double snow_scaled_kernel_weight(const snow_scaled_kernel *scaled_kernel,
                                 double t);

/* The weight as a table: cell c spans the distances from c / scale - shift and
 * holds the weight at its beginning and the rise to its end. Smooth kernels are
 * accurate to about 1e-5 of their peak, and kinks at 0 and at the ends fall
 * between cells. Where a widened tent or cut Gauss gains or loses a voxel in
 * reach its weight has a kink or small jump within a cell: 4e-4 at most. Not
 * for the box, which jumps. */
typedef struct snow_scaled_kernel_cell {
    float weight, rise;
} snow_scaled_kernel_cell;

typedef struct snow_scaled_kernel_table {
    snow_scaled_kernel_cell *cells;
    float shift; /* half the support and a margin of empty cells, voxels */
    float scale; /* cells per voxel */
    snow_scaled_kernel made_for;
} snow_scaled_kernel_table;

/* Makes the table unless it is for this kernel already; the record begins as
 * zeros. Errors: SNOW_STATUS_NO_MEMORY. Free with snow_release(context,
 * table->cells).
 */
snow_status
snow_scaled_kernel_table_make(snow_context *context,
                              const snow_scaled_kernel *scaled_kernel,
                              snow_scaled_kernel_table *table);

/* The weight at distance t, from the table; |t| may exceed the support by a few
 * EDGE. */
static inline float
snow_scaled_kernel_look_up(const snow_scaled_kernel_table *table, float t) {
    float place = (t + table->shift) * table->scale;
    int cell = (int)place;
    snow_scaled_kernel_cell c = table->cells[cell];
    return c.weight + (place - (float)cell) * c.rise;
}

/* The weight of a box in closed form: the reciprocal of the number of voxels
 * whose support contains the point. */
float snow_scaled_kernel_box(const snow_scaled_kernel *scaled_kernel, double t);

#endif
