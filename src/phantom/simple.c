/* phantom/simple.c - three phantoms of plain geometry.
 *
 *   cube    the paper's Cube (section 5.2): 256x256x110, 98 % empty at every
 *           threshold.  Its beams frame a cube in the world (voxels are longer
 *           along z); a small block floats in it, off the centre.
 *   shells  thin concentric spheres, an octant cut away, and one small ball
 *           whose three coordinates differ, so that a picture that is mirrored
 *           or has swapped axes is recognised.
 *   marschner-lobb  the test signal of S. R. Marschner and R. J. Lobb, "An
 *           evaluation of reconstruction filters for volume rendering", IEEE
 *           Visualization 1994, equation 3: f_M = 6, alpha = 0.25, on -1..1. */
#include "phantom/phantom.h"

#include <math.h>

/* Half the cube's side, and half a beam's: chosen so that 2 % of the voxels
 * touch the solid. */
#define CUBE_HALF 104.0
#define BEAM_HALF 3.8

/* The frame at (x, y, z): near two of the three pairs of faces at once. */
static double frame_distance(double x, double y, double z) {
    double across[3] = {fabs(fabs(x) - CUBE_HALF), fabs(fabs(y) - CUBE_HALF),
                        fabs(fabs(z) - CUBE_HALF)};
    const double along[3] = {fabs(x), fabs(y), fabs(z)};
    double least = 1e9;
    for (int a = 0; a < 3; a++) {
        double p = across[(a + 1) % 3], q = across[(a + 2) % 3];
        double d = (p > q ? p : q) - BEAM_HALF;
        double beyond = along[a] - CUBE_HALF - BEAM_HALF;
        d = d > beyond ? d : beyond;
        least = least < d ? least : d;
    }
    return least;
}

static void cube_row(const snow_phantom_grid *grid, int64_t j, int64_t k,
                     void *out) {
    static const snow_solid block[] = {
        {SNOW_BOX, {30, 22, 14}, {24, 24, 24}, 0, 0, 0},
    };
    double y = snow_phantom_place(grid, 1, j);
    double z = snow_phantom_place(grid, 2, k);
    uint8_t *bytes = out;
    snow_shape_row row;
    snow_shape_row_begin(&row, block, 1, y, z);
    for (int64_t i = 0; i < grid->dims[0]; i++) {
        double x = snow_phantom_place(grid, 0, i), value = 0;
        snow_shape_paint(grid, &value, 160, snow_shape_distance(&row, x));
        snow_shape_paint(grid, &value, 255, frame_distance(x, y, z));
        bytes[i] = snow_phantom_byte(value);
    }
}

const snow_phantom snow_phantom_cube = {
    .name = "cube",
    .text = "the frame of a cube, 98 % empty, as in Table 1 of the paper",
    .dims = {256, 256, 110},
    .extent = {256, 256, 256},
    .type = SNOW_TYPE_UINT8,
    .row = cube_row,
};

static void shells_row(const snow_phantom_grid *grid, int64_t j, int64_t k,
                       void *out) {
    static const struct {
        double radius, value;
    } shells[] = {{24, 255}, {48, 200}, {72, 150}, {96, 100}, {118, 60}};
    double y = snow_phantom_place(grid, 1, j);
    double z = snow_phantom_place(grid, 2, k);
    uint8_t *bytes = out;
    for (int64_t i = 0; i < grid->dims[0]; i++) {
        double x = snow_phantom_place(grid, 0, i), value = 0;
        double radius = sqrt(x * x + y * y + z * z);
        double octant = x < y ? x : y;
        octant = octant < z ? octant : z;
        for (size_t n = 0; n < sizeof shells / sizeof *shells; n++) {
            double distance = fabs(radius - shells[n].radius) - 2.5;
            if (n > 0)
                distance = distance > octant ? distance : octant;
            if (distance < grid->edge)
                snow_shape_paint(grid, &value, shells[n].value, distance);
        }
        double bx = x + 104, by = y - 88, bz = z - 60;
        snow_shape_paint(grid, &value, 220,
                         sqrt(bx * bx + by * by + bz * bz) - 12);
        bytes[i] = snow_phantom_byte(value);
    }
}

const snow_phantom snow_phantom_shells = {
    .name = "shells",
    .text = "five thin spheres, an octant cut away, and a ball at -x +y +z",
    .dims = {128, 128, 128},
    .extent = {256, 256, 256},
    .type = SNOW_TYPE_UINT8,
    .row = shells_row,
};

/* Cosine of `turns` full turns: folded to a quarter, then its Taylor series to
 * t^22, whose next term is below 1e-18 there.  (Plain arithmetic, so that
 * every machine rounds alike: see phantom.h.) */
static double cosine(double turns) {
#define TERM(n) (1.0 / ((n) * ((n)-1.0)))
    static const double terms[] = {TERM(22), TERM(20), TERM(18), TERM(16),
                                   TERM(14), TERM(12), TERM(10), TERM(8),
                                   TERM(6),  TERM(4),  TERM(2)};
#undef TERM
    const double tau = 6.283185307179586;
    double fraction = turns - floor(turns), sign = 1;
    if (fraction > 0.5)
        fraction = 1 - fraction;
    if (fraction > 0.25) {
        fraction = 0.5 - fraction;
        sign = -1;
    }
    double square = fraction * tau * (fraction * tau), sum = 1;
    for (size_t n = 0; n < sizeof terms / sizeof *terms; n++)
        sum = 1 - square * terms[n] * sum;
    return sign * sum;
}

static void signal_row(const snow_phantom_grid *grid, int64_t j, int64_t k,
                       void *out) {
    const double alpha = 0.25, frequency = 6;
    double y = snow_phantom_place(grid, 1, j);
    double z = snow_phantom_place(grid, 2, k);
    double sine = cosine(z / 4 - 0.25); /* sin(pi z / 2) */
    float *values = out;
    for (int64_t i = 0; i < grid->dims[0]; i++) {
        double x = snow_phantom_place(grid, 0, i);
        double wave = cosine(sqrt(x * x + y * y) / 4);
        double ripple = cosine(frequency * wave);
        values[i] =
            (float)((1 - sine + alpha * (1 + ripple)) / (2 * (1 + alpha)));
    }
}

const snow_phantom snow_phantom_signal = {
    .name = "marschner-lobb",
    .text = "the test signal of Marschner and Lobb 1994, float32 0 to 1",
    .dims = {40, 40, 40},
    .extent = {2, 2, 2},
    .type = SNOW_TYPE_FLOAT32,
    .row = signal_row,
};
