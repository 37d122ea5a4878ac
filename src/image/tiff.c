/* image/tiff.c - TIFF pictures of floats, by libtiff.
 *
 * Writes 32-bit floats, red, green, blue and associated (premultiplied) alpha,
 * in strips compressed by Deflate.  Reads 8 and 16 bits or floats, 1 to 4
 * interleaved samples per pixel, in strips; straight alpha is multiplied in. */
#include "image/image.h"

#include "base/module.h"
#include "io/tiff.h"

#if SNOW_HAVE_TIFF && !SNOW_LOADS

/* Approximate bytes of a strip before compression. */
#define STRIP_BYTES 65536

/* --- writing -------------------------------------------------------------- */

static bool set_tags(TIFF *tiff, const snow_image *image, int strip) {
    uint16_t extra = EXTRASAMPLE_ASSOCALPHA;
    bool values = image->channels == 1;
    bool good =
        TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, image->width) &&
        TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, image->height) &&
        TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 32) &&
        TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_IEEEFP) &&
        TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, values ? 1 : 4) &&
        (values || TIFFSetField(tiff, TIFFTAG_EXTRASAMPLES, 1, &extra)) &&
        TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC,
                     values ? PHOTOMETRIC_MINISBLACK : PHOTOMETRIC_RGB) &&
        TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG) &&
        TIFFSetField(tiff, TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT) &&
        TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, strip);
    if (good && TIFFIsCODECConfigured(COMPRESSION_ADOBE_DEFLATE))
        good = TIFFSetField(tiff, TIFFTAG_COMPRESSION,
                            COMPRESSION_ADOBE_DEFLATE) &&
               TIFFSetField(tiff, TIFFTAG_ZIPQUALITY, 1);
    return good;
}

static snow_status fail_writing(const snow_tiff *file) {
    if (file->status != SNOW_STATUS_OK)
        return file->status;
    return snow_fail(
        file->context, SNOW_STATUS_FAILED,
        "the TIFF file cannot be written (libtiff: %s); write a .npy instead",
        *file->complaint ? file->complaint : "out of memory");
}

static snow_status fill_file(snow_tiff *file, const snow_image *image) {
    int samples = image->channels == 1 ? 1 : 4,
        row = 4 * samples * image->width;
    int strip = STRIP_BYTES / row < 1 ? 1 : STRIP_BYTES / row;
    if (!set_tags(file->tiff, image, strip))
        return fail_writing(file);
    float *line =
        snow_allocate_array(file->context, (uint64_t)image->width, 16);
    if (!line)
        return SNOW_STATUS_NO_MEMORY;
    bool good = true;
    for (int y = 0; y < image->height && good; y++) {
        size_t first = (size_t)y * (size_t)image->width;
        for (int x = 0; x < image->width; x++) {
            float rgba[4];
            snow_image_rgba(image, first + (size_t)x, rgba);
            memcpy(line + samples * x, rgba, (size_t)samples * sizeof *line);
        }
        file->status = snow_image_report(image, y);
        good = file->status == SNOW_STATUS_OK &&
               TIFFWriteScanline(file->tiff, line, (uint32_t)y, 0) == 1;
    }
    snow_release(file->context, line);
    good = good && TIFFWriteDirectory(file->tiff) == 1 &&
           file->status == SNOW_STATUS_OK;
    return good ? SNOW_STATUS_OK : fail_writing(file);
}

static snow_status write_tiff(const snow_image *image,
                              const snow_image_options *options,
                              snow_writer *writer) {
    snow_tiff file;
    (void)options;
    snow_status status = snow_tiff_create(image->context, &file);
    if (status == SNOW_STATUS_OK)
        status = fill_file(&file, image);
    snow_tiff_end(&file);
    if (status == SNOW_STATUS_OK)
        status = snow_writer_write(writer, file.store.bytes, file.store.size);
    snow_tiff_close(&file);
    return status;
}

/* --- reading -------------------------------------------------------------- */

typedef struct tiff_plan {
    uint32_t width, height;
    uint16_t samples, bits, format;
    bool straight; /* alpha is to be multiplied in */
} tiff_plan;

static snow_status fail_tiff(const snow_tiff *file, const snow_source *source) {
    return snow_fail_within(file->context, snow_tiff_fail(file), "%s",
                            snow_source_name(source));
}

static bool is_known(TIFF *tiff, const tiff_plan *plan) {
    uint16_t planes = 0, photometric = 0;
    TIFFGetFieldDefaulted(tiff, TIFFTAG_PLANARCONFIG, &planes);
    TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &photometric);
    bool levels = plan->format == SAMPLEFORMAT_UINT &&
                  (plan->bits == 8 || plan->bits == 16);
    bool floats = plan->format == SAMPLEFORMAT_IEEEFP &&
                  (plan->bits == 32 || plan->bits == 64);
    bool colors = photometric == PHOTOMETRIC_RGB && plan->samples >= 3;
    bool greys = photometric == PHOTOMETRIC_MINISBLACK && plan->samples <= 2;
    return (levels || floats) && (colors || greys) && plan->samples <= 4 &&
           planes == PLANARCONFIG_CONTIG && !TIFFIsTiled(tiff);
}

static snow_status read_header(const snow_tiff *file, const snow_source *source,
                               tiff_plan *plan) {
    TIFF *tiff = file->tiff;
    uint16_t count = 0;
    const uint16_t *extra = NULL;
    *plan = (tiff_plan){.width = 0};
    TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &plan->width);
    TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &plan->height);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLESPERPIXEL, &plan->samples);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_BITSPERSAMPLE, &plan->bits);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLEFORMAT, &plan->format);
    if (TIFFGetField(tiff, TIFFTAG_EXTRASAMPLES, &count, &extra) && count)
        plan->straight = extra[0] == EXTRASAMPLE_UNASSALPHA;
    SNOW_TRY(snow_image_check_sides(source, plan->width, plan->height));
    if (!is_known(tiff, plan))
        return snow_fail(
            file->context, SNOW_STATUS_BAD_INPUT,
            "%s: is a TIFF of %u samples of %u bits; give one of 1 to 4 "
            "interleaved samples, of 8 or 16 bits or floats, in strips",
            snow_source_name(source), plan->samples, plan->bits);
    if ((uint64_t)plan->width * plan->height / SNOW_DEFLATE_RATIO >
        snow_seekable_size(file->bytes))
        return fail_tiff(file, source);
    return SNOW_STATUS_OK;
}

/* Samples are in the machine's byte order. */
static double sample_at(const tiff_plan *plan, const unsigned char *line,
                        size_t index) {
    uint16_t level;
    float single;
    double value;
    switch (plan->bits) {
    case 8:
        return line[index] / 255.0;
    case 16:
        memcpy(&level, line + 2 * index, sizeof level);
        return level / 65535.0;
    case 32:
        memcpy(&single, line + 4 * index, sizeof single);
        return (double)single;
    default:
        memcpy(&value, line + 8 * index, sizeof value);
        return value;
    }
}

static void widen_line(const tiff_plan *plan, const unsigned char *line,
                       float *out) {
    int colors = plan->samples < 3 ? 1 : 3;
    bool alpha = plan->samples > colors;
    for (size_t x = 0; x < plan->width; x++, out += 4) {
        size_t first = x * plan->samples;
        double a = alpha ? sample_at(plan, line, first + (size_t)colors) : 1;
        for (int c = 0; c < 3; c++) {
            size_t at = first + (size_t)(colors == 1 ? 0 : c);
            double value = sample_at(plan, line, at);
            out[c] = (float)(plan->straight ? value * a : value);
        }
        out[3] = (float)a;
    }
}

static snow_status read_strips(snow_tiff *file, const tiff_plan *plan,
                               uint32_t rows, unsigned char *strip,
                               snow_image *image) {
    const uint64_t bytes = (uint64_t)TIFFScanlineSize64(file->tiff);
    for (uint32_t y = 0; y < plan->height; y++) {
        const uint32_t left = plan->height - y;
        if (y % rows == 0)
            SNOW_TRY(snow_tiff_decode(
                file, TIFFComputeStrip(file->tiff, y, 0), strip,
                bytes * (left < rows ? left : rows), bytes));
        widen_line(plan, strip + bytes * (y % rows),
                   image->pixels + 4 * (size_t)y * plan->width);
    }
    return SNOW_STATUS_OK;
}

static snow_status read_lines(snow_tiff *file, const snow_source *source,
                              const tiff_plan *plan, snow_image *image) {
    const uint64_t bytes = (uint64_t)TIFFScanlineSize64(file->tiff);
    uint32_t rows = 0;
    TIFFGetFieldDefaulted(file->tiff, TIFFTAG_ROWSPERSTRIP, &rows);
    rows = rows && rows < plan->height ? rows : plan->height;
    if (bytes != (uint64_t)plan->width * plan->samples * plan->bits / 8)
        return fail_tiff(file, source);
    unsigned char *strip = snow_allocate_array(file->context, bytes * rows, 1);
    if (!strip)
        return SNOW_STATUS_NO_MEMORY;
    snow_status status = read_strips(file, plan, rows, strip, image);
    snow_release(file->context, strip);
    return status == SNOW_STATUS_OK
               ? status
               : snow_fail_within(file->context, status, "%s",
                                  snow_source_name(source));
}

static snow_status read_page(snow_tiff *file, const snow_source *source,
                             snow_image **out) {
    tiff_plan plan;
    snow_image *image = NULL;
    SNOW_TRY(read_header(file, source, &plan));
    SNOW_TRY(snow_image_make(file->context, (int)plan.width, (int)plan.height,
                             4, &image));
    snow_status status = read_lines(file, source, &plan, image);
    if (status == SNOW_STATUS_OK)
        *out = image;
    else
        snow_image_free(image);
    return status;
}

static snow_status read_tiff(snow_source *source, snow_image **out) {
    snow_tiff file;
    snow_status status = snow_tiff_open(source, &file);
    if (status == SNOW_STATUS_OK)
        status = read_page(&file, source, out);
    else
        snow_fail_within(file.context, status, "%s", snow_source_name(source));
    snow_tiff_close(&file);
    return status;
}

const snow_image_format snow_image_tiff = {.name = "TIFF",
                                           .suffix = ".tif",
                                           .other = ".tiff",
                                           .write = write_tiff,
                                           .probe = snow_tiff_probe,
                                           .read = read_tiff,
                                           .in_any_order = true};

#elif SNOW_LOADS && SNOW_HAVE_TIFF

static snow_status write_tiff(const snow_image *image,
                              const snow_image_options *options,
                              snow_writer *writer) {
    const snow_module *module;
    SNOW_TRY(snow_module_load(image->context, "tiff", &module));
    return module->picture->write(image, options, writer);
}

static snow_status read_tiff(snow_source *source, snow_image **out) {
    const snow_module *module;
    SNOW_TRY(snow_module_load(snow_source_context(source), "tiff", &module));
    return module->picture->read(source, out);
}

const snow_image_format snow_image_tiff = {.name = "TIFF",
                                           .suffix = ".tif",
                                           .other = ".tiff",
                                           .module = "tiff",
                                           .write = write_tiff,
                                           .probe = snow_tiff_probe,
                                           .read = read_tiff,
                                           .in_any_order = true};

#else

const snow_image_format snow_image_tiff = {.name = "TIFF",
                                           .suffix = ".tif",
                                           .other = ".tiff",
                                           .package = "libtiff-dev",
                                           .probe = snow_tiff_probe};

#endif
