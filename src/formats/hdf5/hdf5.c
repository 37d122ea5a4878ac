/* formats/hdf5/hdf5.c - data sets of HDF5 files, including NetCDF-4.
 *
 * The last axis is x, the ones before y and z, then channel and time, unless
 * the file or the sizes say otherwise (formats/axes.h).  For a box libhdf5
 * reads only the chunks that it touches. */
#include "formats/hdf5/hdf5.h"
#include "formats/array.h"
#include "formats/cf/model.h"
#include "formats/features.h"
#include "formats/hdf5/blocks.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static bool probe_hdf5(const unsigned char *bytes, size_t size) {
    static const unsigned char magic[8] = "\x89HDF\r\n\x1a\n";
    /* A user block may come first, of 512 bytes times a power of two. */
    for (size_t at = 0; at + 8 <= size; at = at ? 2 * at : 512)
        if (!memcmp(bytes + at, magic, 8))
            return true;
    return false;
}

#if SNOW_HAVE_HDF5 && !SNOW_LOADS

/* Voxels that a file may have beyond those that deflate can compress into it:
 * chunks that were never written are not in the file. */
#define UNWRITTEN_BYTES ((uint64_t)256 << 20)

static hid_t native_type(snow_type type) {
    const hid_t types[] = {[SNOW_TYPE_INT8] = H5T_NATIVE_INT8,
                           [SNOW_TYPE_UINT8] = H5T_NATIVE_UINT8,
                           [SNOW_TYPE_INT16] = H5T_NATIVE_INT16,
                           [SNOW_TYPE_UINT16] = H5T_NATIVE_UINT16,
                           [SNOW_TYPE_INT32] = H5T_NATIVE_INT32,
                           [SNOW_TYPE_UINT32] = H5T_NATIVE_UINT32,
                           [SNOW_TYPE_INT64] = H5T_NATIVE_INT64,
                           [SNOW_TYPE_UINT64] = H5T_NATIVE_UINT64,
                           [SNOW_TYPE_FLOAT32] = H5T_NATIVE_FLOAT,
                           [SNOW_TYPE_FLOAT64] = H5T_NATIVE_DOUBLE};
    return types[type];
}

/* MINC scales each slice by tables of its own, which are not supported. */
static snow_status refuse_minc(snow_context *context, hid_t file) {
    if (H5Lexists(file, "minc-2.0", H5P_DEFAULT) <= 0)
        return SNOW_STATUS_OK;
    return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                     "is a MINC file, whose values are scaled slice by slice; "
                     "convert it with mnc2nii");
}

/* The sizes, and the requested channel or component and time. */
static snow_status pick(snow_context *context, const hdf5_set *set,
                        const hdf5_axes *axes, const cf_values *values,
                        const snow_volume_options *options,
                        snow_volume_info *info, hsize_t start[HDF5_MOST_AXES]) {
    const snow_axes *roles = &axes->roles;
    int64_t sizes[HDF5_MOST_AXES], channel;
    for (int i = 0; i < set->axes; i++) {
        sizes[i] = (int64_t)set->sizes[set->axes - 1 - i];
        if (sizes[i] < 1)
            return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                             "%.200s is empty; choose another with --dataset",
                             set->path);
    }
    info->type = values->type;
    SNOW_TRY(
        snow_volume_pick_axes(context, options, roles, sizes, info, &channel));
    if (axes->colors && roles->interleaved && sizes[roles->channel] >= 3) {
        snow_channels_begin(info, sizes[roles->channel], false);
        snow_channels_are_colors(info);
    }
    memset(start, 0, HDF5_MOST_AXES * sizeof *start);
    if (roles->time >= 0)
        start[set->axes - 1 - roles->time] = (hsize_t)info->time;
    if (roles->channel >= 0)
        start[set->axes - 1 - roles->channel] = (hsize_t)channel;
    return SNOW_STATUS_OK;
}

/* Reads the box of the region, at the channel and the time of `start`. */
static snow_status read_region(const hdf5_file *file, const hdf5_set *set,
                               const snow_axes *roles,
                               const snow_region *region,
                               const hsize_t start[HDF5_MOST_AXES],
                               snow_volume *volume) {
    hsize_t first[HDF5_MOST_AXES], count[HDF5_MOST_AXES] = {1, 1, 1, 1, 1};
    if (set->constant) { /* of type float64 */
        const int64_t *box = region->count;
        for (int64_t i = 0; i < box[0] * box[1] * box[2]; i++)
            ((double *)volume->owned)[i] = set->value;
        return SNOW_STATUS_OK;
    }
    memcpy(first, start, sizeof first);
    for (int i = 0; i < 3; i++) {
        int at = set->axes - 1 - roles->space[i];
        if (roles->space[i] < 0)
            continue;
        first[at] = (hsize_t)region->first[i];
        count[at] = (hsize_t)region->count[i];
    }
    return snow_hdf5_read_box(
        volume->context, file, set->id,
        native_type(set->no_sign ? SNOW_TYPE_INT16 : set->type), set->axes,
        first, count, volume->owned);
}

/* Impossible sizes are refused before memory is allocated. */
static snow_status check_size(snow_context *context, const hdf5_file *file,
                              const snow_region *region) {
    uint64_t most;
    if (!snow_mul_u64(snow_hdf5_size(file), SNOW_DEFLATE_RATIO, &most) ||
        !snow_add_u64(most, UNWRITTEN_BYTES, &most) || region->all <= most)
        return SNOW_STATUS_OK;
    return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                     "claims %llu bytes of voxels, which its %llu bytes cannot "
                     "hold; it is truncated or damaged",
                     (unsigned long long)region->all,
                     (unsigned long long)snow_hdf5_size(file));
}

/* A data set on the way to be read. */
typedef struct hdf5_job {
    snow_context *context;
    const hdf5_file *file;
    const hdf5_set *set;
    hdf5_axes axes;
    hsize_t start[HDF5_MOST_AXES];
    cf_attributes says;
    cf_values values;
    cf_file parts;
    cf_model model;
    snow_uneven grid;
} hdf5_job;

/* Chunks are unpacked as a whole. */
static void note_chunks(const hdf5_job *job, const snow_region *region) {
    const int axes = job->set->axes;
    hsize_t chunk[HDF5_MOST_AXES];
    int64_t size[3] = {1, 1, 1};
    const hid_t plan =
        job->set->constant ? -1 : H5Dget_create_plist(job->set->id);
    const bool chunked = plan >= 0 && H5Pget_layout(plan) == H5D_CHUNKED &&
                         H5Pget_chunk(plan, axes, chunk) == axes;
    snow_hdf5_drop(plan);
    for (int i = 0; i < 3 && chunked; i++)
        if (job->axes.roles.space[i] >= 0)
            size[i] = (int64_t)chunk[axes - 1 - job->axes.roles.space[i]];
    if (chunked)
        snow_region_in_blocks(job->context, region, size);
}

/* Reads a box of the file's own voxels as they are stored. */
static snow_status read_stored(void *user, const snow_volume_options *options,
                               snow_volume_info *info, snow_volume **out) {
    hdf5_job *job = user;
    snow_context *context = job->context;
    snow_region region;
    snow_volume *volume = NULL;
    SNOW_TRY(snow_region_lay_out(context, options, info, &region));
    SNOW_TRY(check_size(context, job->file, &region));
    if (!snow_uneven_any(&job->grid))
        note_chunks(job, &region);
    if (!out)
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_volume_new(context, info, &volume));
    snow_status status = read_region(job->file, job->set, &job->axes.roles,
                                     &region, job->start, volume);
    return snow_volume_give(status, volume, out);
}

/* Fills info, and finds where the voxels are. */
static snow_status lay_set(hdf5_job *job, const snow_volume_options *options,
                           snow_volume_info *info) {
    SNOW_TRY(
        snow_hdf5_read_axes(job->context, job->file, job->set, &job->axes));
    snow_hdf5_attributes(job->file, job->set->id, &job->says);
    job->values = snow_hdf5_values(job->context, job->file, job->set,
                                   &job->axes, &job->says);
    return pick(job->context, job->set, &job->axes, &job->values, options, info,
                job->start);
}

/* --- other parts of the file ----------------------------------------------
 */

static bool attribute_of_file(void *user, const char *name, cf_attribute *out) {
    const hdf5_job *job = user;
    const hid_t root = H5Oopen(snow_hdf5_id(job->file), "/", H5P_DEFAULT);
    const bool found =
        root >= 0 && snow_hdf5_attribute(job->file, root, name, out);
    snow_hdf5_drop(root);
    return found;
}

/* Beside the data set that is read. */
static bool open_beside(const hdf5_job *job, const char *name, hdf5_set *out) {
    const char *path = job->set->path;
    snprintf(out->path, sizeof out->path, "%.*s%s",
             (int)(strrchr(path, '/') + 1 - path), path, name);
    return snow_hdf5_open_values(snow_hdf5_id(job->file), out->path, out);
}

static int64_t axes_of(void *user, const char *name) {
    hdf5_set set = {.spatial = false};
    if (!open_beside(user, name, &set))
        return 0;
    snow_hdf5_drop(set.id);
    return set.axes;
}

static bool letters_of(void *user, const char *name, int64_t row,
                       char out[20]) {
    const hdf5_job *job = user;
    const hid_t file = snow_hdf5_id(job->file),
                id = H5Lexists(file, name, H5P_DEFAULT) > 0
                         ? H5Dopen2(file, name, H5P_DEFAULT)
                         : -1,
                type = id < 0 ? -1 : H5Dget_type(id),
                space = id < 0 ? -1 : H5Dget_space(id);
    hsize_t sizes[2], first[2] = {(hsize_t)row, 0}, count[2] = {1, 19};
    memset(out, 0, 20);
    const bool right = type >= 0 && H5Tget_class(type) == H5T_STRING &&
                       H5Tget_size(type) == 1 &&
                       H5Sget_simple_extent_ndims(space) == 2 &&
                       H5Sget_simple_extent_dims(space, sizes, NULL) == 2 &&
                       first[0] < sizes[0] && sizes[1] >= count[1] &&
                       snow_hdf5_read_box(job->context, job->file, id, type, 2,
                                          first, count, out) == SNOW_STATUS_OK;
    snow_hdf5_drop(space);
    snow_hdf5_drop(type);
    snow_hdf5_drop(id);
    return right;
}

static snow_status read_other(void *user, const char *name,
                              const snow_volume_options *options,
                              snow_volume_info *info, snow_volume **out) {
    const hdf5_job *job = user;
    hdf5_set set = {.spatial = false};
    hdf5_job other = {.context = job->context, .file = job->file, .set = &set};
    snow_status status = SNOW_STATUS_OK;
    if (!open_beside(job, name, &set))
        return snow_fail(job->context, SNOW_STATUS_BAD_INPUT,
                         "%.100s cannot be read", name);
    status = snow_hdf5_check_storage(job->context, set.id);
    if (status == SNOW_STATUS_OK)
        status = lay_set(&other, options, info);
    if (status == SNOW_STATUS_OK)
        status = snow_cf_read(job->context, NULL, &other.grid, &other.values,
                              read_stored, &other, options, info, out);
    snow_cf_release(job->context, other.axes.scales, HDF5_MOST_AXES);
    snow_hdf5_drop(set.id);
    return status;
}

/* What a model's grid says beside the conventions. */
static snow_status take_model(hdf5_job *job, const char *name,
                              const snow_volume_options *options,
                              snow_volume_info *info) {
    const snow_axes *roles = &job->axes.roles;
    cf_axis axes[4] = {{0}};
    job->parts = (cf_file){.context = job->context,
                           .user = job,
                           .attribute = attribute_of_file,
                           .axes_of = axes_of,
                           .letters = letters_of,
                           .read = read_other};
    for (int i = 0; i < 4; i++) {
        const int role = i < 3 ? roles->space[i] : roles->time;
        if (role < 0)
            continue;
        axes[i] = job->axes.scales[role];
        memcpy(job->parts.axis[i], job->axes.names[role],
               sizeof job->parts.axis[i]);
    }
    SNOW_TRY(snow_model_take(&job->parts, name, &job->says, options, info, axes,
                             &job->model));
    for (int i = 0; i < 3; i++)
        if (roles->space[i] >= 0)
            job->axes.scales[roles->space[i]] = axes[i];
    return SNOW_STATUS_OK;
}

/* --- a data set -----------------------------------------------------------
 */

static snow_status read_job(hdf5_job *job, const snow_volume_options *options,
                            snow_volume_info *info, snow_volume **out) {
    const hdf5_file *file = job->file;
    const char *slash = strrchr(job->set->path, '/');
    SNOW_TRY(lay_set(job, options, info));
    SNOW_TRY(snow_hdf5_mean(job->context, file, job->set, &job->axes,
                            &job->says, info, &job->values));
    SNOW_TRY(
        take_model(job, slash ? slash + 1 : job->set->path, options, info));
    snow_hdf5_place(job->context, file, job->set, &job->axes, options, info,
                    &job->grid);
    return snow_cf_read(job->context, &job->model, &job->grid, &job->values,
                        read_stored, job, options, info, out);
}

static snow_status read_set(snow_context *context, const hdf5_file *file,
                            const hdf5_set *set,
                            const snow_volume_options *options,
                            snow_volume_info *info, snow_volume **out) {
    hdf5_job job = {.context = context, .file = file, .set = set};
    if (!set->constant)
        SNOW_TRY(snow_hdf5_check_storage(context, set->id));
    snow_status status = read_job(&job, options, info, out);
    snow_cf_release(context, job.axes.scales, HDF5_MOST_AXES);
    return status;
}

/* The only volume of a file may be of modes around an axis. */
static snow_status read_found(snow_context *context, const hdf5_file *file,
                              hdf5_set *set, const snow_volume_options *options,
                              snow_volume_info *info, snow_volume **out) {
    bool found = false;
    if (!options->dataset)
        SNOW_TRY(snow_hdf5_read_theta(context, file, set->path, options, info,
                                      out, &found));
    if (found)
        return SNOW_STATUS_OK;
    snow_hdf5_trim_imaris(file, set);
    return read_set(context, file, set, options, info, out);
}

/* The data set of that name, or all that is read with it. */
static snow_status read_named(snow_context *context, const hdf5_file *file,
                              const hdf5_series *series,
                              const snow_volume_options *given,
                              snow_volume_info *info, snow_volume **out) {
    hdf5_set set;
    bool found;
    char path[HDF5_NAME_BYTES];
    snow_volume_options own = *given, *options = &own;
    if (own.dataset) {
        SNOW_TRY(snow_hdf5_complete(context, file, own.dataset, path));
        own.dataset = path;
    }
    SNOW_TRY(snow_hdf5_read_theta(context, file, options->dataset, options,
                                  info, out, &found));
    if (found)
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_hdf5_find(context, file, options->dataset, &set));
    set.spatial |= series->stack;
    set.no_sign = series->no_sign;
    if (set.no_sign)
        set.type = SNOW_TYPE_UINT16;
    snow_status status = read_found(context, file, &set, options, info, out);
    snow_hdf5_drop(set.id);
    return status;
}

/* What all data sets of a series or stack are together. */
static void describe_all(const hdf5_series *series,
                         const snow_volume_info *said, snow_volume_info *info) {
    info->times = series->count;
    info->time = series->step;
    if (series->stack) {
        info->channels = said->channels;
        info->light = said->light;
        memcpy(info->channel, said->channel, sizeof info->channel);
    }
    if (isnan(info->time_value) && (!series->stack || series->count > 1)) {
        info->time_value = (double)series->number;
        memcpy(info->time_unit, "step", 5);
    }
}

/* A pattern of names is a series, whose steps are files' own. */
static snow_status read_step(snow_context *context, const hdf5_file *file,
                             const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out) {
    const hid_t id = snow_hdf5_id(file);
    snow_volume_options own = *options;
    snow_volume_info said;
    hdf5_series series;
    char active[HDF5_NAME_BYTES];
    SNOW_TRY(snow_hdf5_find_step(context, id, options, &series));
    if (!series.given)
        SNOW_TRY(snow_hdf5_find_stack(context, file, options, &said, &series));
    if (!series.given && !own.dataset && snow_hdf5_active_image(file, active)) {
        own.dataset = active;
        snow_notify(context,
                    "%s is taken, which the file says is active; "
                    "--dataset selects another",
                    active);
    }
    if (series.given) {
        own.dataset = series.path;
        own.time = 0;
    }
    if (series.stack) {
        own.channel = 0;
        own.component = NULL;
    }
    SNOW_TRY(read_named(context, file, &series, &own, info, out));
    if (series.given)
        describe_all(&series, &said, info);
    return SNOW_STATUS_OK;
}

static snow_status read_hdf5(snow_source *source,
                             const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out) {
    snow_context *context = snow_source_context(source);
    hdf5_file *file;
    *info = snow_volume_info_default("hdf5");
    SNOW_TRY(snow_hdf5_open(source, &file));
    snow_status status = refuse_minc(context, snow_hdf5_id(file));
    if (status == SNOW_STATUS_OK)
        status = snow_hdf5_refuse_strangers(context, file, options->dataset);
    bool found = false;
    if (status == SNOW_STATUS_OK)
        status =
            snow_hdf5_read_leaves(context, file, options, info, out, &found);
    if (status == SNOW_STATUS_OK && !found)
        status = snow_hdf5_read_overlapping(context, file, options, info, out,
                                            &found);
    if (status == SNOW_STATUS_OK && !found && options->levels)
        status = snow_fail(context, SNOW_STATUS_BAD_USAGE,
                           "--levels %lld: this file has no levels of "
                           "refinement; remove the option",
                           (long long)options->levels);
    if (status == SNOW_STATUS_OK && !found)
        status = read_step(context, file, options, info, out);
    snow_hdf5_close(file);
    return status;
}

#elif SNOW_LOADS && SNOW_HAVE_HDF5

SNOW_READ_BY_MODULE(read_hdf5, "hdf5")

#else

SNOW_READ_UNBUILT(read_hdf5, "HDF5", "libhdf5-dev")

#endif

const snow_format snow_format_hdf5 = {
    .name = "hdf5",
    .text = "HDF5 and NetCDF-4 (.h5, .hdf5, .nc), one data set of them",
    .suffixes = {".h5", ".hdf5", ".hdf", ".nc4", ".h5.gz"},
    .probe = probe_hdf5,
    .crops = true,
    .sets = true,
    .channels = true,
    .levels = true,
    .read = read_hdf5,
};
