/* classify/values/value_coder.c - see value_coder.h. */
#include "classify/values/value_coder.h"

#include "classify/values/value_labels.h"
#include "volume/clip_planes.h"

#include <math.h>

static inline int16_t number_of(double low, double high, double value) {
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
    return number_of(scale->low, scale->high,
                     scale->log ? log10(value)
                                : snow_place_of(scale->linear, value));
}

/* The number of a data value, or of the label that it is. */
static int16_t coded(const snow_value_coder *coder, double value) {
    if (!coder->names)
        return scaled(&coder->scale, value);
    return isnan(value) ? SNOW_VALUE_HOLE
                        : (int16_t)snow_value_label_of(
                              coder->names, coder->name_count, value);
}

snow_status snow_value_coder_make(const snow_volume *volume,
                                  const snow_value_scale14 *scale,
                                  snow_value_coder *coder) {
    const snow_volume_info *info = &volume->info;
    size_t count = (size_t)1 << 8 * (snow_type_size(info->type) & 3);
    coder->scale = *scale;
    coder->type = info->type;
    coder->slope = info->slope;
    coder->intercept = info->intercept;
    coder->ruled = scale->whole && !coder->names;
    if (snow_type_size(info->type) > 2 || coder->ruled)
        return SNOW_STATUS_OK;
    SNOW_TRY(SNOW_RESERVE(volume->context, coder->numbers, 0, count));
    coder->lowest = snow_type_lowest(info->type);
    for (size_t n = 0; n < count; n++)
        coder->numbers[n] =
            coded(coder, info->slope * (double)((int32_t)n + coder->lowest) +
                             info->intercept);
    return SNOW_STATUS_OK;
}

void snow_value_coder_fini(snow_context *context, snow_value_coder *coder) {
    snow_release(context, coder->numbers);
    *coder = (snow_value_coder){0};
}

#define CODE_NARROW(name, type)                                                \
    static void code_##name(const snow_value_coder *coder, const type *stored, \
                            size_t count, int16_t *out) {                      \
        const int16_t *numbers = coder->numbers - coder->lowest;               \
        const snow_value_rule rule = coder->scale.rule;                        \
        const type low = (type)rule.bottom, high = (type)rule.top;             \
        for (size_t n = 0; n < count && coder->ruled; n++) {                   \
            type native = stored[n] < low ? low : stored[n];                   \
            out[n] = snow_value_by_rule(&rule, native < high ? native : high); \
        }                                                                      \
        for (size_t n = 0; n < count && !coder->ruled; n++)                    \
            out[n] = numbers[stored[n]];                                       \
    }

CODE_NARROW(INT8, int8_t)
CODE_NARROW(UINT8, uint8_t)
CODE_NARROW(INT16, int16_t)
CODE_NARROW(UINT16, uint16_t)

#define CODE_WIDE(name, type)                                                  \
    static void code_##name(const snow_value_coder *coder, const type *stored, \
                            size_t count, int16_t *out) {                      \
        const snow_value_scale14 scale = coder->scale;                         \
        const double slope = coder->slope, intercept = coder->intercept;       \
        const bool plain = scale.high > scale.low && !scale.log &&             \
                           !(scale.linear > 0) && !coder->names;               \
        for (size_t n = 0; n < count; n++) {                                   \
            double value = slope * (double)stored[n] + intercept;              \
            out[n] = plain && value == value                                   \
                         ? number_of(scale.low, scale.high, value)             \
                         : coded(coder, value);                                \
        }                                                                      \
    }

CODE_WIDE(INT32, int32_t)
CODE_WIDE(UINT32, uint32_t)
CODE_WIDE(INT64, int64_t)
CODE_WIDE(UINT64, uint64_t)
CODE_WIDE(FLOAT32, float)
CODE_WIDE(FLOAT64, double)

void snow_value_code_row(const snow_value_coder *coder, const void *stored,
                         size_t count, int16_t *out) {
    switch (coder->type) {
#define CODE_CASE(name, type, text)             \
    case SNOW_TYPE_##name:                      \
        code_##name(coder, stored, count, out); \
        break;
        SNOW_TYPE_MAP(CODE_CASE)
#undef CODE_CASE
    case SNOW_TYPE_NONE:
        break;
    }
}

void snow_value_code_clipped(const snow_value_coder *coder,
                             const snow_volume *volume, const int64_t at[3],
                             int axis, size_t count, int16_t *out) {
    int64_t here[3] = {at[0], at[1], at[2]};
    for (size_t n = 0; n < count; n++, here[axis]++) {
        if (out[n] != SNOW_VALUE_HOLE)
            continue;
        double native =
            snow_clip_planes_value_at(volume->clip, volume->info.dims, here);
        out[n] = coded(coder, coder->slope * native + coder->intercept);
    }
}
