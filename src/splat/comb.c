/* splat/comb.c - footprints of sheared slices. */
#include "splat/comb.h"

#include <math.h>

/* Half the support rounded up, to either side.  Kernels that jump at their ends
 * may have a voxel just beyond, which counts as on the end. */
static int taps_aside(const snow_taper *taper) {
    bool jumps =
        taper->kernel == SNOW_KERNEL_BOX || taper->kernel == SNOW_KERNEL_GAUSS;
    return (int)ceil(jumps ? snow_taper_reach(taper) : taper->half);
}

int snow_comb_taps(const snow_taper *taper) {
    return 2 * taps_aside(taper);
}

void snow_comb_make(const snow_taper *taper, const snow_lattice *lattice,
                    double slice, snow_comb *out) {
    int before = taps_aside(taper) - 1, taps = snow_comb_taps(taper);
    int64_t offset[2] = {0, 0};
    for (int phase = 0; phase < lattice->phases; phase++) {
        double at = (double)phase / lattice->phases - slice * lattice->slope;
        double base = floor(at);
        offset[phase] = (int64_t)base - before;
        snow_taper_spread(taper, at - base, -before, taps, out->weights[phase]);
    }
    bool odd = lattice->phases == 2 && offset[1] > offset[0];
    out->offset = offset[0];
    out->lead[0] = 0;
    out->lead[1] = odd;
}
