/* phantom/shape.c - solids as signed distances, and lattice noise.
 *
 * Distances of boxes, cylinders and capsules are exact; that of an ellipsoid is
 * the usual first-order one, exact at the surface.  Fillets use the polynomial
 * smooth minimum.  A row of voxels first drops all solids that are too far away
 * to matter, so that a voxel evaluates only a few. */
#include "phantom/phantom.h"

#include <math.h>

/* Not fmax and fmin, which must handle NaN: none occurs here. */
static double larger(double a, double b) {
    return a > b ? a : b;
}

static double smaller(double a, double b) {
    return a < b ? a : b;
}

/* length (length - 1) / slope: the value of the implicit surface divided by its
 * gradient.  At the centre the gradient is 0, and the smallest half-axis is the
 * distance. */
static double ellipsoid(const double size[3], double x, double y, double z) {
    double qx = x / size[0], qy = y / size[1], qz = z / size[2];
    double rx = qx / size[0], ry = qy / size[1], rz = qz / size[2];
    double length = sqrt(qx * qx + qy * qy + qz * qz);
    double slope = sqrt(rx * rx + ry * ry + rz * rz);
    if (slope <= 0)
        return -smaller(size[0], smaller(size[1], size[2]));
    return length * (length - 1) / slope;
}

/* A box that is smaller by the rounding radius, then expanded by it; inside,
 * the nearest face gives a negative distance. */
static double box(const snow_solid *solid, double x, double y, double z) {
    double qx = fabs(x) - solid->size[0] + solid->round;
    double qy = fabs(y) - solid->size[1] + solid->round;
    double qz = fabs(z) - solid->size[2] + solid->round;
    double ox = larger(qx, 0), oy = larger(qy, 0), oz = larger(qz, 0);
    double inside = smaller(larger(qx, larger(qy, qz)), 0);
    return sqrt(ox * ox + oy * oy + oz * oz) + inside - solid->round;
}

/* `along` is measured on the axis, `a` and `b` across it. */
static double cylinder(const snow_solid *solid, double along, double a,
                       double b) {
    double across = sqrt(a * a + b * b) - solid->size[0] + solid->round;
    double beyond = fabs(along) - solid->size[1] + solid->round;
    double oa = larger(across, 0), ob = larger(beyond, 0);
    return sqrt(oa * oa + ob * ob) + smaller(larger(across, beyond), 0) -
           solid->round;
}

/* Distance to the nearest point of the segment, less the radius. */
static double capsule(const snow_solid *solid, double x, double y, double z) {
    double ex = solid->size[0] - solid->at[0];
    double ey = solid->size[1] - solid->at[1];
    double ez = solid->size[2] - solid->at[2];
    double t = (x * ex + y * ey + z * ez) / (ex * ex + ey * ey + ez * ez);
    t = smaller(larger(t, 0), 1);
    double dx = x - t * ex, dy = y - t * ey, dz = z - t * ez;
    return sqrt(dx * dx + dy * dy + dz * dz) - solid->round;
}

/* Converts world coordinates to those of the solid. */
static double solid_distance(const snow_solid *solid, double x, double y,
                             double z) {
    x -= solid->at[0], y -= solid->at[1], z -= solid->at[2];
    switch (solid->kind) {
    case SNOW_ELLIPSOID:
        return ellipsoid(solid->size, x, y, z);
    case SNOW_BOX:
        return box(solid, x, y, z);
    case SNOW_CYLINDER_X:
        return cylinder(solid, x, y, z);
    case SNOW_CYLINDER_Y:
        return cylinder(solid, y, x, z);
    case SNOW_CYLINDER_Z:
        return cylinder(solid, z, x, y);
    case SNOW_CAPSULE:
        return capsule(solid, x, y, z);
    }
    return SNOW_SHAPE_FAR;
}

/* The smallest and largest coordinate of a solid along an axis. */
static void solid_bounds(const snow_solid *solid, int axis, double *low,
                         double *high) {
    double at = solid->at[axis], reach = solid->size[axis];
    if (solid->kind == SNOW_CAPSULE) {
        *low = smaller(at, reach) - solid->round;
        *high = larger(at, reach) + solid->round;
        return;
    }
    if (solid->kind != SNOW_ELLIPSOID && solid->kind != SNOW_BOX)
        reach = solid->size[axis == (int)solid->kind - SNOW_CYLINDER_X];
    *low = at - reach;
    *high = at + reach;
}

/* A twin stands on both sides of x = 0, and its bounds are those of |x|. */
void snow_shape_row_begin(snow_shape_row *row, const snow_solid *solids,
                          size_t count, double y, double z) {
    *row = (snow_shape_row){.y = y, .z = z, .first = 1, .last = 0};
    for (size_t i = 0; i < count && row->count < SNOW_SHAPE_MOST; i++) {
        const snow_solid *solid = solids + i;
        double reach = SNOW_SHAPE_FAR + solid->blend, low, high;
        solid_bounds(solid, 1, &low, &high);
        /* The distance of a value from an interval; 0 within it. */
        double dy = larger(larger(low - y, y - high), 0);
        solid_bounds(solid, 2, &low, &high);
        /* The distance of a value from an interval; 0 within it. */
        double dz = larger(larger(low - z, z - high), 0);
        if (dy * dy + dz * dz > reach * reach)
            continue;
        solid_bounds(solid, 0, &low, &high);
        low -= reach, high += reach;
        row->near[row->count].solid = solid;
        row->near[row->count].first = low;
        row->near[row->count].last = high;
        double mirrored = solid->how & SNOW_TWIN ? -high : low;
        row->first = row->count ? smaller(row->first, mirrored) : mirrored;
        row->last = row->count ? larger(row->last, high) : high;
        row->count++;
    }
}

/* The smaller of two distances, with a fillet of `width`. */
static double join(double a, double b, double width) {
    double least = smaller(a, b), gap = fabs(a - b);
    if (gap >= width)
        return least;
    double h = (width - gap) / width;
    return least - h * h * width * 0.25;
}

/* A solid that carves joins the outside: the complement has the negative
 * distance. */
double snow_shape_distance(const snow_shape_row *row, double x) {
    double distance = SNOW_SHAPE_FAR;
    if (x < row->first || x > row->last)
        return distance;
    for (int i = 0; i < row->count; i++) {
        const snow_solid *solid = row->near[i].solid;
        double at = solid->how & SNOW_TWIN ? fabs(x) : x;
        if (at < row->near[i].first || at > row->near[i].last)
            continue;
        double d = solid_distance(solid, at, row->y, row->z);
        distance = solid->how & SNOW_CARVE ? -join(-distance, d, solid->blend)
                                           : join(distance, d, solid->blend);
    }
    return distance;
}

/* Linear across the edge: approximately the share of a voxel cut by a plane. */
void snow_shape_paint(const snow_phantom_grid *grid, double *under,
                      double value, double distance) {
    double share = smaller(larger(0.5 - distance / grid->edge, 0), 1);
    *under += (value - *under) * share;
}

/* The finaliser of SplitMix64 (Steele, Lea, Flood 2014): each input bit
 * reaches all output bits. */
static uint64_t scramble(uint64_t key) {
    key = (key ^ key >> 30) * UINT64_C(0xBF58476D1CE4E5B9);
    key = (key ^ key >> 27) * UINT64_C(0x94D049BB133111EB);
    return key ^ key >> 31;
}

/* Depends on position and seed alone, so rows can be made in any order. */
uint64_t snow_noise_key(uint64_t seed, int64_t y, int64_t z) {
    uint64_t key = scramble(seed * UINT64_C(0x9E3779B97F4A7C15) + (uint64_t)z);
    return scramble(key + (uint64_t)y);
}

uint32_t snow_noise_bits(uint64_t key, int64_t x) {
    return (uint32_t)(scramble(key + (uint64_t)x) >> 32);
}

/* Slope 0 at both ends: lattice cells meet without a crease. */
static double ease(double t) {
    return t * t * (3 - 2 * t);
}

/* y and z are constant along a row: of the eight corners of a cell only two
 * columns remain to be interpolated at each voxel. */
void snow_noise_row_begin(snow_noise_row *row, uint64_t seed, double cell,
                          double half, double y, double z) {
    double v = floor(y / cell), w = floor(z / cell);
    double ty = ease(y / cell - v), tz = ease(z / cell - w);
    int64_t j = (int64_t)v, k = (int64_t)w;
    row->cell = cell;
    row->base = (int64_t)floor(-half / cell);
    uint64_t keys[4];
    for (int n = 0; n < 4; n++)
        keys[n] = snow_noise_key(seed, j + n % 2, k + n / 2);
    for (int i = 0; i < SNOW_NOISE_MOST; i++) {
        double corner[4];
        for (int n = 0; n < 4; n++)
            corner[n] = snow_noise_bits(keys[n], row->base + i) * 0x1p-32;
        double low = corner[0] + (corner[1] - corner[0]) * ty;
        double high = corner[2] + (corner[3] - corner[2]) * ty;
        row->column[i] = low + (high - low) * tz;
    }
}

/* The lattice point before x, and the share of the way to the next. */
double snow_noise_at(const snow_noise_row *row, double x) {
    double u = x / row->cell, whole = floor(u);
    int64_t i = (int64_t)whole - row->base;
    double t = ease(u - whole);
    return row->column[i] + (row->column[i + 1] - row->column[i]) * t;
}
