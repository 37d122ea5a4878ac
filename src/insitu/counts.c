/* insitu/counts.c - how often values occur, for whoever changes the look of a
 * running simulation: the files of its pictures have it (output.c). */
#include "insitu/internal.h"

#include <math.h>
#include <string.h>

/* A rank counts about so many voxels: rows of slices at equal distances. */
#define VOXELS_ENOUGH 250e3
#define LINES_LEAST 16

/* How far apart slices are that are counted, and rows of one: the same on all
 * ranks. */
static void choose_steps(const snow_insitu *insitu, int64_t *row,
                         int64_t *slice) {
    const int64_t *dims = insitu->whole.dims;
    const double own = (double)dims[0] * (double)dims[1] * (double)dims[2] /
                       snow_comm_size(insitu->comm);
    const double step = own / VOXELS_ENOUGH;
    *slice = (int64_t)fmax(1, fmin(step, (double)(dims[2] / LINES_LEAST)));
    *row = (int64_t)fmax(
        1, fmin(step / (double)*slice, (double)(dims[1] / LINES_LEAST)));
}

static int64_t first_of(int64_t first, int64_t step) {
    return (first + step - 1) / step * step;
}

static snow_status count_slice(snow_insitu *insitu, const snow_volume *slice) {
    uint64_t here[SNOW_INSITU_BINS];
    INSITU_TRY(snow_volume_histogram(slice, insitu->ends[0], insitu->ends[1],
                                     SNOW_INSITU_BINS, here));
    for (int i = 0; i < SNOW_INSITU_BINS; i++)
        insitu->counts[i] += (int64_t)here[i];
    return SNOW_STATUS_OK;
}

/* The rows of a slice that are counted, of voxels of `value` bytes. */
static void copy_rows(const snow_insitu *insitu, const snow_extent *part,
                      int64_t z, int64_t step, size_t value, char *out) {
    const char *voxels = snow_volume_voxels(insitu->volume);
    const size_t bytes = (size_t)part->count[0] * value;
    for (int64_t y = first_of(part->first[1], step);
         y < part->first[1] + part->count[1]; y += step, out += bytes) {
        const int64_t at = part->first[0] - part->stored[0] +
                           (y - part->stored[1]) * insitu->pitch[0] +
                           (z - part->stored[2]) * insitu->pitch[1];
        memcpy(out, voxels + (size_t)at * value, bytes);
    }
}

/* Own voxels, without those of neighbours, slice by slice through `copy`, which
 * has room for a slice. */
static snow_status count_slices(snow_insitu *insitu, const snow_extent *part,
                                void *copy) {
    int64_t row, step;
    choose_steps(insitu, &row, &step);
    const int64_t end = part->first[1] + part->count[1],
                  first = first_of(part->first[1], row);
    snow_volume_info info = *snow_volume_get_info(insitu->volume);
    const int64_t dims[3] = {part->count[0], (end - first + row - 1) / row, 1};
    snow_volume *wrapped = NULL;
    if (first >= end)
        return SNOW_STATUS_OK;
    memcpy(info.dims, dims, sizeof dims);
    snow_status status =
        snow_volume_wrap(insitu->context, &info, copy, &wrapped);
    for (int64_t z = first_of(part->first[2], step);
         status == SNOW_STATUS_OK && z < part->first[2] + part->count[2];
         z += step) {
        copy_rows(insitu, part, z, row, snow_type_size(info.type), copy);
        status = count_slice(insitu, wrapped);
    }
    snow_volume_close(wrapped);
    return status;
}

static snow_status count_own(snow_insitu *insitu) {
    snow_extent part;
    snow_extent_init(&part);
    INSITU_TRY(snow_volume_get_extent(insitu->volume, &part));
    const size_t voxels = (size_t)part.count[0] * (size_t)part.count[1];
    if (!voxels || !part.count[2])
        return SNOW_STATUS_OK;
    void *copy = snow_context_allocate(
        insitu->context,
        voxels * snow_type_size(snow_volume_get_info(insitu->volume)->type));
    snow_status status =
        copy ? count_slices(insitu, &part, copy) : SNOW_STATUS_NO_MEMORY;
    snow_context_release(insitu->context, copy);
    return status;
}

static snow_status count_all(snow_insitu *insitu) {
    double *ends = insitu->ends;
    memset(insitu->counts, 0, sizeof insitu->counts);
    if (!insitu->knows_ends)
        INSITU_TRY(snow_insitu_find_values(insitu, ends));
    if (!(ends[0] < ends[1]) || !isfinite(ends[1] - ends[0]))
        return SNOW_STATUS_OK;
    INSITU_TRY(snow_comm_agree_status(insitu->comm, count_own(insitu)));
    INSITU_TRY(snow_comm_reduce_ints(insitu->comm, insitu->counts,
                                     SNOW_INSITU_BINS, SNOW_REDUCE_SUM));
    insitu->counted = true;
    return SNOW_STATUS_OK;
}

snow_status snow_insitu_count(snow_insitu *insitu) {
    insitu->counted = false;
    /* Only PNGs, of formats of more than 8 bits, have room for them. */
    if (!insitu->refresh || snow_image_format_bits(insitu->pattern) <= 8)
        return SNOW_STATUS_OK;
    snow_status status = count_all(insitu);
    if (status != SNOW_STATUS_NO_MEMORY)
        return status;
    snow_insitu_report(insitu,
                       "%s; this picture is written without the counts "
                       "of its values, which a viewer's histogram needs",
                       snow_context_message(insitu->context));
    return SNOW_STATUS_OK;
}
