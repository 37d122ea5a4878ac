/* encode/shear_warp/encode_steps.c - an encoding is made step by step, and a
 * step item by item: all at once, or some bands at a time. */
#include "encode/shear_warp/encode.h"

#include "base/thread_pool.h"

#include <stdatomic.h>
#include <string.h>

typedef struct store_job {
    snow_value_store *store;
    const snow_value_store_params *params;
    size_t scratch_bytes; /* of a thread */
    atomic_int failed;    /* the last failure's snow_status */
} store_job;

static void *scratch_of(const store_job *job, int worker) {
    return job->store->scratch + (size_t)worker * job->scratch_bytes;
}

/* Words of the masks that are cleared at once: 2 MB. */
#define CLEARED ((size_t)1 << 19)

static void clear_item(void *of, int64_t item, int worker) {
    const store_job *job = of;
    const snow_value_store *s = job->store;
    const size_t first = (size_t)item * CLEARED;
    const size_t left = snow_value_masks_words(s) - first;
    (void)worker;
    memset(s->masks + first, 0,
           (left < CLEARED ? left : CLEARED) * sizeof *s->masks);
}

static void cells_item(void *of, int64_t band, int worker) {
    const store_job *job = of;
    snow_value_cells_band(job->store, job->params, band, worker,
                          scratch_of(job, worker));
}

static void coarse_item(void *of, int64_t eight, int worker) {
    const store_job *job = of;
    (void)worker;
    snow_value_cells_coarse(job->store, eight);
}

static void active_item(void *of, int64_t band, int worker) {
    store_job *job = of;
    const snow_status status = snow_value_active_band(
        job->store, job->params, band, worker, scratch_of(job, worker));
    if (status != SNOW_STATUS_OK)
        atomic_store(&job->failed, (int)status);
}

static void measure_item(void *of, int64_t band, int worker) {
    const store_job *job = of;
    snow_value_rows_measure(job->store, band, scratch_of(job, worker));
}

static void fill_item(void *of, int64_t band, int worker) {
    const store_job *job = of;
    snow_value_rows_fill(job->store, band, scratch_of(job, worker));
}

static void border_item(void *of, int64_t slice, int worker) {
    const store_job *job = of;
    (void)worker;
    snow_value_rows_border(job->store, slice);
}

/* Scratch for whichever step takes most. */
static snow_status reserve_scratch(store_job *job) {
    snow_value_store *s = job->store;
    size_t most = ((size_t)s->columns / 2 + 2) * sizeof(snow_span);
    size_t cells = snow_value_cells_bytes(s, job->params);
    size_t active = s->in_place ? 0 : snow_value_active_bytes(s, job->params);
    most = cells > most ? cells : most;
    most = active > most ? active : most;
    job->scratch_bytes = snow_align(most);
    return SNOW_RESERVE(s->context, s->scratch, 0,
                        job->scratch_bytes * (size_t)job->params->threads);
}

/* By the cells of every eighth slice that no run hides, and how many intervals
 * of them there are. */
static snow_encoding choose(const snow_value_store *s) {
    uint64_t cells = 0, intervals = 0, slices = 0;
    const size_t size = s->mask_words * s->mask_rows;
    for (int64_t slice = s->slices / 2 % 8; slice < s->slices;
         slice += 8, slices++)
        for (size_t n = 0; n < size; n++) {
            uint32_t mask = ~UINT32_C(0);
            for (int interval = 0; interval < s->interval_count; interval++)
                mask &= s->masks[snow_value_mask_at(s, interval, slice) + n];
            cells += (uint64_t)__builtin_popcount(mask);
            intervals += (uint64_t)__builtin_popcount(mask & ~(mask << 1));
        }
    return snow_encoding_choose((uint64_t)(s->columns * s->rows) * slices,
                                cells, intervals);
}

/* --- the steps ------------------------------------------------------------ */

static int64_t count_clears(const snow_value_store *s) {
    return (int64_t)((snow_value_masks_words(s) + CLEARED - 1) / CLEARED);
}
static int64_t count_bands(const snow_value_store *s) {
    return s->band_count;
}
static int64_t count_eights(const snow_value_store *s) {
    return s->eight_count;
}
static int64_t count_slices(const snow_value_store *s) {
    return s->slices;
}

static snow_status choose_encoding(store_job *job) {
    snow_value_store *s = job->store;
    const snow_encoding asked = job->params->encoding;
    s->encoding = asked == SNOW_ENCODING_AUTO ? choose(s) : asked;
    return SNOW_STATUS_OK;
}

static snow_status place_rows(store_job *job) {
    return snow_value_rows_place(job->store);
}

/* What is made one after the other.  In place, the masks are all. */
static const struct store_step {
    int64_t (*count)(const snow_value_store *store); /* items */
    snow_work_fn *work;
    snow_status (*before)(store_job *job); /* may be NULL */
    bool quick;                            /* is not worth being divided */
} steps[] = {
    {count_clears, clear_item, NULL, false},
    {count_bands, cells_item, NULL, false},
    {count_eights, coarse_item, NULL, true},
    {count_bands, active_item, choose_encoding, false},
    {count_bands, measure_item, NULL, true},
    {count_bands, fill_item, place_rows, false},
    {count_slices, border_item, NULL, true},
};

static int count_steps(const snow_value_store *s) {
    return s->in_place ? 3 : (int)(sizeof steps / sizeof *steps);
}

int64_t snow_value_store_left(const snow_value_store *s) {
    int64_t left = 0;
    for (int n = s->step; n < count_steps(s); n++)
        left += steps[n].quick ? 0 : steps[n].count(s);
    return left > s->made ? left - s->made : 0;
}

typedef struct store_part {
    store_job *job;
    snow_work_fn *work;
    int64_t first;
} store_part;

static void part_item(void *of, int64_t item, int worker) {
    const store_part *part = of;
    part->work(part->job, part->first + item, worker);
}

/* Up to so many items of the step that the store is at. */
static snow_status make_items(store_job *job, int64_t most) {
    snow_value_store *s = job->store;
    const struct store_step *step = &steps[s->step];
    const int threads = job->params->threads;
    int64_t items = step->count(s) - s->made;
    store_part part = {job, step->work, s->made};
    if (s->made == 0 && step->before)
        SNOW_TRY(step->before(job));
    if (!step->quick && items > most)
        items = most;
    SNOW_TRY(snow_parallel(s->context, threads < items ? threads : (int)items,
                           items, part_item, &part));
    SNOW_TRY((snow_status)atomic_load(&job->failed));
    s->made += items;
    if (s->made < step->count(s))
        return SNOW_STATUS_OK;
    s->step++;
    s->made = 0;
    return SNOW_STATUS_OK;
}

snow_status snow_value_store_go_on(snow_value_store *s,
                                   const snow_value_store_params *params,
                                   int64_t bands) {
    store_job job = {.store = s, .params = params};
    const int end = count_steps(s);
    atomic_init(&job.failed, SNOW_STATUS_OK);
    SNOW_TRY(reserve_scratch(&job));
    const int64_t until = snow_value_store_left(s) - bands;
    while (s->step < end &&
           (steps[s->step].quick || snow_value_store_left(s) > until))
        SNOW_TRY(make_items(&job, snow_value_store_left(s) - until));
    if (s->step == end)
        snow_value_store_add_up(s);
    return SNOW_STATUS_OK;
}

snow_status snow_value_store_encode(snow_value_store *s,
                                    const snow_value_store_params *params) {
    snow_monitor *monitor = s->context->monitor;
    SNOW_TRY(snow_value_store_begin(s, params));
    snow_monitor_next(monitor, SNOW_STAGE_ENCODE, 0, 0.1);
    SNOW_TRY(snow_value_store_go_on(s, params, count_clears(s)));
    snow_monitor_next(monitor, SNOW_STAGE_ENCODE, 0.1, 0.5);
    SNOW_TRY(snow_value_store_go_on(s, params, s->band_count));
    snow_monitor_next(monitor, SNOW_STAGE_ENCODE, 0.5, 1);
    return snow_value_store_go_on(s, params, snow_value_store_left(s));
}
