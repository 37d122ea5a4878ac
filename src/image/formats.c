/* image/formats.c - the table of picture formats; saves and loads pictures.
 *
 * A file is written in the format that its name requests, and read in the
 * format that its first bytes show.  Nothing here knows the contents of a
 * format. */
#include "image/image.h"

#include "base/module.h"
#include "base/monitor.h"
#include "image/overlay.h"
#include "io/lookup.h"

#include <string.h>
#include <sys/stat.h>

/* The first is used for standard output. */
static const snow_image_format *const formats[] = {
    &snow_image_png,
#ifndef SNOW_WRITES_PNG /* alone: wasm/CMakeLists.txt */
    &snow_image_npy,  &snow_image_pfm,  &snow_image_exr,
    &snow_image_tiff, &snow_image_webp, &snow_image_jpeg,
#endif
};

#define FORMAT_COUNT (sizeof formats / sizeof *formats)

/* The number of bytes by which formats are recognised. */
#define PROBE_BYTES 16

/* The format of a path's suffix, or NULL.  There is no default for other names:
 * a picture in a format that nobody requested would be a surprise. */
static const snow_image_format *format_of(const char *path) {
    if (!path)
        return NULL;
    if (strcmp(path, "-") == 0)
        return formats[0];
    for (size_t i = 0; i < FORMAT_COUNT; i++)
        if (snow_has_suffix(path, formats[i]->suffix) ||
            (formats[i]->other && snow_has_suffix(path, formats[i]->other)))
            return formats[i];
    return NULL;
}

const char *snow_image_format_suffix(size_t index, bool *built) {
    if (index >= FORMAT_COUNT)
        return NULL;
    const snow_image_format *format = formats[index];
    *built = !format->package &&
             (!format->module || snow_module_is_there(format->module));
    return formats[index]->suffix;
}

int snow_image_format_bits(const char *path) {
    const snow_image_format *format = format_of(path);
    return format ? format->bits : -1;
}

bool snow_image_format_has_depth(const char *path) {
    const snow_image_format *format = format_of(path);
    return format && format->takes_depth;
}

/* A missing module is reported before anything is written. */
static snow_status load_module(snow_context *context, const char *path,
                               const snow_image_format *format) {
    const snow_module *module;
    if (!format->module ||
        snow_module_load(context, format->module, &module) == SNOW_STATUS_OK)
        return SNOW_STATUS_OK;
    return snow_fail_within(context, SNOW_STATUS_BAD_USAGE, "%s", path);
}

static snow_status choose_format(snow_context *context, const char *path,
                                 const snow_image_format **out) {
    SNOW_TRY(snow_need_path(context, path));
    const snow_image_format *format = format_of(path);
    if (format && format->package)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "%s: this build cannot write %s; install %s and build "
                         "again, or write a %s",
                         path, format->name, format->package,
                         format->bits ? ".png" : ".npy");
    SNOW_TRY(format ? load_module(context, path, format) : SNOW_STATUS_OK);
    if (format) {
        *out = format;
        return SNOW_STATUS_OK;
    }
    return snow_fail(
        context, SNOW_STATUS_BAD_USAGE,
        "%s: has no suffix of a picture format; use .png, .jpg, .webp, "
        ".npy, .exr, .tif or .pfm",
        path);
}

static snow_status check_overlay(snow_context *context, const char *path,
                                 int width, int height,
                                 const snow_image_format *format,
                                 const snow_overlay *overlay) {
    if (overlay && !format->bits)
        return snow_fail(
            context, SNOW_STATUS_BAD_USAGE,
            "%s: %s cannot hold an overlay; leave it out, or write a .png",
            path, format->name);
    if (overlay && (overlay->width != width || overlay->height != height))
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "%s: the overlay has %d x %d pixels, but the picture "
                         "%d x %d; make an overlay of its size",
                         path, overlay->width, overlay->height, width, height);
    return SNOW_STATUS_OK;
}

static snow_status check_depth(snow_context *context, const char *path,
                               int width, int height,
                               const snow_image_format *format,
                               const snow_image *depth) {
    if (!depth)
        return SNOW_STATUS_OK;
    if (!format->takes_depth)
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "%s: %s cannot hold depth; write a .exr, or write the "
                         "depth to a file of its own",
                         path, format->name);
    if (depth->channels == 1 && depth->width == width &&
        depth->height == height)
        return SNOW_STATUS_OK;
    return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                     "%s: the depth has %d x %d pixels with %d channels, but "
                     "the picture %d x %d; make a depth of its size",
                     path, depth->width, depth->height, depth->channels, width,
                     height);
}

/* Refuses options that a format does not support, so that none is ignored. */
static snow_status check_options(snow_context *context, const char *path,
                                 int width, int height,
                                 const snow_image_format *format,
                                 const snow_image_options *options) {
    if (!format->bits && (options->flatten || options->bits))
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "%s: %s supports neither a background nor a number of "
                         "bits; leave them out, or write a .png",
                         path, format->name);
    if (options->bits > format->bits && options->bits == 16)
        return snow_fail(
            context, SNOW_STATUS_BAD_USAGE,
            "%s: %s has %d bits per channel; leave 16 out, or write a .png",
            path, format->name, format->bits);
    if (format->most_side &&
        (width > format->most_side || height > format->most_side))
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "%s: %s has at most %d pixels per side; write a .png",
                         path, format->name, format->most_side);
    if (options->bits != 0 && options->bits != 8 && options->bits != 16)
        return snow_fail(
            context, SNOW_STATUS_BAD_USAGE,
            "%s: %d bits per channel are not possible; use 8 or 16", path,
            options->bits);
    for (int i = 0; options->flatten && i < 3; i++)
        if (!(options->background[i] >= 0 && options->background[i] <= 1))
            return snow_fail(
                context, SNOW_STATUS_BAD_USAGE,
                "%s: the background has a channel of %g; use 0 to 1", path,
                options->background[i]);
    SNOW_TRY(check_depth(context, path, width, height, format, options->depth));
    return check_overlay(context, path, width, height, format,
                         options->overlay);
}

/* Adds the file's name to messages of layers that do not know it. */
static snow_status name_file(snow_context *context, snow_status status,
                             const char *name) {
    if (status == SNOW_STATUS_NO_MEMORY || status == SNOW_STATUS_FAILED)
        return snow_fail_within(context, status, "%s", name);
    return status;
}

static void take_dress(const snow_image *image, const snow_image_format *format,
                       snow_image_options *options) {
    if (!image->dressed || !format->bits || options->flatten ||
        options->overlay)
        return;
    options->flatten = true;
    memcpy(options->background, image->ground, sizeof image->ground);
    options->overlay = image->letters;
}

/* Refusals come first, before there is a file.  Then the writer leaves a
 * complete file or none. */
snow_status snow_image_save(const snow_image *image, const char *path,
                            const snow_image_options *given) {
    snow_image_options options;
    const snow_image_format *format = NULL;
    if (!image) /* none was made: there is no context for a message either */
        return SNOW_STATUS_BAD_USAGE;
    SNOW_TRY(
        SNOW_RECORD_READ(image->context, snow_image_options, given, &options));
    SNOW_TRY(choose_format(image->context, path, &format));
    if (format->bits && image->channels == 1)
        return snow_fail(image->context, SNOW_STATUS_BAD_USAGE,
                         "%s: %s holds colours, not values in data units; "
                         "write .npy, .exr, .tif or .pfm, or paint them first",
                         path, format->name);
    take_dress(image, format, &options);
    SNOW_TRY(check_options(image->context, path, image->width, image->height,
                           format, &options));
    snow_writer *writer = NULL;
    SNOW_TRY(
        snow_writer_open(image->context, path, options.overwrite, &writer));
    if (options.unsynced)
        snow_writer_hurry(writer);
    snow_monitor monitor;
    snow_monitor_begin(image->context, &monitor, NULL, NULL);
    snow_status status =
        snow_monitor_end(&monitor, format->write(image, &options, writer));
    if (status != SNOW_STATUS_OK) {
        snow_writer_abandon(writer);
        return name_file(image->context, status, path);
    }
    return snow_writer_commit(writer);
}

/* The writer itself knows best what it can write, so one is opened and aborted.
 * Standard output always exists and must not be written to here. */
static snow_status check_place(snow_context *context, const char *path,
                               bool overwrite) {
    /* Who reads a pipe takes the end of this check for the end of the
     * picture. */
    struct stat here;
    if (strcmp(path, "-") == 0 ||
        (stat(path, &here) == 0 && S_ISFIFO(here.st_mode)))
        return SNOW_STATUS_OK;
    snow_writer *writer = NULL;
    SNOW_TRY(snow_writer_open(context, path, overwrite, &writer));
    snow_writer_abandon(writer);
    return SNOW_STATUS_OK;
}

snow_status snow_image_check(snow_context *context, const char *path, int width,
                             int height, const snow_image_options *given) {
    const snow_image_format *format = NULL;
    snow_image_options options;
    SNOW_TRY(SNOW_RECORD_READ(context, snow_image_options, given, &options));
    SNOW_TRY(choose_format(context, path, &format));
    SNOW_TRY(check_options(context, path, width, height, format, &options));
    return check_place(context, path, options.overwrite);
}

/* The format that the first bytes of an open source show. */
static snow_status probe_source(snow_source *source,
                                const snow_image_format **out) {
    unsigned char start[PROBE_BYTES];
    size_t got = 0;
    SNOW_TRY(snow_source_peek(source, start, sizeof start, &got));
    for (size_t i = 0; i < FORMAT_COUNT; i++) {
        if (!formats[i]->probe(start, got))
            continue;
        *out = formats[i];
        return formats[i]->package
                   ? snow_fail(snow_source_context(source),
                               SNOW_STATUS_BAD_INPUT,
                               "%s: this build cannot read %s; install %s and "
                               "build again",
                               snow_source_name(source), formats[i]->name,
                               formats[i]->package)
                   : SNOW_STATUS_OK;
    }
    return snow_fail(snow_source_context(source), SNOW_STATUS_BAD_INPUT,
                     "%s: %s", snow_source_name(source),
                     got ? "is not a picture of a known format; give a PNG, "
                           "JPEG, WebP, NPY, EXR, TIFF or PFM file"
                         : "is empty; give a PNG, JPEG, WebP, NPY, EXR, TIFF "
                           "or PFM file");
}

/* Reads the picture that an open source holds, to its end: the trailer that
 * proves a gzip stream correct comes after the last pixel. */
static snow_status read_picture(snow_source *source, snow_image **out) {
    const snow_image_format *format = NULL;
    SNOW_TRY(probe_source(source, &format));
    snow_image *image = NULL;
    snow_status status = format->read(source, &image);
    if (status != SNOW_STATUS_OK)
        return name_file(snow_source_context(source), status,
                         snow_source_name(source));
    if (!format->in_any_order)
        status = snow_source_finish(source);
    if (status != SNOW_STATUS_OK) {
        snow_image_free(image);
        return status;
    }
    *out = image;
    return SNOW_STATUS_OK;
}

snow_status snow_image_load(snow_context *context, const char *path,
                            snow_image **out) {
    snow_source *source = NULL;
    snow_image *image = NULL;
    SNOW_TRY(snow_need_path(context, path));
    snow_lookup_begin(context);
    SNOW_TRY(snow_source_open(context, path, &source));
    snow_status status = snow_lookup_end(context, read_picture(source, &image));
    snow_source_close(source);
    if (status == SNOW_STATUS_OK)
        *out = image;
    else
        snow_image_free(image);
    return status;
}

/* The entry for fuzzing: no file is touched. */
snow_status snow_image_load_memory(snow_context *context, const char *name,
                                   const void *bytes, size_t size,
                                   snow_image **out) {
    snow_source *source = NULL;
    SNOW_TRY(snow_source_open_memory(context, name, bytes, size, &source));
    snow_status status = read_picture(source, out);
    snow_source_close(source);
    return status;
}
