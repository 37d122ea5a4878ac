/* values.c - implements values.h. */
#include "draw/values.h"
#include "draw/ranks.h"
#include "run/log.h"

#include <snowglass/extend.h>

#include <math.h>
#include <string.h>

/* Hands over a rank's own voxels, without those of its neighbours. */
typedef snow_status visit_fn(const snow_volume *voxels, void *user);

/* Slice by slice, as a copy of them all may have no room. */
static snow_status visit_part(drawing *d, const snow_extent *part,
                              visit_fn *visit, void *user) {
    snow_context *context = d->state.context;
    snow_volume_info info = *snow_volume_get_info(d->state.volume);
    snow_brick stored = {
        .voxels = snow_volume_voxels(d->state.volume),
        .stride = {1, info.dims[0], info.dims[0] * info.dims[1]}};
    snow_box slice = {.count = {part->count[0], part->count[1], 1}};
    snow_volume *wrapped = NULL;
    memcpy(stored.box.first, part->stored, sizeof part->stored);
    memcpy(stored.box.count, info.dims, sizeof info.dims);
    memcpy(slice.first, part->first, sizeof slice.first);
    memcpy(info.dims, slice.count, sizeof info.dims);
    size_t value = snow_type_size(info.type);
    void *copy =
        snow_context_allocate(context, (size_t)snow_box_voxels(&slice) * value);
    snow_status status = copy ? snow_volume_wrap(context, &info, copy, &wrapped)
                              : SNOW_STATUS_NO_MEMORY;
    for (int64_t z = 0; status == SNOW_STATUS_OK && z < part->count[2]; z++) {
        snow_brick_copy(&stored, value, &slice, &slice, copy);
        status = visit(wrapped, user);
        slice.first[2]++;
    }
    snow_volume_close(wrapped);
    snow_context_release(context, copy);
    return status;
}

/* *in_file: they are not here, and none is handed over. */
static snow_status visit_own(drawing *d, visit_fn *visit, void *user,
                             bool *in_file) {
    snow_extent part;
    snow_extent_init(&part);
    snow_status status = snow_volume_get_extent(d->state.volume, &part);
    bool any = status == SNOW_STATUS_OK && part.count[0] > 0;
    *in_file = any && !snow_volume_voxels(d->state.volume);
    if (!any || *in_file)
        return status;
    return process_ranks() == 1 ? visit(d->state.volume, user)
                                : visit_part(d, &part, visit, user);
}

static int agree(const drawing *d, snow_status status) {
    return process_agree(check_status(d->state.context, status));
}

static snow_status measure(const snow_volume *voxels, void *user) {
    double *ends = user;
    snow_volume_statistics of = {.size = sizeof of};
    snow_status status = snow_volume_get_statistics(voxels, &of);
    if (status != SNOW_STATUS_OK)
        return status;
    ends[0] = fmin(ends[0], of.min); /* which passes over NaN */
    ends[1] = fmax(ends[1], of.max);
    return SNOW_STATUS_OK;
}

/* What is not known of one part is not known of all. */
void values_ends(drawing *d, double ends[2]) {
    if (d->values.measured) {
        memcpy(ends, d->values.ends, sizeof d->values.ends);
        return;
    }
    double here[2] = {INFINITY, -INFINITY};
    bool in_file;
    ranks_tell(d, RANKS_ENDS, NULL);
    int done = agree(d, visit_own(d, measure, here, &in_file));
    if (in_file) {
        here[0] = -INFINITY;
        here[1] = INFINITY;
    }
    if (done == CONTINUE && process_ranks() > 1) {
        snow_comm *comm = process_comm();
        snow_comm_reduce_doubles(comm, &here[0], 1, SNOW_REDUCE_MIN);
        snow_comm_reduce_doubles(comm, &here[1], 1, SNOW_REDUCE_MAX);
    }
    bool known = done == CONTINUE && isfinite(here[0]) && isfinite(here[1]);
    ends[0] = known ? here[0] : NAN;
    ends[1] = known ? here[1] : NAN;
    d->values.measured = process_talks() && !d->live;
    memcpy(d->values.ends, ends, sizeof d->values.ends);
}

void values_window(drawing *d, double window[2]) {
    const snow_look look = {
        .size = sizeof look, .preset = "linear", .range = SNOW_RANGE_SLICES};
    snow_transfer *transfer = NULL;
    ranks_tell(d, RANKS_WINDOW, NULL);
    window[0] = 0;
    window[1] = 1;
    if (drawing_new_transfer(d, &look, &transfer) == SNOW_STATUS_OK)
        snow_transfer_domain(transfer, &window[0], &window[1]);
    snow_transfer_free(transfer);
}

typedef struct bins {
    double low, high;
    int64_t counts[VALUES_BINS + 1]; /* and parts that are not here */
} bins;

static snow_status count(const snow_volume *voxels, void *user) {
    bins *b = user;
    uint64_t here[VALUES_BINS];
    snow_status status =
        snow_volume_histogram(voxels, b->low, b->high, VALUES_BINS, here);
    for (size_t i = 0; status == SNOW_STATUS_OK && i < VALUES_BINS; i++)
        b->counts[i] += (int64_t)here[i];
    return status;
}

/* Whole rows, of at least so many voxels at once; and seconds of a piece. */
#define PIECE_VOXELS 262144
#define PIECE_SECONDS 0.006

/* Counts some rows more, as a volume of one slice. */
static snow_status count_rows(drawing *d, bins *b, int64_t *done) {
    snow_volume_info info = *snow_volume_get_info(d->state.volume);
    const char *voxels = snow_volume_voxels(d->state.volume);
    const int64_t left = info.dims[1] * info.dims[2] - *done / info.dims[0];
    const int64_t rows = PIECE_VOXELS / info.dims[0] + 1;
    snow_volume *wrapped = NULL;
    info.dims[1] = rows < left ? rows : left;
    info.dims[2] = 1;
    snow_status status = snow_volume_wrap(
        d->state.context, &info,
        voxels + (size_t)*done * snow_type_size(info.type), &wrapped);
    if (status == SNOW_STATUS_OK)
        status = count(wrapped, b);
    snow_volume_close(wrapped);
    *done += info.dims[0] * info.dims[1];
    return status;
}

static bool is_range(const double ends[2], double low, double high) {
    return !(ends[0] < low) && !(low < ends[0]) && !(ends[1] < high) &&
           !(high < ends[1]);
}

/* What is kept of these values; else in the place of what was longest not
 * asked for. */
static kept_counts *counts_of(drawing *d, double low, double high) {
    kept_values *k = &d->values;
    kept_counts *oldest = &k->kept[1], *found = NULL;
    if (k->measured && is_range(k->ends, low, high))
        found = &k->kept[0];
    for (int i = 1; i <= VALUES_PARTS && !found; i++) {
        kept_counts *each = &k->kept[i];
        if (is_range((double[2]){each->low, each->high}, low, high))
            found = each;
        if (each->used < oldest->used)
            oldest = each;
    }
    if (!found)
        found = oldest;
    found->used = ++k->uses;
    return found;
}

static int count_piece(drawing *d, kept_counts *k, double low, double high) {
    const snow_volume_info *info = snow_volume_get_info(d->state.volume);
    const int64_t all = info->dims[0] * info->dims[1] * info->dims[2];
    const double begin = seconds_now();
    if (k->low < low || low < k->low || k->high < high || high < k->high)
        k->done = 0;
    bins b = {.low = k->low = low, .high = k->high = high};
    snow_status status = SNOW_STATUS_OK;
    if (k->done == 0)
        memset(k->counts, 0, sizeof k->counts);
    while (status == SNOW_STATUS_OK && k->done < all &&
           seconds_now() - begin < PIECE_SECONDS)
        status = count_rows(d, &b, &k->done);
    for (size_t i = 0; i < VALUES_BINS; i++)
        k->counts[i] += (uint64_t)b.counts[i];
    if (status != SNOW_STATUS_OK) {
        k->done = 0;
        return fail_status(d->state.context, status);
    }
    return k->done < all ? VALUES_MORE : CONTINUE;
}

int values_count(drawing *d, double low, double high,
                 uint64_t counts[VALUES_BINS]) {
    bins all = {.low = low, .high = high};
    bool in_file;
    if (process_ranks() == 1 && snow_volume_voxels(d->state.volume)) {
        kept_counts *k = counts_of(d, low, high);
        int piece = count_piece(d, k, low, high);
        memcpy(counts, k->counts, sizeof k->counts);
        return piece;
    }
    ranks_tell(d, RANKS_HISTOGRAM, json_pack("[f,f]", low, high));
    int done = agree(d, visit_own(d, count, &all, &in_file));
    if (done != CONTINUE)
        return done;
    all.counts[VALUES_BINS] = in_file;
    snow_status status = SNOW_STATUS_OK;
    if (process_ranks() > 1)
        status = snow_comm_reduce_ints(process_comm(), all.counts,
                                       VALUES_BINS + 1, SNOW_REDUCE_SUM);
    if (status != SNOW_STATUS_OK)
        return fail_status(d->state.context, status);
    for (size_t i = 0; i < VALUES_BINS; i++)
        counts[i] = (uint64_t)all.counts[i];
    return all.counts[VALUES_BINS] ? SNOW_STATUS_BAD_USAGE : CONTINUE;
}
