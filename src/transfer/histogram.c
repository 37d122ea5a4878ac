/* transfer/histogram.c - counts how often values occur, exactly and without a
 * copy of them.
 *
 * Voxels of 8 and 16 bits are counted once by their native value, and all else
 * is computed from these counts.  For other types doubles are converted to
 * 64-bit keys of the same order and a quantile is found 16 bits at a time, most
 * significant first, by counting (radix selection).  This takes four passes
 * over the voxels whatever the range of values, which equal bins could not do
 * for data from 1e-3 to 1e38.
 *
 * All results are counts, minima or maxima.  Each of many ranks computes them
 * for the voxels that it is responsible for, and they are added up.  So all
 * ranks get the same results for the whole volume, to the bit, as one rank
 * would, however it is partitioned.  The same holds for slabs of a volume that
 * stays in its file (volume/stream.h).  Each pass reads them again, except that
 * what sampled passes read is kept after the first one, if there is memory for
 * it. */
#include "transfer/look.h"
#include "volume/stream.h"

#include <math.h>
#include <string.h>

#define BLOCK 1024
#define DIGIT_BITS 16
#define DIGITS (1 << DIGIT_BITS)

/* The fewest voxels that a sampled pass reads, if there are as many. */
#define SAMPLE (INT64_C(1) << 24)

/* A walk over the voxels that this rank is responsible for, in the order of the
 * whole volume, in contiguous runs. */
typedef struct walk {
    const snow_volume *volume;
    bool log;        /* values that are not above 0 become NaN */
    snow_region box; /* of the whole volume, in voxels */
    int64_t stored[3];
    int64_t runs, run; /* number of runs; index of the next one */
    uint64_t at, end;  /* of the current run: voxels of the whole volume */
    int64_t ahead; /* from a voxel of the whole volume to its place in memory */
    uint64_t stride; /* distance of sampled blocks in the whole volume */
} walk;

static walk walk_begin(const snow_volume *volume, bool log,
                       snow_histogram_mode histogram_mode) {
    snow_extent part;
    snow_volume_get_extent(volume, &part);
    walk w = {.volume = volume, .log = log, .box = {.value = 1}};
    memcpy(w.stored, part.stored, sizeof w.stored);
    memcpy(w.box.dims, part.dims, sizeof w.box.dims);
    memcpy(w.box.first, part.first, sizeof w.box.first);
    memcpy(w.box.count, part.count, sizeof w.box.count);
    if (part.count[0] && part.count[1] && part.count[2])
        w.runs = snow_region_runs(&w.box);
    int64_t skip = part.dims[0] * part.dims[1] * part.dims[2] / SAMPLE;
    w.stride = BLOCK;
    if (histogram_mode == SNOW_HISTOGRAM_SAMPLED && skip > 1)
        w.stride *= (uint64_t)skip;
    return w;
}

/* A run is contiguous in memory too: whole rows or slices of the volume are
 * stored without gaps. */
static bool next_run(walk *w) {
    if (w->run == w->runs)
        return false;
    const int64_t *dims = w->box.dims, *own = w->volume->info.dims;
    snow_region_run(&w->box, w->run++, &w->at, &w->end);
    int64_t row = (int64_t)w->at / dims[0], x = (int64_t)w->at % dims[0];
    int64_t y = row % dims[1] - w->stored[1], z = row / dims[1] - w->stored[2];
    w->ahead = (z * own[1] + y) * own[0] + x - w->stored[0] - (int64_t)w->at;
    return true;
}

/* Finds the next voxels, up to BLOCK, that a sampled block has in the run:
 * their number, 0 at the end, and the place in memory of the first. */
static size_t next_voxels(walk *w, int64_t *first) {
    for (;;) {
        if (w->at >= w->end && !next_run(w))
            return 0;
        uint64_t offset = w->at % w->stride;
        if (offset < BLOCK) {
            uint64_t count = BLOCK - offset;
            if (count > w->end - w->at)
                count = w->end - w->at;
            *first = (int64_t)w->at + w->ahead;
            w->at += count;
            return (size_t)count;
        }
        w->at += w->stride - offset;
    }
}

/* Their data values. */
static size_t next_block(walk *w, double values[BLOCK]) {
    const snow_volume_info *info = &w->volume->info;
    int64_t first = 0;
    size_t count = next_voxels(w, &first);
    snow_volume_natives(w->volume, first, count, values);
    for (size_t i = 0; i < count; i++)
        values[i] = info->slope * values[i] + info->intercept;
    for (size_t i = 0; i < count && w->log; i++)
        values[i] = values[i] > 0 ? values[i] : (double)NAN;
    return count;
}

/* Makes one pass over all slabs of a volume, each with a walk of its own, or
 * over the sample.  Many ranks have their voxels in memory, where it cannot
 * fail. */
static snow_status each_slab(const snow_histogram *histogram,
                             snow_histogram_mode histogram_mode,
                             snow_slab_fn *visit, void *user) {
    static const snow_slab_cut cut = {.step = 1};
    if (histogram_mode == SNOW_HISTOGRAM_SAMPLED && histogram->sample)
        return visit(histogram->sample, user);
    return snow_slabs_visit(histogram->volume, &cut, visit, user);
}

/* Adds up what all ranks have counted. */
static snow_status sum_up(const snow_histogram *histogram, uint64_t *counts,
                          size_t count) {
    if (!histogram->comm)
        return SNOW_STATUS_OK;
    return snow_comm_reduce_ints(histogram->comm, (int64_t *)counts, count,
                                 SNOW_SUM);
}

/* The same for a table of DIGITS counts, most of which are often zero: only
 * those between the first and the last that any rank uses are sent. */
static snow_status sum_up_table(const snow_histogram *histogram,
                                uint64_t *counts) {
    int64_t ends[2] = {0, 1 - DIGITS}; /* the first; the last, negated */
    if (!histogram->comm)
        return SNOW_STATUS_OK;
    while (ends[0] < DIGITS && !counts[ends[0]])
        ends[0]++;
    while (ends[1] < 0 && !counts[-ends[1]])
        ends[1]++;
    SNOW_TRY(snow_comm_reduce_ints(histogram->comm, ends, 2, SNOW_MIN));
    if (ends[0] == DIGITS)
        return SNOW_STATUS_OK;
    return sum_up(histogram, counts + ends[0], (size_t)(1 - ends[1] - ends[0]));
}

static snow_status agree(const snow_histogram *histogram, snow_status status) {
    return histogram->comm ? snow_comm_agree_status(histogram->comm, status)
                           : status;
}

/* --- 8 and 16 bit types ----------------------------------------------------
 */

/* The smallest value of a type that is counted; returns false for others. */
static bool counted_type(snow_type type, int *smallest) {
    *smallest = type == SNOW_TYPE_INT8    ? INT8_MIN
                : type == SNOW_TYPE_INT16 ? INT16_MIN
                                          : 0;
    return type == SNOW_TYPE_INT8 || type == SNOW_TYPE_UINT8 ||
           type == SNOW_TYPE_INT16 || type == SNOW_TYPE_UINT16;
}

/* Bytes that are compared at once. */
#define EVEN 32

/* Whether these bytes are copies of one value of `size` bytes, 1 or 2.  Empty
 * regions usually are, and incrementing the same count again and again is
 * slow. */
static bool is_even(const void *bytes, size_t size) {
    uint64_t words[EVEN / sizeof(uint64_t)];
    memcpy(words, bytes, sizeof words);
    uint64_t turned = words[0] << 8 * size | words[0] >> (64 - 8 * size);
    uint64_t differ = words[0] ^ turned;
    for (size_t n = 1; n < sizeof words / sizeof *words; n++)
        differ |= words[0] ^ words[n];
    return !differ;
}

/* `user` points to the counts. */
static snow_status count_natives(const snow_volume *volume, void *user) {
    uint64_t *counts = user;
    walk w = walk_begin(volume, false, SNOW_HISTOGRAM_EXACT);
#define COUNT_TYPE(name, c_type, smallest)                             \
    case name: {                                                       \
        const c_type *voxels = volume->voxels;                         \
        const uint64_t some = EVEN / sizeof *voxels;                   \
        while (next_run(&w)) {                                         \
            const c_type *at = voxels + (int64_t)w.at + w.ahead;       \
            const c_type *end = at + (w.end - w.at);                   \
            while (at < end)                                           \
                if ((uint64_t)(end - at) >= some &&                    \
                    is_even(at, sizeof *voxels)) {                     \
                    counts[*at - (smallest)] += some;                  \
                    at += some;                                        \
                } else {                                               \
                    const c_type *last =                               \
                        (uint64_t)(end - at) < some ? end : at + some; \
                    while (at < last)                                  \
                        counts[*at++ - (smallest)]++;                  \
                }                                                      \
        }                                                              \
        break;                                                         \
    }
    switch (volume->info.type) {
        COUNT_TYPE(SNOW_TYPE_INT8, int8_t, INT8_MIN)
        COUNT_TYPE(SNOW_TYPE_UINT8, uint8_t, 0)
        COUNT_TYPE(SNOW_TYPE_INT16, int16_t, INT16_MIN)
        COUNT_TYPE(SNOW_TYPE_UINT16, uint16_t, 0)
    default:
        break;
    }
#undef COUNT_TYPE
    return SNOW_STATUS_OK;
}

/* The n-th counted value in the order of data values (reversed if the slope is
 * negative), and its count. */
static uint64_t nth_value(const snow_histogram *histogram, int n,
                          double *value) {
    const snow_volume_info *info = &histogram->volume->info;
    int smallest, place = info->slope < 0 ? DIGITS - 1 - n : n;
    counted_type(info->type, &smallest);
    *value = info->slope * (place + smallest) + info->intercept;
    return histogram->log && !(*value > 0) ? 0 : histogram->counts[place];
}

/* --- the range alone, of 8 and 16 bit types -------------------------------
 */

/* The extremes of native values. */
typedef struct natives {
    bool until_negative; /* data values below 0 end the search */
    bool any, negative;
    int low, high;
} natives;

#define EXTREMES_BLOCK 65536

static void find_extremes(const snow_volume *volume, int64_t first,
                          int64_t count, int *low, int *high) {
#define EXTREMES_TYPE(name, c_type)                                \
    case name: {                                                   \
        const c_type *at = (const c_type *)volume->voxels + first; \
        c_type least = at[0], most = at[0];                        \
        for (int64_t n = 1; n < count; n++) {                      \
            least = at[n] < least ? at[n] : least;                 \
            most = at[n] > most ? at[n] : most;                    \
        }                                                          \
        *low = least;                                              \
        *high = most;                                              \
        break;                                                     \
    }
    switch (volume->info.type) {
        EXTREMES_TYPE(SNOW_TYPE_INT8, int8_t)
        EXTREMES_TYPE(SNOW_TYPE_UINT8, uint8_t)
        EXTREMES_TYPE(SNOW_TYPE_INT16, int16_t)
        EXTREMES_TYPE(SNOW_TYPE_UINT16, uint16_t)
    default:
        break;
    }
#undef EXTREMES_TYPE
}

static double data_value(const snow_volume *volume, int native) {
    return volume->info.slope * native + volume->info.intercept;
}

static void join_extremes(const snow_volume *volume, int64_t first,
                          int64_t count, natives *n) {
    int low = 0, high = 0;
    find_extremes(volume, first, count, &low, &high);
    n->low = n->any && n->low < low ? n->low : low;
    n->high = n->any && n->high > high ? n->high : high;
    n->any = true;
    n->negative =
        data_value(volume, n->low) < 0 || data_value(volume, n->high) < 0;
}

/* Of the voxels that a volume answers for; `user` are natives. */
static snow_status measure_natives(const snow_volume *volume, void *user) {
    natives *n = user;
    walk w = walk_begin(volume, false, SNOW_HISTOGRAM_EXACT);
    while (next_run(&w))
        for (uint64_t at = w.at; at < w.end; at += EXTREMES_BLOCK) {
            uint64_t left = w.end - at;
            if (n->until_negative && n->negative)
                return SNOW_STATUS_OK;
            join_extremes(
                volume, (int64_t)at + w.ahead,
                left < EXTREMES_BLOCK ? (int64_t)left : EXTREMES_BLOCK, n);
        }
    return SNOW_STATUS_OK;
}

/* Data values rise or fall with natives, so that their extremes are those of
 * the natives.  *found is false where the smallest and largest value that count
 * (finite, and above 0 on a logarithmic scale) are others. */
static snow_status find_range(snow_histogram *histogram, bool *found) {
    const snow_volume *volume = histogram->volume;
    natives n = {.until_negative = histogram->need == SNOW_NEED_SIGN};
    *found = false;
    SNOW_TRY(each_slab(histogram, SNOW_HISTOGRAM_EXACT, measure_natives, &n));
    double low = data_value(volume, n.low), high = data_value(volume, n.high);
    if (!n.any || !isfinite(low) || !isfinite(high))
        return SNOW_STATUS_OK;
    histogram->min = low < high ? low : high;
    histogram->max = low < high ? high : low;
    histogram->finite = 1;
    *found = !histogram->log || histogram->min > 0;
    return SNOW_STATUS_OK;
}

/* --- the counts of these types --------------------------------------------
 */

static void measure_counts(snow_histogram *histogram) {
    for (int n = 0; n < DIGITS; n++) {
        double value;
        uint64_t count = nth_value(histogram, n, &value);
        if (!count || !isfinite(value))
            continue;
        if (!histogram->finite) {
            histogram->min = value;
            histogram->at_min = count;
        }
        histogram->max = value;
        histogram->finite += count;
    }
}

static double counted_quantile(const snow_histogram *histogram, uint64_t rank) {
    for (int n = 0; n < DIGITS; n++) {
        double value;
        uint64_t count = nth_value(histogram, n, &value);
        if (!isfinite(value))
            continue;
        if (rank < count)
            return value;
        rank -= count;
    }
    return histogram->max;
}

/* --- all types -------------------------------------------------------------
 */

/* Allocates the sample of a volume that stays in its file, with no more than a
 * quarter of what the limit leaves; without it passes read the file.  Every
 * pass reads rows no longer than two samples completely. */
static void make_sample(snow_histogram *histogram) {
    const snow_volume *volume = histogram->volume;
    snow_context *context = volume->context;
    const int64_t *dims = volume->info.dims;
    if (!volume->stream)
        return;
    walk w = walk_begin(volume, false, SNOW_HISTOGRAM_SAMPLED);
    uint64_t all = (uint64_t)(dims[0] * dims[1] * dims[2]);
    uint64_t rest = all % w.stride < BLOCK ? all % w.stride : BLOCK;
    uint64_t count = all / w.stride * BLOCK + rest;
    uint64_t bytes = count * snow_type_size(volume->info.type);
    if (context->limit && (context->bytes > context->limit ||
                           bytes > (context->limit - context->bytes) / 4))
        return;
    snow_volume_info info = volume->info;
    info.dims[0] = (int64_t)count;
    info.dims[1] = info.dims[2] = 1;
    if (snow_volume_new(context, &info, &histogram->sample) != SNOW_STATUS_OK)
        histogram->sample = NULL;
}

/* Adds to the sample what a sampled pass sees of a slab; it has `at` voxels
 * already. */
static void keep_sample(const snow_volume *slab, const snow_volume *sample,
                        uint64_t *at) {
    size_t count, size = snow_type_size(slab->info.type);
    int64_t first = 0;
    walk w = walk_begin(slab, false, SNOW_HISTOGRAM_SAMPLED);
    while ((count = next_voxels(&w, &first))) {
        memcpy((char *)sample->owned + *at * size,
               (const char *)slab->voxels + (uint64_t)first * size,
               count * size);
        *at += count;
    }
}

/* The state of measuring a volume. */
typedef struct measuring {
    snow_histogram *histogram;
    uint64_t sampled; /* number of voxels */
} measuring;

/* `user` points to a measuring. */
static snow_status measure_values(const snow_volume *slab, void *user) {
    measuring *m = user;
    snow_histogram *histogram = m->histogram;
    double values[BLOCK];
    size_t count;
    walk w = walk_begin(slab, histogram->log, SNOW_HISTOGRAM_EXACT);
    if (histogram->sample)
        keep_sample(slab, histogram->sample, &m->sampled);
    while ((count = next_block(&w, values))) {
        for (size_t i = 0; i < count; i++) {
            double value = values[i];
            if (!isfinite(value))
                continue;
            if (!histogram->finite++)
                histogram->min = histogram->max = value;
            if (value < histogram->min) {
                histogram->min = value;
                histogram->at_min = 0;
            }
            histogram->at_min += value == histogram->min;
            if (value > histogram->max)
                histogram->max = value;
        }
    }
    return SNOW_STATUS_OK;
}

/* Joins the results of all ranks; one without a finite voxel does not count. */
static snow_status join_measures(snow_histogram *histogram) {
    if (!histogram->comm)
        return SNOW_STATUS_OK;
    double ends[2] = {INFINITY, INFINITY};
    if (histogram->finite) {
        ends[0] = histogram->min;
        ends[1] = -histogram->max;
    }
    SNOW_TRY(snow_comm_reduce_doubles(histogram->comm, ends, 2, SNOW_MIN));
    uint64_t counts[2] = {histogram->finite, 0};
    if (histogram->finite && histogram->min == ends[0])
        counts[1] = histogram->at_min;
    SNOW_TRY(sum_up(histogram, counts, 2));
    if (counts[0]) {
        histogram->min = ends[0];
        histogram->max = -ends[1];
        histogram->finite = counts[0];
        histogram->at_min = counts[1];
    }
    return SNOW_STATUS_OK;
}

/* Ranks agree that each has a table before they count. */
static snow_status count_all(snow_histogram *histogram) {
    histogram->counts = snow_allocate_clear(histogram->volume->context,
                                            DIGITS * sizeof *histogram->counts);
    SNOW_TRY(agree(histogram,
                   histogram->counts ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY));
    SNOW_TRY(each_slab(histogram, SNOW_HISTOGRAM_EXACT, count_natives,
                       histogram->counts));
    SNOW_TRY(sum_up_table(histogram, histogram->counts));
    measure_counts(histogram);
    return SNOW_STATUS_OK;
}

/* Stores the range for modes other than over (render/modes/modes.c), which
 * spares them a pass. */
static void note_range(const snow_histogram *histogram) {
    const int64_t *dims = histogram->volume->info.dims;
    const snow_volume_statistics range = {.voxels = dims[0] * dims[1] * dims[2],
                                          .finite = (int64_t)histogram->finite,
                                          .min = histogram->min,
                                          .max = histogram->max};
    if (histogram->volume->stream && !histogram->log)
        snow_stream_note_range(histogram->volume, &range);
}

/* What is not known by less is counted; ranks count always. */
static snow_status count_as_needed(snow_histogram *histogram) {
    bool found = false;
    if (!histogram->comm && histogram->need < SNOW_NEED_COUNTS)
        SNOW_TRY(find_range(histogram, &found));
    if (found)
        return SNOW_STATUS_OK;
    histogram->need = SNOW_NEED_COUNTS;
    histogram->finite = 0;
    histogram->min = histogram->max = NAN;
    return count_all(histogram);
}

snow_status snow_histogram_new(const snow_volume *volume, snow_comm *comm,
                               bool log, snow_histogram_need need,
                               snow_histogram *out) {
    snow_histogram histogram = {.need = need,
                                .volume = volume,
                                .comm = comm,
                                .min = NAN,
                                .max = NAN,
                                .log = log};
    int smallest;
    snow_status status;
    if (need == SNOW_NEED_NOTHING) {
        *out = histogram;
        return SNOW_STATUS_OK;
    }
    if (counted_type(volume->info.type, &smallest))
        status = count_as_needed(&histogram);
    else {
        histogram.need = SNOW_NEED_COUNTS;
        measuring m = {&histogram, 0};
        make_sample(&histogram);
        status =
            each_slab(&histogram, SNOW_HISTOGRAM_EXACT, measure_values, &m);
        if (status == SNOW_STATUS_OK)
            status = join_measures(&histogram);
    }
    if (status != SNOW_STATUS_OK) {
        snow_histogram_free(&histogram);
        return status;
    }
    /* Makes a zero positive: which sign is found first is chance. */
    histogram.min += 0.0;
    histogram.max += 0.0;
    if (histogram.need == SNOW_NEED_COUNTS)
        note_range(&histogram);
    *out = histogram;
    return SNOW_STATUS_OK;
}

void snow_histogram_free(snow_histogram *histogram) {
    snow_volume_close(histogram->sample);
    snow_release(histogram->volume->context, histogram->counts);
}

/* The bin of a value; -1 outside. */
static int bin_of(bool log, double value, double low, double high, int bins) {
    if (!(value >= low && value <= high))
        return -1;
    int bin = (int)(snow_share_on(log, low, high, value) * bins);
    return bin < bins ? bin : bins - 1;
}

/* The state of counting bins. */
typedef struct bin_count {
    bool log;
    double low, high;
    int bins;
    uint64_t *counts, all;
} bin_count;

/* `user` points to a bin_count. */
static snow_status count_sampled(const snow_volume *slab, void *user) {
    bin_count *b = user;
    double values[BLOCK];
    size_t got;
    walk w = walk_begin(slab, b->log, SNOW_HISTOGRAM_SAMPLED);
    while ((got = next_block(&w, values)))
        for (size_t i = 0; i < got; i++) {
            int bin = bin_of(b->log, values[i], b->low, b->high, b->bins);
            b->all += isfinite(values[i]) != 0;
            if (bin >= 0)
                b->counts[bin]++;
        }
    return SNOW_STATUS_OK;
}

snow_status snow_count_bins(const snow_histogram *histogram, double low,
                            double high, int bins, uint64_t *counts,
                            uint64_t *all) {
    memset(counts, 0, (size_t)bins * sizeof *counts);
    if (!histogram->counts) {
        bin_count b = {histogram->log, low, high, bins, counts, 0};
        SNOW_TRY(
            each_slab(histogram, SNOW_HISTOGRAM_SAMPLED, count_sampled, &b));
        *all = b.all;
        SNOW_TRY(sum_up(histogram, counts, (size_t)bins));
        return sum_up(histogram, all, 1);
    }
    for (int n = 0; n < DIGITS; n++) {
        double value;
        uint64_t count = nth_value(histogram, n, &value);
        int bin = count ? bin_of(histogram->log, value, low, high, bins) : -1;
        if (bin >= 0)
            counts[bin] += count;
    }
    *all = histogram->finite;
    return SNOW_STATUS_OK;
}

/* A key with the order of doubles: all bits of negative numbers are inverted,
 * of others the sign bit; -0 counts as 0. */
static uint64_t key_of(double value) {
    uint64_t bits;
    value += 0.0;
    memcpy(&bits, &value, sizeof bits);
    return bits >> 63 ? ~bits : bits | UINT64_C(1) << 63;
}

static double value_of(uint64_t key) {
    uint64_t bits = key >> 63 ? key ^ UINT64_C(1) << 63 : ~key;
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* The search for one quantile: the bits found so far, and its rank among the
 * values that share them. */
typedef struct search {
    uint64_t prefix;
    uint64_t rank; /* from 0 */
    uint64_t *counts;
} search;

/* The counts of one digit for several searches. */
typedef struct digit_count {
    bool log;
    snow_histogram_mode histogram_mode;
    search *searches;
    size_t count;
    int shift;    /* of the digit */
    uint64_t all; /* number of all values */
} digit_count;

/* Counts the next digit of all values that begin with a search's prefix; `user`
 * points to a digit_count. */
static snow_status count_digits(const snow_volume *slab, void *user) {
    digit_count *d = user;
    double values[BLOCK];
    int shift = d->shift;
    uint64_t above =
        shift + DIGIT_BITS < 64 ? ~UINT64_C(0) << (shift + DIGIT_BITS) : 0;
    size_t got;
    walk w = walk_begin(slab, d->log, d->histogram_mode);
    while ((got = next_block(&w, values))) {
        for (size_t i = 0; i < got; i++) {
            if (!isfinite(values[i]))
                continue;
            uint64_t key = key_of(values[i]);
            d->all++;
            for (size_t n = 0; n < d->count; n++)
                if ((key & above) == d->searches[n].prefix)
                    d->searches[n].counts[key >> shift & (DIGITS - 1)]++;
        }
    }
    return SNOW_STATUS_OK;
}

static void take_digit(search *s, int shift) {
    uint64_t digit = 0;
    while (s->rank >= s->counts[digit])
        s->rank -= s->counts[digit++];
    s->prefix |= digit << shift;
}

/* The rank, from 0, of the value that is not exceeded by a share of `all`. */
static uint64_t rank_of(double fraction, uint64_t all) {
    double rank = ceil(fraction * (double)all) - 1;
    if (rank <= 0)
        return 0;
    return rank < (double)(all - 1) ? (uint64_t)rank : all - 1;
}

/* Finds digit after digit; `counts` has a table for each search. */
static snow_status select_digits(const snow_histogram *histogram,
                                 snow_histogram_mode histogram_mode,
                                 const double *fractions, size_t count,
                                 search *searches, uint64_t *counts) {
    for (int shift = 64 - DIGIT_BITS; shift >= 0; shift -= DIGIT_BITS) {
        memset(counts, 0, count * DIGITS * sizeof *counts);
        digit_count d = {histogram->log, histogram_mode, searches,
                         count,          shift,          0};
        SNOW_TRY(each_slab(histogram, histogram_mode, count_digits, &d));
        SNOW_TRY(sum_up(histogram, &d.all, 1));
        for (size_t n = 0; n < count && d.all; n++) {
            SNOW_TRY(sum_up_table(histogram, searches[n].counts));
            if (shift == 64 - DIGIT_BITS)
                searches[n].rank = rank_of(fractions[n], d.all);
            take_digit(&searches[n], shift);
        }
    }
    return SNOW_STATUS_OK;
}

static snow_status select_keys(const snow_histogram *histogram,
                               snow_histogram_mode histogram_mode,
                               const double *fractions, size_t count,
                               double *out) {
    snow_context *context = histogram->volume->context;
    search searches[SNOW_QUANTILES_MOST] = {{0}};
    uint64_t *counts = snow_allocate(context, count * DIGITS * sizeof *counts);
    snow_status status =
        agree(histogram, counts ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY);
    for (size_t n = 0; n < count && counts; n++)
        searches[n].counts = counts + n * DIGITS;
    if (status == SNOW_STATUS_OK)
        status = select_digits(histogram, histogram_mode, fractions, count,
                               searches, counts);
    for (size_t n = 0; n < count && status == SNOW_STATUS_OK; n++)
        out[n] = value_of(searches[n].prefix);
    snow_release(context, counts);
    return status;
}

snow_status snow_quantiles(const snow_histogram *histogram,
                           snow_histogram_mode histogram_mode,
                           const double *fractions, size_t count, double *out) {
    if (!histogram->counts)
        return select_keys(histogram, histogram_mode, fractions, count, out);
    for (size_t n = 0; n < count; n++)
        out[n] = counted_quantile(histogram,
                                  rank_of(fractions[n], histogram->finite));
    return SNOW_STATUS_OK;
}
