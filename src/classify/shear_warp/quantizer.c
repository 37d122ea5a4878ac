/* classify/shear_warp/quantizer.c - see quantizer.h. */
#include "classify/shear_warp/quantizer.h"

#include "classify/shear_warp/labels.h"
#include "volume/clip_planes.h"

#include <math.h>

static inline int16_t quantize(double low, double high, double value) {
    value = value < low ? low : value;
    value = value > high ? high : value;
    /* To the nearest integer, halves to the even one: adding this leaves no bit
     * for fractions. */
    const double big = 0x1.8p52;
    return (int16_t)(int)(((value - low) * SNOW_VALUE_MOST / (high - low)) +
                          big - big);
}

static int16_t scaled(const snow_value_scale14 *scale, double value) {
    if (isnan(value) || (scale->log && !(value > 0)))
        return SNOW_VALUE_HOLE;
    if (!(scale->high > scale->low))
        return 0;
    return quantize(scale->low, scale->high,
                    scale->log ? log10(value)
                               : snow_place_of(scale->linear, value));
}

/* The number of a data value, or of the label that it is. */
static int16_t coded(const snow_quantizer *quantizer, double value) {
    if (!quantizer->names)
        return scaled(&quantizer->scale, value);
    return isnan(value) ? SNOW_VALUE_HOLE
                        : (int16_t)snow_value_label_of(
                              quantizer->names, quantizer->name_count, value);
}

snow_status snow_quantizer_make(const snow_volume *volume,
                                const snow_value_scale14 *scale,
                                snow_quantizer *quantizer) {
    const snow_volume_info *info = &volume->info;
    size_t count = (size_t)1 << 8 * (snow_type_size(info->type) & 3);
    quantizer->scale = *scale;
    quantizer->type = info->type;
    quantizer->slope = info->slope;
    quantizer->intercept = info->intercept;
    quantizer->is_fixed = scale->whole && !quantizer->names;
    if (snow_type_size(info->type) > 2 || quantizer->is_fixed)
        return SNOW_STATUS_OK;
    SNOW_TRY(SNOW_RESERVE(volume->context, quantizer->quantized, 0, count));
    quantizer->lowest = snow_type_lowest(info->type);
    for (size_t n = 0; n < count; n++)
        quantizer->quantized[n] = coded(
            quantizer, info->slope * (double)((int32_t)n + quantizer->lowest) +
                           info->intercept);
    return SNOW_STATUS_OK;
}

void snow_quantizer_fini(snow_context *context, snow_quantizer *quantizer) {
    snow_release(context, quantizer->quantized);
    *quantizer = (snow_quantizer){0};
}

#define CODE_NARROW(name, type)                                               \
    static void code_##name(const snow_quantizer *quantizer,                  \
                            const type *stored, size_t count, int16_t *out) { \
        const int16_t *quantized = quantizer->quantized - quantizer->lowest;  \
        const snow_fixed_quantizer fixed = quantizer->scale.fixed;            \
        const type low = (type)fixed.bottom, high = (type)fixed.top;          \
        for (size_t n = 0; n < count && quantizer->is_fixed; n++) {           \
            type native = stored[n] < low ? low : stored[n];                  \
            out[n] =                                                          \
                snow_quantize_fixed(&fixed, native < high ? native : high);   \
        }                                                                     \
        for (size_t n = 0; n < count && !quantizer->is_fixed; n++)            \
            out[n] = quantized[stored[n]];                                    \
    }

CODE_NARROW(INT8, int8_t)
CODE_NARROW(UINT8, uint8_t)
CODE_NARROW(INT16, int16_t)
CODE_NARROW(UINT16, uint16_t)

#define CODE_WIDE(name, type)                                                 \
    static void code_##name(const snow_quantizer *quantizer,                  \
                            const type *stored, size_t count, int16_t *out) { \
        const snow_value_scale14 scale = quantizer->scale;                    \
        const double slope = quantizer->slope,                                \
                     intercept = quantizer->intercept;                        \
        const bool plain = scale.high > scale.low && !scale.log &&            \
                           !(scale.linear > 0) && !quantizer->names;          \
        for (size_t n = 0; n < count; n++) {                                  \
            double value = slope * (double)stored[n] + intercept;             \
            out[n] = plain && value == value                                  \
                         ? quantize(scale.low, scale.high, value)             \
                         : coded(quantizer, value);                           \
        }                                                                     \
    }

CODE_WIDE(INT32, int32_t)
CODE_WIDE(UINT32, uint32_t)
CODE_WIDE(INT64, int64_t)
CODE_WIDE(UINT64, uint64_t)
CODE_WIDE(FLOAT32, float)
CODE_WIDE(FLOAT64, double)

void snow_quantize_row(const snow_quantizer *quantizer, const void *stored,
                       size_t count, int16_t *out) {
    switch (quantizer->type) {
#define CODE_CASE(name, type, text)                 \
    case SNOW_TYPE_##name:                          \
        code_##name(quantizer, stored, count, out); \
        break;
        SNOW_TYPE_MAP(CODE_CASE)
#undef CODE_CASE
    case SNOW_TYPE_NONE:
        break;
    }
}

void snow_quantize_clipped(const snow_quantizer *quantizer,
                           const snow_volume *volume, const int64_t at[3],
                           int axis, size_t count, int16_t *out) {
    int64_t here[3] = {at[0], at[1], at[2]};
    for (size_t n = 0; n < count; n++, here[axis]++) {
        if (out[n] != SNOW_VALUE_HOLE)
            continue;
        double native =
            snow_clip_planes_value_at(volume->clip, volume->info.dims, here);
        out[n] =
            coded(quantizer, quantizer->slope * native + quantizer->intercept);
    }
}
