/* splat/phases.c - weights by phase; see splat/phases.h. */
#include "splat/phases.h"

#include <math.h>
#include <string.h>

/* Phases per voxel.  A cubic B-spline bends by at most 2 per voxel squared, so
 * that linear steps of 1/1024 are off by 2.4e-7.  A kernel widened by w bends
 * w^2 times less; what it keeps are the kinks where a voxel comes into reach,
 * as in snow_taper_table_make. */
#define CELLS_MOST 1024
#define CELLS_LEAST 16

bool snow_phases_serve(const snow_taper *taper) {
    return taper->kernel != SNOW_KERNEL_BOX &&
           snow_taper_taps(taper) <= SNOW_TAPS_MOST;
}

snow_status snow_phases_make(snow_context *context, const snow_taper *taper,
                             snow_phases *phases) {
    if (phases->weights && snow_taper_same(taper, &phases->made_for))
        return SNOW_OK;
    int taps = snow_taper_taps(taper), padded = (taps + 3) / 4 * 4;
    int cells = (int)fmax(CELLS_MOST / taper->wide, CELLS_LEAST);
    size_t row = (size_t)padded, rows = (size_t)cells + 2;
    SNOW_TRY(snow_reserve(context, &phases->weights, &phases->capacity, 0,
                          rows * row * sizeof *phases->weights));
    memset(phases->weights, 0, rows * row * sizeof *phases->weights);
    /* Two rows at the end: phase 1, and what is read beside it, times 0, when
     * a phase just below 1 is rounded up. */
    for (size_t n = 0; n < rows; n++)
        snow_taper_phase(taper, fmin((double)n / cells, 1),
                         phases->weights + n * row);
    phases->taps = taps;
    phases->padded = padded;
    phases->cells = cells;
    phases->reach = snow_taper_phase_reach(taper);
    phases->made_for = *taper;
    return SNOW_OK;
}

void snow_phases_fini(snow_context *context, snow_phases *phases) {
    snow_release(context, phases->weights);
    *phases = (snow_phases){0};
}
