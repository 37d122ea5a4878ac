/* insitu/counts.c - how often values occur, for whoever changes the look of a
 * running simulation: the files of its pictures have it (output.c). */
#include "insitu/internal.h"

#include <math.h>
#include <string.h>

/* A rank counts about so many voxels, in slices at equal distances. */
#define VOXELS_ENOUGH 1e6
#define SLICES_LEAST 16

/* The distance, the same on all ranks. */
static int64_t slice_step(const snow_insitu *insitu) {
    const int64_t *dims = insitu->whole.dims, most = dims[2] / SLICES_LEAST;
    const double own = (double)dims[0] * (double)dims[1] * (double)dims[2] /
                       snow_comm_size(insitu->comm);
    const double step = fmin(own / VOXELS_ENOUGH, (double)most);
    return step > 1 ? (int64_t)step : 1;
}

static snow_status count_slice(snow_insitu *insitu, const snow_volume *slice) {
    uint64_t here[SNOW_INSITU_BINS];
    INSITU_TRY(snow_volume_histogram(slice, insitu->ends[0], insitu->ends[1],
                                     SNOW_INSITU_BINS, here));
    for (int i = 0; i < SNOW_INSITU_BINS; i++)
        insitu->counts[i] += (int64_t)here[i];
    return SNOW_STATUS_OK;
}

/* Own voxels, without those of neighbours, slice by slice through `copy`. */
static snow_status count_slices(snow_insitu *insitu, const snow_extent *part,
                                snow_box slice, void *copy) {
    snow_volume_info info = *snow_volume_get_info(insitu->volume);
    snow_brick stored = {.voxels = snow_volume_voxels(insitu->volume),
                         .stride = {1, insitu->pitch[0], insitu->pitch[1]}};
    const size_t value = snow_type_size(info.type);
    const int64_t step = slice_step(insitu);
    snow_volume *wrapped = NULL;
    memcpy(stored.box.first, part->stored, sizeof part->stored);
    memcpy(stored.box.count, info.dims, sizeof info.dims);
    memcpy(info.dims, slice.count, sizeof info.dims);
    snow_status status =
        snow_volume_wrap(insitu->context, &info, copy, &wrapped);
    for (int64_t z = (part->first[2] + step - 1) / step * step;
         status == SNOW_STATUS_OK && z < part->first[2] + part->count[2];
         z += step) {
        slice.first[2] = z;
        snow_brick_copy(&stored, value, &slice, &slice, copy);
        status = count_slice(insitu, wrapped);
    }
    snow_volume_close(wrapped);
    return status;
}

static snow_status count_own(snow_insitu *insitu) {
    snow_extent part;
    snow_extent_init(&part);
    INSITU_TRY(snow_volume_get_extent(insitu->volume, &part));
    snow_box slice = {.first = {part.first[0], part.first[1], 0},
                      .count = {part.count[0], part.count[1], 1}};
    const size_t voxels = (size_t)snow_box_voxels(&slice);
    if (!voxels)
        return SNOW_STATUS_OK;
    void *copy = snow_context_allocate(
        insitu->context,
        voxels * snow_type_size(snow_volume_get_info(insitu->volume)->type));
    snow_status status =
        copy ? count_slices(insitu, &part, slice, copy) : SNOW_STATUS_NO_MEMORY;
    snow_context_release(insitu->context, copy);
    return status;
}

snow_status snow_insitu_count(snow_insitu *insitu) {
    double *ends = insitu->ends;
    memset(insitu->counts, 0, sizeof insitu->counts);
    INSITU_TRY(snow_insitu_find_values(insitu, ends));
    if (!(ends[0] < ends[1]) || !isfinite(ends[1] - ends[0]))
        return SNOW_STATUS_OK;
    INSITU_TRY(snow_comm_agree_status(insitu->comm, count_own(insitu)));
    return snow_comm_reduce_ints(insitu->comm, insitu->counts, SNOW_INSITU_BINS,
                                 SNOW_REDUCE_SUM);
}
