/* phantom/phantom.h - what the built-in test volumes share: their sampling
 * grid, solids as signed distances, and noise.
 *
 * A phantom is a function of world position, so any number of voxels samples
 * the same shape.  Every machine must make the same bytes.  So shapes use only
 * + - * / and sqrt, which IEEE 754 rounds in one way, in an order that the
 * build keeps (no fused multiply-add).  sin, exp and others may differ in the
 * last bit between C libraries and are not used.  Noise is integer
 * arithmetic. */
#ifndef SNOW_PHANTOM_PHANTOM_H
#define SNOW_PHANTOM_PHANTOM_H

#include "volume/volume.h"

/* The positions of a phantom's voxels: voxel (i, j, k) at origin + step *
 * index. The middle of the voxel boxes is the origin of the world. */
typedef struct snow_phantom_grid {
    int64_t dims[3];
    double origin[3], step[3];
    double edge; /* width over which a surface changes from outside to inside:
                    about a voxel, so that it has a gradient */
    uint64_t seed;
} snow_phantom_grid;

/* A built-in volume.  `row` fills voxels (0.., j, k). */
typedef struct snow_phantom {
    const char *name;
    const char *text;
    int64_t dims[3];  /* default size */
    double extent[3]; /* world size of all voxel boxes */
    snow_type type;
    bool medical;
    void (*row)(const snow_phantom_grid *grid, int64_t j, int64_t k, void *out);
} snow_phantom;

extern const snow_phantom snow_phantom_cube;
extern const snow_phantom snow_phantom_head;
extern const snow_phantom snow_phantom_engine;
extern const snow_phantom snow_phantom_shells;
extern const snow_phantom snow_phantom_signal;
extern const snow_phantom snow_phantom_turbulence;

/* snow_volume_open_phantom, with the box of the options; if `out` is NULL it
 * fills only the info, whose matrix is that of the whole, as with
 * snow_format.read. */
snow_status snow_phantom_make(snow_context *context, const char *name,
                              const snow_volume_options *options, uint64_t seed,
                              snow_volume_info *info, snow_volume **out);

/* World coordinate of an index along an axis: one product and one sum, so that
 * all machines round alike. */
static inline double snow_phantom_place(const snow_phantom_grid *grid, int axis,
                                        int64_t index) {
    return grid->origin[axis] + grid->step[axis] * (double)index;
}

/* A value as uint8: to the nearest, halves up, clamped to 0 to 255. */
static inline uint8_t snow_phantom_byte(double value) {
    if (value <= 0)
        return 0;
    return value >= 255 ? 255 : (uint8_t)(value + 0.5);
}

/* --- solids --------------------------------------------------------------- */

typedef enum snow_solid_kind {
    SNOW_ELLIPSOID,  /* size: radii */
    SNOW_BOX,        /* size: half lengths of sides */
    SNOW_CYLINDER_X, /* size: radius, half length, - */
    SNOW_CYLINDER_Y,
    SNOW_CYLINDER_Z,
    SNOW_CAPSULE /* size: the other end; radius in `round` */
} snow_solid_kind;

/* One solid.  Solids of a shape are joined, or carved out, in their order. */
typedef struct snow_solid {
    snow_solid_kind kind;
    double at[3];
    double size[3];
    double round; /* radius of its edges */
    double blend; /* width of the fillet to the previous solids */
    unsigned how; /* 0, or of these: */
} snow_solid;

#define SNOW_CARVE 1u /* takes away instead of adding */
#define SNOW_TWIN 2u  /* mirrored at -x as well: must lie at x > 0 */

#define SNOW_SHAPE_MOST 48 /* most solids of a shape */

/* Distances are correct up to this far from a shape, and limited to it. */
#define SNOW_SHAPE_FAR 12.0

/* The solids that affect one row of voxels. */
typedef struct snow_shape_row {
    double y, z;
    double first, last; /* no solid is near at smaller or larger x */
    int count;
    struct {
        const snow_solid *solid;
        double first, last; /* of |x| for twins */
    } near[SNOW_SHAPE_MOST];
} snow_shape_row;

/* Selects the solids near the row at (y, z). */
void snow_shape_row_begin(snow_shape_row *row, const snow_solid *solids,
                          size_t count, double y, double z);

/* Signed distance from the shape's surface at x, negative inside, approximate
 * within SNOW_SHAPE_FAR of it. */
double snow_shape_distance(const snow_shape_row *row, double x);

/* Blends `value` over *under if `distance` is inside. */
void snow_shape_paint(const snow_phantom_grid *grid, double *under,
                      double value, double distance);

/* --- noise ---------------------------------------------------------------- */

/* 32 evenly distributed bits for position x of the row with that key. */
uint64_t snow_noise_key(uint64_t seed, int64_t y, int64_t z);
uint32_t snow_noise_bits(uint64_t key, int64_t x);

#define SNOW_NOISE_MOST 64 /* most lattice points across the extent */

/* Smooth noise over a lattice of `cell` world units, prepared for one row. */
typedef struct snow_noise_row {
    double cell;
    int64_t base; /* lattice index of column[0] */
    double column[SNOW_NOISE_MOST];
} snow_noise_row;

/* Prepares it for x in -half..half; half / cell < SNOW_NOISE_MOST / 2 - 2. */
void snow_noise_row_begin(snow_noise_row *row, uint64_t seed, double cell,
                          double half, double y, double z);

/* Noise at x: 0 to 1, mean 1/2. */
double snow_noise_at(const snow_noise_row *row, double x);

#endif
