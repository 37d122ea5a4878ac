/* formats/zarr/codec.c - the codecs in an array's metadata, and the fill value
 * of voxels that are not stored.
 *
 * Version 2 names the codecs of numcodecs, version 3 its own, which are the
 * same. */
#include "formats/zarr/zarr.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* --- codecs --------------------------------------------------------------- */

static const struct {
    const char *name;
    zarr_packer packer;
} packers[] = {
    {"zlib", ZARR_INFLATE}, {"gzip", ZARR_INFLATE}, {"zstd", ZARR_ZSTD},
    {"lz4", ZARR_LZ4},      {"blosc", ZARR_BLOSC},
};

static snow_status add_packer(const char *name, const json_t *given,
                              zarr_packer packer, zarr_array *array) {
    zarr_coding *coding = &array->coding;
    const char *inner = json_string_value(json_object_get(given, "cname"));
    if (coding->packer)
        return ZARR_FAIL(array,
                         "is compressed twice, by %s and %.40s; copy the "
                         "array with one of them",
                         coding->text, name);
    coding->packer = packer;
    snprintf(coding->text, sizeof coding->text, "%.16s%s%.16s", name,
             inner ? " " : "", inner ? inner : "");
    return SNOW_STATUS_OK;
}

static snow_status add_filter(const char *name, zarr_filter filter,
                              zarr_array *array) {
    zarr_coding *coding = &array->coding;
    if (coding->packer || coding->inner_sums ||
        coding->filter_count == ZARR_MOST_FILTERS)
        return ZARR_FAIL(array,
                         "has the filter %.40s in an unsupported place; "
                         "copy the array without filters",
                         name);
    coding->filters[coding->filter_count++] = filter;
    return SNOW_STATUS_OK;
}

/* Delta is supported for differences of the array's own type. */
static bool is_own_delta(const json_t *given, const zarr_array *array) {
    static const char *const keys[] = {"dtype", "astype"};
    for (int i = 0; i < 2; i++) {
        const json_t *item = json_object_get(given, keys[i]);
        const char *type = json_string_value(item);
        if (!item && i)
            continue; /* the same as dtype */
        if (!type || strlen(type) != 3 || !strchr("iu", type[1]) ||
            (size_t)(type[2] - '0') != array->width ||
            (*type == '>') != array->big_endian)
            return false;
    }
    return array->type < SNOW_TYPE_FLOAT32 &&
           array->values == SNOW_CODING_PLAIN;
}

snow_status snow_zarr_add_coder(const char *name, const json_t *given,
                                zarr_array *array) {
    zarr_coding *coding = &array->coding;
    if (!strncmp(name, "numcodecs.", 10))
        name += 10;
    for (size_t i = 0; i < sizeof packers / sizeof *packers; i++)
        if (!strcmp(name, packers[i].name))
            return add_packer(name, given, packers[i].packer, array);
    if (!strcmp(name, "crc32c")) {
        int *sums = coding->packer ? &coding->outer_sums : &coding->inner_sums;
        if (++*sums <= 2)
            return SNOW_STATUS_OK;
    }
    if (!strcmp(name, "shuffle")) {
        double width = json_number_value(json_object_get(given, "elementsize"));
        if (width >= 1 && width <= 64)
            return add_filter(name, (zarr_filter){ZARR_SHUFFLE, (size_t)width},
                              array);
    }
    if (!strcmp(name, "delta") && is_own_delta(given, array))
        return add_filter(name, (zarr_filter){ZARR_DELTA, array->width}, array);
    return ZARR_FAIL(
        array,
        "uses the codec %.40s, which is not supported; copy the array without "
        "filters, compressed by zstd, gzip or blosc (zarr.copy, or ome_zarr)",
        name);
}

/* --- fill ----------------------------------------------------------------- */

bool snow_zarr_number(const json_t *given, double *out) {
    static const struct {
        const char *name;
        double value;
    } words[] = {{"NaN", NAN},
                 {"Infinity", INFINITY},
                 {"-Infinity", -INFINITY},
                 {"", NAN}}; /* what node.c makes of one without quotes */
    const char *text = json_string_value(given);
    if (!given || json_is_null(given) || json_is_false(given))
        *out = 0;
    else if (json_is_true(given))
        *out = 1;
    else if (json_is_number(given))
        *out = json_number_value(given);
    else
        for (size_t i = 0; i < sizeof words / sizeof *words; i++)
            if (text && !strcmp(text, words[i].name)) {
                *out = words[i].value;
                return true;
            }
    return !json_is_array(given) && !json_is_object(given) && !text;
}

/* "0x7fc00000": the bits of a float. */
static bool fill_bits(const json_t *given, const zarr_array *array,
                      double *out) {
    const char *text = json_string_value(given);
    uint64_t bits = 0;
    if (!text || strncmp(text, "0x", 2) != 0 ||
        strlen(text) != 2 + 2 * array->width)
        return false;
    for (const char *at = text + 2; *at; at++) {
        const char *digits = "0123456789abcdef0123456789ABCDEF";
        const char *digit = strchr(digits, *at);
        if (!digit)
            return false;
        bits = bits << 4 | (uint64_t)((digit - digits) % 16);
    }
    float single;
    uint32_t low = (uint32_t)bits;
    memcpy(&single, &low, sizeof single);
    if (array->values == SNOW_CODING_HALF)
        single = snow_half_to_float((uint16_t)bits);
    *out = single;
    if (array->type == SNOW_TYPE_FLOAT64)
        memcpy(out, &bits, sizeof bits);
    return array->type == SNOW_TYPE_FLOAT64 || array->type == SNOW_TYPE_FLOAT32;
}

/* Returns false for a number outside of the type.  A double rounds INT64_MAX
 * and UINT64_MAX up by one; those values are accepted as the maxima. */
static bool store_whole(const json_t *given, double value, snow_type type,
                        unsigned char *fill) {
    size_t width = snow_type_size(type);
    bool is_signed = snow_type_is_signed(type);
    double end = ldexp(1, (int)(8 * width) - (is_signed ? 1 : 0));
    double least = is_signed ? -end : 0;
    if (!(value >= least && (value < end || (width == 8 && value <= end))) ||
        floor(value) < value)
        return false;
    uint64_t bits;
    if (json_is_integer(given))
        bits = (uint64_t)json_integer_value(given);
    else if (value >= end)
        bits = is_signed ? INT64_MAX : UINT64_MAX;
    else
        bits = value < 0 ? (uint64_t)(int64_t)value : (uint64_t)value;
    for (size_t i = 0; i < width; i++) {
        size_t at = snow_machine_big_endian() ? width - 1 - i : i;
        fill[at] = (unsigned char)(bits >> (8 * i));
    }
    return true;
}

snow_status snow_zarr_take_fill(const json_t *given, zarr_array *array) {
    double value = 0;
    bool right =
        snow_zarr_number(given, &value) || fill_bits(given, array, &value);
    float single = right ? (float)value : 0;
    if (right && array->type == SNOW_TYPE_FLOAT64)
        memcpy(array->fill, &value, sizeof value);
    else if (right && array->type == SNOW_TYPE_FLOAT32)
        memcpy(array->fill, &single, sizeof single);
    else if (right)
        right = store_whole(given, value, array->type, array->fill);
    if (!right)
        return ZARR_FAIL(array,
                         "has a fill_value that is not a valid %s; correct it",
                         snow_type_name(array->type));
    array->has_fill = given && !json_is_null(given);
    array->fill_number =
        json_is_integer(given)
            ? (cf_number){value, (uint64_t)json_integer_value(given)}
            : snow_cf_number(value);
    snow_text_print(array->fill_text, sizeof array->fill_text, "%g", value);
    return SNOW_STATUS_OK;
}
