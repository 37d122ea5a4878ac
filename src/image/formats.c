/* image/formats.c - the table of picture formats, and saving and loading.
 *
 * A file is written in the format that its name asks for, and read in the one
 * that its first bytes show.  Nothing here knows what is inside a format. */
#include "image/image.h"
#include "image/overlay.h"

#include <string.h>

/* The first is what standard output gets. */
static const snow_image_format *const formats[] = {
    &snow_image_png,
    &snow_image_npy,
    &snow_image_pfm,
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
        if (snow_has_suffix(path, formats[i]->suffix))
            return formats[i];
    return NULL;
}

int snow_image_bits(const char *path) {
    const snow_image_format *format = format_of(path);
    return format ? format->bits : -1;
}

static snow_status choose_format(snow_context *context, const char *path,
                                 const snow_image_format **out) {
    const snow_image_format *format = format_of(path);
    if (format) {
        *out = format;
        return SNOW_OK;
    }
    return snow_fail(context, SNOW_BAD_USAGE,
                     "%s: the name does not tell a picture format; let it end "
                     "with .png, .npy or .pfm",
                     path);
}

/* Refuses what a format cannot heed, rather than to ignore it. */
static snow_status check_options(const snow_image *image, const char *path,
                                 const snow_image_format *format,
                                 const snow_image_options *options) {
    snow_context *context = image->context;
    if (format->bits && image->channels == 1)
        return snow_fail(context, SNOW_BAD_USAGE,
                         "%s: %s holds colours, not values in data units; "
                         "write .npy or .pfm, or paint them first",
                         path, format->name);
    if (!format->bits && (options->flatten || options->bits))
        return snow_fail(context, SNOW_BAD_USAGE,
                         "%s: %s takes neither a background nor a number of "
                         "bits; leave them out, or write a .png",
                         path, format->name);
    if (options->bits != 0 && options->bits != 8 && options->bits != 16)
        return snow_fail(context, SNOW_BAD_USAGE,
                         "%s: %d bits a channel are not possible; take 8 or "
                         "16",
                         path, options->bits);
    const snow_overlay *overlay = options->overlay;
    if (overlay && !format->bits)
        return snow_fail(context, SNOW_BAD_USAGE,
                         "%s: %s takes no overlay; leave it out, or write a "
                         ".png",
                         path, format->name);
    if (overlay &&
        (overlay->width != image->width || overlay->height != image->height))
        return snow_fail(context, SNOW_BAD_USAGE,
                         "%s: the overlay is of %d x %d pixels, the picture of "
                         "%d x %d; make one for it",
                         path, overlay->width, overlay->height, image->width,
                         image->height);
    for (int i = 0; options->flatten && i < 3; i++)
        if (!(options->background[i] >= 0 && options->background[i] <= 1))
            return snow_fail(context, SNOW_BAD_USAGE,
                             "%s: the background has a channel of %g; take 0 "
                             "to 1",
                             path, options->background[i]);
    return SNOW_OK;
}

/* Puts the file's name before messages of layers that know none. */
static snow_status name_file(snow_context *context, snow_status status,
                             const char *name) {
    if (status == SNOW_NO_MEMORY || status == SNOW_FAILED)
        return snow_fail_within(context, status, "%s", name);
    return status;
}

/* Refusals come first, before there is a file; then the writer sees to it that
 * there is a whole one or none. */
snow_status snow_image_save(const snow_image *image, const char *path,
                            const snow_image_options *options) {
    static const snow_image_options standard = {0};
    if (!options)
        options = &standard;
    const snow_image_format *format = NULL;
    SNOW_TRY(choose_format(image->context, path, &format));
    SNOW_TRY(check_options(image, path, format, options));
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

snow_status snow_image_check_sides(const snow_source *source, int64_t width,
                                   int64_t height) {
    if (width >= 1 && height >= 1 && width <= SNOW_IMAGE_SIDE &&
        height <= SNOW_IMAGE_SIDE)
        return SNOW_OK;
    return snow_fail(snow_source_context(source), SNOW_BAD_INPUT,
                     "%s: a picture of %lld x %lld pixels is not read; it may "
                     "have 1 to %d a side",
                     snow_source_name(source), (long long)width,
                     (long long)height, SNOW_IMAGE_SIDE);
}

/* The format that an open source shows itself to be of. */
static snow_status probe_source(snow_source *source,
                                const snow_image_format **out) {
    unsigned char start[PROBE_BYTES];
    size_t got = 0;
    SNOW_TRY(snow_source_peek(source, start, sizeof start, &got));
    for (size_t i = 0; i < FORMAT_COUNT; i++)
        if (formats[i]->probe(start, got)) {
            *out = formats[i];
            return SNOW_OK;
        }
    return snow_fail(snow_source_context(source), SNOW_BAD_INPUT, "%s: %s",
                     snow_source_name(source),
                     got ? "is no picture of a known format; give a PNG, NPY "
                           "or PFM file"
                         : "is empty; give a PNG, NPY or PFM file");
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
