/* image/pfm.c - portable float maps.
 *
 * Follows Paul Debevec's description (pauldebevec.com/Research/HDR/PFM):
 *
 *   PF            colour (Pf: grey)
 *   640 480       width, height
 *   -1.0          the scale; negative: little-endian
 *   rows of floats, the lowest row first, no padding
 *
 * Writes colour maps of the premultiplied pixels without alpha, and values in
 * data units as grey.  Reads both kinds and both byte orders. */
#include "image/image.h"

#include <stdio.h>
#include <string.h>

/* The format has no alpha: the file holds the picture on black. */
static snow_status write_pfm(const snow_image *image,
                             const snow_image_options *options,
                             snow_writer *writer) {
    (void)options;
    char header[64];
    bool values = image->channels == 1;
    int length = snprintf(header, sizeof header, "%s\n%d %d\n-1.0\n",
                          values ? "Pf" : "PF", image->width, image->height);
    SNOW_TRY(snow_writer_write(writer, header, (size_t)length));
    return snow_image_write_floats(image, values ? 1 : 3, true, writer);
}

static bool is_blank(unsigned char c) {
    return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

static bool probe_pfm(const unsigned char *bytes, size_t size) {
    return size >= 3 && bytes[0] == 'P' &&
           (bytes[1] == 'F' || bytes[1] == 'f') && is_blank(bytes[2]);
}

static snow_status refuse_header(snow_source *source) {
    return snow_fail(snow_source_context(source), SNOW_STATUS_BAD_INPUT,
                     "%s: the PFM header is damaged; it needs PF or Pf, width, "
                     "height and a scale that is not 0",
                     snow_source_name(source));
}

/* Reads one word of the header and the single blank that ends it: the pixels
 * begin directly after the last word. */
static snow_status read_word(snow_source *source, char *word, size_t size) {
    size_t length = 0;
    while (length < size) {
        unsigned char c;
        size_t got;
        SNOW_TRY(snow_source_read(source, &c, 1, &got));
        if (got == 0)
            break;
        if (!is_blank(c)) {
            word[length++] = (char)c;
        } else if (length > 0) {
            word[length] = '\0';
            return SNOW_STATUS_OK;
        }
    }
    return refuse_header(source);
}

/* Reads the header up to the first pixel.  The scale's sign is the byte order.
 * Its size relates samples to watts per square metre and steradian; readers
 * usually ignore it. */
static snow_status read_header(snow_source *source, int64_t *width,
                               int64_t *height, snow_float_layout *layout) {
    char kind[4], word[3][32];
    SNOW_TRY(read_word(source, kind, sizeof kind));
    for (int i = 0; i < 3; i++)
        SNOW_TRY(read_word(source, word[i], sizeof word[i]));
    double scale;
    if (!snow_parse_int64(word[0], width) ||
        !snow_parse_int64(word[1], height) ||
        !snow_parse_double(word[2], &scale) || !(scale < 0 || scale > 0))
        return refuse_header(source);
    if (scale != 1 && scale != -1)
        snow_notify(snow_source_context(source),
                    "%s: the scale %g of the PFM header is ignored",
                    snow_source_name(source), scale);
    *layout = (snow_float_layout){.channels = strcmp(kind, "PF") ? 1 : 3,
                                  .sample_bytes = 4,
                                  .big_endian = scale > 0,
                                  .bottom_up = true};
    return SNOW_STATUS_OK;
}

static snow_status read_pfm(snow_source *source, snow_image **out) {
    int64_t width, height;
    snow_float_layout layout;
    SNOW_TRY(read_header(source, &width, &height, &layout));
    SNOW_TRY(snow_image_read_floats(source, width, height, &layout, out));
    (*out)->alpha_unknown = true;
    return SNOW_STATUS_OK;
}

const snow_image_format snow_image_pfm = {
    .name = "PFM",
    .suffix = ".pfm",
    .write = write_pfm,
    .probe = probe_pfm,
    .read = read_pfm,
};
