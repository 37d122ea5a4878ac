/* image/floats.c - reads and writes rows of plain floats, for PFM and NPY.
 *
 * One row at a time passes through a buffer, so that reading needs little more
 * memory than the picture.  Byte orders are explicit, never the machine's. */
#include "image/image.h"

#include <string.h>

/* Decodes an IEEE 754 float of `size` (4 or 8) bytes.  A double beyond float's
 * range becomes infinite. */
static float decode_sample(const unsigned char *bytes, int size,
                           bool big_endian) {
    uint64_t bits = 0;
    for (int i = 0; i < size; i++)
        bits = bits << 8 | bytes[big_endian ? i : size - 1 - i];
    if (size == 8) {
        double wide;
        memcpy(&wide, &bits, sizeof wide);
        return (float)wide;
    }
    uint32_t low = (uint32_t)bits;
    float sample;
    memcpy(&sample, &low, sizeof sample);
    return sample;
}

/* Converts a row of the file to `width` pixels of four floats. */
static void decode_row(const unsigned char *bytes, int width,
                       const snow_float_layout *layout, float *row) {
    for (int x = 0; x < width; x++) {
        float samples[4];
        for (int c = 0; c < layout->channels; c++) {
            samples[c] =
                decode_sample(bytes, layout->sample_bytes, layout->big_endian);
            bytes += layout->sample_bytes;
        }
        /* Expands the samples of a pixel in the file to red, green, blue and
         * alpha:
         *
         *   g        -> g g g 1        r g b    -> r g b 1
         *   g a      -> g g g a        r g b a  -> r g b a */
        float *pixel = row + 4 * (size_t)x;
        bool grey = layout->channels < 3;
        pixel[0] = samples[0];
        pixel[1] = samples[grey ? 0 : 1];
        pixel[2] = samples[grey ? 0 : 2];
        pixel[3] =
            layout->channels % 2 == 0 ? samples[layout->channels - 1] : 1;
    }
}

/* Fills the picture from the source, through a buffer of one row. */
static snow_status read_rows(snow_source *source,
                             const snow_float_layout *layout,
                             snow_image *image) {
    size_t row_bytes = (size_t)image->width * (size_t)layout->channels *
                       (size_t)layout->sample_bytes;
    unsigned char *bytes = snow_allocate(image->context, row_bytes);
    if (!bytes)
        return SNOW_STATUS_NO_MEMORY;
    snow_status status = SNOW_STATUS_OK;
    for (int i = 0; i < image->height && status == SNOW_STATUS_OK; i++) {
        status = snow_source_read_all(source, bytes, row_bytes, "the pixels");
        int y = layout->bottom_up ? image->height - 1 - i : i;
        if (status == SNOW_STATUS_OK)
            decode_row(bytes, image->width, layout,
                       image->pixels + (size_t)y * (size_t)image->width * 4);
    }
    snow_release(image->context, bytes);
    return status;
}

/* The order matters: the sides bound the product, the product is compared with
 * the bytes in the file, and only then memory is allocated. */
snow_status snow_image_read_floats(snow_source *source, int64_t width,
                                   int64_t height,
                                   const snow_float_layout *layout,
                                   snow_image **out) {
    SNOW_TRY(snow_image_check_sides(source, width, height));
    SNOW_TRY(snow_source_expect(source,
                                (uint64_t)width * (uint64_t)height *
                                    (uint64_t)layout->channels *
                                    (uint64_t)layout->sample_bytes,
                                "the pixels"));
    snow_image *image = NULL;
    SNOW_TRY(snow_image_make(snow_source_context(source), (int)width,
                             (int)height, 4, &image));
    snow_status status = read_rows(source, layout, image);
    if (status != SNOW_STATUS_OK) {
        snow_image_free(image);
        return status;
    }
    *out = image;
    return SNOW_STATUS_OK;
}

/* Writes row y into `bytes`; with 3 channels alpha is omitted. */
static void encode_row(const snow_image *image, int y, int channels,
                       unsigned char *bytes) {
    size_t first = (size_t)y * (size_t)image->width;
    for (size_t i = first; i < first + (size_t)image->width; i++) {
        float rgba[4];
        snow_image_rgba(image, i, rgba);
        for (int c = 0; c < channels; c++) {
            uint32_t bits;
            memcpy(&bits, &rgba[c], sizeof bits);
            for (int shift = 0; shift < 32; shift += 8)
                *bytes++ = (unsigned char)(bits >> shift & 255);
        }
    }
}

snow_status snow_image_write_floats(const snow_image *image, int channels,
                                    bool bottom_up, snow_writer *writer) {
    size_t row_bytes = (size_t)image->width * (size_t)channels * sizeof(float);
    unsigned char *bytes = snow_allocate(image->context, row_bytes);
    if (!bytes)
        return SNOW_STATUS_NO_MEMORY;
    snow_status status = SNOW_STATUS_OK;
    for (int i = 0; i < image->height && status == SNOW_STATUS_OK; i++) {
        int y = bottom_up ? image->height - 1 - i : i;
        encode_row(image, y, channels, bytes);
        status = snow_writer_write(writer, bytes, row_bytes);
        if (status == SNOW_STATUS_OK)
            status = snow_image_report(image, i);
    }
    snow_release(image->context, bytes);
    return status;
}
