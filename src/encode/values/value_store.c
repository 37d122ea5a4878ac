/* encode/values/value_store.c - see value_store.h. */
#include "encode/values/value_store.h"

#include "encode/values/value_encode.h"

#include <string.h>

/* --- sizes ---------------------------------------------------------------- */

static snow_status reserve_masks(snow_value_store *s) {
    size_t slices = (size_t)snow_value_planes(s) * (size_t)s->slices;
    size_t masks = slices * s->mask_words * s->mask_rows;
    SNOW_TRY(snow_reserve(s->context, &s->masks, &s->masks_capacity, 0,
                          (masks + SNOW_VALUE_ROWS) * sizeof *s->masks));
    memset(s->masks, 0, (masks + SNOW_VALUE_ROWS) * sizeof *s->masks);
    size_t coarse = s->mask_words * s->coarse_words * sizeof *s->coarse;
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

/* Whether rows are stored values, and where they are. */
static void place_stored(snow_value_store *s,
                         const snow_value_store_params *params) {
    const snow_placement *p = params->placement;
    const snow_value_coder *coder = params->coder;
    const int64_t *dims = params->volume->info.dims;
    const int64_t strides[3] = {1, dims[0], dims[0] * dims[1]};
    s->in_place = params->encoding == SNOW_ENCODING_AUTO && !params->copied &&
                  snow_value_store_by_stored(params) && !coder->scale.clamps &&
                  coder->type != SNOW_TYPE_INT8;
    s->turned = s->in_place && p->u_axis != 0;
    s->kind = SNOW_VALUE_NUMBERS;
    if (!s->in_place)
        return;
    s->kind =
        snow_type_size(coder->type) == 1 ? SNOW_VALUE_BYTES : SNOW_VALUE_WORDS;
    s->rule = coder->scale.rule;
    s->stored = params->volume->voxels;
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
    s->stored = s->copy;
    return SNOW_STATUS_OK;
}

/* Sizes, and how rows are kept. */
static void describe(snow_value_store *s,
                     const snow_value_store_params *params) {
    const snow_placement *p = params->placement;
    s->columns = p->columns;
    s->rows = p->rows;
    s->slices = p->slices;
    s->reach = params->reach;
    s->margin = snow_value_margin(params);
    s->run_count = params->run_count;
    memcpy(s->runs, params->runs,
           (size_t)params->run_count * sizeof *params->runs);
    s->counted_ranges = params->seen_count;
    for (int n = 0; n < params->seen_count; n++)
        s->counted[n] = params->seen[n];
    s->holes = params->holes;
    s->cubic = params->cubic;
    s->labels = params->coder->names != NULL;
    if (s->holes && !s->run_count) /* nothing is invisible but holes */
        s->runs[s->run_count++] = SNOW_VALUE_NO_RUN;
    place_stored(s, params);
    s->mask_words = snow_value_words(s) + 2;
    s->mask_rows =
        (size_t)s->rows + 2 * (size_t)s->margin + 2 * SNOW_VALUE_ROWS;
    s->coarse_words = s->mask_rows / ((size_t)SNOW_VALUE_COARSE * 64) + 2;
    s->eight_count = (s->slices + SNOW_VALUE_EIGHT - 1) / SNOW_VALUE_EIGHT;
}

snow_status snow_value_store_begin(snow_value_store *s,
                                   const snow_value_store_params *params) {
    const snow_placement *p = params->placement;
    if (p->columns * p->rows > (int64_t)UINT32_MAX)
        return snow_fail(
            s->context, SNOW_STATUS_BAD_USAGE,
            "slices of %lldx%lld voxels are too large to encode: the limit is "
            "4294967295 voxels; render a part of the volume",
            (long long)p->columns, (long long)p->rows);
    s->step = 0;
    s->made = 0;
    describe(s, params);
    SNOW_TRY(reserve_masks(s));
    if (s->in_place)
        forget_rows(s);
    if (!s->turned)
        forget_turned(s);
    SNOW_TRY(reserve_bands(s));
    if (s->turned)
        SNOW_TRY(reserve_turned(s));
    return s->in_place ? SNOW_STATUS_OK : reserve_rows(s);
}

/* --- what it takes -------------------------------------------------------- */

/* Of stored values there are masks and at most a copy, which counts as IA. */
void snow_value_store_add_up(snow_value_store *s) {
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

/* Without a rule IA and rows may have all voxels. */
uint64_t snow_value_store_expect(const snow_value_store_params *params) {
    snow_value_store s = {.context = params->volume->context};
    describe(&s, params);
    uint64_t masks = (uint64_t)snow_value_planes(&s) * (uint64_t)s.slices *
                     s.mask_words * s.mask_rows * sizeof *s.masks;
    uint64_t voxels = (uint64_t)(s.columns * s.rows * s.slices);
    uint64_t size = s.kind == SNOW_VALUE_BYTES ? 1 : sizeof(int16_t);
    return masks + (s.in_place ? s.turned * size : 2 * size) * voxels;
}

uint64_t snow_value_store_bytes(const snow_value_store *s) {
    uint64_t bytes = s->masks_capacity + s->coarse_capacity +
                     s->eights_capacity + s->bands_capacity +
                     s->values_capacity + s->copy_capacity + s->at_capacity +
                     s->ends_capacity + s->seen_capacity + s->scratch_capacity;
    return s->in_place ? bytes : bytes + s->ea_bytes + s->ia_bytes;
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
