/* classify/classify.c - applies the transfer function: native value to sample
 * (model, sections 3 and 6).
 *
 * A voxel is interesting when its opacity is above 0 and, for a threshold T >
 * 0, 255 a > T + 0.0001. Here a is the opacity before the correction for path
 * length, times the gradient opacity if there is one. Voxels that are not
 * interesting contribute nothing. */
#include "classify/classify.h"

#include "base/exp_log.h"

#define TEMPLATE "classify/classify_row.tmpl.h"
#include "volume/each_type.h"

static snow_classify_row_fn *const type_rows[] = {
#define ENTRY(name, type, text) [SNOW_TYPE_##name] = classify_row_##name,
    SNOW_TYPE_MAP(ENTRY)};

bool snow_classify_value(const snow_classifier *c, double native,
                         float *sample) {
    const snow_volume_info *info = &c->volume->info;
    double value = info->slope * native + info->intercept;
    double opacity = snow_transfer_opacity(c->transfer, value);
    sample[0] = sample[1] = 0; /* a call of memset costs more than the rest */
    if (c->channels == 4)
        sample[2] = sample[3] = 0;
    if (!(opacity > 0))
        return false;
    bool interesting = snow_is_interesting(opacity, c->threshold);
    if (c->only_counts || (!interesting && !c->keep_all))
        return interesting;
    double rgb[3] = {0, 0, 0};
    if (!c->no_colors)
        snow_transfer_color(c->transfer, value, rgb);
    /* Along an axis of a cubic grid the exponent is 1. */
    double corrected = c->exponent == 1
                           ? opacity
                           : snow_opacity_of(snow_clarity(opacity),
                                             snow_exponent_within(c->exponent));
    double weight = c->premultiply ? corrected : 1;
    for (int i = 0; i < c->channels - 1; i++)
        sample[i] = (float)(rgb[i] * weight);
    sample[c->channels - 1] = (float)corrected;
    return interesting;
}

/* What becomes of all values of a type of 8 or 16 bits. */
static snow_status make_table(snow_context *context, snow_classifier *c) {
    const snow_type type = c->volume->info.type;
    size_t values = (size_t)1 << 8 * snow_type_size(type);
    size_t channels = (size_t)c->channels;
    SNOW_TRY(SNOW_RESERVE(context, c->keep, 0, values));
    SNOW_TRY(SNOW_RESERVE(context, c->table, 0, values * channels));
    for (size_t i = 0; i < values; i++) {
        double native = snow_type_lowest(type) + (double)i;
        c->keep[i] = snow_classify_value(c, native, c->table + i * channels) ||
                     c->keep_all;
    }
    return SNOW_STATUS_OK;
}

snow_status snow_classifier_make(snow_context *context,
                                 const snow_volume *volume,
                                 const snow_transfer *transfer,
                                 const snow_classify_options *options,
                                 snow_classifier *c) {
    c->volume = volume;
    c->transfer = transfer;
    c->no_colors = options->no_colors;
    c->channels = transfer->grey || c->no_colors ? 2 : 4;
    c->keep_all = options->keep_all;
    c->premultiply = options->premultiply;
    c->only_counts =
        options->only_counts && !snow_transfer_has_gradient_opacity(transfer);
    c->threshold = options->threshold;
    c->exponent = options->opacity_exponent;
    c->classify_row = type_rows[volume->info.type];
    c->gradient_factors = snow_transfer_has_gradient_opacity(transfer);
    if (c->gradient_factors) {
        SNOW_TRY(snow_gradient_opacity_init(context, volume, transfer,
                                            c->threshold, options->isa,
                                            &c->gradient_opacity));
        c->gradient_opacity_premultiply = c->premultiply;
        c->gradient_opacity_exponent = c->exponent;
        c->premultiply = false;
        c->exponent = 1;
    }
    return snow_type_size(volume->info.type) <= 2 ? make_table(context, c)
                                                  : SNOW_STATUS_OK;
}

void snow_classifier_fini(snow_context *context, snow_classifier *c) {
    snow_release(context, c->keep);
    snow_release(context, c->table);
    *c = (snow_classifier){0};
}

const void *snow_row_voxels(const snow_volume *volume,
                            const snow_placement *placement, int64_t slice,
                            int64_t row, int64_t *stride) {
    int64_t strides[3];
    snow_volume_steps(volume, strides);
    *stride = strides[placement->u_axis];
    int64_t first = slice * strides[placement->slice_axis] +
                    row * strides[placement->v_axis];
    return (const char *)volume->voxels +
           (size_t)first * snow_type_size(volume->info.type);
}

/* Applies the gradient opacity to up to SNOW_GRADIENT_OPACITY_BLOCK voxels of a
 * row. Voxels that stay interesting are moved up to `kept` and `out`, which lie
 * at or before their sources. Returns their number. With keep_all every voxel
 * stays and the threshold is ignored, as without a gradient opacity. */
static size_t apply_gradient_opacity_block(const snow_classifier *c,
                                           const double *factors, size_t count,
                                           const uint32_t *columns,
                                           const float *samples, uint32_t *kept,
                                           float *out) {
    size_t channels = (size_t)c->channels, stay = 0;
    double opacities[SNOW_GRADIENT_OPACITY_BLOCK];
    for (size_t n = 0; n < count; n++) {
        double opacity = (double)samples[(n + 1) * channels - 1] * factors[n];
        kept[stay] = columns[n];
        for (size_t i = 0; i < channels; i++)
            out[stay * channels + i] = samples[n * channels + i];
        opacities[stay] = opacity;
        stay += c->keep_all || snow_is_interesting(opacity, c->threshold);
    }
    snow_gradient_opacity_correct(
        &c->gradient_opacity, c->gradient_opacity_exponent, stay, opacities);
    for (size_t n = 0; n < stay; n++) {
        double weight = c->gradient_opacity_premultiply ? opacities[n] : 1;
        float *sample = out + n * channels;
        for (size_t i = 0; i + 1 < channels; i++)
            sample[i] = (float)((double)sample[i] * weight);
        sample[channels - 1] = (float)opacities[n];
    }
    return stay;
}

/* The same for the `count` voxels of a row from entry `first` of the row block
 * on. */
static size_t apply_gradient_opacity_row(const snow_classifier *c,
                                         const snow_gradient_opacity_row *row,
                                         size_t first, size_t count,
                                         snow_row_block *row_block) {
    size_t channels = (size_t)c->channels, stay = 0;
    uint32_t *columns = row_block->columns + first;
    float *samples = row_block->samples + first * channels;
    for (size_t n = 0; n < count; n += SNOW_GRADIENT_OPACITY_BLOCK) {
        size_t left = count - n;
        size_t some = left < SNOW_GRADIENT_OPACITY_BLOCK
                          ? left
                          : SNOW_GRADIENT_OPACITY_BLOCK;
        double factors[SNOW_GRADIENT_OPACITY_BLOCK];
        snow_gradient_opacity_factors(&c->gradient_opacity, row, columns + n,
                                      some, factors);
        stay += apply_gradient_opacity_block(
            c, factors, some, columns + n, samples + n * channels,
            columns + stay, samples + stay * channels);
    }
    return stay;
}

void snow_classify_row_block(const snow_classifier *classifier,
                             const snow_placement *placement, int64_t slice,
                             int64_t first, int64_t rows,
                             snow_row_block *row_block) {
    row_block->slice = slice;
    row_block->first_row = first;
    row_block->rows = rows;
    row_block->count = 0;
    for (int64_t row = 0; row < rows; row++) {
        int64_t stride;
        const void *voxels = snow_row_voxels(classifier->volume, placement,
                                             slice, first + row, &stride);
        size_t count = classifier->classify_row(
            classifier, voxels, stride, placement->columns,
            row_block->columns + row_block->count,
            row_block->samples +
                row_block->count * (size_t)classifier->channels);
        if (classifier->gradient_factors)
            count = apply_gradient_opacity_row(
                classifier,
                &(snow_gradient_opacity_row){placement, slice, first + row},
                row_block->count, count, row_block);
        row_block->count += count;
        row_block->row_end[row] = row_block->count;
    }
}

/* --- row blocks ----------------------------------------------------------- */

/* Voxels of a row block: with 4 bytes of column and 16 of sample each it takes
 * 320 KB, a part of today's second-level caches. */
#define ROW_BLOCK_VOXELS 16384

snow_status snow_row_block_make(snow_context *context,
                                const snow_placement *placement, int channels,
                                snow_row_block *row_block) {
    if (placement->columns > UINT32_MAX)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "rows of %lld voxels are too long to render: the "
                         "limit is 4294967295; render a part of the volume",
                         (long long)placement->columns);
    int64_t rows = ROW_BLOCK_VOXELS / placement->columns;
    if (rows > placement->rows)
        rows = placement->rows;
    if (rows < 1)
        rows = 1;
    uint64_t voxels = (uint64_t)rows * (uint64_t)placement->columns;
    row_block->room_rows = rows;
    SNOW_TRY(SNOW_RESERVE(context, row_block->row_end, 0, rows));
    SNOW_TRY(SNOW_RESERVE(context, row_block->columns, 0, voxels));
    return SNOW_RESERVE(context, row_block->samples, 0,
                        (size_t)voxels * (size_t)channels);
}

void snow_row_block_free(snow_context *context, snow_row_block *row_block) {
    snow_release(context, row_block->row_end);
    snow_release(context, row_block->columns);
    snow_release(context, row_block->samples);
    *row_block = (snow_row_block){0};
}
