/* parallel/same_file.c - see same_file.h. */
#include "parallel/same_file.h"

#include "base/fingerprint.h"

#include <string.h>

/* Rows of voxels that are compared, evenly from the first to the last. */
#define ROWS 5

enum {
    WIDTH,
    HEIGHT,
    DEPTH,
    TYPE,
    TIMES,
    BYTES,
    HASH,
    MASK,
    ROW,
    CHANGED,
    FACTS
};

/* Mixes the rows of the volume into a hash. */
static snow_status hash_rows(snow_context *context, snow_open_fn *open,
                             const char *path,
                             const snow_volume_options *options,
                             const snow_volume_info *whole, uint64_t *hash) {
    for (int n = 0; n < ROWS; n++) {
        snow_volume_options row = *options;
        snow_volume_info info;
        snow_volume *volume;
        row.mask = row.labels = NULL;
        memset(row.clip, 0, sizeof row.clip);
        for (int axis = 1; axis < 3; axis++) {
            row.crop[axis][0] += (whole->dims[axis] - 1) * n / (ROWS - 1);
            row.crop[axis][1] = row.crop[axis][0] + 1;
        }
        row.crop[0][1] = row.crop[0][0] + whole->dims[0];
        SNOW_TRY(open(context, path, &row, &info, &volume));
        *hash = snow_hash_mix(*hash, snow_volume_voxels(volume),
                              (size_t)info.dims[0] * snow_type_size(info.type));
        snow_volume_close(volume);
    }
    return SNOW_STATUS_OK;
}

/* Which fact is not the same on all ranks; FACTS: all are. */
static snow_status find_different(snow_comm *comm, const int64_t facts[FACTS],
                                  int *out) {
    int64_t ends[2 * FACTS];
    for (int n = 0; n < FACTS; n++) {
        ends[n] = facts[n];
        ends[FACTS + n] = -facts[n];
    }
    SNOW_TRY(snow_comm_reduce_ints(comm, ends, 2 * FACTS, SNOW_REDUCE_MIN));
    *out = 0;
    while (*out < FACTS && ends[*out] == -ends[FACTS + *out])
        ++*out;
    return SNOW_STATUS_OK;
}

snow_status snow_ranks_compare_file(snow_comm *comm, snow_open_fn *open,
                                    const char *path,
                                    const snow_volume_options *options,
                                    const snow_volume_info *whole) {
    snow_context *context = snow_comm_context(comm);
    const snow_fingerprint file = snow_fingerprint_of(path);
    const char *mask_path = options->mask ? options->mask : "";
    const snow_fingerprint mask = snow_fingerprint_of(mask_path);
    const int64_t voxels = whole->dims[0] * whole->dims[1] * whole->dims[2] *
                           (int64_t)snow_type_size(whole->type);
    uint64_t rows = SNOW_HASH_START;
    snow_warning_fn *warning = context->warning;
    context->warning = NULL;
    snow_status status =
        open && file.bytes < voxels / 2
            ? hash_rows(context, open, path, options, whole, &rows)
            : SNOW_STATUS_OK;
    context->warning = warning;
    SNOW_TRY(snow_comm_agree_status(comm, status));
    const int64_t facts[FACTS] = {
        [WIDTH] = whole->dims[0],     [HEIGHT] = whole->dims[1],
        [DEPTH] = whole->dims[2],     [TYPE] = (int64_t)whole->type,
        [TIMES] = whole->times,       [BYTES] = file.bytes,
        [HASH] = file.hash,           [MASK] = mask.hash,
        [ROW] = (int64_t)(rows >> 2), [CHANGED] = file.changed};
    int different;
    SNOW_TRY(find_different(comm, facts, &different));
    if (different < CHANGED)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "%s: is not the same file on all ranks; put it on "
                         "a file system that all ranks share",
                         different == MASK ? mask_path : path);
    if (different == CHANGED && snow_comm_rank(comm) == 0)
        snow_notify(context,
                    "%s: was changed at another time on some ranks, as copies "
                    "are; its size and some of its blocks are the same",
                    path);
    return SNOW_STATUS_OK;
}
