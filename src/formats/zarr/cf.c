/* formats/zarr/cf.c - arrays of data sets, as xarray writes them: attributes of
 * the Climate and Forecast conventions (formats/cf.h), and coordinates in
 * arrays that have the names of axes.
 *
 *     .zarray      fill_value, which xarray's version 2 has for _FillValue
 *     .zattrs      _ARRAY_DIMENSIONS, scale_factor, units, ...
 *     zarr.json    dimension_names; _FillValue as base64 of a double */
#include "formats/bytes/number.h"
#include "formats/zarr/zarr.h"
#include "io/filters/filters.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* --- attributes ----------------------------------------------------------- */

/* The eight bytes of a double, which xarray writes for a float. */
static bool read_base64(snow_context *context, const char *text, double *out) {
    unsigned char bytes[9];
    size_t got = 0;
    snow_source *source;
    if (snow_source_open_memory(context, "_FillValue", text, strlen(text),
                                &source) != SNOW_STATUS_OK)
        return false;
    if (snow_source_unpack_base64(source) == SNOW_STATUS_OK)
        snow_source_read(source, bytes, sizeof bytes, &got);
    snow_source_close(source);
    const uint64_t bits = got == 8 ? snow_number_at(bytes, 8, false) : 0;
    memcpy(out, &bits, sizeof bits);
    return got == 8;
}

static bool add_number(const json_t *given, cf_attribute *out) {
    double value;
    if (json_is_null(given) || json_is_boolean(given) ||
        !snow_zarr_number(given, &value))
        return false;
    if (out->count++ < CF_MOST_NUMBERS)
        out->numbers[out->count - 1] =
            json_is_integer(given)
                ? (cf_number){value, (uint64_t)json_integer_value(given)}
                : snow_cf_number(value);
    return true;
}

static void convert(snow_context *context, const char *name,
                    const json_t *given, cf_attribute *out) {
    const char *text = json_string_value(given);
    double value;
    memset(out, 0, sizeof *out);
    for (size_t i = 0; i < json_array_size(given); i++)
        if (!add_number(json_array_get(given, i), out))
            memcpy(out->text, "?", 2); /* no list of numbers */
    if (json_is_array(given) || add_number(given, out) || !text)
        return;
    if (!strcmp(name, "_FillValue") && read_base64(context, text, &value)) {
        out->numbers[0] = snow_cf_number(value);
        out->count = 1;
    } else {
        snprintf(out->text, sizeof out->text, "%.255s", text);
    }
}

static void read_attributes(snow_context *context, const json_t *from,
                            cf_attributes *out) {
    cf_attribute given;
    snow_cf_attributes_begin(out);
    for (const char *const *name = snow_cf_names; *name; name++) {
        const json_t *item = json_object_get(from, *name);
        convert(context, *name, item, &given);
        if (item)
            snow_cf_take(*name, &given, out);
    }
}

/* --- coordinates ---------------------------------------------------------- */

static snow_status read_values(const zarr_array *array, double **out) {
    snow_context *context = array->store->context;
    const int64_t count = array->sizes[0];
    zarr_box box = {.store = array->store,
                    .array = array,
                    .roles = {{0, -1, -1}, -1, -1, false},
                    .end = {count}};
    snow_volume_info info = snow_volume_info_default("zarr");
    snow_volume *line;
    info.dims[0] = count;
    info.type = array->type;
    SNOW_TRY(snow_zarr_check_box(&box, 8 * (uint64_t)count));
    SNOW_TRY(snow_volume_new(context, &info, &line));
    snow_status status = snow_zarr_fill(&box, line->owned);
    double *values = NULL;
    if (status == SNOW_STATUS_OK) {
        values = snow_allocate_array(context, (uint64_t)count, sizeof *values);
        status = values ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY;
    }
    if (values)
        snow_volume_stored(line, 0, (size_t)count, values);
    snow_volume_close(line);
    *out = values;
    return status;
}

/* Takes the coordinates of a node, if it is an array of them. */
static snow_status take_node(const zarr_store *store, const char *path,
                             const char *name, const zarr_node *node,
                             int64_t count, snow_axis_hint *hint,
                             cf_axis *out) {
    cf_attributes says;
    zarr_array array;
    double *values;
    if (snow_zarr_describe(store, path, node, &array) != SNOW_STATUS_OK) {
        snow_notify(store->context, "the coordinates of %s are left out: %s",
                    name, store->context->message);
        return SNOW_STATUS_OK;
    }
    if (array.axes != 1 || array.sizes[0] != count ||
        count > CF_MOST_COORDINATES)
        return SNOW_STATUS_OK;
    read_attributes(store->context, node->attributes, &says);
    *hint = snow_cf_hint(name, &says);
    SNOW_TRY(read_values(&array, &values));
    snow_cf_take_axis(store->context, &says, array.type, false, count, values,
                      out);
    return SNOW_STATUS_OK;
}

/* Looks for an array of the name in the array's group, and in those above. */
static snow_status read_axis(const zarr_array *array, int axis,
                             snow_axis_hint *hint, cf_axis *out) {
    char group[ZARR_PATH_BYTES], path[ZARR_PATH_BYTES];
    const char *name = array->names[axis];
    const zarr_store *store = array->store;
    memcpy(group, array->path, sizeof group);
    for (char *end = group; *group && end;) {
        zarr_node node;
        end = strrchr(group, '/');
        *(end ? end : group) = 0;
        SNOW_TRY(snow_zarr_join(store, group, name, path));
        if (!strcmp(path, array->path))
            continue;
        SNOW_TRY(snow_zarr_look(store, path, &node));
        const bool found = node.kind == ZARR_ARRAY;
        snow_status status = SNOW_STATUS_OK;
        if (found)
            status = take_node(store, path, name, &node, array->sizes[axis],
                               hint, out);
        snow_zarr_forget(&node);
        if (found || status != SNOW_STATUS_OK)
            return status;
    }
    return SNOW_STATUS_OK;
}

/* --- both ----------------------------------------------------------------- */

/* Zarr 2's fill value is xarray's _FillValue, but not that of an image, whose 0
 * is black and whose 65,535 is saturated. */
static bool masks_fill(const zarr_found *found) {
    const zarr_array *array = &found->array;
    return array->version == 2 && array->has_fill && !found->image &&
           json_object_get(found->attributes, "_ARRAY_DIMENSIONS") &&
           array->values != SNOW_CODING_BOOL &&
           !isnan(array->fill_number.value) &&
           (array->type >= SNOW_TYPE_FLOAT32 || array->fill_number.value != 0);
}

snow_status snow_zarr_read_cf(const zarr_found *found, zarr_cf *out) {
    const zarr_array *array = &found->array;
    bool applies;
    memset(out, 0, sizeof *out);
    read_attributes(array->store->context, found->attributes, &out->says);
    applies = out->says.any;
    for (int i = 0; i < array->axes && !found->image; i++) {
        const int from_end = array->axes - 1 - i;
        const char *name = array->names[i];
        snow_axis_hint other,
            *hint = from_end < SNOW_MOST_AXES ? &out->hints[from_end] : &other;
        if (!*name)
            continue;
        out->named = true;
        *hint = snow_cf_hint(name, NULL);
        if (!strchr(name, '/') && *name != '.')
            SNOW_TRY(read_axis(array, i, hint, &out->axes[i]));
        applies |= out->axes[i].coordinates != NULL;
    }
    out->named |= applies && !found->image;
    cf_attribute *fills = &out->says.limits[0];
    if (masks_fill(found) && fills->count < CF_MOST_NUMBERS) {
        fills->numbers[fills->count++] = array->fill_number;
        applies = true;
    }
    out->values = applies ? snow_cf_settle(array->store->context, &out->says,
                                           array->type, false)
                          : snow_cf_values_default(array->type);
    return SNOW_STATUS_OK;
}

void snow_zarr_release_cf(const zarr_store *store, zarr_cf *cf) {
    snow_cf_release(store->context, cf->axes, ZARR_MOST_AXES);
}
