/* image/formats.c - the table of picture formats, and saving and loading.
 *
 * A file is written in the format that its name asks for, and read in the one
 * that its first bytes show.  Nothing here knows what is inside a format. */
#include "image/image.h"

#include "base/module.h"
#include "image/overlay.h"

#include <string.h>

/* The first is what standard output gets. */
static const snow_image_format *const formats[] = {
    &snow_image_png, &snow_image_npy,  &snow_image_pfm,
    &snow_image_exr, &snow_image_tiff, &snow_image_webp,
};

#define FORMAT_COUNT (sizeof formats / sizeof *formats)

/* The bytes that formats are told apart by. */
#define PROBE_BYTES 16

/* The format that a path's suffix stands for, or NULL.  There is no default for
 * other names: a picture in a format that nobody asked for would surprise. */
static const snow_image_format *format_of(const char *path) {
    if (strcmp(path, "-") == 0)
        return formats[0];
    for (size_t i = 0; i < FORMAT_COUNT; i++)
        if (snow_has_suffix(path, formats[i]->suffix) ||
            (formats[i]->other && snow_has_suffix(path, formats[i]->other)))
            return formats[i];
    return NULL;
}

const char *snow_image_suffix(size_t index, bool *built) {
    if (index >= FORMAT_COUNT)
        return NULL;
    const snow_image_format *format = formats[index];
    *built = !format->package &&
             (!format->module || snow_module_is_there(format->module));
    return formats[index]->suffix;
}

int snow_image_bits(const char *path) {
    const snow_image_format *format = format_of(path);
    return format ? format->bits : -1;
}

bool snow_image_takes_depth(const char *path) {
    const snow_image_format *format = format_of(path);
    return format && format->takes_depth;
}

/* A module that is missing is told of before there is anything to write. */
static snow_status load_module(snow_context *context, const char *path,
                               const snow_image_format *format) {
    const snow_module *module;
    if (!format->module ||
        snow_module_load(context, format->module, &module) == SNOW_OK)
        return SNOW_OK;
    return snow_fail_within(context, SNOW_BAD_USAGE, "%s", path);
}

static snow_status choose_format(snow_context *context, const char *path,
                                 const snow_image_format **out) {
    const snow_image_format *format = format_of(path);
    if (format && format->package)
        return snow_fail(context, SNOW_BAD_USAGE,
                         "%s: this build writes no %s; install %s and build "
                         "again, or write a %s",
                         path, format->name, format->package,
                         format->bits ? ".png" : ".npy");
    SNOW_TRY(format ? load_module(context, path, format) : SNOW_OK);
    if (format) {
        *out = format;
        return SNOW_OK;
    }
    return snow_fail(context, SNOW_BAD_USAGE,
                     "%s: the name does not tell a picture format; let it end "
                     "with .png, .webp, .npy, .exr, .tif or .pfm",
                     path);
}

static snow_status check_overlay(snow_context *context, const char *path,
                                 int width, int height,
                                 const snow_image_format *format,
                                 const snow_overlay *overlay) {
    if (overlay && !format->bits)
        return snow_fail(context, SNOW_BAD_USAGE,
                         "%s: %s takes no overlay; leave it out, or write a "
                         ".png",
                         path, format->name);
    if (overlay && (overlay->width != width || overlay->height != height))
        return snow_fail(context, SNOW_BAD_USAGE,
                         "%s: the overlay is of %d x %d pixels, the picture of "
                         "%d x %d; make one for it",
                         path, overlay->width, overlay->height, width, height);
    return SNOW_OK;
}

static snow_status check_depth(snow_context *context, const char *path,
                               int width, int height,
                               const snow_image_format *format,
                               const snow_image *depth) {
    if (!depth)
        return SNOW_OK;
    if (!format->takes_depth)
        return snow_fail(context, SNOW_BAD_USAGE,
                         "%s: %s takes no depth beside the picture; write a "
                         ".exr, or the depth to a file of its own",
                         path, format->name);
    if (depth->channels == 1 && depth->width == width &&
        depth->height == height)
        return SNOW_OK;
    return snow_fail(context, SNOW_BAD_USAGE,
                     "%s: the depth is of %d x %d pixels of %d channels, the "
                     "picture of %d x %d; make one for it",
                     path, depth->width, depth->height, depth->channels, width,
                     height);
}

/* Refuses what a format cannot heed, rather than to ignore it. */
static snow_status check_options(snow_context *context, const char *path,
                                 int width, int height,
                                 const snow_image_format *format,
                                 const snow_image_options *options) {
    if (!format->bits && (options->flatten || options->bits))
        return snow_fail(context, SNOW_BAD_USAGE,
                         "%s: %s takes neither a background nor a number of "
                         "bits; leave them out, or write a .png",
                         path, format->name);
    if (options->bits > format->bits && options->bits == 16)
        return snow_fail(context, SNOW_BAD_USAGE,
                         "%s: %s has %d bits a channel; leave 16 out, or write "
                         "a .png",
                         path, format->name, format->bits);
    if (format->most_side &&
        (width > format->most_side || height > format->most_side))
        return snow_fail(context, SNOW_BAD_USAGE,
                         "%s: %s has at most %d pixels a side; write a .png",
                         path, format->name, format->most_side);
    if (options->bits != 0 && options->bits != 8 && options->bits != 16)
        return snow_fail(context, SNOW_BAD_USAGE,
                         "%s: %d bits a channel are not possible; take 8 or "
                         "16",
                         path, options->bits);
    for (int i = 0; options->flatten && i < 3; i++)
        if (!(options->background[i] >= 0 && options->background[i] <= 1))
            return snow_fail(context, SNOW_BAD_USAGE,
                             "%s: the background has a channel of %g; take 0 "
                             "to 1",
                             path, options->background[i]);
    SNOW_TRY(check_depth(context, path, width, height, format, options->depth));
    return check_overlay(context, path, width, height, format,
                         options->overlay);
}

/* Puts the file's name before messages of layers that know none. */
static snow_status name_file(snow_context *context, snow_status status,
                             const char *name) {
    if (status == SNOW_NO_MEMORY || status == SNOW_FAILED)
        return snow_fail_within(context, status, "%s", name);
    return status;
}

static const snow_image_options standard = {0};

/* Refusals come first, before there is a file; then the writer sees to it that
 * there is a whole one or none. */
snow_status snow_image_save(const snow_image *image, const char *path,
                            const snow_image_options *options) {
    if (!options)
        options = &standard;
    const snow_image_format *format = NULL;
    SNOW_TRY(choose_format(image->context, path, &format));
    if (format->bits && image->channels == 1)
        return snow_fail(image->context, SNOW_BAD_USAGE,
                         "%s: %s holds colours, not values in data units; "
                         "write .npy, .exr, .tif or .pfm, or paint them first",
                         path, format->name);
    SNOW_TRY(check_options(image->context, path, image->width, image->height,
                           format, options));
    snow_writer *writer = NULL;
    SNOW_TRY(
        snow_writer_open(image->context, path, options->overwrite, &writer));
    snow_status status = format->write(image, options, writer);
    if (status != SNOW_OK) {
        snow_writer_abandon(writer);
        return name_file(image->context, status, path);
    }
    return snow_writer_commit(writer);
}

/* A writer knows best what it can write: one is begun and given up.  Standard
 * output would be written to, and is always there. */
snow_status snow_image_check_path(snow_context *context, const char *path,
                                  bool overwrite) {
    const snow_image_format *format = NULL;
    SNOW_TRY(choose_format(context, path, &format));
    if (strcmp(path, "-") == 0)
        return SNOW_OK;
    snow_writer *writer = NULL;
    SNOW_TRY(snow_writer_open(context, path, overwrite, &writer));
    snow_writer_abandon(writer);
    return SNOW_OK;
}

snow_status snow_image_check(snow_context *context, const char *path, int width,
                             int height, const snow_image_options *options) {
    const snow_image_format *format = NULL;
    if (!options)
        options = &standard;
    SNOW_TRY(choose_format(context, path, &format));
    SNOW_TRY(check_options(context, path, width, height, format, options));
    return snow_image_check_path(context, path, options->overwrite);
}

/* The format that an open source shows itself to be of. */
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
                   ? snow_fail(snow_source_context(source), SNOW_BAD_INPUT,
                               "%s: this build reads no %s; install %s and "
                               "build again",
                               snow_source_name(source), formats[i]->name,
                               formats[i]->package)
                   : SNOW_OK;
    }
    return snow_fail(snow_source_context(source), SNOW_BAD_INPUT, "%s: %s",
                     snow_source_name(source),
                     got ? "is no picture of a known format; give a PNG, "
                           "WebP, NPY, EXR, TIFF or PFM file"
                         : "is empty; give a PNG, WebP, NPY, EXR, TIFF or PFM "
                           "file");
}

/* Reads the picture that an open source holds, to its end: a gzip stream is
 * right only when its trailer is, which comes after the last pixel. */
static snow_status read_picture(snow_source *source, snow_image **out) {
    const snow_image_format *format = NULL;
    SNOW_TRY(probe_source(source, &format));
    snow_image *image = NULL;
    snow_status status = format->read(source, &image);
    if (status != SNOW_OK)
        return name_file(snow_source_context(source), status,
                         snow_source_name(source));
    if (!format->in_any_order)
        status = snow_source_finish(source);
    if (status != SNOW_OK) {
        snow_image_free(image);
        return status;
    }
    *out = image;
    return SNOW_OK;
}

snow_status snow_image_load(snow_context *context, const char *path,
                            snow_image **out) {
    snow_source *source = NULL;
    SNOW_TRY(snow_source_open(context, path, &source));
    snow_status status = read_picture(source, out);
    snow_source_close(source);
    return status;
}

/* The fuzzers' door: no file is touched. */
snow_status snow_image_load_memory(snow_context *context, const char *name,
                                   const void *bytes, size_t size,
                                   snow_image **out) {
    snow_source *source = NULL;
    SNOW_TRY(snow_source_open_memory(context, name, bytes, size, &source));
    snow_status status = read_picture(source, out);
    snow_source_close(source);
    return status;
}
