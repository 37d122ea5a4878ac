/* splat/across.c - footprints of sheared slices, and the filter of a row for
 * each level. */
#include "splat/across.h"

#include <math.h>

#define SELECT_SCALAR
#include "simd/select.h"
#define ACROSS_CHANNELS 2
#define ACROSS_WEAVE V(weave2)
#define ACROSS_NAME(part) NAME(across2##part)
#include "splat/across.tmpl.h"
#define ACROSS_CHANNELS 4
#define ACROSS_WEAVE V(weave4)
#define ACROSS_NAME(part) NAME(across4##part)
#include "splat/across.tmpl.h"
#if SNOW_HAS_AVX
#define SELECT_AVX2
#include "simd/select.h"
#define ACROSS_CHANNELS 2
#define ACROSS_WEAVE V(weave2)
#define ACROSS_NAME(part) NAME(across2##part)
#include "splat/across.tmpl.h"
#define ACROSS_CHANNELS 4
#define ACROSS_WEAVE V(weave4)
#define ACROSS_NAME(part) NAME(across4##part)
#include "splat/across.tmpl.h"
#define SELECT_AVX512
#include "simd/select.h"
#define ACROSS_CHANNELS 2
#define ACROSS_WEAVE V(weave2)
#define ACROSS_NAME(part) NAME(across2##part)
#include "splat/across.tmpl.h"
#define ACROSS_CHANNELS 4
#define ACROSS_WEAVE V(weave4)
#define ACROSS_NAME(part) NAME(across4##part)
#include "splat/across.tmpl.h"
#endif

snow_across_fn *snow_across_of(snow_isa isa, int channels) {
#if SNOW_HAS_AVX
    if (isa == SNOW_ISA_AVX512)
        return channels == 2 ? across2_avx512 : across4_avx512;
    if (isa == SNOW_ISA_AVX2)
        return channels == 2 ? across2_avx2 : across4_avx2;
#endif
    (void)isa;
    return channels == 2 ? across2_scalar : across4_scalar;
}

/* Half the support rounded up, to either side.  Kernels that jump at their ends
 * may have a voxel just beyond, which counts as on the end. */
static int taps_aside(const snow_taper *taper) {
    bool jumps =
        taper->kernel == SNOW_KERNEL_BOX || taper->kernel == SNOW_KERNEL_GAUSS;
    return (int)ceil(jumps ? snow_taper_reach(taper) : taper->half);
}

int snow_taper_taps(const snow_taper *taper) {
    return 2 * taps_aside(taper);
}

void snow_across_place(const snow_taper *taper, const snow_lattice *lattice,
                       double slice, float *weights, snow_across *out) {
    snow_across across = {.phases = lattice->phases,
                          .stride = lattice->stride,
                          .taps = snow_taper_taps(taper),
                          .first = lattice->first,
                          .weights = weights};
    for (int phase = 0; phase < lattice->phases; phase++) {
        double at =
            (double)phase / lattice->phases - slice * lattice->slope;
        double base = floor(at);
        int before = taps_aside(taper) - 1;
        across.offset[phase] = (int64_t)base - before;
        snow_taper_spread(taper, at - base, -before, across.taps,
                          weights + phase * across.taps);
    }
    *out = across;
}
