/* classify/shading/normals.h - normals of 16 bits, and the shading table of a
 * view.
 *
 * Shading turns a normal to the viewer, so n and -n are the same normal, and
 * half a sphere is enough.  It is unfolded onto a square (an octahedron's upper
 * half: Meyer et al. 2010, Cigolle et al. 2014) of 255 x 255 places; one more
 * code stands for no gradient.  A stored normal is off by at most
 * SNOW_NORMAL_ERROR degrees, by 0.24 in the mean.
 *
 * A normal that is nearly perpendicular to the line of sight may be turned to
 * the viewer on the other side than the exact one.  With a head light this
 * changes rounding only; with a light from the side such a voxel, on the
 * object's outline, may be lit instead of dark. */
#ifndef SNOW_CLASSIFY_SHADING_NORMALS_H
#define SNOW_CLASSIFY_SHADING_NORMALS_H

#include "classify/classify.h"
#include "simd/isa.h"

#define SNOW_NORMALS 65536
#define SNOW_NORMAL_SIDE 255
#define SNOW_NO_NORMAL 0       /* the code of a voxel without a gradient */
#define SNOW_NORMAL_ERROR 0.56 /* degrees */

/* The effect of a normal on a colour c: min(1, c * factor + white). Both are
 * from 0 to 2, in steps of 1 / SNOW_GLOSS_ONE, a 128th of an 8-bit step; the
 * factor is the lower half. Floats would double the table's size, and voxels
 * wait for its memory. */
typedef uint32_t snow_gloss;
#define SNOW_GLOSS_ONE 32767.0f

/* The code of a direction (not 0, any length), and the unit vector that a code
 * stands for (one of the two). */
uint16_t snow_normal_code(const double direction[3]);
void snow_normal_of(uint16_t code, double normal[3]);

/* How a volume's index gradients are transformed to world space, for encoding.
 */
typedef struct snow_normal_maker {
    const snow_volume *volume;
    double carry[3][3]; /* inverse transpose of the matrix' linear part; its
                           largest entry is 1: only directions count */
    bool skewed;        /* beyond single precision */
    snow_isa isa;       /* resolved; all instruction sets give the same bits */
} snow_normal_maker;

/* Errors: SNOW_STATUS_BAD_USAGE (a singular matrix). */
snow_status snow_normal_maker_init(snow_context *context,
                                   const snow_volume *volume,
                                   snow_normal_maker *out);

/* Normals of the voxels of one row (model, point 4: central differences of
 * native values, one-sided at borders and beside values that are not finite).
 * The row is that of `placement`'s slice, or lies half-way `between` it and the
 * next, for the mean of their gradients; `columns` are rising. */
void snow_normals_of_row(const snow_normal_maker *maker,
                         const snow_placement *placement, int64_t slice,
                         int64_t row, bool between, const uint32_t *columns,
                         size_t count, uint16_t *normals);

/* The shading table of a view and light (model, point 4): SNOW_NORMALS entries
 * into `table`.  `threads` as in base/thread_pool.h. */
snow_status snow_gloss_table(snow_context *context,
                             const snow_settings *settings,
                             const snow_placement *placement, int threads,
                             snow_gloss *table);

#endif
