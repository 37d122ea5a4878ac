/* phantom/turbulence.c - a flow that fills space, as in a simulation: K.
 * Perlin's turbulence ("An image synthesizer", SIGGRAPH 1985), the sum of
 * absolute noises, each half as large as the one before.  Each is weighted as
 * the velocities of eddies of its size (Kolmogorov 1941: by the cube root of
 * it); sheets where noises pass zero are folded into one another. */
#include "phantom/phantom.h"

#include <math.h>

#define OCTAVES 5

static void turbulence_row(const snow_phantom_grid *grid, int64_t j, int64_t k,
                           void *out) {
    static const struct {
        double cell, weight; /* size of eddies; cube root of size / 72 */
    } octaves[OCTAVES] = {
        {72, 1}, {36, 0.7937}, {18, 0.62996}, {9, 0.5}, {4.5, 0.39685}};
    const double all = 1 + 0.7937 + 0.62996 + 0.5 + 0.39685;
    snow_noise_row rows[OCTAVES];
    double y = snow_phantom_place(grid, 1, j);
    double z = snow_phantom_place(grid, 2, k);
    for (int n = 0; n < OCTAVES; n++)
        snow_noise_row_begin(&rows[n], grid->seed ^ (uint64_t)n << 32,
                             octaves[n].cell, 128, y, z);
    float *values = out;
    for (int64_t i = 0; i < grid->dims[0]; i++) {
        double x = snow_phantom_place(grid, 0, i), sum = 0;
        for (int n = 0; n < OCTAVES; n++)
            sum += octaves[n].weight * fabs(2 * snow_noise_at(&rows[n], x) - 1);
        values[i] = (float)(1 - sum / all);
    }
}

const snow_phantom snow_phantom_turbulence = {
    .name = "turbulence",
    .text = "folded sheets of all sizes, float32 0 to 1 (Perlin 1985)",
    .dims = {128, 128, 128},
    .extent = {256, 256, 256},
    .type = SNOW_TYPE_FLOAT32,
    .row = turbulence_row,
};
