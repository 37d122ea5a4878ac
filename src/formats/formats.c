/* formats/formats.c - selects the reader for a file and applies the options
 * that all formats share.
 *
 * The first bytes decide, then the name; sizes from the user make everything
 * else raw data.  The file's name is added to every message here, so that
 * readers need not do it. */
#include "formats/opening.h"

#include "formats/amr/amr.h"
#include "formats/bytes/packed.h"
#include "formats/zarr/zarr.h"
#include "io/folder.h"
#include "io/lookup.h"
#include "phantom/phantom.h"
#include "volume/mask.h"

#include <math.h>
#include <string.h>

#define PHANTOM "phantom:"

/* True if an option describes raw data. */
static bool looks_raw(const snow_volume_options *options) {
    return options->dims[0] || options->dims[1] || options->dims[2] ||
           options->type || options->endian || options->offset;
}

/* Checks the options' values, before the format is known. */
static snow_status check_options(snow_context *context,
                                 const snow_volume_options *options) {
    for (int i = 0; i < 3; i++) {
        double spacing = options->spacing[i];
        if (!(spacing >= 0) || !isfinite(spacing))
            return snow_fail(
                context, SNOW_STATUS_BAD_USAGE,
                "--spacing: %g is not a length; give three lengths above 0",
                spacing);
        if (options->dims[i] < 0)
            return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                             "--dims: %lld is not a number of voxels; give "
                             "three sizes of at least 1",
                             (long long)options->dims[i]);
    }
    if (!(options->z_scale >= 0) || !isfinite(options->z_scale))
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "--z-scale: %g is not a factor; give one above 0, or "
                         "auto",
                         options->z_scale);
    if (options->levels < 0)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "--levels: %lld is not a number of levels; give at "
                         "least 1, or 0 for all",
                         (long long)options->levels);
    if (options->vertical && strcmp(options->vertical, "levels") != 0 &&
        strcmp(options->vertical, "height") != 0)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "--vertical %.64s: is no way to show levels; give "
                         "levels or height",
                         options->vertical);
    if (options->suv && strcmp(options->suv, "bw") != 0 &&
        strcmp(options->suv, "lbm") != 0 && strcmp(options->suv, "bsa") != 0 &&
        strcmp(options->suv, "none") != 0)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "--suv %.64s: is no unit of PET; give bw, lbm, bsa or "
                         "none",
                         options->suv);
    return SNOW_STATUS_OK;
}

/* Ends the reading of a volume, which may be NULL.  Applies the options for all
 * formats: first the spacing, then the offset of the box, which is a multiple
 * of the spacing. */
static snow_status finish(snow_context *context, snow_status status,
                          const snow_volume_options *options,
                          snow_volume_info *given, snow_volume *volume,
                          snow_volume_info *info, snow_volume **out) {
    const int64_t first[3] = {options->crop[0][0], options->crop[1][0],
                              options->crop[2][0]};
    if (status == SNOW_STATUS_OK) {
        snow_volume_info_measure(given);
        status = snow_volume_replace_spacing(context, options, given);
    }
    if (status == SNOW_STATUS_OK && options->z_scale > 0) {
        snow_volume_stretch(given, options->z_scale);
        status = snow_volume_info_check(context, given);
    }
    if (status == SNOW_STATUS_OK)
        *info = snow_volume_info_of_box(given, first, given->dims);
    if (status == SNOW_STATUS_OK && volume)
        volume->info = *info;
    if (status == SNOW_STATUS_OK && options->suv &&
        strcmp(options->suv, "none") != 0 && strcmp(given->modality, "PT") != 0)
        snow_notify(context, "--suv: the volume is no PET in DICOM; its values "
                             "stay as they are");
    return snow_volume_give(status, volume, out);
}

/* For a format that cannot stop after the header, or in the middle. */
static snow_status read_whole(const snow_format *format, snow_source *source,
                              const snow_volume_options *options,
                              snow_volume_info *info, snow_volume **out) {
    snow_volume *volume;
    SNOW_TRY(format->read(source, options, info, &volume));
    snow_status status = snow_volume_crop(options, &volume);
    if (status == SNOW_STATUS_OK)
        *info = volume->info;
    return snow_volume_give(status, volume, out);
}

/* An option that a format ignores must not seem to work. */
static snow_status check_choice(snow_context *context,
                                const snow_format *format,
                                const snow_volume_options *options) {
    char channel[24] = "", levels[24] = "";
    snow_append(channel, sizeof channel, "%lld", (long long)options->channel);
    snow_append(levels, sizeof levels, "%lld", (long long)options->levels);
    const char *part = options->component;
    const struct {
        bool ignored;
        const char *option, *value, *why;
    } choices[] = {
        {options->dataset && !format->sets, "dataset", options->dataset,
         "a single data set"},
        {options->channel && !format->channels, "channel", channel,
         "one value per voxel"},
        {part && strcmp(part, "0") != 0 && !format->channels, "component", part,
         "one value per voxel"},
        {options->series && !format->series, "series", options->series,
         "no series"},
        {options->levels && !format->levels, "levels", levels,
         "no levels of refinement"},
    };
    SNOW_TRY(snow_component_check(context, format->names, options));
    for (size_t i = 0; i < sizeof choices / sizeof *choices; i++)
        if (choices[i].ignored)
            return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                             "--%s %.200s: files of the format %s have %s; "
                             "remove the option",
                             choices[i].option, choices[i].value, format->name,
                             choices[i].why);
    return SNOW_STATUS_OK;
}

/* Options for raw data are refused with other formats, not ignored: they could
 * contradict the header. */
static snow_status read_with(const snow_format *format, snow_source *source,
                             const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out) {
    snow_context *context = snow_source_context(source);
    if (format != &snow_format_raw && looks_raw(options))
        return snow_fail(
            context, SNOW_STATUS_BAD_USAGE,
            "this is a file of the format %s, whose header has sizes and type; "
            "remove --dims, --type, --endian and --offset",
            format->name);
    SNOW_TRY(check_choice(context, format, options));
    snow_volume *volume = NULL, **wanted = out ? &volume : NULL;
    snow_volume_info given;
    snow_status status =
        format->crops ? format->read(source, options, &given, wanted)
                      : read_whole(format, source, options, &given, wanted);
    return finish(context, status, options, &given, volume, info, out);
}

/* An empty file has its own message: each format would miss something else.  A
 * suffix counts only while the user has not described the bytes: .img and .bin
 * mean many things. */
static snow_status read_source(snow_source *source,
                               const snow_volume_options *options,
                               snow_volume_info *info, snow_volume **out) {
    unsigned char bytes[SNOW_PEEK_BYTES];
    size_t size;
    SNOW_TRY(snow_source_peek(source, bytes, sizeof bytes, &size));
    if (snow_looks_bzip2(bytes, size)) { /* gzip is undone already */
        SNOW_TRY(snow_source_unpack_bzip2(source));
        SNOW_TRY(snow_source_peek(source, bytes, sizeof bytes, &size));
    }
    if (!size)
        return snow_fail(snow_source_context(source), SNOW_STATUS_BAD_INPUT,
                         "is empty; get or write the file again");
    const char *mesh = snow_mesh_in_netcdf(bytes, size);
    if (mesh && !options->dataset)
        return snow_fail(snow_source_context(source), SNOW_STATUS_BAD_INPUT,
                         "%s", mesh);
    const snow_format *format = snow_format_of_bytes(bytes, size);
    if (!format && !options->dims[0])
        format = snow_format_of_name(snow_source_name(source));
    return read_with(format ? format : &snow_format_raw, source, options, info,
                     out);
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

/* Owns the source from here on: it is closed on every return, after the message
 * has taken its name. */
static snow_status open_source(snow_source *source,
                               const snow_volume_options *options,
                               snow_volume_info *info, snow_volume **out) {
    snow_context *context = snow_source_context(source);
    snow_status status = check_options(context, options);
    if (status == SNOW_STATUS_OK)
        status = read_source(source, options, info, out);
    if (status != SNOW_STATUS_OK)
        name_failure(context, status, snow_source_name(source));
    snow_source_close(source);
    return status;
}

/* A phantom is not a file; of the options only sizes, spacing and box apply.
 * The seed is not among the options and is 0 here. */
static snow_status open_phantom(snow_context *context, const char *name,
                                const snow_volume_options *options,
                                snow_volume_info *info, snow_volume **out) {
    SNOW_TRY(check_options(context, options));
    if (options->type || options->endian || options->offset || options->time ||
        options->channel || options->dataset || options->series ||
        options->component)
        return snow_fail(
            context, SNOW_STATUS_BAD_USAGE,
            PHANTOM "%s: a phantom has its own type; remove --type, --endian, "
                    "--offset, --time, --channel, --component, --dataset and "
                    "--series",
            name);
    snow_volume *volume = NULL;
    snow_volume_info given;
    SNOW_TRY(snow_phantom_make(context, name, options, 0, &given,
                               out ? &volume : NULL));
    return finish(context, SNOW_STATUS_OK, options, &given, volume, info, out);
}

/* Reads a folder or a pattern: a Zarr array, or files with one slice each. */
static snow_status read_folder(snow_context *context, const char *path,
                               const snow_volume_options *options,
                               snow_volume_info *info, snow_volume **out) {
    static const snow_format slices = {
        .name = "slices", .channels = true, .series = true};
    const bool zarr = snow_zarr_is(context, path);
    SNOW_TRY(snow_refuse_folder(context, path));
    SNOW_TRY(
        check_choice(context, zarr ? &snow_format_zarr : &slices, options));
    return zarr ? snow_zarr_read_folder(context, path, options, info, out)
                : snow_stack_read(context, path, options, snow_format_of_name,
                                  info, out);
}

/* Applies the options for all formats to files in a folder. */
static snow_status open_stack(snow_context *context, const char *path,
                              const snow_volume_options *options,
                              snow_volume_info *info, snow_volume **out) {
    snow_volume *volume = NULL;
    snow_volume_info given;
    snow_status status = check_options(context, options);
    if (status == SNOW_STATUS_OK && looks_raw(options))
        status =
            snow_fail(context, SNOW_STATUS_BAD_USAGE,
                      "files in a folder have headers with sizes and type; "
                      "remove --dims, --type, --endian and --offset");
    if (status == SNOW_STATUS_OK)
        status =
            read_folder(context, path, options, &given, out ? &volume : NULL);
    status = finish(context, status, options, &given, volume, info, out);
    return status == SNOW_STATUS_OK ? status
                                    : name_failure(context, status, path);
}

static snow_open_named_fn open_named_path;

static snow_status open_file(snow_context *context, const char *path, int depth,
                             const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out) {
    snow_source *source;
    if (depth && snow_source_is_stream(path)) /* it could wait for ever */
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "%s: is a pipe; give a regular file", path);
    snow_status status = snow_source_open(context, path, &source);
    if (status != SNOW_STATUS_OK)
        return name_failure(context, status,
                            strcmp(path, "-") ? path : "standard input");
    snow_source_set_opener(source, depth, open_named_path);
    return open_source(source, options, info, out);
}

static snow_status open_inside(snow_context *context, const char *path,
                               const char *inside, int depth,
                               const snow_volume_options *options,
                               snow_volume_info *info, snow_volume **out) {
    snow_volume_options own = *options;
    if (own.dataset)
        return snow_fail(
            context, SNOW_STATUS_BAD_USAGE,
            "%s: names a data set, as --dataset does; give only one of them",
            path);
    own.dataset = inside;
    size_t length = (size_t)(inside - 1 - path);
    char *file = snow_allocate(context, length + 1);
    if (!file)
        return SNOW_STATUS_NO_MEMORY;
    memcpy(file, path, length);
    file[length] = 0;
    snow_status status = open_named_path(context, file, depth, &own, info, out);
    snow_release(context, file);
    return status;
}

/* The prefix has priority over a file of that name: "./phantom:x" still opens
 * one. */
static snow_status open_named_path(snow_context *context, const char *path,
                                   int depth,
                                   const snow_volume_options *options,
                                   snow_volume_info *info, snow_volume **out) {
    if (!strncmp(path, PHANTOM, strlen(PHANTOM)))
        return open_phantom(context, path + strlen(PHANTOM), options, info,
                            out);
    const char *inside = snow_data_set_in(context, path);
    char *header;
    if (inside)
        return open_inside(context, path, inside, depth, options, info, out);
    SNOW_TRY(snow_plotfile_header(context, path, &header));
    if (header) {
        snow_status status =
            open_named_path(context, header, depth, options, info, out);
        snow_release(context, header);
        return status;
    }
    if (snow_is_folder(context, path) || snow_is_pattern(context, path))
        return open_stack(context, path, options, info, out);
    return open_file(context, path, depth, options, info, out);
}

/* A volume on the way to be opened, component by component. */
typedef struct input {
    snow_context *context;
    const char *path;
    bool is_file;
    const void *bytes; /* else, in memory */
    size_t size;
    snow_bytes_behind with; /* or by a function, if there is one */
} input;

static snow_status read_input(void *user, const snow_volume_options *options,
                              snow_volume_info *info, snow_volume **out) {
    const input *in = user;
    snow_source *source;
    if (in->is_file)
        return open_named_path(in->context, in->path, 0, options, info, out);
    snow_status status =
        in->with.read_at
            ? snow_source_open_with(in->context, in->path, &in->with, &source)
            : snow_source_open_memory(in->context, in->path, in->bytes,
                                      in->size, &source);
    return status == SNOW_STATUS_OK
               ? open_source(source, options, info, out)
               : name_failure(in->context, status, in->path);
}

static snow_status open_path(snow_context *context, const char *path,
                             const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out) {
    input in = {.context = context, .path = path, .is_file = true};
    return snow_components_read(context, read_input, &in,
                                snow_source_is_stream(path), options, info,
                                out);
}

static snow_status open_any(snow_context *context, const char *path,
                            const snow_volume_options *given,
                            snow_volume_info *info, snow_volume **out) {
    snow_volume_options options;
    snow_volume *volume = NULL, **wanted = out ? &volume : NULL;
    SNOW_TRY(snow_need_path(context, path));
    SNOW_TRY(SNOW_RECORD_READ(context, snow_volume_options, given, &options));
    snow_lookup_begin(context);
    snow_status status =
        snow_mask_asked(&options)
            ? snow_masked_open(context, path, &options, open_path, info, wanted)
            : open_path(context, path, &options, info, wanted);
    if (status == SNOW_STATUS_OK && volume && options.label_table)
        status = snow_label_table_read(context, options.label_table, volume);
    return snow_volume_finish(context, status, volume, out);
}

/* A slab of a picture is read under the picture's monitor. */
snow_status snow_volume_open(snow_context *context, const char *path,
                             const snow_volume_options *options,
                             snow_volume **out) {
    snow_monitor monitor;
    snow_volume_info info;
    snow_monitor_begin_reading(context, &monitor);
    return snow_monitor_end(&monitor,
                            open_any(context, path, options, &info, out));
}

snow_status snow_volume_inspect(snow_context *context, const char *path,
                                const snow_volume_options *options,
                                snow_volume_info *out) {
    snow_volume_info info;
    SNOW_TRY(open_any(context, path, options, &info, NULL));
    return SNOW_RECORD_FILL(context, snow_volume_info, &info, out);
}

snow_status snow_volume_open_streamed(snow_context *context, const char *path,
                                      const snow_volume_options *options,
                                      uint64_t slab_bytes, snow_volume **out) {
    return snow_stream_open(context, path, options, slab_bytes, open_any, out);
}

/* Not of a file. */
static snow_status open_bytes(input *in, const snow_volume_options *given,
                              snow_volume **out) {
    snow_monitor monitor;
    snow_volume_info info;
    snow_volume_options options;
    SNOW_TRY(
        SNOW_RECORD_READ(in->context, snow_volume_options, given, &options));
    if (snow_mask_asked(&options))
        return snow_fail(in->context, SNOW_STATUS_BAD_USAGE,
                         "%s: bytes in memory have no file of a mask beside "
                         "them; open them and take snow_volume_mask or "
                         "snow_volume_clip",
                         in->path);
    snow_volume *volume = NULL;
    snow_monitor_begin_reading(in->context, &monitor);
    snow_lookup_begin(in->context);
    snow_status status = snow_components_read(in->context, read_input, in,
                                              false, &options, &info, &volume);
    return snow_monitor_end(
        &monitor, snow_volume_finish(in->context, status, volume, out));
}

snow_status snow_volume_open_memory(snow_context *context, const char *name,
                                    const void *bytes, size_t size,
                                    const snow_volume_options *options,
                                    snow_volume **out) {
    input in = {.context = context, .path = name, .bytes = bytes, .size = size};
    return open_bytes(&in, options, out);
}

snow_status snow_volume_open_with(snow_context *context, const char *name,
                                  snow_read_at_fn *read_at, void *user,
                                  uint64_t size,
                                  const snow_volume_options *options,
                                  snow_volume **out) {
    input in = {
        .context = context, .path = name, .with = {read_at, user, size}};
    return open_bytes(&in, options, out);
}
