/* info_volume.c - what info opens, and the geometry of a volume as JSON, also
 * of those of a list. */
#include "commands/info_volume.h"
#include "commands/commands.h"
#include "commands/world.h"
#include "run/log.h"
#include "run/paths.h"

#include <math.h>
#include <string.h>

/* The cosine between index axis `axis` and world axis `row`.  The matrix maps
 * indices to the world, so its column is the direction of an index axis, and as
 * long as the spacing. */
static double cosine(const snow_volume_info *info, int row, int axis) {
    return info->matrix[row][axis] / info->spacing[axis];
}

/* The letter of the side that each index axis points to.  Each world axis is
 * assigned to one index axis, the best pair first, so that an oblique volume
 * has three different letters too. */
void info_axis_letters(const snow_volume_info *info, char letters[4]) {
    static const char sides[3][2] = {{'L', 'R'}, {'P', 'A'}, {'I', 'S'}};
    bool row_used[3] = {false}, axis_used[3] = {false};
    for (int turn = 0; turn < 3; turn++) {
        int best_row = -1, best_axis = -1;
        for (int k = 0; k < 9; k++) {
            int row = k / 3, axis = k % 3;
            if (row_used[row] || axis_used[axis])
                continue;
            if (best_row < 0 || fabs(cosine(info, row, axis)) >
                                    fabs(cosine(info, best_row, best_axis))) {
                best_row = row;
                best_axis = axis;
            }
        }
        row_used[best_row] = axis_used[best_axis] = true;
        letters[best_axis] =
            sides[best_row][cosine(info, best_row, best_axis) > 0];
    }
    letters[3] = '\0';
}

/* Null for what the file does not say. */
static json_t *channels_json(const snow_volume_info *info) {
    json_t *list = json_array();
    for (int n = 0; n < SNOW_CHANNELS_MAX && n < info->channels; n++) {
        const snow_channel *one = &info->channel[n];
        const bool ranged = one->window[0] < one->window[1];
        json_t *row = json_object();
        json_object_set_new(row, "name", json_string(one->name));
        json_object_set_new(row, "color",
                            one->color[0] >= 0 ? json_vector(one->color, 3)
                                               : json_null());
        json_object_set_new(row, "window",
                            ranged ? json_vector(one->window, 2) : json_null());
        json_object_set_new(row, "shown", json_boolean(one->shown));
        json_array_append_new(list, row);
    }
    return list;
}

/* The first of those that have names. */
static json_t *component_names(const snow_volume_info *info) {
    json_t *list = json_array();
    for (int n = 0; n < SNOW_CHANNELS_MAX && n < info->components; n++)
        json_array_append_new(list, json_string(info->channel[n].name));
    return list;
}

/* Scripts rely on the keys: dims has x first, matrix maps index to world, row
 * by row. */
void info_set_geometry(json_t *object, const snow_volume_info *info) {
    const snow_volume_info own = world_in_units(info);
    json_t *matrix = json_array(), *units = json_array();
    for (int i = 0; i < 4; i++)
        json_array_append_new(matrix, json_vector(own.matrix[i], 4));
    for (int i = 0; i < 3; i++)
        json_array_append_new(units, json_string(world_unit(info, i)));
    json_object_set_new(object, "format", json_string(info->format));
    json_object_set_new(object, "dims", json_sizes(info->dims, 3));
    json_object_set_new(object, "type",
                        json_string(snow_type_name(info->type)));
    json_object_set_new(object, "spacing", json_vector(own.spacing, 3));
    json_object_set_new(object, "unit", json_string(info->unit));
    json_object_set_new(object, "axis_units", units);
    json_object_set_new(object, "matrix", matrix);
    json_object_set_new(object, "medical", json_boolean(info->medical));
    if (info->medical) {
        char letters[4];
        info_axis_letters(info, letters);
        json_object_set_new(object, "axes", json_string(letters));
    }
    json_object_set_new(object, "slope", json_number(info->slope));
    json_object_set_new(object, "intercept", json_number(info->intercept));
    json_object_set_new(object, "times", json_integer(info->times));
    json_object_set_new(object, "time", json_integer(info->time));
    json_object_set_new(
        object, "components",
        json_integer(info->components > 1 ? info->components : 1));
    json_object_set_new(object, "magnitude", json_boolean(info->magnitude));
    if (info->components > 1 && *info->channel[0].name)
        json_object_set_new(object, "component_names", component_names(info));
    if (info->channels > 1) {
        json_object_set_new(object, "channel_count",
                            json_integer(info->channels));
        json_object_set_new(object, "channels", channels_json(info));
    }
    if (*info->quantity)
        json_object_set_new(object, "quantity", json_string(info->quantity));
    if (info->hounsfield || *info->value_unit)
        json_object_set_new(
            object, "value_unit",
            json_string(info->hounsfield ? "HU" : info->value_unit));
    if (!isnan(info->time_value)) {
        json_object_set_new(object, "time_value",
                            json_number(info->time_value));
        json_object_set_new(object, "time_unit", json_string(info->time_unit));
        json_object_set_new(object, "calendar", json_string(info->calendar));
    }
    if (*info->storage)
        json_object_set_new(object, "storage", json_string(info->storage));
    if (*info->modality)
        json_object_set_new(object, "modality", json_string(info->modality));
    if (*info->description)
        json_object_set_new(
            object, *info->modality ? "series_description" : "long_name",
            json_string(info->description));
    if (info->window[0] < info->window[1])
        json_object_set_new(object, "window", json_vector(info->window, 2));
}

/* Opens a volume, or reads its header alone. */
static snow_status open_or_inspect(snow_context *context, const char *path,
                                   const snow_volume_options *data,
                                   snow_volume_info *info, snow_volume **out) {
    return out ? snow_volume_open(context, path, data, out)
               : snow_volume_inspect(context, path, data, info);
}

int info_open(snow_context *context, const options *opts, const char *path,
              snow_volume_info *info, snow_volume **out) {
    char fault[1024];
    snow_volume_options data = data_options(opts);
    snow_status status = open_or_inspect(context, path, &data, info, out);
    snprintf(fault, sizeof fault, "%s", snow_context_message(context));
    if (status != SNOW_STATUS_BAD_INPUT || data.allow_gaps ||
        (!is_folder(path) && !strstr(fault, "--allow-gaps")))
        return check_status(context, status);
    data.allow_gaps = true;
    if (open_or_inspect(context, path, &data, info, out) != SNOW_STATUS_OK) {
        say("%s", fault);
        return (int)status;
    }
    if (opts->verbosity >= 0)
        say("note: %s: other verbs need --allow-gaps to open it", path);
    return CONTINUE;
}
