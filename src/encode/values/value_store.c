/* encode/values/value_store.c - see value_store.h. */
#include "encode/values/value_store.h"

#include "base/thread_pool.h"
#include "encode/values/value_encode.h"

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

static void keep_status(store_job *job, snow_status status) {
    if (status != SNOW_STATUS_OK)
        atomic_store(&job->failed, (int)status);
}

static void cells_item(void *of, int64_t band, int worker) {
    store_job *job = of;
    keep_status(job, snow_value_cells_band(job->store, job->params, band,
                                           worker, scratch_of(job, worker)));
}

static void coarse_item(void *of, int64_t eight, int worker) {
    const store_job *job = of;
    (void)worker;
    snow_value_cells_coarse(job->store, eight);
}

static void shell_item(void *of, int64_t band, int worker) {
    store_job *job = of;
    keep_status(job, snow_value_shell_band(job->store, job->params, band,
                                           worker, scratch_of(job, worker)));
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

/* --- sizes ------------------------------------------------------------------
 */

static snow_status reserve_masks(snow_value_store *s) {
    s->mask_words = snow_value_words(s) + 2;
    s->mask_rows =
        (size_t)s->rows + 2 * (size_t)s->margin + 2 * SNOW_VALUE_ROWS;
    s->coarse_words = s->mask_rows / ((size_t)SNOW_VALUE_COARSE * 64) + 2;
    size_t slices = (size_t)snow_value_planes(s) * (size_t)s->slices;
    size_t masks = slices * s->mask_words * s->mask_rows;
    SNOW_TRY(snow_reserve(s->context, &s->masks, &s->masks_capacity, 0,
                          (masks + SNOW_VALUE_ROWS) * sizeof *s->masks));
    memset(s->masks, 0, (masks + SNOW_VALUE_ROWS) * sizeof *s->masks);
    size_t coarse = s->mask_words * s->coarse_words * sizeof *s->coarse;
    s->eight_count = (s->slices + SNOW_VALUE_EIGHT - 1) / SNOW_VALUE_EIGHT;
    SNOW_TRY(snow_reserve(s->context, &s->eights, &s->eights_capacity, 0,
                          (size_t)snow_value_planes(s) *
                              (size_t)s->eight_count * coarse));
    return snow_reserve(s->context, &s->coarse, &s->coarse_capacity, 0,
                        slices * coarse);
}

static snow_status reserve_bands(snow_value_store *s) {
    size_t before = s->bands_capacity;
    s->band_count = (s->rows + SNOW_VALUE_BAND - 1) / SNOW_VALUE_BAND;
    SNOW_TRY(snow_reserve(s->context, &s->bands, &s->bands_capacity, before,
                          (size_t)s->band_count * sizeof *s->bands));
    for (size_t n = before / sizeof *s->bands;
         n < s->bands_capacity / sizeof *s->bands; n++)
        s->bands[n] = (snow_sparse){.context = s->context};
    SNOW_TRY(snow_reserve(s->context, &s->seen, &s->seen_capacity, 0,
                          (size_t)s->band_count * sizeof *s->seen));
    memset(s->seen, 0, (size_t)s->band_count * sizeof *s->seen);
    return SNOW_STATUS_OK;
}

static void forget_turned(snow_value_store *s) {
    snow_release(s->context, s->copy);
    s->copy = NULL;
    s->copy_capacity = 0;
}

/* Gives up EA, IA, PA and rows. */
static void forget_rows(snow_value_store *s) {
    for (size_t n = 0; n < s->bands_capacity / sizeof *s->bands; n++)
        snow_sparse_fini(&s->bands[n]);
    snow_release(s->context, s->bands);
    snow_release(s->context, s->values);
    snow_release(s->context, s->at);
    snow_release(s->context, s->ends);
    s->bands = NULL;
    s->values = NULL;
    s->at = NULL;
    s->ends = NULL;
    s->bands_capacity = s->values_capacity = 0;
    s->at_capacity = s->ends_capacity = 0;
}

static snow_status reserve_rows(snow_value_store *s) {
    size_t rows = (size_t)s->slices * (size_t)(s->rows + 2 * s->margin);
    SNOW_TRY(snow_reserve(s->context, &s->at, &s->at_capacity, 0,
                          rows * sizeof *s->at));
    return snow_reserve(s->context, &s->ends, &s->ends_capacity, 0,
                        rows * sizeof *s->ends);
}

/* Whether rows are natives, and where they are. */
static void place_natives(snow_value_store *s,
                          const snow_value_store_params *params) {
    const snow_placement *p = params->placement;
    const snow_value_coder *coder = params->coder;
    const int64_t *dims = params->volume->info.dims;
    const int64_t strides[3] = {1, dims[0], dims[0] * dims[1]};
    s->in_place = params->encoding == SNOW_ENCODING_AUTO && !params->copied &&
                  snow_value_store_by_natives(params) && !coder->scale.clamps &&
                  coder->type != SNOW_TYPE_INT8;
    s->turned = s->in_place && p->u_axis != 0;
    s->kind = SNOW_VALUE_NUMBERS;
    if (!s->in_place)
        return;
    s->kind =
        snow_type_size(coder->type) == 1 ? SNOW_VALUE_BYTES : SNOW_VALUE_WORDS;
    s->rule = coder->scale.rule;
    s->natives = params->volume->voxels;
    s->native_count = dims[0] * dims[1] * dims[2];
    s->slice_step = strides[p->slice_axis];
    s->row_step = strides[p->v_axis];
}

/* Room for rows that are turned.  They are a cache line farther apart than they
 * are long: at steps of a power of 2 many would share a place in the cache. */
static snow_status reserve_turned(snow_value_store *s) {
    const int64_t size = s->kind == SNOW_VALUE_BYTES ? 1 : 2;
    s->row_step = (s->columns * size + 127) / 64 * 64 / size;
    s->slice_step = s->rows * s->row_step;
    s->native_count = s->slices * s->slice_step;
    SNOW_TRY(snow_reserve(s->context, &s->copy, &s->copy_capacity, 0,
                          (size_t)(s->native_count * size)));
    s->natives = s->copy;
    return SNOW_STATUS_OK;
}

/* Scratch for whichever step takes most. */
static snow_status reserve_scratch(store_job *job) {
    snow_value_store *s = job->store;
    size_t most = ((size_t)s->columns / 2 + 2) * sizeof(snow_span);
    size_t cells = snow_value_cells_bytes(s, job->params);
    size_t shell = s->in_place ? 0 : snow_value_shell_bytes(s, job->params);
    most = cells > most ? cells : most;
    most = shell > most ? shell : most;
    job->scratch_bytes = (most + 63) / 64 * 64;
    return snow_reserve(s->context, &s->scratch, &s->scratch_capacity, 0,
                        job->scratch_bytes * (size_t)job->params->threads);
}

static snow_status begin(store_job *job) {
    snow_value_store *s = job->store;
    const snow_value_store_params *params = job->params;
    const snow_placement *p = params->placement;
    if (p->columns * p->rows > (int64_t)UINT32_MAX)
        return snow_fail(
            s->context, SNOW_STATUS_BAD_USAGE,
            "slices of %lldx%lld voxels are too large to encode: the limit is "
            "4294967295 voxels; render a part of the volume",
            (long long)p->columns, (long long)p->rows);
    s->columns = p->columns;
    s->rows = p->rows;
    s->slices = p->slices;
    s->reach = params->reach;
    s->margin = snow_value_margin(params);
    s->run_count = params->run_count;
    memcpy(s->runs, params->runs,
           (size_t)params->run_count * sizeof *params->runs);
    s->holes = params->holes;
    s->cubic = params->cubic;
    s->labels = params->coder->names != NULL;
    if (s->holes && !s->run_count) /* nothing is invisible but holes */
        s->runs[s->run_count++] = SNOW_VALUE_NO_RUN;
    place_natives(s, params);
    SNOW_TRY(reserve_masks(s));
    if (s->in_place)
        forget_rows(s);
    if (!s->turned)
        forget_turned(s);
    SNOW_TRY(reserve_bands(s));
    if (s->turned)
        SNOW_TRY(reserve_turned(s));
    if (!s->in_place)
        SNOW_TRY(reserve_rows(s));
    return reserve_scratch(job);
}

/* --- the encoding -----------------------------------------------------------
 */

/* By the cells of every eighth slice that no run hides, and how many runs of
 * them there are. */
static snow_encoding choose(const snow_value_store *s) {
    uint64_t cells = 0, runs = 0, slices = 0;
    const size_t size = s->mask_words * s->mask_rows;
    for (int64_t slice = s->slices / 2 % 8; slice < s->slices;
         slice += 8, slices++)
        for (size_t n = 0; n < size; n++) {
            uint32_t mask = ~UINT32_C(0);
            for (int run = 0; run < s->run_count; run++)
                mask &= s->masks[snow_value_mask_at(s, run, slice) + n];
            cells += (uint64_t)__builtin_popcount(mask);
            runs += (uint64_t)__builtin_popcount(mask & ~(mask << 1));
        }
    return snow_encoding_choose((uint64_t)(s->columns * s->rows) * slices,
                                cells, runs);
}

/* Of natives there are masks and at most a copy, which counts as IA. */
static void add_up(snow_value_store *s) {
    s->voxels = s->ea_bytes = 0;
    if (s->in_place) {
        s->encoding = SNOW_ENCODING_BITMAP;
        s->ea_bytes = (uint64_t)snow_value_planes(s) * (uint64_t)s->slices *
                      s->mask_words * s->mask_rows * sizeof *s->masks;
        s->ia_bytes = s->turned ? (uint64_t)s->native_count *
                                      (s->kind == SNOW_VALUE_BYTES ? 1 : 2)
                                : 0;
        s->pa_bytes = 0;
        return;
    }
    for (int64_t n = 0; n < s->band_count; n++) {
        s->voxels += s->bands[n].ia_voxels;
        s->ea_bytes += s->bands[n].ea_bytes;
    }
    s->ia_bytes = s->voxels * sizeof(int16_t);
    s->pa_bytes = (uint64_t)s->band_count * (uint64_t)(s->slices + 1) *
                  sizeof(snow_slice_pointer);
}

void snow_value_store_count(const snow_value_store *s, int64_t first,
                            int64_t count, uint64_t *ea, uint64_t *ia,
                            uint64_t *pa) {
    *ea = *ia = 0;
    for (int64_t n = 0; n < s->band_count; n++) {
        const snow_slice_pointer *from = &s->bands[n].pa[first];
        *ea += from[count].ea - from->ea;
        *ia += (from[count].ia - from->ia) * sizeof(int16_t);
    }
    *pa = (uint64_t)s->band_count * (uint64_t)(count + 1) *
          sizeof(snow_slice_pointer);
}

static snow_status each(store_job *job, int64_t items, snow_work_fn *work) {
    int threads = job->params->threads;
    SNOW_TRY(snow_parallel(job->store->context,
                           threads < items ? threads : (int)items, items, work,
                           job));
    return (snow_status)atomic_load(&job->failed);
}

snow_status snow_value_store_encode(snow_value_store *s,
                                    const snow_value_store_params *params) {
    store_job job = {.store = s, .params = params};
    atomic_init(&job.failed, SNOW_STATUS_OK);
    SNOW_TRY(begin(&job));
    snow_monitor_next(s->context->monitor, SNOW_STAGE_ENCODE, 0, 0.5);
    SNOW_TRY(each(&job, s->band_count, cells_item));
    SNOW_TRY(each(&job, s->eight_count, coarse_item));
    if (s->in_place) {
        add_up(s);
        return SNOW_STATUS_OK;
    }
    s->encoding =
        params->encoding == SNOW_ENCODING_AUTO ? choose(s) : params->encoding;
    snow_monitor_next(s->context->monitor, SNOW_STAGE_ENCODE, 0.5, 1);
    SNOW_TRY(each(&job, s->band_count, shell_item));
    SNOW_TRY(each(&job, s->band_count, measure_item));
    SNOW_TRY(snow_value_rows_place(s));
    SNOW_TRY(each(&job, s->band_count, fill_item));
    SNOW_TRY(each(&job, s->slices, border_item));
    add_up(s);
    return SNOW_STATUS_OK;
}

void snow_value_store_fini(snow_value_store *s) {
    forget_rows(s);
    forget_turned(s);
    snow_release(s->context, s->masks);
    snow_release(s->context, s->coarse);
    snow_release(s->context, s->eights);
    snow_release(s->context, s->seen);
    snow_release(s->context, s->scratch);
    *s = (snow_value_store){.context = s->context};
}
