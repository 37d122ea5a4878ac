/* volume/formats.c - which reader opens a file, and what holds for all.
 *
 * The first bytes decide, then the name; the sizes that a user gives make
 * everything else raw data.  The name of the file is put before every message
 * here, so that no reader has to. */
#include "base/folder.h"
#include "volume/mask.h"
#include "volume/phantom.h"
#include "volume/stack.h"
#include "volume/volume.h"
#include "volume/zarr.h"

#include <math.h>
#include <string.h>

#define PHANTOM "phantom:"

/* DICOM comes before all: its 128 bytes without a meaning are TIFF in files
 * that are both, for programs that know slices only as that.  Raw, which
 * recognises nothing, is the last. */
static const snow_format *const formats[] = {
    &snow_format_dicom,     &snow_format_nrrd, &snow_format_nifti,
    &snow_format_metaimage, &snow_format_npy,  &snow_format_vtk,
    &snow_format_vti,       &snow_format_mrc,  &snow_format_tiff,
    &snow_format_png,       &snow_format_hdf5, &snow_format_netcdf,
    &snow_format_den,       &snow_format_zarr, &snow_format_raw,
};
#define FORMAT_COUNT (sizeof formats / sizeof *formats)

const char *snow_format_name(size_t index) {
    return index < FORMAT_COUNT ? formats[index]->name : NULL;
}

const char *snow_format_text(size_t index) {
    return index < FORMAT_COUNT ? formats[index]->text : NULL;
}

/* The first in the order of the table that claims them. */
const snow_format *snow_format_of_bytes(const void *bytes, size_t size) {
    for (size_t i = 0; i < FORMAT_COUNT; i++)
        if (formats[i]->probe && formats[i]->probe(bytes, size))
            return formats[i];
    return NULL;
}

/* For bytes that no probe knows: a damaged file is refused by the reader that
 * its name asks for, which says more than "unknown". */
const snow_format *snow_format_of_name(const char *name) {
    for (size_t i = 0; i < FORMAT_COUNT; i++)
        for (const char *const *suffix = formats[i]->suffixes; *suffix;
             suffix++)
            if (snow_has_suffix(name, *suffix))
                return formats[i];
    return NULL;
}

/* A suffix counts only while the user has not described the bytes: .img and
 * .bin mean many things. */
static const snow_format *choose(const char *name, const void *bytes,
                                 size_t size,
                                 const snow_volume_options *options) {
    const snow_format *format = snow_format_of_bytes(bytes, size);
    if (!format && !options->dims[0])
        format = snow_format_of_name(name);
    return format ? format : &snow_format_raw;
}

/* True when an option is given that describes raw data. */
static bool tells_raw(const snow_volume_options *options) {
    return options->dims[0] || options->dims[1] || options->dims[2] ||
           options->type || options->endian || options->offset;
}

/* The options' values by themselves, before a format is known. */
static snow_status check_options(snow_context *context,
                                 const snow_volume_options *options) {
    for (int i = 0; i < 3; i++) {
        double spacing = options->spacing[i];
        if (!(spacing >= 0) || !isfinite(spacing))
            return snow_fail(context, SNOW_BAD_USAGE,
                             "--spacing: %g is no length; give three lengths "
                             "above 0",
                             spacing);
        if (options->dims[i] < 0)
            return snow_fail(context, SNOW_BAD_USAGE,
                             "--dims: %lld is no number of voxels; give three "
                             "sizes of at least 1",
                             (long long)options->dims[i]);
    }
    if (options->time < 0)
        return snow_fail(context, SNOW_BAD_USAGE,
                         "time step %lld is none; they count from 0",
                         (long long)options->time);
    return SNOW_OK;
}

/* Stretches the matrix' columns to the spacing that the user gave. */
static snow_status replace_spacing(snow_context *context,
                                   const snow_volume_options *options,
                                   snow_volume_info *info) {
    snow_volume_info changed = *info;
    for (int j = 0; j < 3; j++)
        for (int i = 0; i < 3 && options->spacing[j] > 0; i++)
            changed.matrix[i][j] *= options->spacing[j] / info->spacing[j];
    /* The file's own matrix was checked: the option alone can be at fault. */
    if (snow_volume_info_check(context, &changed) != SNOW_OK)
        return snow_fail(context, SNOW_BAD_USAGE,
                         "--spacing %gx%gx%g makes voxels too small, too large "
                         "or too flat to compute with; give lengths in "
                         "another unit",
                         options->spacing[0], options->spacing[1],
                         options->spacing[2]);
    snow_volume_info_measure(&changed);
    *info = changed;
    return SNOW_OK;
}

/* What holds for all formats: the spacing first, then the way to the first
 * voxel of the box, which is so many spacings. */
static snow_status finish_info(snow_context *context,
                               const snow_volume_options *options,
                               snow_volume_info *info) {
    snow_volume_info_measure(info);
    SNOW_TRY(replace_spacing(context, options, info));
    const int64_t first[3] = {options->crop[0][0], options->crop[1][0],
                              options->crop[2][0]};
    *info = snow_volume_info_of_box(info, first, info->dims);
    return SNOW_OK;
}

/* Cuts the box out of a volume that was read whole. */
static snow_status crop_volume(const snow_volume_options *options,
                               snow_volume **volume) {
    snow_context *context = (*volume)->context;
    snow_volume_info info = (*volume)->info;
    int64_t time = info.time, times = info.times;
    snow_window window;
    snow_volume *box;
    info.time = 0;
    info.times = 1;
    SNOW_TRY(snow_window_lay(context, options, &info, &window));
    const snow_file_part all = {&window, 0, window.all};
    if (snow_file_part_is_all(&all))
        return SNOW_OK;
    info.time = time;
    info.times = times;
    SNOW_TRY(snow_volume_new(context, &info, &box));
    snow_file_part_copy(&all, (*volume)->voxels, box->owned);
    snow_volume_close(*volume);
    *volume = box;
    return SNOW_OK;
}

/* With a format that cannot stop behind the header, or in the middle. */
static snow_status read_whole(const snow_format *format, snow_source *source,
                              const snow_volume_options *options,
                              snow_volume_info *info, snow_volume **out) {
    snow_volume *volume;
    SNOW_TRY(format->read(source, options, info, &volume));
    snow_status status = crop_volume(options, &volume);
    if (status == SNOW_OK)
        *info = volume->info;
    if (status == SNOW_OK && out)
        *out = volume;
    else
        snow_volume_close(volume);
    return status;
}

/* What cannot be chosen in a format must not seem to have been. */
static snow_status check_choice(snow_context *context,
                                const snow_format *format,
                                const snow_volume_options *options) {
    if (options->dataset && !format->sets)
        return snow_fail(
            context, SNOW_BAD_USAGE,
            "--dataset %.200s: files of the format %s have their data alone; "
            "leave the option out",
            options->dataset, format->name);
    if (options->channel && !format->channels)
        return snow_fail(
            context, SNOW_BAD_USAGE,
            "there is no channel %lld; files of the format %s have one value a "
            "voxel, so leave --channel out",
            (long long)options->channel, format->name);
    if (options->series && !format->series)
        return snow_fail(
            context, SNOW_BAD_USAGE,
            "--series %.64s: files of the format %s have no series; leave the "
            "option out",
            options->series, format->name);
    return SNOW_OK;
}

/* Options that describe raw data are refused with other formats rather than
 * ignored: they would contradict the header. */
static snow_status read_with(const snow_format *format, snow_source *source,
                             const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out) {
    snow_context *context = snow_source_context(source);
    if (format != &snow_format_raw && tells_raw(options))
        return snow_fail(
            context, SNOW_BAD_USAGE,
            "this is a file of the format %s, which tells its sizes and type "
            "itself; leave out --dims, --type, --endian and "
            "--offset",
            format->name);
    SNOW_TRY(check_choice(context, format, options));
    snow_volume *volume = NULL;
    SNOW_TRY(
        format->crops
            ? format->read(source, options, info, out ? &volume : NULL)
            : read_whole(format, source, options, info, out ? &volume : NULL));
    snow_status status = finish_info(context, options, info);
    if (status != SNOW_OK) {
        snow_volume_close(volume);
        return status;
    }
    if (out) {
        volume->info = *info;
        *out = volume;
    }
    return SNOW_OK;
}

/* An empty file has its own words: each format would miss something else. */
static snow_status read_source(snow_source *source,
                               const snow_volume_options *options,
                               snow_volume_info *info, snow_volume **out) {
    unsigned char bytes[SNOW_PEEK_BYTES];
    size_t size;
    SNOW_TRY(snow_source_peek(source, bytes, sizeof bytes, &size));
    if (!size)
        return snow_fail(snow_source_context(source), SNOW_BAD_INPUT,
                         "is empty; fetch or write the file again");
    return read_with(choose(snow_source_name(source), bytes, size, options),
                     source, options, info, out);
}

snow_status snow_fail_in_file(snow_context *context, snow_status status,
                              const char *path) {
    const char *message = context->message;
    size_t length = strlen(path);
    if (length &&
        (strncmp(message, path, length) != 0 || message[length] != ':'))
        snow_fail_within(context, status, "%s", path);
    return status;
}

/* A failure's message with the file's name, as one line of printable text
 * whatever a header quoted in it contains. */
static snow_status name_failure(snow_context *context, snow_status status,
                                const char *name) {
    snow_fail_in_file(context, status, name);
    for (char *at = context->message; *at; at++)
        if ((unsigned char)*at < ' ' || *at == 127)
            *at = '?';
    return status;
}

static const snow_volume_options no_options;

/* Owns the source from here on: every way out closes it after the message has
 * taken its name. */
static snow_status open_source(snow_source *source,
                               const snow_volume_options *options,
                               snow_volume_info *info, snow_volume **out) {
    snow_context *context = snow_source_context(source);
    snow_volume_info told;
    snow_status status = check_options(context, options);
    if (status == SNOW_OK)
        status = read_source(source, options, &told, out);
    if (status == SNOW_OK)
        *info = told;
    else
        name_failure(context, status, snow_source_name(source));
    snow_source_close(source);
    return status;
}

/* A phantom is no file; of the options its sizes, spacing and box make sense.
 * The seed is not among the options and is 0 here. */
static snow_status open_phantom(snow_context *context, const char *name,
                                const snow_volume_options *options,
                                snow_volume_info *info, snow_volume **out) {
    SNOW_TRY(check_options(context, options));
    if (options->type || options->endian || options->offset || options->time ||
        options->channel || options->dataset || options->series)
        return snow_fail(
            context, SNOW_BAD_USAGE,
            PHANTOM
            "%s: a phantom has its own type; leave out "
            "--type, --endian, --offset, --time, --channel, --dataset and "
            "--series",
            name);
    snow_volume *volume = NULL;
    snow_volume_info told;
    SNOW_TRY(snow_phantom_make(context, name, options, 0, &told,
                               out ? &volume : NULL));
    snow_status status = finish_info(context, options, &told);
    if (status != SNOW_OK) {
        snow_volume_close(volume);
        return status;
    }
    *info = told;
    if (out) {
        volume->info = told;
        *out = volume;
    }
    return SNOW_OK;
}

/* A folder or a pattern: an array of Zarr, or slices in files of their own. */
static snow_status read_folder(snow_context *context, const char *path,
                               const snow_volume_options *options,
                               snow_volume_info *info, snow_volume **out) {
    if (!snow_zarr_is(path))
        return snow_stack_read(context, path, options, info, out);
    SNOW_TRY(check_choice(context, &snow_format_zarr, options));
    return snow_zarr_read_folder(context, path, options, info, out);
}

/* What holds for all formats holds for files in a folder. */
static snow_status open_stack(snow_context *context, const char *path,
                              const snow_volume_options *options,
                              snow_volume_info *info, snow_volume **out) {
    snow_volume *volume = NULL;
    snow_volume_info told;
    snow_status status = check_options(context, options);
    if (status == SNOW_OK && tells_raw(options))
        status = snow_fail(context, SNOW_BAD_USAGE,
                           "a folder's files tell their sizes and type "
                           "themselves; leave out --dims, --type, --endian and "
                           "--offset");
    if (status == SNOW_OK)
        status =
            read_folder(context, path, options, &told, out ? &volume : NULL);
    if (status == SNOW_OK)
        status = finish_info(context, options, &told);
    if (status != SNOW_OK) {
        snow_volume_close(volume);
        return name_failure(context, status, path);
    }
    *info = told;
    if (out) {
        volume->info = told;
        *out = volume;
    }
    return SNOW_OK;
}

/* The path of a data set in "file.h5:/path", where that is no file but its
 * front is one; else NULL. */
static const char *data_set_in(const char *path) {
    const char *found = NULL;
    for (const char *at = path; (at = strstr(at, ":/")); at++)
        found = at;
    if (!found || snow_is_there(path, strlen(path)) ||
        !snow_is_there(path, (size_t)(found - path)))
        return NULL;
    return found + 1;
}

static snow_status open_path(snow_context *context, const char *path,
                             const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out);

static snow_status open_inside(snow_context *context, const char *path,
                               const char *inside,
                               const snow_volume_options *options,
                               snow_volume_info *info, snow_volume **out) {
    snow_volume_options own = *options;
    if (own.dataset)
        return snow_fail(context, SNOW_BAD_USAGE,
                         "%s: names a data set, as --dataset does; leave one "
                         "of them out",
                         path);
    own.dataset = inside;
    size_t length = (size_t)(inside - 1 - path);
    char *file = snow_allocate(context, length + 1);
    if (!file)
        return SNOW_NO_MEMORY;
    memcpy(file, path, length);
    file[length] = 0;
    snow_status status = open_path(context, file, &own, info, out);
    snow_release(context, file);
    return status;
}

/* The prefix comes before any file of that name: "./phantom:x" still reaches
 * one. */
static snow_status open_path(snow_context *context, const char *path,
                             const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out) {
    if (!options)
        options = &no_options;
    if (!strncmp(path, PHANTOM, strlen(PHANTOM)))
        return open_phantom(context, path + strlen(PHANTOM), options, info,
                            out);
    const char *inside = data_set_in(path);
    if (inside)
        return open_inside(context, path, inside, options, info, out);
    if (snow_is_folder(path) || snow_is_pattern(path))
        return open_stack(context, path, options, info, out);
    snow_source *source;
    snow_status status = snow_source_open(context, path, &source);
    if (status != SNOW_OK)
        return name_failure(context, status,
                            strcmp(path, "-") ? path : "standard input");
    return open_source(source, options, info, out);
}

snow_status snow_volume_open(snow_context *context, const char *path,
                             const snow_volume_options *options,
                             snow_volume **out) {
    snow_volume_info info;
    if (snow_mask_asked(options))
        return snow_mask_open(context, path, options, &info, out);
    return open_path(context, path, options, &info, out);
}

snow_status snow_volume_inspect(snow_context *context, const char *path,
                                const snow_volume_options *options,
                                snow_volume_info *out) {
    if (snow_mask_asked(options))
        return snow_mask_open(context, path, options, out, NULL);
    return open_path(context, path, options, out, NULL);
}

snow_status snow_volume_open_memory(snow_context *context, const char *name,
                                    const void *bytes, size_t size,
                                    const snow_volume_options *options,
                                    snow_volume **out) {
    snow_source *source;
    snow_volume_info info;
    if (snow_mask_asked(options))
        return snow_fail(context, SNOW_BAD_USAGE,
                         "%s: bytes in memory have no file of a mask beside "
                         "them; open them and take snow_volume_mask or "
                         "snow_volume_clip",
                         name);
    snow_status status =
        snow_source_open_memory(context, name, bytes, size, &source);
    if (status != SNOW_OK)
        return name_failure(context, status, name);
    return open_source(source, options ? options : &no_options, &info, out);
}
