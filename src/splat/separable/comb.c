/* splat/separable/comb.c - footprints of sheared slices. */
#include "splat/separable/comb.h"

#include <math.h>

/* Half the support rounded up, on either side. For kernels that jump at their
 * ends a voxel just beyond may count as on the end. */
static int taps_aside(const snow_scaled_kernel *scaled_kernel) {
    bool jumps = scaled_kernel->kernel == SNOW_KERNEL_BOX ||
                 scaled_kernel->kernel == SNOW_KERNEL_GAUSS;
    return (int)ceil(jumps ? snow_scaled_kernel_reach(scaled_kernel)
                           : scaled_kernel->half);
}

int snow_comb_taps(const snow_scaled_kernel *scaled_kernel) {
    return 2 * taps_aside(scaled_kernel);
}

void snow_comb_make(const snow_scaled_kernel *scaled_kernel,
                    const snow_lattice *lattice, double slice, snow_comb *out) {
    int before = taps_aside(scaled_kernel) - 1,
        taps = snow_comb_taps(scaled_kernel);
    int64_t offset[2] = {0, 0};
    for (int phase = 0; phase < lattice->phases; phase++) {
        double at = (double)phase / lattice->phases - slice * lattice->slope;
        double base = floor(at);
        offset[phase] = (int64_t)base - before;
        snow_scaled_kernel_spread(scaled_kernel, at - base, -before, taps,
                                  out->weights[phase]);
    }
    bool odd = lattice->phases == 2 && offset[1] > offset[0];
    out->offset = offset[0];
    out->lead[0] = 0;
    out->lead[1] = odd;
}
