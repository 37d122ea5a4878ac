/* splat/kernel.c - the kernels of splat/kernel.h in double precision, and their
 * tables. */
#include "splat/kernel.h"

#include <math.h>
#include <string.h>

#define EDGE 1e-5 /* distances to an edge that count as 0, voxels */
#define CELLS_PER_VOXEL 256
#define CELLS_PER_VOXEL_KINKED 1024 /* supports of 2: see below */
#define MARGIN_CELLS 2              /* empty cells on either side of a table */

/* The most cells on either side of a table's middle. A kernel wide enough to
 * need more is smooth at this pitch, and positions in the table stay far below
 * 2^24, where a float would miss a cell. */
#define HALF_CELLS_MOST 32768

/* From this width on the integral replaces the sum over all integer shifts. By
 * Poisson's formula they differ by 2 / (pi w)^2 of it for the linear B-spline,
 * 5e-5, and by less for the others. The sum itself would cost w K terms. */
#define WIDE_ENOUGH 64

/* The centred B-spline of order K (degree K - 1), by de Boor's recursion over
 * the K+1 knots -K/2 .. K/2. */
static double bspline(int order, double t) {
    double x = t + order / 2.0; /* knots at 0 .. K */
    double basis[SNOW_FOOTPRINT_MOST];
    for (int i = 0; i < order; i++)
        basis[i] = x >= i && x < i + 1 ? 1 : 0;
    for (int k = 2; k <= order; k++)
        for (int i = 0; i + k <= order; i++)
            basis[i] =
                ((x - i) * basis[i] + (i + k - x) * basis[i + 1]) / (k - 1);
    return basis[0];
}

static double tent(int support, double t) {
    return fmax(0, 1 - 2 * fabs(t) / support);
}

static double gauss(int support, double t) {
    double sigma = support / 8.0;
    return exp(-t * t / (2 * sigma * sigma));
}

static double box(int support, double t) {
    (void)support;
    (void)t;
    return 1;
}

/* Integrals over the support. */
static double bspline_area(int order) {
    (void)order;
    return 1;
}

static double tent_area(int support) {
    return support / 2.0;
}

static double gauss_area(int support) {
    const double root = 2.5066282746310005024;    /* sqrt(2 pi) */
    return root * support / 8 * erf(4 / sqrt(2)); /* cut at 4 sigma */
}

static const struct kernel_entry {
    const char *name;
    double (*value)(int support, double t); /* inside the support */
    double (*area)(int support);            /* NULL: weights in closed form */
    int default_support;
} kernels[] = {
    [SNOW_KERNEL_AUTO] = {"auto", bspline, bspline_area, 4},
    [SNOW_KERNEL_BSPLINE] = {"bspline", bspline, bspline_area, 4},
    [SNOW_KERNEL_TENT] = {"tent", tent, tent_area, 2},
    [SNOW_KERNEL_GAUSS] = {"gauss", gauss, gauss_area, 4},
    [SNOW_KERNEL_BOX] = {"box", box, NULL, 2},
};

#define KERNEL_COUNT (int)(sizeof kernels / sizeof kernels[0])

const char *snow_kernel_name(snow_kernel kernel) {
    const int value = (int)kernel;
    return value >= 0 && value < KERNEL_COUNT ? kernels[value].name : NULL;
}

int snow_kernel_from_name(const char *name) {
    for (int i = 0; i < KERNEL_COUNT; i++)
        if (snow_same_name(name, kernels[i].name))
            return i;
    return -1;
}

int snow_kernel_default_support(snow_kernel kernel) {
    return kernels[kernel].default_support;
}

static double variance_of(snow_kernel kernel, double support) {
    switch (kernel) {
    case SNOW_KERNEL_TENT:
        return support * support / 24;
    case SNOW_KERNEL_GAUSS:
        return support * support / 64;
    case SNOW_KERNEL_BOX:
        return support * support / 12;
    default:
        return support / 12;
    }
}

snow_scaled_kernel snow_scaled_kernel_make(snow_kernel kernel, int support,
                                           double rho) {
    double pixel = (rho * rho - 1) / (12 * variance_of(kernel, support));
    double wide = sqrt(1 + fmax(0, pixel));
    return (snow_scaled_kernel){kernel, support, wide * support / 2, wide};
}

bool snow_scaled_kernel_covers(const snow_scaled_kernel *scaled_kernel,
                               double t) {
    return t >= -scaled_kernel->half - EDGE && t < scaled_kernel->half - EDGE;
}

double snow_scaled_kernel_reach(const snow_scaled_kernel *scaled_kernel) {
    return scaled_kernel->half + 2 * EDGE;
}

/* b(t / w); 0 outside the support. */
static double value_at(const snow_scaled_kernel *scaled_kernel, double t) {
    if (!snow_scaled_kernel_covers(scaled_kernel, t))
        return 0;
    return kernels[scaled_kernel->kernel].value(scaled_kernel->support,
                                                t / scaled_kernel->wide);
}

double snow_scaled_kernel_weight(const snow_scaled_kernel *scaled_kernel,
                                 double t) {
    double value = value_at(scaled_kernel, t), sum = 0;
    if (value <= 0)
        return 0;
    if (scaled_kernel->kernel == SNOW_KERNEL_BOX)
        return snow_scaled_kernel_box(scaled_kernel, t);
    if (scaled_kernel->wide >= WIDE_ENOUGH)
        return value /
               (scaled_kernel->wide *
                kernels[scaled_kernel->kernel].area(scaled_kernel->support));
    double first = ceil(-scaled_kernel->half - EDGE - t);
    for (double n = first; t + n < scaled_kernel->half - EDGE; n++)
        sum += value_at(scaled_kernel, t + n);
    return value / sum;
}

float snow_scaled_kernel_box(const snow_scaled_kernel *scaled_kernel,
                             double t) {
    double from_left = t + scaled_kernel->half + EDGE,
           width = 2 * scaled_kernel->half;
    if (from_left < 0 || from_left >= width)
        return 0;
    /* Shifted copies of the point begin at its fraction and end at width. */
    double fraction = from_left - floor(from_left);
    return (float)(1 / ceil(width - fraction));
}

snow_status
snow_scaled_kernel_table_make(snow_context *context,
                              const snow_scaled_kernel *scaled_kernel,
                              snow_scaled_kernel_table *out) {
    const snow_scaled_kernel *made = &out->made_for;
    if (out->cells && scaled_kernel->kernel == made->kernel &&
        scaled_kernel->support == made->support &&
        scaled_kernel->half == made->half && scaled_kernel->wide == made->wide)
        return SNOW_STATUS_OK;
    /* A wide kernel is smooth: fewer cells per voxel suffice. A widened one of
     * support 2 has steep kinks within cells, where the number of voxels in
     * reach changes. */
    int most =
        scaled_kernel->support == 2 ? CELLS_PER_VOXEL_KINKED : CELLS_PER_VOXEL;
    double fine = fmax(most / scaled_kernel->wide, 4);
    size_t cells =
        2 * (size_t)fmin(ceil(scaled_kernel->half * fine), HALF_CELLS_MOST);
    double scale = (double)cells / (2 * scaled_kernel->half);
    size_t all = cells + 2 * MARGIN_CELLS;
    SNOW_TRY(SNOW_RESERVE(context, out->cells, 0, all));
    snow_scaled_kernel_cell *table = out->cells;
    memset(table, 0, all * sizeof *table);
    /* A little inside the ends, where a half-open kernel is not 0. */
    double inside = scaled_kernel->half - 2 * EDGE, weight = 0;
    for (size_t c = 0; c <= cells; c++) {
        double t = (double)c / scale - scaled_kernel->half;
        double next = snow_scaled_kernel_weight(scaled_kernel,
                                                fmin(fmax(t, -inside), inside));
        if (c > 0)
            table[MARGIN_CELLS + c - 1] = (snow_scaled_kernel_cell){
                (float)weight, (float)(next - weight)};
        weight = next;
    }
    out->shift = (float)(scaled_kernel->half + MARGIN_CELLS / scale);
    out->scale = (float)scale;
    out->made_for = *scaled_kernel;
    return SNOW_STATUS_OK;
}
