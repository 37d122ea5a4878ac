/* encode/shear_warp/store.c - see store.h. */
#include "encode/shear_warp/store.h"

#include "base/clear.h"
#include "encode/shear_warp/encode.h"

#include <string.h>

/* --- sizes ---------------------------------------------------------------- */

static snow_status reserve_masks(snow_value_store *s) {
    size_t slices = (size_t)snow_value_planes(s) * (size_t)s->slices;
    SNOW_TRY(SNOW_RESERVE(s->context, s->masks, 0, snow_value_masks_words(s)));
    size_t coarse = s->mask_words * s->coarse_words;
    SNOW_TRY(SNOW_RESERVE(s->context, s->eights, 0,
                          (size_t)snow_value_planes(s) *
                              (size_t)s->eight_count * coarse));
    return SNOW_RESERVE(s->context, s->coarse, 0, slices * coarse);
}

/* Bands that there is memory for. */
static size_t bands_held(const snow_value_store *s) {
    return snow_block_bytes(s->bands) / sizeof *s->bands;
}

static snow_status reserve_bands(snow_value_store *s) {
    size_t before = bands_held(s);
    s->band_count = (s->rows + SNOW_VALUE_BAND - 1) / SNOW_VALUE_BAND;
    SNOW_TRY(SNOW_RESERVE(s->context, s->bands, before, s->band_count));
    for (size_t n = before; n < bands_held(s); n++)
        s->bands[n] = (snow_sparse){.context = s->context};
    SNOW_TRY(SNOW_RESERVE(s->context, s->seen, 0, s->band_count));
    memset(s->seen, 0, (size_t)s->band_count * sizeof *s->seen);
    return SNOW_STATUS_OK;
}

/* Gives up EA, IA, PA and rows. */
static void forget_rows(snow_value_store *s) {
    for (size_t n = 0; n < bands_held(s); n++)
        snow_sparse_fini(&s->bands[n]);
    SNOW_DROP(s->context, s->bands);
    SNOW_DROP(s->context, s->values);
    SNOW_DROP(s->context, s->at);
    SNOW_DROP(s->context, s->ends);
}

/* Whether rows are stored values, and where they are. */
static void place_stored(snow_value_store *s,
                         const snow_value_store_params *params) {
    const snow_placement *p = params->placement;
    const snow_quantizer *quantizer = params->quantizer;
    const int64_t *dims = params->volume->info.dims;
    int64_t strides[3];
    snow_volume_steps(params->volume, strides);
    s->in_place = params->encoding == SNOW_ENCODING_AUTO && !params->copied &&
                  snow_value_store_by_stored(params) &&
                  !quantizer->scale.clamps && quantizer->type != SNOW_TYPE_INT8;
    s->turned = s->in_place && p->u_axis != 0;
    s->kind = SNOW_VALUE_QUANTIZED;
    if (!s->in_place)
        return;
    s->kind = snow_type_size(quantizer->type) == 1 ? SNOW_VALUE_BYTES
                                                   : SNOW_VALUE_SHORTS;
    s->fixed = quantizer->scale.fixed;
    s->stored = params->volume->voxels;
    s->native_count =
        (dims[2] - 1) * strides[2] + (dims[1] - 1) * strides[1] + dims[0];
    s->slice_step = strides[p->slice_axis];
    s->row_step = strides[p->v_axis];
}

/* Room for rows that are turned.  The same row of all slices lies together, so
 * that a band, which is made at once, has pages of memory of its own.  Rows and
 * slices are a cache line farther apart than they are long: at steps of a power
 * of 2 many would share a place in the cache. */
static snow_status reserve_turned(snow_value_store *s) {
    const int64_t size = s->kind == SNOW_VALUE_BYTES ? 1 : 2;
    s->slice_step = (s->columns * size + 127) / 64 * 64 / size;
    s->row_step = s->slices * s->slice_step + 64 / size;
    s->native_count = s->rows * s->row_step;
    SNOW_TRY(SNOW_RESERVE(s->context, s->copy, 0, s->native_count * size));
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
    s->interval_count = params->interval_count;
    memcpy(s->intervals, params->intervals,
           (size_t)params->interval_count * sizeof *params->intervals);
    s->counted_ranges = params->seen_count;
    for (int n = 0; n < params->seen_count; n++)
        s->counted[n] = params->seen[n];
    s->holes = params->holes;
    s->cubic = params->cubic;
    s->labels = params->quantizer->names != NULL;
    if (s->holes && !s->interval_count) /* nothing is invisible but holes */
        s->intervals[s->interval_count++] = SNOW_VALUE_NO_RUN;
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
    SNOW_TRY(snow_slice_check(s->context, p));
    s->step = 0;
    s->made = 0;
    describe(s, params);
    SNOW_TRY(reserve_masks(s));
    if (s->in_place)
        forget_rows(s);
    if (!s->turned)
        SNOW_DROP(s->context, s->copy);
    SNOW_TRY(reserve_bands(s));
    if (s->turned)
        SNOW_TRY(reserve_turned(s));
    if (params->in_parts) {
        snow_memory_by_pages(s->context, s->masks, snow_block_bytes(s->masks));
        snow_memory_by_pages(s->context, s->copy, snow_block_bytes(s->copy));
    }
    if (s->in_place)
        return SNOW_STATUS_OK;
    int64_t rows = s->slices * (s->rows + 2 * s->margin);
    SNOW_TRY(SNOW_RESERVE(s->context, s->at, 0, rows));
    return SNOW_RESERVE(s->context, s->ends, 0, rows);
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
    *ea = *ia = *pa = 0;
    if (s->in_place) { /* all slices take as much */
        *ea = s->ea_bytes / (uint64_t)s->slices * (uint64_t)count;
        *ia = s->ia_bytes / (uint64_t)s->slices * (uint64_t)count;
        return;
    }
    for (int64_t n = 0; n < s->band_count; n++) {
        const snow_slice_pointer *from = &s->bands[n].pa[first];
        *ea += from[count].ea - from->ea;
        *ia += (from[count].ia - from->ia) * sizeof(int16_t);
    }
    *pa = (uint64_t)s->band_count * (uint64_t)(count + 1) *
          sizeof(snow_slice_pointer);
}

/* Without a fixed-point quantizer IA and rows may have all voxels. */
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
    const void *const blocks[] = {s->masks,  s->coarse, s->eights, s->bands,
                                  s->values, s->copy,   s->at,     s->ends,
                                  s->seen,   s->scratch};
    uint64_t bytes = s->in_place ? 0 : s->ea_bytes + s->ia_bytes;
    for (size_t n = 0; n < sizeof blocks / sizeof *blocks; n++)
        bytes += snow_block_bytes(blocks[n]);
    return bytes;
}

void snow_value_store_fini(snow_value_store *s) {
    forget_rows(s);
    snow_release(s->context, s->copy);
    snow_release(s->context, s->masks);
    snow_release(s->context, s->coarse);
    snow_release(s->context, s->eights);
    snow_release(s->context, s->seen);
    snow_release(s->context, s->scratch);
    *s = (snow_value_store){.context = s->context};
}
