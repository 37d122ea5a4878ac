/* tests/reference/kernel.c - the reference's kernels and weights.
 *
 * Point 7 of the model. */
#include "reference/reference.h"

#include <math.h>

/* What counts as on an edge, in voxels. */
#define EDGE 1e-5

#define LARGEST_SUPPORT 9

/* The B-spline of order K on the knots 0, 1, ..., K by the recursion of Cox
 * (1972) and de Boor (1972), at t + K/2. */
static double bspline(int order, double t) {
    double x = t + order / 2.0, n[LARGEST_SUPPORT + 1];
    for (int i = 0; i < order; i++)
        n[i] = x >= i && x < i + 1;
    for (int k = 2; k <= order; k++)
        for (int i = 0; i + k <= order; i++)
            n[i] = ((x - i) * n[i] + (i + k - x) * n[i + 1]) / (k - 1);
    return n[0];
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

static double variance(snow_kernel kernel, double support) {
    switch (kernel) {
    case SNOW_KERNEL_TENT:
        return support * support / 24;
    case SNOW_KERNEL_GAUSS:
        return support * support / 64;
    case SNOW_KERNEL_BOX:
        return support * support / 12;
    case SNOW_KERNEL_AUTO:
    case SNOW_KERNEL_BSPLINE:
        break;
    }
    return support / 12;
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
