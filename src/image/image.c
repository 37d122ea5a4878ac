/* image/image.c - pictures in memory, and their checksum.
 *
 * A picture is one block of floats, premultiplied and linear, filled by
 * compositing (section 4.2 of the paper: the sheets end up here).  The checksum
 * is 64-bit FNV-1a (Fowler, Noll, Vo; RFC 9923), computed from a form that does
 * not depend on the machine. */
#include "image/image.h"

#include "base/monitor.h"

#include <snowglass/overlay.h>

#include <string.h>

SNOW_RECORD_OF_ZEROS(snow_image_options);
SNOW_RECORD_OF_ZEROS(snow_image_difference);

snow_status snow_image_make(snow_context *context, int width, int height,
                            int channels, snow_image **out) {
    if (width < 1 || height < 1 || width > SNOW_IMAGE_SIDE ||
        height > SNOW_IMAGE_SIDE)
        return snow_fail(
            context, SNOW_STATUS_BAD_USAGE,
            "a picture of %d x %d pixels is not possible; use 1 to %d per side",
            width, height, SNOW_IMAGE_SIDE);
    if (channels != 1 && channels != 2 && channels != 4)
        return snow_fail(
            context, SNOW_STATUS_BAD_USAGE,
            "a picture of %d channels is not possible; use 1 (values), 2 "
            "(grey, alpha) or 4 (red, green, blue, alpha)",
            channels);
    snow_image *image = snow_allocate(context, sizeof *image);
    if (!image)
        return SNOW_STATUS_NO_MEMORY;
    uint64_t samples = (uint64_t)width * (uint64_t)height * (uint64_t)channels;
    *image = (snow_image){.context = context,
                          .width = width,
                          .height = height,
                          .channels = channels};
    image->pixels = snow_allocate_array(context, samples, sizeof(float));
    if (!image->pixels) {
        snow_release(context, image);
        return SNOW_STATUS_NO_MEMORY;
    }
    *out = image;
    return SNOW_STATUS_OK;
}

/* Number of floats; snow_image_make has checked that their bytes do not
 * overflow. */
static size_t count_samples(const snow_image *image) {
    return (size_t)image->width * (size_t)image->height *
           (size_t)image->channels;
}

snow_status snow_image_new(snow_context *context, int width, int height,
                           int channels, snow_image **out) {
    snow_image *image = NULL;
    SNOW_TRY(snow_image_make(context, width, height, channels, &image));
    memset(image->pixels, 0, count_samples(image) * sizeof(float));
    *out = image;
    return SNOW_STATUS_OK;
}

snow_status snow_image_report(const snow_image *image, int line) {
    snow_monitor *monitor = image->context->monitor;
    snow_monitor_report(monitor, SNOW_STAGE_WRITE, line, image->height);
    return snow_monitor_status(monitor);
}

void snow_image_dress(snow_image *image, const double ground[3],
                      snow_overlay *letters) {
    image->dressed = true;
    memcpy(image->ground, ground, sizeof image->ground);
    image->letters = letters;
}

void snow_image_free(snow_image *image) {
    if (!image)
        return;
    snow_context *context = image->context;
    snow_overlay_free(image->letters);
    snow_release(context, image->pixels);
    snow_release(context, image);
}

int snow_image_width(const snow_image *image) {
    return image->width;
}

int snow_image_height(const snow_image *image) {
    return image->height;
}

int snow_image_channels(const snow_image *image) {
    return image->channels;
}

float *snow_image_pixels(snow_image *image) {
    return image->pixels;
}

const float *snow_image_data(const snow_image *image) {
    return image->pixels;
}

/* Adds the four bytes of a number, lowest first, to an FNV-1a hash. */
static uint64_t hash_number(uint64_t hash, uint32_t number) {
    for (int shift = 0; shift < 32; shift += 8) {
        hash ^= number >> shift & 255;
        hash *= UINT64_C(0x100000001b3);
    }
    return hash;
}

/* The bits of a sample in canonical form: sums are equal if snow_image_compare
 * finds no difference. */
static uint32_t canonical_bits(float sample) {
    if (sample == 0)
        return 0;
    if (sample != sample)
        return 0x7fc00000; /* the quiet NaN without a payload */
    uint32_t bits;
    memcpy(&bits, &sample, sizeof bits);
    return bits;
}

/* Byte by byte, as FNV-1a is defined: anybody can compute it from a .npy file
 * and its shape. */
uint64_t snow_image_checksum(const snow_image *image) {
    uint64_t hash = UINT64_C(0xcbf29ce484222325);
    hash = hash_number(hash, (uint32_t)image->width);
    hash = hash_number(hash, (uint32_t)image->height);
    hash = hash_number(hash, (uint32_t)image->channels);
    size_t samples = count_samples(image);
    for (size_t i = 0; i < samples; i++)
        hash = hash_number(hash, canonical_bits(image->pixels[i]));
    return hash;
}

snow_status snow_image_check_sides(const snow_source *source, int64_t width,
                                   int64_t height) {
    if (width >= 1 && height >= 1 && width <= SNOW_IMAGE_SIDE &&
        height <= SNOW_IMAGE_SIDE)
        return SNOW_STATUS_OK;
    return snow_fail(snow_source_context(source), SNOW_STATUS_BAD_INPUT,
                     "%s: a picture of %lld x %lld pixels cannot be read; 1 to "
                     "%d per side are possible",
                     snow_source_name(source), (long long)width,
                     (long long)height, SNOW_IMAGE_SIDE);
}
