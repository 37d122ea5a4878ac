/* formats/netcdf/find.c - selects the variable of a classic NetCDF file that is
 * the volume. */
#include "formats/netcdf/netcdf.h"

#include "formats/format.h"

#include <stdio.h>
#include <string.h>

int64_t snow_netcdf_size_of(const netcdf_header *header,
                            const netcdf_variable *v, int64_t axis) {
    return axis < v->axes ? header->dimensions[v->axis[v->axes - 1 - axis]].size
                          : 1;
}

/* Returns whether a variable could be a volume, by its last axes, or by any. */
static bool is_volume(const netcdf_header *header, const netcdf_variable *v,
                      int axes, bool anywhere) {
    int wide = 0;
    if (!v->type || v->axes < axes || v->axes > NETCDF_MOST_AXES)
        return false;
    for (int i = 0; i < (anywhere ? v->axes : axes); i++)
        wide += snow_netcdf_size_of(header, v, i) > 1;
    return wide >= axes;
}

static void note(const netcdf_header *header, const netcdf_variable *v,
                 char *list, size_t capacity) {
    char sizes[128] = "";
    for (int64_t i = 0, at = 0; i < v->axes && at < 100; i++)
        at += snprintf(sizes + at, sizeof sizes - (size_t)at, "%s%lld",
                       i ? "x" : "",
                       (long long)snow_netcdf_size_of(header, v, i));
    snow_list_add(list, capacity, "%s (%s)", v->name, sizes);
}

static void add_aside(void *user, const char *name, const cf_attribute *given) {
    snow_cf_aside_add(name, given->text, user);
}

/* The only variable with three axes or, if there is none, with as many beside
 * axes of one entry, or with two; then of those that say where others lie. */
static snow_status find_only(const netcdf_header *header, snow_seekable *bytes,
                             char *list, size_t capacity,
                             const netcdf_variable **out) {
    static const struct {
        int axes;
        bool anywhere;
    } ways[] = {{3, false}, {3, true}, {2, false}};
    cf_aside aside = {""};
    int found = 0;
    for (int64_t i = 0; i < header->variable_count; i++)
        snow_netcdf_attributes(header, bytes, &header->variables[i], add_aside,
                               &aside);
    for (int n = 0; n < 6 && !found; n++)
        for (int64_t i = 0; i < header->variable_count; i++) {
            const netcdf_variable *v = &header->variables[i];
            if (!is_volume(header, v, ways[n % 3].axes, ways[n % 3].anywhere) ||
                snow_cf_is_aside(&aside, v->name) != (n >= 3))
                continue;
            *out = v;
            note(header, v, list, capacity);
            found++;
        }
    if (found == 1)
        return SNOW_STATUS_OK;
    if (!found)
        return snow_fail(header->context, SNOW_STATUS_BAD_INPUT,
                         "has no numeric variable with three dimensions; "
                         "choose another file");
    return snow_fail(header->context, SNOW_STATUS_BAD_USAGE,
                     "holds %d volumes; choose one with --dataset: %s", found,
                     list);
}

const netcdf_variable *snow_netcdf_variable(const netcdf_header *header,
                                            const char *name) {
    for (int64_t i = 0; i < header->variable_count; i++)
        if (!strcmp(header->variables[i].name, name))
            return &header->variables[i];
    return NULL;
}

snow_status snow_netcdf_find(const netcdf_header *header, snow_seekable *bytes,
                             const char *asked, const netcdf_variable **out) {
    char list[800] = "";
    snow_status status = find_only(header, bytes, list, sizeof list, out);
    if (!asked)
        return status;
    if (*asked == '/') /* the same name as in NetCDF-4 */
        asked++;
    *out = snow_netcdf_variable(header, asked);
    if (*out && (*out)->type && (*out)->axes >= 1 &&
        (*out)->axes <= NETCDF_MOST_AXES)
        return SNOW_STATUS_OK;
    if (*out)
        return snow_fail(header->context, SNOW_STATUS_BAD_INPUT,
                         "%.100s is not a numeric array with one to five "
                         "dimensions; choose another with --dataset",
                         asked);
    return snow_fail(header->context, SNOW_STATUS_BAD_USAGE,
                     "--dataset %.200s: there is no such variable; the file "
                     "has %s",
                     asked, *list ? list : "none that is a volume");
}
