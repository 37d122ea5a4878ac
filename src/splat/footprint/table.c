/* splat/footprint/table.c - footprint tables along one image axis; see
 * splat/footprint/table.h. */
#include "splat/footprint/table.h"

#include <math.h>

/* Pixels by which an origin may move before the weights are recomputed. */
#define SAME_PLACE 1e-9

snow_status snow_footprint_table_make(snow_context *context,
                                      const snow_scaled_kernel *scaled_kernel,
                                      int64_t voxels, int pixels,
                                      snow_footprint_table *taps) {
    /* The most voxels that reach a pixel. */
    uint64_t reached =
        (uint64_t)fmin(ceil(2 * scaled_kernel->half) + 1, (double)voxels);
    uint64_t weights;
    if (!snow_mul_u64((uint64_t)pixels, reached, &weights) ||
        weights > UINT32_MAX) /* the limit of `offset` */
        return snow_fail(context, SNOW_STATUS_NO_MEMORY,
                         "the footprints of %lld voxels on %d pixels need more "
                         "than 4294967295 weights; render a smaller picture",
                         (long long)voxels, pixels);
    taps->origin = NAN;
    SNOW_TRY(SNOW_RESERVE(context, taps->first, 0, voxels));
    SNOW_TRY(SNOW_RESERVE(context, taps->count, 0, voxels));
    SNOW_TRY(SNOW_RESERVE(context, taps->offset, 0, voxels));
    return SNOW_RESERVE(context, taps->weights, 0, weights);
}

void snow_footprint_table_fini(snow_context *context,
                               snow_footprint_table *taps) {
    snow_release(context, taps->first);
    snow_release(context, taps->count);
    snow_release(context, taps->offset);
    snow_release(context, taps->weights);
    *taps = (snow_footprint_table){0};
}

/* Fills the run of one voxel at `centre`; returns its number of pixels. */
static int fill_run(const snow_scaled_kernel *scaled_kernel, int pixels,
                    double centre, double step, int *first, float *weights) {
    double reach = snow_scaled_kernel_reach(scaled_kernel) * fabs(step);
    int last = snow_last_pixel(centre + reach, pixels), count = 0;
    *first = snow_first_pixel(centre - reach, pixels);
    for (int pixel = *first; pixel <= last; pixel++) {
        double t = (pixel + 0.5 - centre) / step;
        if (snow_scaled_kernel_covers(scaled_kernel, t))
            weights[count++] =
                (float)snow_scaled_kernel_weight(scaled_kernel, t);
        else if (!count)
            (*first)++;
    }
    return count;
}

void snow_footprint_table_place(snow_footprint_table *taps,
                                const snow_scaled_kernel *scaled_kernel,
                                int64_t voxels, int pixels, double origin,
                                double step) {
    if (fabs(origin - taps->origin) < SAME_PLACE)
        return;
    uint32_t offset = 0;
    for (int64_t n = 0; n < voxels; n++) {
        int first;
        int count = fill_run(scaled_kernel, pixels, origin + (double)n * step,
                             step, &first, taps->weights + offset);
        taps->first[n] = first;
        taps->count[n] = count;
        taps->offset[n] = offset;
        offset += (uint32_t)count;
    }
    taps->origin = origin;
}
