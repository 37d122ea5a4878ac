/* tests/reference/kernel.c - the reference's kernels and weights.
 *
 * Point 7 of the model. */
#include "reference/reference.h"

#include <math.h>

/* What counts as on an edge, in voxels. */
#define EDGE 1e-5

/* The B-spline of order K, which is K boxes of width 1 convolved, by
 * Schoenberg's (1946) sum of truncated powers: 1 / (K-1)!  sum over j of (-1)^j
 * (K over j) max(0, t + K/2 - j)^(K-1). */
static double bspline(int order, double t) {
    double sum = 0, over = 1, factorial = 1;
    if (!(fabs(t) < order / 2.0))
        return 0;
    for (int j = 0; j <= order; j++) {
        double x = t + order / 2.0 - j;
        if (x >= 0)
            sum += (j % 2 ? -over : over) * pow(x, order - 1);
        over = over * (order - j) / (j + 1);
    }
    for (int n = 2; n < order; n++)
        factorial *= n;
    return sum / factorial;
}

static bool inside(double half, double t) {
    return t >= -half - EDGE && t < half - EDGE;
}

double reference_kernel(snow_kernel kernel, int support, double w, double t) {
    double half = w * support / 2, sigma = w * support / 8;
    switch (kernel) {
    case SNOW_KERNEL_TENT:
        return fmax(0, 1 - fabs(t) / half);
    case SNOW_KERNEL_GAUSS:
        return inside(half, t) ? exp(-t * t / (2 * sigma * sigma)) : 0;
    case SNOW_KERNEL_BOX:
        return inside(half, t) ? 1 : 0;
    case SNOW_KERNEL_AUTO:
    case SNOW_KERNEL_BSPLINE:
        break;
    }
    return bspline(support, t / w);
}

int reference_support(const snow_settings *settings) {
    if (settings->footprint != 0)
        return settings->footprint;
    return settings->kernel == SNOW_KERNEL_TENT ||
                   settings->kernel == SNOW_KERNEL_BOX
               ? 2
               : 4;
}

/* Variances of convolved kernels add up; that of a box of width 1 is 1/12. */
static double variance(snow_kernel kernel, double support) {
    double box = 1.0 / 12;
    switch (kernel) {
    case SNOW_KERNEL_TENT: /* two boxes of half its support */
        return 2 * box * (support / 2) * (support / 2);
    case SNOW_KERNEL_GAUSS:
        return (support / 8) * (support / 8);
    case SNOW_KERNEL_BOX:
        return box * support * support;
    case SNOW_KERNEL_AUTO:
    case SNOW_KERNEL_BSPLINE:
        break;
    }
    return box * support;
}

double reference_widening(snow_kernel kernel, int support, double rho) {
    double more = fmax(0, rho * rho - 1);
    return sqrt(1 + more / (12 * variance(kernel, support)));
}

void reference_weights(snow_kernel kernel, int support, double w, double u,
                       int64_t count, double *weights, int64_t *first,
                       int64_t *last) {
    double reach = support * w / 2 + 1;
    int64_t lowest = (int64_t)floor(u - reach);
    int64_t highest = (int64_t)ceil(u + reach);
    *first = lowest > 0 ? lowest : 0;
    *last = highest < count - 1 ? highest : count - 1;
    if (*first > *last)
        return;
    double sum = 0;
    for (int64_t i = lowest; i <= highest; i++) {
        double b = reference_kernel(kernel, support, w, u - (double)i);
        sum += b;
        if (i >= 0 && i < count)
            weights[i] = b;
    }
    for (int64_t i = *first; i <= *last; i++)
        weights[i] /= sum;
}
