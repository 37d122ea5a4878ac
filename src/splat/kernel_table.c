/* splat/kernel_table.c - weights by phase; see splat/kernel_table.h. */
#include "splat/kernel_table.h"

#include <math.h>
#include <string.h>

/* Phases per voxel. The second derivative of a cubic B-spline is at most 2 per
 * voxel squared, so linear steps of 1/1024 are off by 2.4e-7. That of a kernel
 * widened by w is w^2 times less, but it keeps the kinks where a voxel comes
 * into reach, as in snow_scaled_kernel_table_make. */
#define CELLS_MOST 1024
#define CELLS_LEAST 16

/* The largest error of a cubic. Counting a point within 1e-5 of an edge as on
 * it changes a tent by as much. */
#define CUBIC_ERROR 2e-5

bool snow_kernel_table_serve(const snow_scaled_kernel *scaled_kernel) {
    return scaled_kernel->kernel != SNOW_KERNEL_BOX &&
           snow_scaled_kernel_taps(scaled_kernel) <= SNOW_PHASE_TAPS_MOST;
}

/* The cubic through values at phases 1/8, 3/8, 5/8 and 7/8 (Lagrange). */
static void cubic_through(const double value[4], float powers[4]) {
    static const double lagrange[4][4] = {
        {35 / 16.0, -35 / 16.0, 21 / 16.0, -5 / 16.0},
        {-71 / 6.0, 47 / 2.0, -31 / 2.0, 23 / 6.0},
        {20, -52, 44, -12},
        {-32 / 3.0, 32, -32, 32 / 3.0},
    };
    for (int n = 0; n < 4; n++)
        powers[n] =
            (float)(lagrange[n][0] * value[0] + lagrange[n][1] * value[1] +
                    lagrange[n][2] * value[2] + lagrange[n][3] * value[3]);
}

static double cubic_at(const float powers[4], double phase) {
    double sum = 0;
    for (int n = 3; n >= 0; n--)
        sum = sum * phase + (double)powers[n];
    return sum;
}

/* Finds the cubics; false if they do not equal the weights. */
static bool fit_cubics(const snow_scaled_kernel *scaled_kernel,
                       float cubics[4][4]) {
    double weights[4][4]; /* [phase][voxel] */
    int taps = snow_scaled_kernel_taps(scaled_kernel);
    if (taps > 4)
        return false;
    memset(weights, 0, sizeof weights);
    for (int n = 0; n < 4; n++)
        snow_scaled_kernel_phase(scaled_kernel, (2 * n + 1) / 8.0, weights[n]);
    for (int tap = 0; tap < 4; tap++)
        cubic_through((double[]){weights[0][tap], weights[1][tap],
                                 weights[2][tap], weights[3][tap]},
                      cubics[tap]);
    for (int n = 0; n <= 64; n++) {
        snow_scaled_kernel_phase(scaled_kernel, n / 64.0, weights[0]);
        for (int tap = 0; tap < taps; tap++)
            if (!(fabs(cubic_at(cubics[tap], n / 64.0) - weights[0][tap]) <
                  CUBIC_ERROR))
                return false;
    }
    return true;
}

snow_status snow_kernel_table_make(snow_context *context,
                                   const snow_scaled_kernel *scaled_kernel,
                                   snow_kernel_table *phases) {
    if (phases->weights &&
        snow_scaled_kernel_same(scaled_kernel, &phases->made_for))
        return SNOW_STATUS_OK;
    int taps = snow_scaled_kernel_taps(scaled_kernel),
        padded = (taps + 3) / 4 * 4;
    int cells = (int)fmax(CELLS_MOST / scaled_kernel->wide, CELLS_LEAST);
    size_t row = (size_t)padded, rows = (size_t)cells + 2;
    SNOW_TRY(SNOW_RESERVE(context, phases->weights, 0, rows * row));
    memset(phases->weights, 0, rows * row * sizeof *phases->weights);
    /* Two rows at the end: phase 1, and one that is read with weight 0 when a
     * phase just below 1 is rounded up. */
    for (size_t n = 0; n < rows; n++) {
        double weights[SNOW_PHASE_TAPS_MOST];
        snow_scaled_kernel_phase(scaled_kernel, fmin((double)n / cells, 1),
                                 weights);
        for (int tap = 0; tap < taps; tap++)
            phases->weights[n * row + (size_t)tap] = (float)weights[tap];
    }
    phases->taps = taps;
    phases->padded = padded;
    phases->cells = cells;
    phases->reach = snow_scaled_kernel_phase_reach(scaled_kernel);
    phases->cubic = fit_cubics(scaled_kernel, phases->cubics);
    phases->made_for = *scaled_kernel;
    return SNOW_STATUS_OK;
}

void snow_kernel_table_fini(snow_context *context, snow_kernel_table *phases) {
    snow_release(context, phases->weights);
    *phases = (snow_kernel_table){0};
}
