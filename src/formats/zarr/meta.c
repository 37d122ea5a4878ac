/* formats/zarr/meta.c - reads the metadata of an array: .zarray of version 2,
 * zarr.json of version 3.
 *
 * All contents of these files are validated.  After snow_zarr_describe all
 * sizes are at least 1, and the bytes of a chunk and of all values fit 63
 * bits. */
#include "formats/zarr/zarr.h"

#include <string.h>

/* --- sizes and types ------------------------------------------------------ */

/* Sizes of at least 1 for each axis. */
static bool take_sizes(const json_t *list, int axes, int64_t *out) {
    if (json_array_size(list) != (size_t)axes)
        return false;
    for (int i = 0; i < axes; i++) {
        double size = json_number_value(json_array_get(list, (size_t)i));
        if (!(size >= 1 && size < 0x1p53) || size != (double)(int64_t)size)
            return false;
        out[i] = (int64_t)size;
    }
    return true;
}

static snow_status take_shape(const json_t *list, zarr_array *array) {
    size_t axes = json_array_size(list);
    if (axes < 1 || axes > ZARR_MOST_AXES)
        return ZARR_FAIL(array,
                         "has %zu axes, but only 1 to %d are supported; choose "
                         "another array with --dataset",
                         axes, ZARR_MOST_AXES);
    array->axes = (int)axes;
    if (!take_sizes(list, array->axes, array->sizes))
        return ZARR_FAIL(
            array, "has an axis without a whole size of at least 1: it is "
                   "empty or damaged; choose another array with --dataset");
    return SNOW_STATUS_OK;
}

/* After this no product overflows. */
static snow_status check_bytes(const zarr_array *array) {
    uint64_t steps[ZARR_MOST_AXES], all;
    for (int i = 0; i < array->axes; i++)
        if (array->file[i] % array->chunk[i])
            return ZARR_FAIL(array,
                             "has chunks of %lld in shards of %lld, which are "
                             "not a multiple; correct zarr.json",
                             (long long)array->chunk[i],
                             (long long)array->file[i]);
    if (snow_array_steps(array->sizes, array->axes, 8, steps, &all) &&
        snow_array_steps(array->file, array->axes, 8, steps, &all))
        return SNOW_STATUS_OK;
    return ZARR_FAIL(array, "has sizes too large for any array; it is damaged");
}

static snow_status take_type(char kind, size_t width, const char *given,
                             zarr_array *array) {
    array->type = snow_numpy_type(kind, width, &array->values);
    array->width = width;
    if (array->type)
        return SNOW_STATUS_OK;
    return ZARR_FAIL(array,
                     "has the unsupported type \"%.40s\"; convert the values "
                     "to one of bool, int8 to uint64, float16 to float64",
                     given ? given : "(several in one)");
}

/* --- version 2 ------------------------------------------------------------ */

/* Filters come before the compressor, in the order of writing. */
static snow_status take_coders_2(const json_t *meta, zarr_array *array) {
    const json_t *filters = json_object_get(meta, "filters");
    const json_t *packer = json_object_get(meta, "compressor");
    if (filters && !json_is_array(filters) && !json_is_null(filters))
        return ZARR_FAIL(
            array,
            "has filters that are neither a list nor null; correct .zarray");
    for (size_t i = 0; i <= json_array_size(filters); i++) {
        bool last = i == json_array_size(filters);
        const json_t *coder = last ? packer : json_array_get(filters, i);
        const char *name = json_string_value(json_object_get(coder, "id"));
        if (last && (!coder || json_is_null(coder)))
            break;
        SNOW_TRY(snow_zarr_add_coder(name ? name : "(none)", coder, array));
    }
    return SNOW_STATUS_OK;
}

static snow_status take_order(const json_t *meta, zarr_array *array) {
    const char *order = json_string_value(json_object_get(meta, "order"));
    bool fortran = order && !strcmp(order, "F");
    if (!fortran && !(order && !strcmp(order, "C")))
        return ZARR_FAIL(
            array,
            "has no valid order; it must be \"C\" or \"F\": correct .zarray");
    for (int i = 0; i < array->axes; i++)
        array->order[i] = fortran ? array->axes - 1 - i : i;
    return SNOW_STATUS_OK;
}

static snow_status take_separator(const json_t *given, char usual,
                                  zarr_array *array) {
    const char *text = json_string_value(given);
    array->separator = text ? *text : usual;
    if (!given || (text && (!strcmp(text, ".") || !strcmp(text, "/"))))
        return SNOW_STATUS_OK;
    return ZARR_FAIL(
        array,
        "has a chunk separator that is neither \".\" nor \"/\"; correct it");
}

static snow_status describe_2(const json_t *meta, zarr_array *array) {
    const json_t *version = json_object_get(meta, "zarr_format");
    if (version && json_number_value(version) != 2)
        return ZARR_FAIL(
            array,
            ".zarray has version %g, but only 2 is supported; convert it",
            json_number_value(version));
    SNOW_TRY(take_shape(json_object_get(meta, "shape"), array));
    if (!take_sizes(json_object_get(meta, "chunks"), array->axes, array->chunk))
        return ZARR_FAIL(array,
                         "lacks a chunk size for some axes; correct .zarray");
    memcpy(array->file, array->chunk, sizeof array->file);
    /* "<f8": the byte order, the kind, the number of bytes. */
    const char *given = json_string_value(json_object_get(meta, "dtype"));
    bool right = given && strlen(given) == 3 && strchr("<>|", *given) &&
                 given[2] >= '1' && given[2] <= '8';
    array->big_endian = right && *given == '>';
    SNOW_TRY(take_type(right ? given[1] : '?',
                       right ? (size_t)(given[2] - '0') : 0, given, array));
    SNOW_TRY(take_order(meta, array));
    SNOW_TRY(take_separator(json_object_get(meta, "dimension_separator"), '.',
                            array));
    return take_coders_2(meta, array);
}

/* --- version 3 ------------------------------------------------------------ */

/* An extension is a name, or an object with one. */
static const char *name_of(const json_t *extension) {
    const char *name = json_string_value(
        json_is_object(extension) ? json_object_get(extension, "name")
                                  : extension);
    return name ? name : "(none)";
}

/* "uint16": the letters give the kind, the number after them the bits. */
static snow_status take_data_type(const json_t *meta, zarr_array *array) {
    static const char *const kinds[] = {"int", "uint", "float"};
    const char *given = name_of(json_object_get(meta, "data_type"));
    if (!strcmp(given, "bool"))
        return take_type('b', 1, given, array);
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        size_t letters = strlen(kinds[i]);
        int64_t bits;
        if (!strncmp(given, kinds[i], letters) &&
            snow_parse_int64(given + letters, &bits) && bits >= 8 &&
            bits <= 64 && bits % 8 == 0)
            return take_type(*kinds[i], (size_t)bits / 8, given, array);
    }
    return take_type('?', 0, given, array);
}

/* The names of files: "c/0/1/2", or as in version 2. */
static snow_status take_keys(const json_t *meta, zarr_array *array) {
    const json_t *keys = json_object_get(meta, "chunk_key_encoding");
    const char *name = name_of(keys);
    array->prefixed = !strcmp(name, "default");
    if (!array->prefixed && strcmp(name, "v2") != 0)
        return ZARR_FAIL(array,
                         "uses the unknown chunk key encoding \"%.40s\"; copy "
                         "the array with \"default\"",
                         name);
    const json_t *given =
        json_object_get(json_object_get(keys, "configuration"), "separator");
    return take_separator(given, array->prefixed ? '/' : '.', array);
}

/* A permutation: axis order[i] of the array is axis i of a chunk. */
static snow_status take_transposition(const json_t *given, zarr_array *array) {
    const json_t *list = json_object_get(given, "order");
    unsigned seen = 0;
    int order[ZARR_MOST_AXES];
    for (int i = 0; i < array->axes; i++) {
        const json_t *axis = json_array_get(list, (size_t)i);
        json_int_t number =
            json_is_integer(axis) ? json_integer_value(axis) : -1;
        if (number >= 0 && number < array->axes)
            seen |= 1U << number;
        order[i] = (int)number;
    }
    if (seen + 1 != 1U << array->axes)
        return ZARR_FAIL(array, "has a transpose codec that is not a "
                                "permutation of its axes; correct zarr.json");
    for (int i = 0; i < array->axes; i++)
        order[i] = array->order[order[i]];
    memcpy(array->order, order, sizeof order);
    return SNOW_STATUS_OK;
}

static snow_status take_endian(const json_t *given, zarr_array *array) {
    const char *text = json_string_value(json_object_get(given, "endian"));
    array->big_endian = text && !strcmp(text, "big");
    if (array->width == 1 || array->big_endian ||
        (text && !strcmp(text, "little")))
        return SNOW_STATUS_OK;
    return ZARR_FAIL(array, "has no valid byte order; it must be \"little\" or "
                            "\"big\": correct zarr.json");
}

/* The index of a shard: plain, with or without a checksum. */
static snow_status take_index(const json_t *given, zarr_array *array) {
    const json_t *codecs = json_object_get(given, "index_codecs");
    const char *place =
        json_string_value(json_object_get(given, "index_location"));
    array->sharded = true;
    array->index_first = place && !strcmp(place, "start");
    size_t count = json_array_size(codecs);
    const json_t *bytes = json_array_get(codecs, 0);
    const char *endian = json_string_value(
        json_object_get(json_object_get(bytes, "configuration"), "endian"));
    array->index_summed =
        count == 2 && !strcmp(name_of(json_array_get(codecs, 1)), "crc32c");
    if ((count == 1 || array->index_summed) &&
        !strcmp(name_of(bytes), "bytes") && !(endian && !strcmp(endian, "big")))
        return SNOW_STATUS_OK;
    return ZARR_FAIL(array, "has an index of its shards with other codecs than "
                            "bytes and crc32c; copy the array with these");
}

/* Reads the codecs of a list; `inner` is true within a shard. */
static snow_status take_codecs(const json_t *list, bool inner,
                               zarr_array *array) {
    bool has_bytes = false;
    for (size_t i = 0; i < json_array_size(list); i++) {
        const json_t *codec = json_array_get(list, i);
        const json_t *given = json_object_get(codec, "configuration");
        const char *name = name_of(codec);
        if (!strcmp(name, "transpose") && !has_bytes) {
            SNOW_TRY(take_transposition(given, array));
        } else if (!strcmp(name, "bytes") && !has_bytes) {
            SNOW_TRY(take_endian(given, array));
            has_bytes = true;
        } else if (!strcmp(name, "sharding_indexed") && !inner &&
                   json_array_size(list) == 1) {
            if (!take_sizes(json_object_get(given, "chunk_shape"), array->axes,
                            array->chunk))
                return ZARR_FAIL(array, "lacks a chunk size in its shards for "
                                        "some axes; correct zarr.json");
            SNOW_TRY(take_index(given, array));
            return take_codecs(json_object_get(given, "codecs"), true, array);
        } else {
            SNOW_TRY(snow_zarr_add_coder(name, given, array));
        }
    }
    return has_bytes
               ? SNOW_STATUS_OK
               : ZARR_FAIL(array, "has no codec \"bytes\"; correct zarr.json");
}

static snow_status describe_3(const json_t *meta, zarr_array *array) {
    const json_t *grid = json_object_get(meta, "chunk_grid");
    const json_t *changed = json_object_get(meta, "storage_transformers");
    if (changed && !(json_is_array(changed) && !json_array_size(changed)))
        return ZARR_FAIL(
            array,
            "is stored through the transformer \"%.40s\", which is not "
            "supported; copy the array without storage_transformers",
            name_of(json_array_get(changed, 0)));
    SNOW_TRY(take_shape(json_object_get(meta, "shape"), array));
    const json_t *chunks =
        json_object_get(json_object_get(grid, "configuration"), "chunk_shape");
    if (strcmp(name_of(grid), "regular") != 0 ||
        !take_sizes(chunks, array->axes, array->file))
        return ZARR_FAIL(
            array,
            "does not have a regular chunk grid; copy the array with one");
    memcpy(array->chunk, array->file, sizeof array->chunk);
    for (int i = 0; i < array->axes; i++)
        array->order[i] = i;
    SNOW_TRY(take_data_type(meta, array));
    SNOW_TRY(take_keys(meta, array));
    return take_codecs(json_object_get(meta, "codecs"), false, array);
}

/* --- both ----------------------------------------------------------------- */

/* Reads the names of axes, as xarray and version 3 store them. */
static void take_names(const zarr_node *node, zarr_array *array) {
    const json_t *list =
        node->version == 3
            ? json_object_get(node->meta, "dimension_names")
            : json_object_get(node->attributes, "_ARRAY_DIMENSIONS");
    if (json_array_size(list) != (size_t)array->axes)
        return;
    for (int i = 0; i < array->axes; i++) {
        const char *name = json_string_value(json_array_get(list, (size_t)i));
        if (name && strlen(name) < ZARR_NAME_BYTES)
            memcpy(array->names[i], name, strlen(name) + 1);
    }
}

snow_status snow_zarr_describe(const zarr_store *store, const char *path,
                               const zarr_node *node, zarr_array *out) {
    zarr_array array = {.store = store, .version = node->version};
    memcpy(array.path, path, strlen(path) + 1);
    SNOW_TRY(node->version == 3 ? describe_3(node->meta, &array)
                                : describe_2(node->meta, &array));
    SNOW_TRY(check_bytes(&array));
    SNOW_TRY(
        snow_zarr_take_fill(json_object_get(node->meta, "fill_value"), &array));
    take_names(node, &array);
    *out = array;
    return SNOW_STATUS_OK;
}
