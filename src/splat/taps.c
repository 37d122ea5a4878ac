/* splat/taps.c - footprint tables along one image axis; see splat/taps.h. */
#include "splat/taps.h"

#include <math.h>

/* Pixels by which an origin may move before the weights are made anew. */
#define SAME_PLACE 1e-9

snow_status snow_taps_make(snow_context *context, const snow_taper *taper,
                           int64_t voxels, int pixels, snow_taps *taps) {
    uint64_t count = (uint64_t)voxels;
    /* A pixel is reached by at most this many voxels. */
    uint64_t reached =
        (uint64_t)fmin(ceil(2 * taper->half) + 1, (double)voxels);
    uint64_t weights;
    if (!snow_mul_u64((uint64_t)pixels, reached, &weights) ||
        weights > UINT32_MAX) /* what `offset` holds */
        return snow_fail(context, SNOW_NO_MEMORY,
                         "the footprints of %lld voxels on %d pixels are too "
                         "many; take a smaller picture",
                         (long long)voxels, pixels);
    size_t of_ints = (size_t)count * sizeof *taps->first;
    taps->origin = NAN;
    SNOW_TRY(
        snow_reserve(context, &taps->first, &taps->first_capacity, 0, of_ints));
    SNOW_TRY(
        snow_reserve(context, &taps->count, &taps->count_capacity, 0, of_ints));
    SNOW_TRY(snow_reserve(context, &taps->offset, &taps->offset_capacity, 0,
                          of_ints));
    return snow_reserve(context, &taps->weights, &taps->weights_capacity, 0,
                        (size_t)weights * sizeof *taps->weights);
}

void snow_taps_fini(snow_context *context, snow_taps *taps) {
    snow_release(context, taps->first);
    snow_release(context, taps->count);
    snow_release(context, taps->offset);
    snow_release(context, taps->weights);
    *taps = (snow_taps){0};
}

/* Fills the run of one voxel at `centre`; returns its number of pixels. */
static int fill_run(const snow_taper *taper, int pixels, double centre,
                    double step, int *first, float *weights) {
    double reach = snow_taper_reach(taper) * fabs(step);
    int last = snow_last_pixel(centre + reach, pixels), count = 0;
    *first = snow_first_pixel(centre - reach, pixels);
    for (int pixel = *first; pixel <= last; pixel++) {
        double t = (pixel + 0.5 - centre) / step;
        if (snow_taper_covers(taper, t))
            weights[count++] = (float)snow_taper_weight(taper, t);
        else if (!count)
            (*first)++;
    }
    return count;
}

void snow_taps_place(snow_taps *taps, const snow_taper *taper, int64_t voxels,
                     int pixels, double origin, double step) {
    if (fabs(origin - taps->origin) < SAME_PLACE)
        return;
    uint32_t offset = 0;
    for (int64_t n = 0; n < voxels; n++) {
        int first;
        int count = fill_run(taper, pixels, origin + (double)n * step, step,
                             &first, taps->weights + offset);
        taps->first[n] = first;
        taps->count[n] = count;
        taps->offset[n] = offset;
        offset += (uint32_t)count;
    }
    taps->origin = origin;
}
