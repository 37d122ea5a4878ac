/* classify/census.c - how often values occur, exact and without a copy of them.
 *
 * 8 and 16 bit voxels are counted once by their native value, and all else is
 * read from these counts.  For other types doubles are turned to 64-bit keys of
 * the same order and the wanted one is found 16 bits at a time, most
 * significant first, by counting (radix selection): four passes over the voxels
 * whatever the range of values, which equal bins could not do for data from
 * 1e-3 to 1e38.
 *
 * Everything that is said of a volume is a count, a minimum or a maximum.  Many
 * ranks find them each of the voxels that it answers for, add them up, and know
 * the same of the whole to the bit as one rank would, however it is cut.  So it
 * is of slabs of a volume that stays in its file (volume/stream.h), which each
 * pass reads anew; but what sampled passes read is kept of the first one, where
 * there is memory for it. */
#include "classify/look.h"
#include "volume/stream.h"

#include <math.h>
#include <string.h>

#define BLOCK 1024
#define DIGIT_BITS 16
#define DIGITS (1 << DIGIT_BITS)

/* Voxels that a sampled pass reads at least, when there are as many. */
#define SAMPLE (INT64_C(1) << 24)

/* A walk over the voxels that this rank answers for, in the order of the whole
 * volume, in runs that have no gap there. */
typedef struct walk {
    const snow_volume *volume;
    bool log;        /* what is not above 0 is made NaN */
    snow_window box; /* of the whole, in voxels */
    int64_t stored[3];
    int64_t runs, run; /* all; the next one */
    uint64_t at, end;  /* of the run that is walked: voxels of the whole */
    int64_t ahead;     /* from a voxel of the whole to the same one in memory */
    uint64_t stride;   /* from one sampled block of the whole to the next */
} walk;

static walk walk_begin(const snow_volume *volume, bool log,
                       snow_effort effort) {
    snow_part part;
    snow_volume_get_part(volume, &part);
    walk w = {.volume = volume, .log = log, .box = {.value = 1}};
    memcpy(w.stored, part.stored, sizeof w.stored);
    memcpy(w.box.dims, part.dims, sizeof w.box.dims);
    memcpy(w.box.first, part.first, sizeof w.box.first);
    memcpy(w.box.count, part.count, sizeof w.box.count);
    if (part.count[0] && part.count[1] && part.count[2])
        w.runs = snow_window_runs(&w.box);
    int64_t skip = part.dims[0] * part.dims[1] * part.dims[2] / SAMPLE;
    w.stride = BLOCK;
    if (effort == SNOW_SAMPLED && skip > 1)
        w.stride *= (uint64_t)skip;
    return w;
}

/* A run is one in memory too: what spans whole rows or slices of the volume is
 * stored with nothing between them. */
static bool next_run(walk *w) {
    if (w->run == w->runs)
        return false;
    const int64_t *dims = w->box.dims, *own = w->volume->info.dims;
    snow_window_run(&w->box, w->run++, &w->at, &w->end);
    int64_t row = (int64_t)w->at / dims[0], x = (int64_t)w->at % dims[0];
    int64_t y = row % dims[1] - w->stored[1], z = row / dims[1] - w->stored[2];
    w->ahead = (z * own[1] + y) * own[0] + x - w->stored[0] - (int64_t)w->at;
    return true;
}

/* Up to BLOCK voxels that a sampled block of the whole has of a run: how many,
 * 0 at the end, and the place in memory of the first one. */
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

/* One pass over all slabs of a volume, each of which is walked by itself, or
 * over the sample.  Many ranks have their voxels in memory, where it cannot
 * fail. */
static snow_status each_slab(const snow_census *census, snow_effort effort,
                             snow_slab_fn *visit, void *user) {
    static const snow_slab_cut cut = {.step = 1};
    if (effort == SNOW_SAMPLED && census->sample)
        return visit(census->sample, user);
    return snow_slabs_visit(census->volume, &cut, visit, user);
}

/* Adds up what all ranks have counted. */
static snow_status sum_up(const snow_census *census, uint64_t *counts,
                          size_t count) {
    if (!census->comm)
        return SNOW_OK;
    return snow_comm_reduce_ints(census->comm, (int64_t *)counts, count,
                                 SNOW_SUM);
}

/* The same for a table of DIGITS counts, of which most are seldom used: only
 * those between the first and the last one that any rank has are sent. */
static snow_status sum_up_table(const snow_census *census, uint64_t *counts) {
    int64_t ends[2] = {0, 1 - DIGITS}; /* the first; the last, negative */
    if (!census->comm)
        return SNOW_OK;
    while (ends[0] < DIGITS && !counts[ends[0]])
        ends[0]++;
    while (ends[1] < 0 && !counts[-ends[1]])
        ends[1]++;
    SNOW_TRY(snow_comm_reduce_ints(census->comm, ends, 2, SNOW_MIN));
    if (ends[0] == DIGITS)
        return SNOW_OK;
    return sum_up(census, counts + ends[0], (size_t)(1 - ends[1] - ends[0]));
}

static snow_status agree(const snow_census *census, snow_status status) {
    return census->comm ? snow_comm_agree(census->comm, status) : status;
}

/* --- 8 and 16 bit types ----------------------------------------------------
 */

/* The smallest value of a counted type; false for the others. */
static bool counted_type(snow_type type, int *smallest) {
    *smallest = type == SNOW_INT8    ? INT8_MIN
                : type == SNOW_INT16 ? INT16_MIN
                                     : 0;
    return type == SNOW_INT8 || type == SNOW_UINT8 || type == SNOW_INT16 ||
           type == SNOW_UINT16;
}

/* Bytes that are looked at together. */
#define EVEN 32

/* Whether so many bytes are copies of one value of `size` bytes, 1 or 2: what
 * is empty mostly is, and one count that is raised again and again is slow. */
static bool is_even(const void *bytes, size_t size) {
    uint64_t words[EVEN / sizeof(uint64_t)];
    memcpy(words, bytes, sizeof words);
    uint64_t turned = words[0] << 8 * size | words[0] >> (64 - 8 * size);
    uint64_t differ = words[0] ^ turned;
    for (size_t n = 1; n < sizeof words / sizeof *words; n++)
        differ |= words[0] ^ words[n];
    return !differ;
}

/* `user` are the counts. */
static snow_status count_natives(const snow_volume *volume, void *user) {
    uint64_t *counts = user;
    walk w = walk_begin(volume, false, SNOW_EXACT);
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
        COUNT_TYPE(SNOW_INT8, int8_t, INT8_MIN)
        COUNT_TYPE(SNOW_UINT8, uint8_t, 0)
        COUNT_TYPE(SNOW_INT16, int16_t, INT16_MIN)
        COUNT_TYPE(SNOW_UINT16, uint16_t, 0)
    default:
        break;
    }
#undef COUNT_TYPE
    return SNOW_OK;
}

/* The n-th counted value in the order of data values (a negative slope turns
 * that of natives), and its count. */
static uint64_t nth_value(const snow_census *census, int n, double *value) {
    const snow_volume_info *info = &census->volume->info;
    int smallest, place = info->slope < 0 ? DIGITS - 1 - n : n;
    counted_type(info->type, &smallest);
    *value = info->slope * (place + smallest) + info->intercept;
    return census->log && !(*value > 0) ? 0 : census->counts[place];
}

static void measure_counts(snow_census *census) {
    for (int n = 0; n < DIGITS; n++) {
        double value;
        uint64_t count = nth_value(census, n, &value);
        if (!count || !isfinite(value))
            continue;
        if (!census->finite) {
            census->min = value;
            census->at_min = count;
        }
        census->max = value;
        census->finite += count;
    }
}

static double counted_quantile(const snow_census *census, uint64_t rank) {
    for (int n = 0; n < DIGITS; n++) {
        double value;
        uint64_t count = nth_value(census, n, &value);
        if (!isfinite(value))
            continue;
        if (rank < count)
            return value;
        rank -= count;
    }
    return census->max;
}

/* --- all types -------------------------------------------------------------
 */

/* Room for the sample of a volume that stays in its file, and no more than a
 * quarter of what a limit leaves; where there is none passes read the file.  A
 * row that is no longer than two samples is walked wholly by any pass. */
static void make_sample(snow_census *census) {
    const snow_volume *volume = census->volume;
    snow_context *context = volume->context;
    const int64_t *dims = volume->info.dims;
    if (!volume->stream)
        return;
    walk w = walk_begin(volume, false, SNOW_SAMPLED);
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
    if (snow_volume_new(context, &info, &census->sample) != SNOW_OK)
        census->sample = NULL;
}

/* What a sampled pass sees of a slab goes to the sample, `at` voxels of which
 * are there.  */
static void keep_sample(const snow_volume *slab, const snow_volume *sample,
                        uint64_t *at) {
    size_t count, size = snow_type_size(slab->info.type);
    int64_t first = 0;
    walk w = walk_begin(slab, false, SNOW_SAMPLED);
    while ((count = next_voxels(&w, &first))) {
        memcpy((char *)sample->owned + *at * size,
               (const char *)slab->voxels + (uint64_t)first * size,
               count * size);
        *at += count;
    }
}

/* A census in the making. */
typedef struct measuring {
    snow_census *census;
    uint64_t sampled; /* voxels */
} measuring;

/* `user` is a measuring. */
static snow_status measure_values(const snow_volume *slab, void *user) {
    measuring *m = user;
    snow_census *census = m->census;
    double values[BLOCK];
    size_t count;
    walk w = walk_begin(slab, census->log, SNOW_EXACT);
    if (census->sample)
        keep_sample(slab, census->sample, &m->sampled);
    while ((count = next_block(&w, values))) {
        for (size_t i = 0; i < count; i++) {
            double value = values[i];
            if (!isfinite(value))
                continue;
            if (!census->finite++)
                census->min = census->max = value;
            if (value < census->min) {
                census->min = value;
                census->at_min = 0;
            }
            census->at_min += value == census->min;
            if (value > census->max)
                census->max = value;
        }
    }
    return SNOW_OK;
}

/* What all ranks have measured; one without a finite voxel has no say. */
static snow_status join_measures(snow_census *census) {
    if (!census->comm)
        return SNOW_OK;
    double ends[2] = {INFINITY, INFINITY};
    if (census->finite) {
        ends[0] = census->min;
        ends[1] = -census->max;
    }
    SNOW_TRY(snow_comm_reduce_doubles(census->comm, ends, 2, SNOW_MIN));
    uint64_t counts[2] = {census->finite, 0};
    if (census->finite && census->min == ends[0])
        counts[1] = census->at_min;
    SNOW_TRY(sum_up(census, counts, 2));
    if (counts[0]) {
        census->min = ends[0];
        census->max = -ends[1];
        census->finite = counts[0];
        census->at_min = counts[1];
    }
    return SNOW_OK;
}

/* Ranks agree that each has a table before they count. */
static snow_status count_all(snow_census *census) {
    census->counts = snow_allocate_clear(census->volume->context,
                                         DIGITS * sizeof *census->counts);
    SNOW_TRY(agree(census, census->counts ? SNOW_OK : SNOW_NO_MEMORY));
    SNOW_TRY(each_slab(census, SNOW_EXACT, count_natives, census->counts));
    SNOW_TRY(sum_up_table(census, census->counts));
    measure_counts(census);
    return SNOW_OK;
}

/* What modes other than over ask for (modes.c): it spares them a reading. */
static void note_range(const snow_census *census) {
    const int64_t *dims = census->volume->info.dims;
    const snow_volume_measures range = {.voxels = dims[0] * dims[1] * dims[2],
                                        .finite = (int64_t)census->finite,
                                        .min = census->min,
                                        .max = census->max};
    if (census->volume->stream && !census->log)
        snow_stream_note_range(census->volume, &range);
}

snow_status snow_census_new(const snow_volume *volume, snow_comm *comm,
                            bool log, snow_census *out) {
    snow_census census = {
        .volume = volume, .comm = comm, .min = NAN, .max = NAN, .log = log};
    int smallest;
    snow_status status;
    if (counted_type(volume->info.type, &smallest))
        status = count_all(&census);
    else {
        measuring m = {&census, 0};
        make_sample(&census);
        status = each_slab(&census, SNOW_EXACT, measure_values, &m);
        if (status == SNOW_OK)
            status = join_measures(&census);
    }
    if (status != SNOW_OK) {
        snow_census_free(&census);
        return status;
    }
    /* Of zeros of both signs it is chance which one was met first. */
    census.min += 0.0;
    census.max += 0.0;
    note_range(&census);
    *out = census;
    return SNOW_OK;
}

void snow_census_free(snow_census *census) {
    snow_volume_close(census->sample);
    snow_release(census->volume->context, census->counts);
}

/* Which bin a value falls into; -1 outside. */
static int bin_of(bool log, double value, double low, double high, int bins) {
    if (!(value >= low && value <= high))
        return -1;
    int bin = (int)(snow_share_on(log, low, high, value) * bins);
    return bin < bins ? bin : bins - 1;
}

/* A histogram in the making. */
typedef struct bin_count {
    bool log;
    double low, high;
    int bins;
    uint64_t *counts, all;
} bin_count;

/* `user` is a bin_count. */
static snow_status count_sampled(const snow_volume *slab, void *user) {
    bin_count *b = user;
    double values[BLOCK];
    size_t got;
    walk w = walk_begin(slab, b->log, SNOW_SAMPLED);
    while ((got = next_block(&w, values)))
        for (size_t i = 0; i < got; i++) {
            int bin = bin_of(b->log, values[i], b->low, b->high, b->bins);
            b->all += isfinite(values[i]) != 0;
            if (bin >= 0)
                b->counts[bin]++;
        }
    return SNOW_OK;
}

snow_status snow_count_bins(const snow_census *census, double low, double high,
                            int bins, uint64_t *counts, uint64_t *all) {
    memset(counts, 0, (size_t)bins * sizeof *counts);
    if (!census->counts) {
        bin_count b = {census->log, low, high, bins, counts, 0};
        SNOW_TRY(each_slab(census, SNOW_SAMPLED, count_sampled, &b));
        *all = b.all;
        SNOW_TRY(sum_up(census, counts, (size_t)bins));
        return sum_up(census, all, 1);
    }
    for (int n = 0; n < DIGITS; n++) {
        double value;
        uint64_t count = nth_value(census, n, &value);
        int bin = count ? bin_of(census->log, value, low, high, bins) : -1;
        if (bin >= 0)
            counts[bin] += count;
    }
    *all = census->finite;
    return SNOW_OK;
}

/* A key with the order of doubles: negative ones have all bits turned, others
 * the sign bit; -0 counts as 0. */
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

/* One wanted value: the bits found so far, and its rank among those that
 * share them. */
typedef struct search {
    uint64_t prefix;
    uint64_t rank; /* from 0 */
    uint64_t *counts;
} search;

/* One digit of several searches. */
typedef struct digit_count {
    bool log;
    snow_effort effort;
    search *searches;
    size_t count;
    int shift;    /* of the digit */
    uint64_t all; /* values that were looked at */
} digit_count;

/* Counts the next digit of all values that begin as a search's prefix does;
 * `user` is a digit_count. */
static snow_status count_digits(const snow_volume *slab, void *user) {
    digit_count *d = user;
    double values[BLOCK];
    int shift = d->shift;
    uint64_t above =
        shift + DIGIT_BITS < 64 ? ~UINT64_C(0) << (shift + DIGIT_BITS) : 0;
    size_t got;
    walk w = walk_begin(slab, d->log, d->effort);
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
    return SNOW_OK;
}

static void take_digit(search *s, int shift) {
    uint64_t digit = 0;
    while (s->rank >= s->counts[digit])
        s->rank -= s->counts[digit++];
    s->prefix |= digit << shift;
}

/* The rank from 0 of the value that a share of `all` does not exceed. */
static uint64_t rank_of(double fraction, uint64_t all) {
    double rank = ceil(fraction * (double)all) - 1;
    if (rank <= 0)
        return 0;
    return rank < (double)(all - 1) ? (uint64_t)rank : all - 1;
}

/* Digit after digit; `counts` has a table for each search. */
static snow_status select_digits(const snow_census *census, snow_effort effort,
                                 const double *fractions, size_t count,
                                 search *searches, uint64_t *counts) {
    for (int shift = 64 - DIGIT_BITS; shift >= 0; shift -= DIGIT_BITS) {
        memset(counts, 0, count * DIGITS * sizeof *counts);
        digit_count d = {census->log, effort, searches, count, shift, 0};
        SNOW_TRY(each_slab(census, effort, count_digits, &d));
        SNOW_TRY(sum_up(census, &d.all, 1));
        for (size_t n = 0; n < count && d.all; n++) {
            SNOW_TRY(sum_up_table(census, searches[n].counts));
            if (shift == 64 - DIGIT_BITS)
                searches[n].rank = rank_of(fractions[n], d.all);
            take_digit(&searches[n], shift);
        }
    }
    return SNOW_OK;
}

static snow_status select_keys(const snow_census *census, snow_effort effort,
                               const double *fractions, size_t count,
                               double *out) {
    snow_context *context = census->volume->context;
    search searches[SNOW_QUANTILES_MOST] = {{0}};
    uint64_t *counts = snow_allocate(context, count * DIGITS * sizeof *counts);
    snow_status status = agree(census, counts ? SNOW_OK : SNOW_NO_MEMORY);
    for (size_t n = 0; n < count && counts; n++)
        searches[n].counts = counts + n * DIGITS;
    if (status == SNOW_OK)
        status =
            select_digits(census, effort, fractions, count, searches, counts);
    for (size_t n = 0; n < count && status == SNOW_OK; n++)
        out[n] = value_of(searches[n].prefix);
    snow_release(context, counts);
    return status;
}

snow_status snow_quantiles(const snow_census *census, snow_effort effort,
                           const double *fractions, size_t count, double *out) {
    if (!census->counts)
        return select_keys(census, effort, fractions, count, out);
    for (size_t n = 0; n < count; n++)
        out[n] =
            counted_quantile(census, rank_of(fractions[n], census->finite));
    return SNOW_OK;
}
