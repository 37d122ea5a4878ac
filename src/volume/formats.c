/* volume/formats.c - which reader opens a file, and what holds for all.
 *
 * The first bytes decide, then the name; the sizes that a user gives make
 * everything else raw data.  The name of the file is put before every message
 * here, so that no reader has to. */
#include "volume/volume.h"

#include <math.h>
#include <string.h>

#define PHANTOM "phantom:"

/* Raw, which recognises nothing, is the last. */
static const snow_format *const formats[] = {
    &snow_format_nrrd, &snow_format_nifti, &snow_format_metaimage,
    &snow_format_npy,  &snow_format_vtk,   &snow_format_vti,
    &snow_format_mrc,  &snow_format_raw,
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
static snow_status replace_spacing(snow_volume *volume,
                                   const snow_volume_options *options) {
    snow_volume_info info = volume->info;
    for (int j = 0; j < 3; j++)
        for (int i = 0; i < 3 && options->spacing[j] > 0; i++)
            info.matrix[i][j] *= options->spacing[j] / info.spacing[j];
    /* The file's own matrix was checked: the option alone can be at fault. */
    if (snow_volume_info_check(volume->context, &info) != SNOW_OK)
        return snow_fail(volume->context, SNOW_BAD_USAGE,
                         "--spacing %gx%gx%g makes voxels too small, too large "
                         "or too flat to compute with; give lengths in "
                         "another unit",
                         options->spacing[0], options->spacing[1],
                         options->spacing[2]);
    snow_volume_info_measure(&info);
    volume->info = info;
    return SNOW_OK;
}

/* Options that describe raw data are refused with other formats rather than
 * ignored: they would contradict the header. */
static snow_status read_with(const snow_format *format, snow_source *source,
                             const snow_volume_options *options,
                             snow_volume **out) {
    snow_context *context = snow_source_context(source);
    if (format != &snow_format_raw && tells_raw(options))
        return snow_fail(context, SNOW_BAD_USAGE,
                         "this is a %s file, which tells its sizes and type "
                         "itself; leave out --dims, --type, --endian and "
                         "--offset",
                         format->name);
    snow_volume *volume;
    SNOW_TRY(format->read(source, options, &volume));
    snow_status status = replace_spacing(volume, options);
    if (status != SNOW_OK) {
        snow_volume_close(volume);
        return status;
    }
    *out = volume;
    return SNOW_OK;
}

/* An empty file has its own words: each format would miss something else. */
static snow_status read_source(snow_source *source,
                               const snow_volume_options *options,
                               snow_volume **out) {
    unsigned char bytes[SNOW_PEEK_BYTES];
    size_t size;
    SNOW_TRY(snow_source_peek(source, bytes, sizeof bytes, &size));
    if (!size)
        return snow_fail(snow_source_context(source), SNOW_BAD_INPUT,
                         "is empty; fetch or write the file again");
    return read_with(choose(snow_source_name(source), bytes, size, options),
                     source, options, out);
}

/* Puts the file's name before a failure's message, unless a source has done
 * so, and makes it one line of printable text whatever a header quoted in it
 * contains. */
static snow_status name_failure(snow_context *context, snow_status status,
                                const char *name) {
    char *message = context->message;
    size_t length = strlen(name);
    if (length &&
        (strncmp(message, name, length) != 0 || message[length] != ':'))
        snow_fail_within(context, status, "%s", name);
    for (char *at = message; *at; at++)
        if ((unsigned char)*at < ' ' || *at == 127)
            *at = '?';
    return status;
}

/* Owns the source from here on: every way out closes it after the message has
 * taken its name. */
static snow_status open_source(snow_source *source,
                               const snow_volume_options *options,
                               snow_volume **out) {
    static const snow_volume_options none;
    if (!options)
        options = &none;
    snow_context *context = snow_source_context(source);
    snow_status status = check_options(context, options);
    if (status == SNOW_OK)
        status = read_source(source, options, out);
    if (status != SNOW_OK)
        name_failure(context, status, snow_source_name(source));
    snow_source_close(source);
    return status;
}

/* A phantom is no file; of the options its sizes and spacing make sense. The
 * seed is not among the options and is 0 here. */
static snow_status open_phantom(snow_context *context, const char *name,
                                const snow_volume_options *options,
                                snow_volume **out) {
    if (!options)
        return snow_volume_phantom(context, name, NULL, 0, out);
    SNOW_TRY(check_options(context, options));
    if (options->type || options->endian || options->offset || options->time ||
        options->channel || options->dataset)
        return snow_fail(
            context, SNOW_BAD_USAGE,
            PHANTOM
            "%s: a phantom has its own type; leave out "
            "--type, --endian, --offset, --time, --channel and --dataset",
            name);
    snow_volume *volume;
    SNOW_TRY(snow_volume_phantom(context, name, options->dims, 0, &volume));
    snow_status status = replace_spacing(volume, options);
    if (status != SNOW_OK) {
        snow_volume_close(volume);
        return status;
    }
    *out = volume;
    return SNOW_OK;
}

/* The prefix comes before any file of that name: "./phantom:x" still reaches
 * one. */
snow_status snow_volume_open(snow_context *context, const char *path,
                             const snow_volume_options *options,
                             snow_volume **out) {
    if (!strncmp(path, PHANTOM, strlen(PHANTOM)))
        return open_phantom(context, path + strlen(PHANTOM), options, out);
    snow_source *source;
    snow_status status = snow_source_open(context, path, &source);
    if (status != SNOW_OK)
        return name_failure(context, status,
                            strcmp(path, "-") ? path : "standard input");
    return open_source(source, options, out);
}

snow_status snow_volume_open_memory(snow_context *context, const char *name,
                                    const void *bytes, size_t size,
                                    const snow_volume_options *options,
                                    snow_volume **out) {
    snow_source *source;
    snow_status status =
        snow_source_open_memory(context, name, bytes, size, &source);
    if (status != SNOW_OK)
        return name_failure(context, status, name);
    return open_source(source, options, out);
}
