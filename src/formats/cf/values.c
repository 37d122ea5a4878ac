/* formats/cf/values.c - the attributes of a variable, and which of its values
 * are missing (cf.h).
 *
 * After CF 2.5.1 and 8.1, and appendix A of the NetCDF Users' Guide: a value is
 * missing if it equals _FillValue or a number of missing_value, or lies outside
 * of the valid ones.  All are compared as they are stored. */
#include "formats/cf/model.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A step is searched for values that few have, up to this size; a larger one is
 * taken to have them, whether its parts do or not. */
#define SEARCHED_BYTES ((uint64_t)256 << 20)

enum { FILL, MISSING, RANGE, LEAST, MOST, LIMITS };

const char *const snow_cf_names[] = {
    "_FillValue",    "missing_value", "valid_range", "valid_min",   "valid_max",
    "scale_factor",  "add_offset",    "_Unsigned",   "units",       "unit",
    "standard_name", "long_name",     "description", "axis",        "calendar",
    "positive",      "flag_values",   "flag_masks",  "coordinates", NULL};

/* --- what a file says ----------------------------------------------------- */

void snow_cf_attributes_begin(cf_attributes *out) {
    memset(out, 0, sizeof *out);
    out->scale = 1;
}

cf_number snow_cf_number(double value) {
    cf_number number = {value, 0};
    if (value >= 0x1p64)
        number.whole = UINT64_MAX;
    else if (value >= 0)
        number.whole = (uint64_t)value;
    else if (value >= -0x1p63)
        number.whole = (uint64_t)(int64_t)value;
    return number;
}

static void take_text(const char *name, const char *text, cf_attributes *out) {
    const struct {
        const char *name;
        char *to;
        size_t capacity;
        bool second; /* only where there is no other */
    } texts[] = {
        {"units", out->units, sizeof out->units, false},
        {"unit", out->units, sizeof out->units, true},
        {"standard_name", out->standard_name, sizeof out->standard_name, false},
        {"long_name", out->long_name, sizeof out->long_name, false},
        {"description", out->long_name, sizeof out->long_name, true},
        {"axis", out->axis, sizeof out->axis, false},
        {"calendar", out->calendar, sizeof out->calendar, false},
        {"positive", out->positive, sizeof out->positive, false},
        {"coordinates", out->coordinates, sizeof out->coordinates, false},
    };
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        if (!strcmp(name, texts[i].name) && !(texts[i].second && *texts[i].to))
            snprintf(texts[i].to, texts[i].capacity, "%.*s",
                     (int)texts[i].capacity - 1, text);
    if (!strcmp(name, "_Unsigned"))
        out->sign = snow_same_name(text, "true")    ? 1
                    : snow_same_name(text, "false") ? -1
                                                    : 0;
}

void snow_cf_take(const char *name, const cf_attribute *given,
                  cf_attributes *out) {
    const double first = given->count ? given->numbers[0].value : NAN;
    take_text(name, given->text, out);
    for (int i = 0; i < LIMITS; i++)
        if (!strcmp(name, snow_cf_names[i]))
            out->limits[i] = *given;
    if (!strcmp(name, "scale_factor") && given->count == 1 && isfinite(first) &&
        first != 0)
        out->scale = first;
    if (!strcmp(name, "add_offset") && given->count == 1 && isfinite(first))
        out->offset = first;
    out->codes |= !strncmp(name, "flag_", 5);
    out->any |= !strcmp(name, "scale_factor") || !strcmp(name, "add_offset") ||
                !strcmp(name, "_FillValue") || !strcmp(name, "missing_value") ||
                !strcmp(name, "standard_name");
}

/* --- what it means -------------------------------------------------------- */

static bool is_integer(snow_type type) {
    return type < SNOW_TYPE_FLOAT32;
}

cf_values snow_cf_values_default(snow_type type) {
    return (cf_values){.type = type,
                       .scale = 1,
                       .codes = is_integer(type),
                       .least = {-INFINITY, (uint64_t)INT64_MIN},
                       .most = {INFINITY, INT64_MAX}};
}

/* Makes a number one of the type; false if that cannot hold it.  Of a type
 * whose sign was changed it may be a number of the stored one: -1 is 255. */
static bool fits(snow_type type, bool changed, cf_number *n) {
    const double end = ldexp(1, 8 * (int)snow_type_size(type));
    const double low = snow_type_is_signed(type) ? -end / 2 : 0,
                 high = low + end;
    if (type == SNOW_TYPE_FLOAT64)
        return true;
    if (type == SNOW_TYPE_FLOAT32) {
        const bool finite = isfinite(n->value);
        n->value = (double)(float)n->value;
        return isfinite(n->value) || !finite;
    }
    if (changed && n->value < low)
        n->value += end;
    else if (changed && n->value >= high)
        n->value -= end;
    /* The largest of 64 bits are rounded up to the end. */
    return n->value >= low && floor(n->value) == n->value &&
           (n->value < high || (end == 0x1p64 && n->value <= high));
}

/* Numbers of an attribute in the type; 0, and a note, where it holds not
 * all. */
static int take_limit(snow_context *context, const cf_attribute *from,
                      const char *name, const cf_values *values, bool changed,
                      cf_number *out) {
    const int count =
        from->count > CF_MOST_NUMBERS ? CF_MOST_NUMBERS : (int)from->count;
    bool right = !*from->text && from->count <= CF_MOST_NUMBERS;
    for (int i = 0; i < count; i++) {
        out[i] = from->numbers[i];
        right = right && fits(values->type, changed, &out[i]);
    }
    if (!right)
        snow_notify(context,
                    "%s is ignored: it is %s; what it names is drawn as any "
                    "other value",
                    name,
                    *from->text                     ? "a text"
                    : from->count > CF_MOST_NUMBERS ? "longer than 64 numbers"
                                                    : "no value of the type");
    return right ? count : 0;
}

/* NC_FILL_SHORT and others of netcdf.h; none of bytes. */
static void take_default(snow_type type, cf_values *out) {
    static const struct {
        snow_type type;
        cf_number fill;
    } fills[] = {{SNOW_TYPE_INT16, {-32767, 0}},
                 {SNOW_TYPE_UINT16, {65535, 0}},
                 {SNOW_TYPE_INT32, {-2147483647, 0}},
                 {SNOW_TYPE_UINT32, {4294967295, 0}},
                 {SNOW_TYPE_INT64, {-0x1p63, (uint64_t)INT64_MIN + 2}},
                 {SNOW_TYPE_UINT64, {0x1p64, UINT64_MAX - 1}},
                 {SNOW_TYPE_FLOAT32, {0x1.ep122, 0}},
                 {SNOW_TYPE_FLOAT64, {0x1.ep122, 0}}};
    for (size_t i = 0; i < sizeof fills / sizeof *fills; i++)
        if (fills[i].type == type) {
            out->fill[out->fills] = fills[i].fill;
            out->fills +=
                fits(out->type, out->type != type, &out->fill[out->fills]);
        }
}

cf_values snow_cf_settle(snow_context *context, const cf_attributes *from,
                         snow_type type, bool is_netcdf) {
    cf_values out = snow_cf_values_default(type);
    cf_number n[CF_MOST_NUMBERS];
    out.scale = from->scale;
    out.offset = from->offset;
    out.codes = from->codes ||
                (is_integer(type) && from->scale == 1 && from->offset == 0);
    /* Integers of NetCDF's old versions are signed, bytes of HDF4 unsigned. */
    if (is_integer(type) && from->sign)
        out.type = snow_type_of_integer(snow_type_size(type), from->sign < 0);
    if (out.type == SNOW_TYPE_UINT64) {
        out.least.whole = 0;
        out.most.whole = UINT64_MAX;
    }
    const bool changed = out.type != type;
    for (int i = 0; i < LIMITS; i++) {
        const int count = take_limit(context, &from->limits[i],
                                     snow_cf_names[i], &out, changed, n);
        for (int k = 0; k < count && i <= MISSING; k++)
            if (!isnan(n[k].value))
                out.fill[out.fills++] = n[k];
        if (count == (i == RANGE ? 2 : 1) && i >= RANGE) {
            out.least = i != MOST ? n[0] : out.least;
            out.most = i != LEAST ? n[count - 1] : out.most;
            out.limited = true;
        }
    }
    if (is_netcdf && !from->limits[FILL].count && !*from->limits[FILL].text) {
        out.rare = !out.fills && !out.limited && is_integer(out.type);
        take_default(type, &out);
    }
    return out;
}

/* --- values --------------------------------------------------------------- */

/* Never of a NaN. */
static bool is_below(snow_type type, cf_number a, cf_number b) {
    if (type == SNOW_TYPE_INT64)
        return (int64_t)a.whole < (int64_t)b.whole;
    return type == SNOW_TYPE_UINT64 ? a.whole < b.whole : a.value < b.value;
}

static bool is_missing(const cf_values *v, cf_number n) {
    bool found =
        is_below(v->type, n, v->least) || is_below(v->type, v->most, n);
    for (int i = 0; i < v->fills && !found; i++)
        found = !is_below(v->type, n, v->fill[i]) &&
                !is_below(v->type, v->fill[i], n);
    return found;
}

static bool is_masked(const cf_values *values) {
    return values->fills || values->limited;
}

/* Missing ones become NaN. */
static void decode(const cf_values *values, int64_t count, double *numbers) {
    const double end = ldexp(1, 8 * (int)snow_type_size(values->type));
    for (int64_t i = 0; i < count; i++) {
        double value = numbers[i];
        if (is_integer(values->type) && value < 0 &&
            !snow_type_is_signed(values->type))
            value += end;
        if (snow_type_is_signed(values->type) && value >= end / 2)
            value -= end;
        numbers[i] = is_missing(values, snow_cf_number(value))
                         ? NAN
                         : value * values->scale + values->offset;
    }
}

void snow_cf_take_axis(snow_context *context, const cf_attributes *says,
                       snow_type type, bool is_netcdf, int64_t count,
                       double *values, cf_axis *out) {
    const cf_values stored = snow_cf_settle(context, says, type, is_netcdf);
    decode(&stored, count, values);
    snow_cf_measure(values, count, says, out);
}

static snow_type float_type(snow_type type) {
    return !is_integer(type)           ? type
           : snow_type_size(type) <= 2 ? SNOW_TYPE_FLOAT32
                                       : SNOW_TYPE_FLOAT64;
}

static cf_number number_at(const snow_volume *volume, int64_t i) {
    cf_number n = {snow_volume_native(volume, i), 0};
    if (is_integer(volume->info.type) &&
        snow_type_size(volume->info.type) == sizeof n.whole)
        memcpy(&n.whole, (const char *)volume->owned + 8 * i, sizeof n.whole);
    return n;
}

static int64_t count_of(const snow_volume *volume) {
    const int64_t *dims = volume->info.dims;
    return dims[0] * dims[1] * dims[2];
}

/* Replaces missing values of `from` in `to`, which may be the same. */
static void blank(const cf_values *values, const snow_volume *from,
                  bool is_whole, snow_volume *to) {
    int64_t rounded = 0, left = 0;
    for (int64_t i = 0; i < count_of(to); i++) {
        const cf_number n = number_at(from, i);
        const bool missing = is_missing(values, n);
        const double value = missing ? NAN : n.value;
        left += !missing;
        if (!missing && to == from)
            continue;
        rounded += n.whole && !missing && fabs(n.value) > 0x1p53;
        if (to->info.type == SNOW_TYPE_FLOAT32)
            ((float *)to->owned)[i] = (float)value;
        else
            ((double *)to->owned)[i] = value;
    }
    if (!left && is_whole)
        snow_notify(to->context,
                    "all voxels are missing, by _FillValue, missing_value or "
                    "the range of valid values as they are stored");
    if (rounded)
        snow_notify(to->context,
                    "%lld integers above 2^53 are rounded to float64, which "
                    "can hold missing values beside them",
                    (long long)rounded);
}

static snow_status blank_volume(const cf_values *values, bool is_whole,
                                snow_volume **volume) {
    snow_volume *old = *volume, *made = old;
    snow_volume_info info = old->info;
    info.type = float_type(info.type);
    if (info.type != old->info.type)
        SNOW_TRY(snow_volume_new(old->context, &info, &made));
    blank(values, old, is_whole, made);
    if (made != old)
        snow_volume_close(old);
    *volume = made;
    return SNOW_STATUS_OK;
}

/* --- rare fill values ----------------------------------------------------- */

static bool has_any(const cf_values *values, const snow_volume *volume) {
    bool found = false;
    for (int64_t i = 0; i < count_of(volume) && !found; i++)
        found = is_missing(values, number_at(volume, i));
    return found;
}

/* Voxels as they are stored. */
typedef struct stored_values {
    cf_values *values;
    cf_read_fn *read;
    void *user;
} stored_values;

/* Looks for a rare fill value in the whole step, of which a box may be read,
 * so that all boxes have one type.  What cannot be read may have it. */
static snow_status search(const stored_values *s,
                          const snow_volume_options *options,
                          const snow_volume_info *info, bool *found) {
    snow_volume_options whole = *options;
    snow_volume_info step = *info;
    snow_volume *volume = NULL;
    memset(whole.crop, 0, sizeof whole.crop);
    const snow_status status = s->read(s->user, &whole, &step, &volume);
    if (status == SNOW_STATUS_STOPPED || status == SNOW_STATUS_NO_MEMORY)
        return status;
    *found = status != SNOW_STATUS_OK || has_any(s->values, volume);
    snow_volume_close(volume);
    return SNOW_STATUS_OK;
}

/* `info` is of the whole step, `volume` NULL or what was read. */
static snow_status settle_rare(const stored_values *s,
                               const snow_volume_options *options,
                               const snow_volume_info *info,
                               const snow_volume *volume) {
    int64_t voxels;
    uint64_t bytes;
    bool found = true;
    if (!s->values->rare)
        return SNOW_STATUS_OK;
    if (snow_volume_count(info->dims, info->type, &voxels, &bytes) &&
        bytes <= SEARCHED_BYTES) {
        if (volume && count_of(volume) == voxels)
            found = has_any(s->values, volume);
        else
            SNOW_TRY(search(s, options, info, &found));
    }
    s->values->rare = false;
    if (!found)
        s->values->fills = 0;
    return SNOW_STATUS_OK;
}

/* A box of the file's own voxels. */
static snow_status read_data(void *user, const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out) {
    const stored_values *s = user;
    const snow_volume_info whole = *info;
    snow_volume *volume = NULL;
    SNOW_TRY(s->read(s->user, options, info, out ? &volume : NULL));
    snow_status status = settle_rare(s, options, &whole, volume);
    if (status == SNOW_STATUS_OK && volume && is_masked(s->values))
        status = blank_volume(
            s->values,
            !memcmp(whole.dims, volume->info.dims, sizeof whole.dims), &volume);
    if (is_masked(s->values))
        info->type = float_type(info->type);
    info->slope = s->values->scale;
    info->intercept = s->values->offset;
    return snow_volume_give(status, volume, out);
}

snow_status snow_cf_read(snow_context *context, const cf_model *model,
                         const snow_uneven *grid, cf_values *values,
                         cf_read_fn *read, void *user,
                         const snow_volume_options *options,
                         snow_volume_info *info, snow_volume **out) {
    stored_values s = {values, read, user};
    cf_reading means = {context, model, read_data, &s};
    cf_reading columns = {context, model, snow_model_means, &means};
    snow_uneven own = *grid;
    own.codes = values->codes;
    if (!model || !model->file)
        return snow_uneven_read(context, &own, options, read_data, &s, info,
                                out);
    if (model->levels)
        return snow_model_columns(&columns, options, info, out);
    return snow_uneven_read(context, &own, options, snow_model_means, &means,
                            info, out);
}
