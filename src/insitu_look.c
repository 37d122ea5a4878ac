/* insitu_look.c - a look for voxels that lie on many ranks.
 *
 * A look depends on how often values occur, not on where.  So each rank sends a
 * share of its voxels to all, the smallest and the greatest among them, and all
 * choose the same look from the same values.  Of fewer than 2^20 voxels that is
 * every one, and the look that of the whole volume in one process. */
#include "insitu_parts.h"
#include "volume/volume.h"

#include <math.h>
#include <string.h>

/* Voxels that are looked at, all ranks together; two a rank more. */
#define SAMPLES (INT64_C(1) << 20)

/* A rank's voxels in a line, from the owned box of its part. */
typedef struct line {
    const snow_volume *volume;
    snow_part part;
    int64_t count;
} line;

/* Where voxel n of the owned box lies in the stored one. */
static int64_t index_of(const line *l, int64_t n) {
    const int64_t *dims = l->volume->info.dims;
    int64_t at[3], index = 0;
    for (int i = 0; i < 3; i++) {
        at[i] = n % l->part.count[i] + l->part.first[i] - l->part.stored[i];
        n /= l->part.count[i];
    }
    for (int i = 2; i >= 0; i--)
        index = index * dims[i] + at[i];
    return index;
}

static void copy_voxel(const line *l, int64_t index, size_t value, char *out) {
    memcpy(out, (const char *)l->volume->voxels + (size_t)index * value, value);
}

/* The smallest and the greatest finite value's places; false where no value is
 * finite. */
static bool find_ends(const line *l, int64_t ends[2]) {
    double least = INFINITY, most = -INFINITY;
    bool found = false;
    for (int64_t n = 0; n < l->count; n++) {
        int64_t index = index_of(l, n);
        double value = snow_volume_native(l->volume, index);
        if (!isfinite(value))
            continue;
        if (value < least) {
            least = value;
            ends[0] = index;
        }
        if (value > most) {
            most = value;
            ends[1] = index;
        }
        found = true;
    }
    return found;
}

/* Every stride-th voxel, and the ends where some are left out; `out` has room
 * for count / stride + 3.  Returns how many. */
static int64_t sample(const line *l, int64_t stride, size_t value, char *out) {
    int64_t count = 0, ends[2] = {0, 0};
    for (int64_t n = 0; n < l->count; n += stride)
        copy_voxel(l, index_of(l, n), value, out + (size_t)count++ * value);
    if (stride == 1 || !find_ends(l, ends))
        return count;
    copy_voxel(l, ends[0], value, out + (size_t)count++ * value);
    copy_voxel(l, ends[1], value, out + (size_t)count++ * value);
    return count;
}

/* The samples of all ranks, one after another; returns how many. */
static int64_t close_up(char *all, const int64_t *counts, int ranks,
                        int64_t most, size_t value) {
    int64_t count = 0;
    for (int rank = 0; rank < ranks; rank++) {
        memmove(all + (size_t)count * value,
                all + (size_t)(rank * most) * value,
                (size_t)counts[rank] * value);
        count += counts[rank];
    }
    return count;
}

/* The look of values that lie in a line. */
static snow_status look_at(snow_context *context, const snow_volume *like,
                           const char *values, int64_t count,
                           const snow_look *look, snow_transfer **out) {
    snow_volume_info info = like->info;
    snow_volume *volume;
    info.dims[0] = count;
    info.dims[1] = info.dims[2] = 1;
    SNOW_TRY(snow_volume_share(context, &info, values, &volume));
    snow_status status = snow_transfer_make(volume, look, out);
    snow_volume_close(volume);
    return status;
}

/* Samples in flight: this rank's, all ranks', and how many each has. */
typedef struct samples {
    char *mine, *all;
    int64_t *counts;
    int64_t most; /* of a rank: the room that each has */
} samples;

static snow_status share_samples(snow_comm *comm, const line *l, int64_t stride,
                                 samples *s) {
    snow_context *context = snow_comm_context(comm);
    uint64_t ranks = (uint64_t)snow_comm_ranks(comm);
    size_t value = snow_type_size(l->volume->info.type);
    s->mine = snow_allocate_array(context, (uint64_t)s->most, value);
    s->all = snow_allocate_array(context, ranks * (uint64_t)s->most, value);
    s->counts = snow_allocate_array(context, ranks, sizeof *s->counts);
    bool there = s->mine && s->all && s->counts;
    SNOW_TRY(snow_comm_agree(comm, there ? SNOW_OK : SNOW_NO_MEMORY));
    size_t bytes = (size_t)s->most * value;
    memset(s->mine, 0, bytes);
    int64_t count = sample(l, stride, value, s->mine);
    SNOW_TRY(snow_comm_share(comm, &count, sizeof count, s->counts));
    return snow_comm_share(comm, s->mine, bytes, s->all);
}

snow_status snow_insitu_choose(snow_comm *comm, const snow_volume *volume,
                               const snow_look *look, snow_transfer **out) {
    snow_context *context = snow_comm_context(comm);
    line l = {.volume = volume};
    samples s = {0};
    snow_volume_get_part(volume, &l.part);
    l.count = l.part.count[0] * l.part.count[1] * l.part.count[2];
    int64_t voxels = l.count;
    SNOW_TRY(snow_comm_reduce_ints(comm, &voxels, 1, SNOW_SUM));
    int64_t stride = (voxels + SAMPLES - 1) / SAMPLES;
    s.most = l.count / stride + 3;
    SNOW_TRY(snow_comm_reduce_ints(comm, &s.most, 1, SNOW_MAX));
    snow_status status = share_samples(comm, &l, stride, &s);
    if (status == SNOW_OK) {
        int ranks = snow_comm_ranks(comm);
        int64_t count = close_up(s.all, s.counts, ranks, s.most,
                                 snow_type_size(volume->info.type));
        status = snow_comm_agree(
            comm, look_at(context, volume, s.all, count, look, out));
    }
    snow_release(context, s.mine);
    snow_release(context, s.all);
    snow_release(context, s.counts);
    return status;
}
