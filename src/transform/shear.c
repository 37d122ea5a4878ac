/* transform/shear.c - the geometry of the intermediate image. */
#include "transform/shear.h"

#include <math.h>

/* The longest side of an intermediate image, pixels: far more than a view of
 * 32,768 pixels needs, which is at most about twice its size. */
#define LONGEST_SIDE (1 << 20)

/* The lattice of one axis: `voxels` long, seen in the range `seen` (voxels of
 * slice 0). */
static bool make_lattice(const snow_placement *p, int64_t voxels, double reach,
                         const double seen[2], snow_lattice *out) {
    double pitch = 1.0 / out->phases;
    double shift = (double)(p->slices - 1) * out->slope;
    double low = fmin(0, shift) - reach;
    double high = fmax(0, shift) + (double)voxels - 1 + reach;
    /* The warp reads two pixels beyond the pixel of its place. */
    double from = fmax(low, seen[0] - 3 * pitch) / pitch;
    double to = fmin(high, seen[1] + 3 * pitch) / pitch;
    if (!(from <= to)) {
        out->count = 0;
        return true;
    }
    double first = floor(from) - SNOW_SHEAR_BORDER;
    first = out->phases * floor(first / out->phases);
    double count = ceil(to) + SNOW_SHEAR_BORDER - first + 1;
    if (!(count <= LONGEST_SIDE) || !(fabs(first) < 1e15))
        return false;
    out->first = (int64_t)first;
    out->count = (int)count;
    return true;
}

snow_status snow_shear_make(snow_context *context, const snow_placement *p,
                            const int phases[2], double reach,
                            snow_shear *out) {
    const int64_t voxels[2] = {p->columns, p->rows};
    snow_shear shear = {0};
    snow_lattice *lattices[2] = {&shear.u, &shear.v};
    bool fits = true;
    for (int axis = 0; axis < 2; axis++) {
        const double *row = p->inverse[axis];
        snow_lattice *lattice = lattices[axis];
        lattice->phases = phases[axis];
        lattice->slope = row[0] * p->step_slice[0] + row[1] * p->step_slice[1];
        double zero = -row[0] * p->origin[0] - row[1] * p->origin[1];
        double seen[2];
        /* The minimum and maximum of a linear function c + a x + b y over the
         * corners of [0, width] x [0, height]. */
        seen[0] =
            zero + fmin(0, row[0] * p->width) + fmin(0, row[1] * p->height);
        seen[1] =
            zero + fmax(0, row[0] * p->width) + fmax(0, row[1] * p->height);
        fits = make_lattice(p, voxels[axis], reach, seen, lattice) && fits;
        double scale = lattice->phases;
        shear.along_x[axis] = scale * row[0];
        shear.along_y[axis] = scale * row[1];
        shear.start[axis] =
            scale * (zero + (row[0] + row[1]) / 2) - (double)lattice->first;
    }
    if (!fits)
        return snow_fail(
            context, SNOW_STATUS_BAD_USAGE,
            "the intermediate image is too large: the limit is 1048576 pixels "
            "a side; use the method footprint or a smaller zoom");
    *out = shear;
    return SNOW_STATUS_OK;
}
