/* volume/convert.c - the same data values in another scalar type.
 *
 * A block at a time through doubles.  Nothing is lost without a word: a value
 * that the type cannot hold ends the conversion, one that is rounded, or may be
 * since it lies beyond the integers that doubles hold, is counted. */
#include "volume/stream.h"

#include <math.h>
#include <string.h>

#define BLOCK 1024

/* From its start the block of a volume and what became of it so far. */
typedef struct conversion {
    snow_type type;
    bool integer;
    double least, most;  /* that the type holds */
    double slope, shift; /* applied to data values */
    bool clamps;         /* to least and most */
    bool wide;           /* the values were integers of 64 bits */
    int64_t lost;        /* values that do not fit */
    int64_t rounded;
    double first_lost;
} conversion;

/* Doubles that the integer types hold, ends included; those of 64 bits end at
 * the last double before the power of two. */
const double *snow_type_limits(snow_type type) {
    static const double limits[][2] = {
        [SNOW_TYPE_INT8] = {INT8_MIN, INT8_MAX},
        [SNOW_TYPE_UINT8] = {0, UINT8_MAX},
        [SNOW_TYPE_INT16] = {INT16_MIN, INT16_MAX},
        [SNOW_TYPE_UINT16] = {0, UINT16_MAX},
        [SNOW_TYPE_INT32] = {INT32_MIN, INT32_MAX},
        [SNOW_TYPE_UINT32] = {0, UINT32_MAX},
        [SNOW_TYPE_INT64] = {-0x1p63, 0x1p63 - 1024},
        [SNOW_TYPE_UINT64] = {0, 0x1p64 - 2048},
        [SNOW_TYPE_FLOAT32] = {-0x1.fffffep127, 0x1.fffffep127},
        [SNOW_TYPE_FLOAT64] = {-INFINITY, INFINITY},
    };
    return limits[type];
}

static void set_limits(conversion *c) {
    c->integer = c->type != SNOW_TYPE_FLOAT32 && c->type != SNOW_TYPE_FLOAT64;
    c->least = snow_type_limits(c->type)[0];
    c->most = snow_type_limits(c->type)[1];
}

/* What a data value becomes; floats keep what is not finite. */
static double fit(conversion *c, double value) {
    double wanted = c->slope * value + c->shift;
    if (c->clamps)
        wanted = fmin(fmax(wanted, c->least), c->most);
    double kept = c->integer ? nearbyint(wanted) : wanted;
    bool held = kept >= c->least && kept <= c->most;
    if (c->integer ? !held || isnan(value) : isfinite(value) && !held) {
        if (!c->lost++)
            c->first_lost = value;
        return 0;
    }
    if (c->type == SNOW_TYPE_FLOAT32)
        kept = (double)(float)wanted;
    c->rounded += (kept != wanted && !isnan(wanted)) ||
                  (c->wide && fabs(value) >= 0x1p53);
    return kept;
}

void snow_type_store(snow_type type, const double *values, size_t count,
                     void *to) {
    switch (type) {
#define NARROW(name, c_type, text)                 \
    case SNOW_TYPE_##name:                         \
        for (size_t i = 0; i < count; i++)         \
            ((c_type *)to)[i] = (c_type)values[i]; \
        break;
        SNOW_TYPE_MAP(NARROW)
#undef NARROW
    case SNOW_TYPE_NONE:
        break;
    }
}

/* Every value fitted, and stored where `voxels` is not NULL. */
static void run(const snow_volume *volume, conversion *c, void *voxels) {
    const snow_volume_info *info = &volume->info;
    int64_t all = info->dims[0] * info->dims[1] * info->dims[2];
    double values[BLOCK];
    for (int64_t first = 0; first < all; first += BLOCK) {
        size_t count = all - first < BLOCK ? (size_t)(all - first) : BLOCK;
        snow_volume_stored(volume, first, count, values);
        for (size_t i = 0; i < count; i++)
            values[i] = fit(c, info->slope * values[i] + info->intercept);
        if (voxels)
            snow_type_store(c->type, values, count,
                            (char *)voxels +
                                (size_t)first * snow_type_size(c->type));
    }
}

static void copy(const snow_volume *volume, void *voxels) {
    const size_t size = snow_type_size(volume->info.type);
    int64_t count;
    uint64_t here, bytes;
    snow_volume_count(volume->info.dims, volume->info.type, &count, &bytes);
    for (int64_t first = 0; first < count; first += (int64_t)here) {
        here = (uint64_t)(count - first);
        const int64_t at = snow_volume_run(volume, first, &here);
        memcpy((char *)voxels + (size_t)first * size,
               (const char *)volume->voxels + (size_t)at * size,
               (size_t)here * size);
    }
}

static bool is_plain(const snow_volume_info *info) {
    return info->slope == 1 && info->intercept == 0;
}

/* The least type, not below the native one, that holds the data values. */
static snow_type exact_type(const snow_volume *volume) {
    static const snow_type order[] = {
        SNOW_TYPE_INT8,  SNOW_TYPE_UINT8,  SNOW_TYPE_INT16,  SNOW_TYPE_UINT16,
        SNOW_TYPE_INT32, SNOW_TYPE_UINT32, SNOW_TYPE_FLOAT32};
    snow_type native = volume->info.type;
    if (is_plain(&volume->info))
        return native;
    for (size_t i = 0; i < sizeof order / sizeof *order; i++) {
        conversion c = {.type = order[i], .slope = 1};
        set_limits(&c);
        if (snow_type_size(c.type) < snow_type_size(native))
            continue;
        run(volume, &c, NULL);
        if (!c.lost && !c.rounded)
            return c.type;
    }
    return SNOW_TYPE_FLOAT64;
}

/* range[0] .. range[1] onto all that an integer type holds. */
static snow_status set_range(const snow_volume *volume, const double range[2],
                             conversion *c) {
    if (!c->integer || snow_type_size(c->type) > 4)
        return snow_fail(volume->context, SNOW_STATUS_BAD_USAGE,
                         "cannot spread values over %s: only integers of 8, 16 "
                         "and 32 bits; leave out the range to keep the values",
                         snow_type_name(c->type));
    if (!(range[0] < range[1]) || !isfinite(range[1] - range[0]))
        return snow_fail(volume->context, SNOW_STATUS_BAD_USAGE,
                         "invalid range %g to %g: the first value must be less "
                         "than the second",
                         range[0], range[1]);
    c->slope = (c->most - c->least) / (range[1] - range[0]);
    c->shift = c->least - c->slope * range[0];
    c->clamps = true;
    return SNOW_STATUS_OK;
}

static snow_status fail_conversion(const snow_volume *volume,
                                   const conversion *c) {
    return snow_fail(volume->context, SNOW_STATUS_BAD_USAGE,
                     "%lld values such as %g do not fit %s; %s",
                     (long long)c->lost, c->first_lost, snow_type_name(c->type),
                     isnan(c->first_lost)
                         ? "convert to float32, which has NaN"
                         : "convert to float32, or give a range to be spread");
}

snow_status snow_volume_convert(const snow_volume *volume, snow_type type,
                                const double range[2], snow_volume **out) {
    snow_volume_info info = volume->info;
    conversion c = {.type = type,
                    .slope = 1,
                    .wide = info.type == SNOW_TYPE_INT64 ||
                            info.type == SNOW_TYPE_UINT64};
    snow_volume *made;
    SNOW_TRY(snow_volume_need_voxels(volume));
    if (!type)
        c.type = exact_type(volume);
    set_limits(&c);
    if (range) {
        SNOW_TRY(set_range(volume, range, &c));
        info.hounsfield = false;
        memset(info.window, 0, sizeof info.window);
    }
    info.type = c.type;
    info.eight_bits = false;
    info.slope = 1;
    info.intercept = 0;
    SNOW_TRY(snow_volume_new(volume->context, &info, &made));
    made->masked = volume->masked;
    if (is_plain(&volume->info) && c.type == volume->info.type && !range)
        copy(volume, made->owned); /* 64 bits whole */
    else
        run(volume, &c, made->owned);
    if (c.lost) {
        snow_volume_close(made);
        return fail_conversion(volume, &c);
    }
    /* Reported, since the file does not show it. */
    const char *name = snow_type_name(c.type);
    if (range)
        snow_notify(volume->context, "values %g to %g became %g to %g of %s",
                    range[0], range[1], c.least, c.most, name);
    else if (c.rounded)
        snow_notify(volume->context, "%lld values were rounded to %s",
                    (long long)c.rounded, name);
    snow_status status =
        volume->labelled && !range
            ? snow_volume_set_labels(made, volume->labels, volume->label_count)
            : SNOW_STATUS_OK;
    if (status == SNOW_STATUS_OK)
        *out = made;
    else
        snow_volume_close(made);
    return status;
}

void snow_volume_fill(snow_volume *volume, double value) {
    const int64_t *dims = volume->info.dims;
    const size_t count = (size_t)(dims[0] * dims[1] * dims[2]);
    switch (volume->info.type) {
#define FILL(name, c_type, text)              \
    case SNOW_TYPE_##name: {                  \
        c_type *to = (c_type *)volume->owned; \
        for (size_t n = 0; n < count; n++)    \
            to[n] = (c_type)value;            \
        break;                                \
    }
        SNOW_TYPE_MAP(FILL)
#undef FILL
    case SNOW_TYPE_NONE:
        break;
    }
}
