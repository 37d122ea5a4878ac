/* formats/zarr/place.c - finds which axes are x, y, z, channel and time, and
 * the positions of voxels.
 *
 * Axes of an image have names (OME-NGFF 0.3 and later) or are t, c, z, y, x.
 * Those of other arrays have the names from xarray or version 3, which may be
 * those of coordinates, or are, from the last one on, x, y, z, time, or x, y,
 * z, channel, time. */
#include "formats/array.h"
#include "formats/zarr/zarr.h"
#include "volume/length_unit.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --- roles ---------------------------------------------------------------- */

static const snow_axes no_roles = {{-1, -1, -1}, -1, -1, false};

/* The role that a name is of; NULL: none. */
static int *role_of_name(snow_axes *roles, const char *name) {
    const struct {
        const char *name;
        int *role;
    } names[] = {{"x", &roles->space[0]},      {"y", &roles->space[1]},
                 {"z", &roles->space[2]},      {"c", &roles->channel},
                 {"channel", &roles->channel}, {"t", &roles->time},
                 {"time", &roles->time}};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (snow_same_name(name, names[i].name))
            return names[i].role;
    return NULL;
}

/* For names that are all known and unique. */
static bool assign_names(const zarr_array *array, snow_axes *out) {
    snow_axes roles = no_roles;
    for (int i = 0; i < array->axes; i++) {
        int *role = role_of_name(&roles, array->names[i]);
        if (!role || *role >= 0)
            return false;
        *role = i;
    }
    *out = roles;
    return true;
}

/* From the last axis on.  Further axes in front must have one entry. */
static void assign_places(const zarr_array *array, snow_axes *out) {
    const int axes = array->axes;
    *out = no_roles;
    for (int i = 0; i < 3 && i < axes; i++)
        out->space[i] = axes - 1 - i;
    if (axes > 4)
        out->channel = axes - 4;
    if (axes > 3)
        out->time = axes > 4 ? axes - 5 : 0;
}

/* By the coordinates of a data set, as in NetCDF. */
static bool assign_hints(const zarr_array *array, const zarr_cf *cf,
                         snow_axes *out) {
    int64_t sizes[SNOW_MOST_AXES];
    const int last = array->axes - 1;
    if (!cf->named || array->axes > SNOW_MOST_AXES)
        return false;
    for (int i = 0; i < SNOW_MOST_AXES; i++)
        sizes[i] = i <= last ? array->sizes[last - i] : 1;
    if (!snow_axes_assign(array->axes, sizes, cf->hints, out))
        return false;
    int *const roles[] = {&out->space[0], &out->space[1], &out->space[2],
                          &out->channel, &out->time};
    for (int n = 0; n < 5; n++)
        *roles[n] = *roles[n] < 0 ? -1 : last - *roles[n];
    return true;
}

/* Before version 0.3 all axes exist. */
static const char *axis_name(const zarr_found *found, int axis) {
    static const char usual[5][2] = {"t", "c", "z", "y", "x"};
    const json_t *axes = json_object_get(found->image, "axes");
    const json_t *own = json_array_get(axes, (size_t)axis);
    if (!axes)
        return found->array.axes == 5 ? usual[axis] : NULL;
    return json_string_value(json_is_object(own) ? json_object_get(own, "name")
                                                 : own);
}

/* Spatial axes with other names are z, y, x in this order, as far as these are
 * free.  NULL: none. */
static int *role_of_kind(const zarr_found *found, int axis, snow_axes *roles) {
    const json_t *own =
        json_array_get(json_object_get(found->image, "axes"), (size_t)axis);
    const char *kind = json_string_value(json_object_get(own, "type"));
    if (!kind)
        return NULL;
    if (!strcmp(kind, "channel") && roles->channel < 0)
        return &roles->channel;
    if (!strcmp(kind, "time") && roles->time < 0)
        return &roles->time;
    for (int i = 0; i < 3 && !strcmp(kind, "space"); i++)
        if (roles->space[i] < 0)
            return &roles->space[i];
    return NULL;
}

/* Names have priority, then kinds from the last axis on. */
static snow_status assign_image(zarr_found *found, snow_axes *out) {
    zarr_array *array = &found->array;
    const json_t *axes = json_object_get(found->image, "axes");
    bool assigned[ZARR_MOST_AXES];
    *out = no_roles;
    if (axes ? json_array_size(axes) != (size_t)array->axes : array->axes != 5)
        return ZARR_FAIL(array,
                         "has %d axes, but its image %zu; correct one of them",
                         array->axes, axes ? json_array_size(axes) : 5);
    for (int i = 0; i < array->axes; i++) {
        const char *name = axis_name(found, i);
        int *role = name ? role_of_name(out, name) : NULL;
        assigned[i] = role && *role < 0;
        if (assigned[i])
            *role = i;
        snprintf(array->names[i], ZARR_NAME_BYTES, "%.30s", name ? name : "?");
    }
    for (int i = array->axes - 1; i >= 0; i--) {
        int *role = assigned[i] ? NULL : role_of_kind(found, i, out);
        if (role)
            *role = i;
    }
    return SNOW_STATUS_OK;
}

snow_status snow_zarr_assign(zarr_found *found, const zarr_cf *cf,
                             snow_axes *out) {
    zarr_array *array = &found->array;
    if (found->image)
        SNOW_TRY(assign_image(found, out));
    else if (!assign_names(array, out) && !assign_hints(array, cf, out))
        assign_places(array, out);
    const int used[] = {out->space[0], out->space[1], out->space[2],
                        out->channel, out->time};
    for (int i = 0; i < array->axes; i++) {
        int role = 0;
        while (role < 5 && used[role] != i)
            role++;
        if (role == 5 && array->sizes[i] > 1)
            return ZARR_FAIL(array,
                             "has %lld entries along axis %d%s%s%s, which no "
                             "option selects; save a part of the array with "
                             "only the axes t, c, z, y, x",
                             (long long)array->sizes[i], i,
                             *array->names[i] ? " (" : "", array->names[i],
                             *array->names[i] ? ")" : "");
        if (role < 5 && !*array->names[i])
            array->names[i][0] = "xyzct"[role];
    }
    return SNOW_STATUS_OK;
}

/* --- channels ------------------------------------------------------------- */

/* Six hexadecimal digits; a window that is shown; active ones are shown. */
static void take_channel(const json_t *from, snow_channel *out) {
    const char *name = json_string_value(json_object_get(from, "label"));
    const char *color = json_string_value(json_object_get(from, "color"));
    const json_t *window = json_object_get(from, "window");
    const json_t *start = json_object_get(window, "start");
    const json_t *end = json_object_get(window, "end");
    char *rest;
    if (name)
        snow_copy_name(name, out->name, sizeof out->name);
    out->shown = !json_is_false(json_object_get(from, "active"));
    if (json_is_number(start) && json_is_number(end) &&
        json_number_value(start) < json_number_value(end)) {
        out->window[0] = json_number_value(start);
        out->window[1] = json_number_value(end);
    }
    if (color && *color == '#')
        color++;
    if (!color || strlen(color) != 6)
        return;
    const unsigned long rgb = strtoul(color, &rest, 16);
    for (int c = 0; c < 3 && !*rest; c++)
        out->color[c] = (double)(rgb >> (16 - 8 * c) & 255) / 255;
}

/* From version 0.5 on all is within "ome". */
void snow_zarr_describe_channels(const zarr_found *found, int64_t count,
                                 snow_volume_info *info) {
    const json_t *own = json_object_get(found->node.attributes, "ome");
    const json_t *omero =
        json_object_get(own ? own : found->node.attributes, "omero");
    const json_t *list = json_object_get(omero, "channels");
    bool any = false;
    snow_channels_begin(info, count, found->image != NULL);
    for (size_t n = 0; n < SNOW_CHANNELS_MAX && n < json_array_size(list); n++)
        take_channel(json_array_get(list, n), &info->channel[n]);
    for (int n = 0; n < SNOW_CHANNELS_MAX && n < count; n++)
        any |= info->channel[n].shown;
    info->channel[0].shown |= !any;
    if (found->image)
        snow_channels_are_light(info, 0);
}

/* --- transformations ------------------------------------------------------ */

typedef struct placement {
    double scale[ZARR_MOST_AXES], shift[ZARR_MOST_AXES];
    bool given;
} placement;

/* Reads one number for each axis: finite, and for a scale not 0. */
static snow_status read_vector(const zarr_array *array, const json_t *list,
                               const char *what, double *out) {
    bool right = json_array_size(list) == (size_t)array->axes;
    bool is_scale = !strcmp(what, "scale");
    for (int i = 0; i < array->axes && right; i++) {
        const json_t *number = json_array_get(list, (size_t)i);
        out[i] = json_number_value(number);
        right = json_is_number(number) && isfinite(out[i]) &&
                (!is_scale || out[i] < 0 || out[i] > 0);
    }
    if (right)
        return SNOW_STATUS_OK;
    return ZARR_FAIL(array,
                     "has a coordinate transformation whose %s is not "
                     "%d numbers%s; correct the attributes of its image",
                     what, array->axes, is_scale ? " other than 0" : "");
}

/* Each transformation applies to the result of those before it. */
static snow_status transform(const zarr_array *array, const json_t *owner,
                             placement *place) {
    const json_t *list = json_object_get(owner, "coordinateTransformations");
    double values[ZARR_MOST_AXES];
    for (size_t k = 0; k < json_array_size(list); k++) {
        const json_t *one = json_array_get(list, k);
        const char *kind = json_string_value(json_object_get(one, "type"));
        bool is_scale = kind && !strcmp(kind, "scale");
        if (is_scale || (kind && !strcmp(kind, "translation"))) {
            SNOW_TRY(
                read_vector(array, json_object_get(one, kind), kind, values));
            for (int i = 0; i < array->axes; i++) {
                place->scale[i] *= is_scale ? values[i] : 1;
                place->shift[i] = is_scale ? place->shift[i] * values[i]
                                           : place->shift[i] + values[i];
            }
            place->given = true;
        } else if (!kind || strcmp(kind, "identity") != 0) {
            snow_notify(array->store->context,
                        "the coordinate transformation \"%.40s\" is ignored",
                        kind ? kind : "?");
        }
    }
    return SNOW_STATUS_OK;
}

static void take_units(const zarr_found *found, const snow_axes *roles,
                       double factors[3], snow_volume_info *info) {
    const json_t *axes = json_object_get(found->image, "axes");
    const char *texts[3] = {NULL};
    for (int role = 0; role < 3; role++) {
        const json_t *axis = json_array_get(axes, (size_t)roles->space[role]);
        const char *unit = json_string_value(json_object_get(axis, "unit"));
        if (roles->space[role] >= 0)
            texts[role] = unit ? unit : "";
    }
    snow_length_join(found->array.store->context, texts, factors, info->unit);
}

/* Before version 0.4 resolution levels have no scale: it is the ratio of their
 * size to that of the finest level, if that exists. */
static snow_status compare_sizes(const zarr_found *found, placement *place) {
    const zarr_array *array = &found->array;
    const char *own = snow_zarr_level_path(found->image, (size_t)found->index);
    const char *other = snow_zarr_level_path(found->image, 0);
    char path[ZARR_PATH_BYTES];
    size_t length = strlen(array->path) - strlen(own);
    zarr_node node;
    if (!found->index || !other ||
        length + strlen(other) >= ZARR_PATH_BYTES / 2)
        return SNOW_STATUS_OK;
    snprintf(path, sizeof path, "%.*s%s", (int)length, array->path, other);
    SNOW_TRY(snow_zarr_look(array->store, path, &node));
    const json_t *shape = json_object_get(node.meta, "shape");
    bool is_like = node.kind == ZARR_ARRAY &&
                   json_array_size(shape) == (size_t)array->axes;
    for (int i = 0; i < array->axes && is_like; i++) {
        double size = json_number_value(json_array_get(shape, (size_t)i));
        double times = size / (double)array->sizes[i];
        if (times >= 1 && times <= 1e6) {
            place->scale[i] = times;
            place->shift[i] = (times - 1) / 2;
        }
    }
    snow_zarr_forget(&node);
    return SNOW_STATUS_OK;
}

snow_status snow_zarr_place(const zarr_found *found, const snow_axes *roles,
                            snow_volume_info *info) {
    placement place = {.given = false};
    double factors[3];
    if (!found->image)
        return SNOW_STATUS_OK;
    for (int i = 0; i < ZARR_MOST_AXES; i++)
        place.scale[i] = 1;
    SNOW_TRY(transform(&found->array, found->level, &place));
    if (!place.given)
        SNOW_TRY(compare_sizes(found, &place));
    SNOW_TRY(transform(&found->array, found->image, &place));
    take_units(found, roles, factors, info);
    for (int role = 0; role < 3; role++) {
        int axis = roles->space[role];
        /* A 2-D image is as deep as its pixels are wide. */
        info->matrix[role][role] = axis >= 0 ? place.scale[axis] * factors[role]
                                             : fabs(info->matrix[0][0]);
        info->matrix[role][3] =
            axis >= 0 ? place.shift[axis] * factors[role] : 0;
    }
    snow_image_turn(info->matrix);
    return SNOW_STATUS_OK;
}
