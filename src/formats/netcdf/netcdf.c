/* formats/netcdf/netcdf.c - variables of classic NetCDF files: .nc.  NetCDF-4
 * files are HDF5, and read as such.
 *
 * The last dimension is x, the ones before y and z, then channel and time, as
 * with HDF5, unless coordinates or sizes say otherwise (formats/axes.h).
 * Coordinates and missing values follow the Climate and Forecast
 * conventions. */
#include "formats/netcdf/netcdf.h"
#include "formats/array.h"
#include "formats/cf/model.h"

#include <stdio.h>
#include <string.h>

static bool probe_netcdf(const unsigned char *bytes, size_t size) {
    return size >= 4 && !memcmp(bytes, "CDF", 3) &&
           (bytes[3] == 1 || bytes[3] == 2 || bytes[3] == 5);
}

/* Computes the strides of all axes, the fastest first, and all bytes from the
 * beginning of the file to the variable's end. */
static bool lay_out(const netcdf_header *header, const netcdf_variable *v,
                    uint64_t steps[NETCDF_MOST_AXES], uint64_t *end) {
    int64_t sizes[NETCDF_MOST_AXES];
    uint64_t bytes;
    int axes = (int)v->axes, inner = axes - (v->records ? 1 : 0);
    for (int i = 0; i < axes; i++)
        sizes[i] = snow_netcdf_size_of(header, v, i);
    if (!snow_array_steps(sizes, inner, snow_type_size(v->type), steps, &bytes))
        return false;
    for (int i = axes; i < NETCDF_MOST_AXES; i++)
        steps[i] = 0;
    if (v->records) {
        uint64_t before;
        steps[axes - 1] = header->record_bytes;
        if (sizes[axes - 1] < 1 ||
            !snow_mul_u64((uint64_t)sizes[axes - 1] - 1, header->record_bytes,
                          &before) ||
            !snow_add_u64(bytes, before, &bytes))
            return false;
    }
    return snow_add_u64(bytes, v->begin, end) && *end <= (uint64_t)INT64_MAX;
}

static void take(void *user, const char *name, const cf_attribute *given) {
    snow_cf_take(name, given, user);
}

static void read_attributes(const netcdf_header *header, snow_seekable *bytes,
                            const netcdf_variable *v, cf_attributes *out) {
    snow_cf_attributes_begin(out);
    if (v)
        snow_netcdf_attributes(header, bytes, v, take, out);
}

/* The coordinate variable of a dimension has its name and is its only axis; of
 * a dimension called time without one (WRF) any variable along it that has the
 * unit of a date.  NULL if there is none.  Gives its attributes. */
static const netcdf_variable *coordinates_of(const netcdf_header *header,
                                             snow_seekable *bytes,
                                             int64_t dimension,
                                             cf_attributes *says) {
    const char *name = header->dimensions[dimension].name;
    const bool is_time = snow_cf_hint(name, NULL).time;
    const netcdf_variable *found = NULL;
    for (int64_t i = 0; i < header->variable_count; i++) {
        const netcdf_variable *v = &header->variables[i];
        if (v->axes != 1 || v->axis[0] != dimension || !v->type)
            continue;
        const bool own = !strcmp(v->name, name);
        if (!own && !found && is_time) {
            read_attributes(header, bytes, v, says);
            if (strstr(says->units, " since "))
                found = v;
        }
        if (own) {
            found = v;
            break;
        }
    }
    read_attributes(header, bytes, found, says);
    return found;
}

/* Truncated coordinates are left out. */
static snow_status read_axis(const netcdf_header *header, snow_seekable *bytes,
                             int64_t dimension, cf_axis *out) {
    int64_t count = header->dimensions[dimension].size;
    cf_attributes says;
    const netcdf_variable *v = coordinates_of(header, bytes, dimension, &says);
    if (!v || count < 1 || count > CF_MOST_COORDINATES ||
        (uint64_t)count > snow_seekable_size(bytes))
        return SNOW_STATUS_OK;
    double *values =
        snow_allocate_array(header->context, (uint64_t)count, sizeof *values);
    if (!values)
        return SNOW_STATUS_NO_MEMORY;
    if (!snow_netcdf_values(header, bytes, v, count, values)) {
        snow_release(header->context, values);
        return SNOW_STATUS_OK;
    }
    snow_cf_take_axis(header->context, &says, v->type, true, count, values,
                      out);
    return SNOW_STATUS_OK;
}

/* The meaning of each axis. */
static snow_status assign_axes(const netcdf_header *header,
                               snow_seekable *bytes, const netcdf_variable *v,
                               int64_t sizes[NETCDF_MOST_AXES],
                               snow_axes *out) {
    snow_axis_hint hints[NETCDF_MOST_AXES] = {{0}};
    for (int i = 0; i < NETCDF_MOST_AXES; i++) {
        sizes[i] = snow_netcdf_size_of(header, v, i);
        if (i >= v->axes)
            continue;
        int64_t dimension = v->axis[v->axes - 1 - i];
        cf_attributes says;
        coordinates_of(header, bytes, dimension, &says);
        hints[i] = snow_cf_hint(header->dimensions[dimension].name, &says);
    }
    if (snow_axes_assign((int)v->axes, sizes, hints, out))
        return SNOW_STATUS_OK;
    return snow_fail(header->context, SNOW_STATUS_BAD_INPUT,
                     "%.100s has more than three dimensions beside time and "
                     "components; write one with fewer",
                     v->name);
}

/* A variable on the way to be read. */
typedef struct netcdf_job {
    snow_source *source;
    snow_seekable *bytes;
    const netcdf_header *header;
    const netcdf_variable *variable;
    cf_axis axes[4]; /* x, y, z, time */
    cf_attributes says;
    cf_values values;
    cf_file file;
    cf_model model;
    snow_uneven grid;
    snow_array array;
    snow_axes roles;
    bool done; /* the source is behind the voxels */
} netcdf_job;

/* Fills info, and finds where the voxels are. */
static snow_status lay_variable(netcdf_job *job,
                                const snow_volume_options *options,
                                snow_volume_info *info) {
    const netcdf_header *header = job->header;
    const netcdf_variable *v = job->variable;
    snow_array *array = &job->array;
    uint64_t steps[NETCDF_MOST_AXES];
    int64_t sizes[NETCDF_MOST_AXES], channel;
    if (!lay_out(header, v, steps, &array->all))
        return snow_fail(header->context, SNOW_STATUS_BAD_INPUT,
                         "%.100s is empty or too large for any file; choose "
                         "another with --dataset",
                         v->name);
    SNOW_TRY(assign_axes(header, job->bytes, v, sizes, &job->roles));
    read_attributes(header, job->bytes, v, &job->says);
    job->values = snow_cf_settle(header->context, &job->says, v->type, true);
    info->type = job->values.type;
    SNOW_TRY(snow_volume_pick_axes(header->context, options, &job->roles, sizes,
                                   info, &channel));
    array->first = v->begin;
    snow_array_place(&job->roles, steps, channel, info, array);
    array->big_endian = true;
    array->more = true;
    return SNOW_STATUS_OK;
}

/* Places the voxels, and says what they are. */
static snow_status describe_variable(netcdf_job *job,
                                     const snow_volume_options *options,
                                     snow_volume_info *info) {
    const netcdf_header *header = job->header;
    const netcdf_variable *v = job->variable;
    SNOW_TRY(lay_variable(job, options, info));
    for (int i = 0; i < 4; i++) {
        const int role = i < 3 ? job->roles.space[i] : job->roles.time;
        if (role < 0)
            continue;
        const int64_t dimension = v->axis[v->axes - 1 - role];
        snprintf(job->file.axis[i], sizeof job->file.axis[i], "%.31s",
                 header->dimensions[dimension].name);
        SNOW_TRY(read_axis(header, job->bytes, dimension, &job->axes[i]));
    }
    snow_cf_time(&job->axes[3], info);
    snow_cf_name(v->name, &job->says, info);
    SNOW_TRY(snow_model_take(&job->file, v->name, &job->says, options, info,
                             job->axes, &job->model));
    snow_cf_place(header->context, job->axes, options, info, &job->grid);
    return SNOW_STATUS_OK;
}

static size_t copy_held(void *user, uint64_t at, void *bytes, size_t size) {
    return snow_seekable_read(user, at, bytes, size);
}

/* Reads a box of stored voxels: from the source if that is still before them,
 * otherwise from what was kept of it, or once more from its place. */
static snow_status read_array(void *user, const snow_volume_options *options,
                              snow_volume_info *info, snow_volume **out) {
    netcdf_job *job = user;
    snow_source *again = NULL;
    const snow_bytes_behind behind = {copy_held, job->bytes,
                                      snow_seekable_size(job->bytes)};
    if (job->done || snow_seekable_held(job->bytes))
        SNOW_TRY(snow_source_open_with(snow_source_context(job->source),
                                       snow_source_name(job->source), &behind,
                                       &again));
    job->done |= out != NULL;
    snow_status status = snow_array_read(again ? again : job->source, options,
                                         &job->array, info, out);
    snow_source_close(again);
    return status;
}

/* --- other parts of the file ----------------------------------------------
 */

typedef struct wanted_attribute {
    const char *name;
    cf_attribute *out;
    bool found;
} wanted_attribute;

static void look_at_attribute(void *user, const char *name,
                              const cf_attribute *given) {
    wanted_attribute *wanted = user;
    if (strcmp(name, wanted->name) != 0)
        return;
    *wanted->out = *given;
    wanted->found = true;
}

static bool attribute_of_file(void *user, const char *name, cf_attribute *out) {
    const netcdf_job *job = user;
    wanted_attribute wanted = {name, out, false};
    snow_netcdf_attributes(job->header, job->bytes, NULL, look_at_attribute,
                           &wanted);
    return wanted.found;
}

static int64_t axes_of(void *user, const char *name) {
    const netcdf_job *job = user;
    const netcdf_variable *v = snow_netcdf_variable(job->header, name);
    return v && v->type && v->axes <= NETCDF_MOST_AXES ? v->axes : 0;
}

static bool letters_of(void *user, const char *name, int64_t row,
                       char out[20]) {
    const netcdf_job *job = user;
    const netcdf_header *header = job->header;
    const netcdf_variable *v = snow_netcdf_variable(header, name);
    if (!v || v->type || v->kind != 2 || v->axes != 2 ||
        snow_netcdf_size_of(header, v, 0) < 19 ||
        row >= snow_netcdf_size_of(header, v, 1))
        return false;
    const uint64_t step = v->records
                              ? header->record_bytes
                              : (uint64_t)snow_netcdf_size_of(header, v, 0);
    out[19] = 0;
    return snow_seekable_read(job->bytes, v->begin + (uint64_t)row * step, out,
                              19) == 19;
}

static snow_status read_other(void *user, const char *name,
                              const snow_volume_options *options,
                              snow_volume_info *info, snow_volume **out) {
    const netcdf_job *job = user;
    netcdf_job other = {.source = job->source,
                        .bytes = job->bytes,
                        .header = job->header,
                        .variable = snow_netcdf_variable(job->header, name),
                        .done = true};
    SNOW_TRY(lay_variable(&other, options, info));
    return snow_cf_read(job->header->context, NULL, &other.grid, &other.values,
                        read_array, &other, options, info, out);
}

static void look_for_minc(void *user, const char *name,
                          const cf_attribute *given) {
    bool *found = user;
    *found |= !strcmp(name, "varid") &&
              !strcmp(given->text, "MINC standard variable");
}

/* MINC scales each slice by tables of its own. */
static bool is_minc(const netcdf_header *header, snow_seekable *bytes) {
    bool found = false;
    for (int64_t i = 0; i < header->variable_count && !found; i++) {
        const netcdf_variable *v = &header->variables[i];
        found =
            !strcmp(v->name, "image-max") || !strcmp(v->name, "rootvariable");
        if (!strcmp(v->name, "image"))
            snow_netcdf_attributes(header, bytes, v, look_for_minc, &found);
    }
    return found;
}

static snow_status read_file(snow_source *source, snow_seekable *bytes,
                             const snow_volume_options *options,
                             const netcdf_header *header,
                             snow_volume_info *info, snow_volume **out) {
    netcdf_job job = {.source = source, .bytes = bytes, .header = header};
    if (is_minc(header, bytes))
        return snow_fail(header->context, SNOW_STATUS_BAD_INPUT,
                         "is a MINC file, whose values are scaled slice by "
                         "slice; convert it with mnc2nii");
    SNOW_TRY(snow_netcdf_find(header, bytes, options->dataset, &job.variable));
    job.file = (cf_file){.context = header->context,
                         .user = &job,
                         .attribute = attribute_of_file,
                         .axes_of = axes_of,
                         .letters = letters_of,
                         .read = read_other};
    snow_status status = describe_variable(&job, options, info);
    if (status == SNOW_STATUS_OK)
        status =
            snow_cf_read(header->context, &job.model, &job.grid, &job.values,
                         read_array, &job, options, info, out);
    snow_cf_release(header->context, job.axes, 4);
    return status;
}

static snow_status read_netcdf(snow_source *source,
                               const snow_volume_options *options,
                               snow_volume_info *info, snow_volume **out) {
    snow_context *context = snow_source_context(source);
    snow_seekable *bytes;
    netcdf_header header;
    *info = snow_volume_info_default("netcdf");
    SNOW_TRY(snow_seekable_open(source, &bytes));
    snow_status status = snow_netcdf_read_header(context, bytes, &header);
    if (status == SNOW_STATUS_OK)
        status = read_file(source, bytes, options, &header, info, out);
    snow_netcdf_free_header(&header);
    snow_seekable_close(bytes);
    return status;
}

const snow_format snow_format_netcdf = {
    .name = "netcdf",
    .text = "NetCDF, classic (.nc, .cdf), one variable of them",
    .suffixes = {".nc", ".cdf", ".nc.gz"},
    .probe = probe_netcdf,
    .crops = true,
    .sets = true,
    .channels = true,
    .read = read_netcdf,
};
