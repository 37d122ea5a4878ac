/* image/image.h - the private record of a picture, and the picture formats. */
#ifndef SNOW_IMAGE_H
#define SNOW_IMAGE_H

#include "io/source.h"
#include "io/writer.h"

#include <snowglass/image.h>

/* The longest side of a picture, in pixels. */
#define SNOW_IMAGE_SIDE 32768

struct snow_image {
    snow_context *context;
    int width, height, channels;
    bool alpha_unknown;    /* its file had none, but the picture may have had */
    float *pixels;         /* [(y * width + x) * channels] */
    bool dressed;          /* files of levels show, without other options: */
    double ground[3];      /* the background */
    snow_overlay *letters; /* and what is drawn over it; NULL: nothing */
};

/* Dresses a picture, which takes the letters over. */
void snow_image_dress(snow_image *image, const double ground[3],
                      snow_overlay *letters);

/* Does what snow_image_new does, but the pixels are undefined. For readers,
 * which fill them: a false size in a file then costs only address space. */
snow_status snow_image_make(snow_context *context, int width, int height,
                            int channels, snow_image **out);

/* For writers, before each line: how far the file is. Errors:
 * SNOW_STATUS_STOPPED. */
snow_status snow_image_report(const snow_image *image, int line);

/* Pixel `index` (y * width + x) as red, green, blue, alpha.  Grey pixels and
 * values give r = g = b; values have alpha 1. */
static inline void snow_image_rgba(const snow_image *image, size_t index,
                                   float rgba[4]) {
    const float *pixel = image->pixels + index * (size_t)image->channels;
    bool grey = image->channels <= 2;
    rgba[0] = pixel[0];
    rgba[1] = pixel[grey ? 0 : 1];
    rgba[2] = pixel[grey ? 0 : 2];
    rgba[3] = image->channels == 1 ? 1 : pixel[grey ? 1 : 3];
}

/* --- formats -------------------------------------------------------------- */

/* The functions of a file format.  A new format is a file that defines its
 * record, and a line in the table of formats.c. */
typedef struct snow_image_format {
    const char *name;    /* for messages: "PNG" */
    const char *suffix;  /* suffix of the files it writes: ".png" */
    const char *other;   /* another suffix, or NULL */
    const char *package; /* the Debian package that this build lacks: then write
                            and read are missing; NULL: none */
    const char *module;  /* base/module.h: loaded to read and write, and may be
                            missing; NULL: none */
    bool in_any_order;   /* reads the source with io/seekable.h */
    bool takes_depth;    /* with the picture (snow_image_options) */
    int most_side;       /* pixels; 0: SNOW_IMAGE_SIDE */
    int bits; /* the most per channel, for integers; 0: floats, without
                 background and overlay */

    /* Writes the picture.  The caller opened the writer, and commits it. */
    snow_status (*write)(const snow_image *image,
                         const snow_image_options *options,
                         snow_writer *writer);

    /* Whether a file that begins with these bytes has this format. */
    bool (*probe)(const unsigned char *bytes, size_t size);

    /* Reads a picture of four channels, from the source's first byte on. */
    snow_status (*read)(snow_source *source, snow_image **out);
} snow_image_format;

extern const snow_image_format snow_image_png, snow_image_npy, snow_image_pfm,
    snow_image_exr, snow_image_tiff, snow_image_webp, snow_image_jpeg;

/* Rows of a picture as files of 8 and 16 bits hold them: with the overlay,
 * placed on the background or with straight alpha, rounded. */
typedef struct snow_levels {
    const snow_image *image;
    const snow_overlay *overlay; /* NULL: none */
    const double *background;    /* NULL: with alpha */
    int bits;                    /* 8 or 16 */
    int samples;  /* per pixel: 1 grey, 2 grey and alpha, 3 or 4 colour */
    int channels; /* per pixel before that: 2 or 4 */
    float *drawn;
    double *row;          /* of some pixels */
    unsigned char *bytes; /* of the last row */
} snow_levels;

/* Begins with a picture.  It stays grey if nothing in it has a colour, unless
 * `colored`.  snow_levels_end must follow, even after a failure. */
snow_status snow_levels_begin(const snow_image *image,
                              const snow_image_options *options, bool colored,
                              snow_levels *out);
void snow_levels_end(snow_levels *levels);

/* Makes row y: width * samples samples; those of 16 bits have the high byte
 * first. */
const unsigned char *snow_levels_row(snow_levels *levels, int y);

/* Pixels from (x, y) on in 2 or 4 channels, with the shapes over them; 2 of a
 * grey picture without coloured shapes. */
void snow_image_draw_some(const snow_image *image, const snow_overlay *overlay,
                          const double *background, int y, int x, int count,
                          int channels, float *out);

/* Refuses, for a reader, sides outside 1 to SNOW_IMAGE_SIDE. */
snow_status snow_image_check_sides(const snow_source *source, int64_t width,
                                   int64_t height);

/* The layout of plain floats in a file. */
typedef struct snow_float_layout {
    int channels;     /* 1 grey, 2 grey and alpha, 3 colour, 4 with alpha */
    int sample_bytes; /* 4 or 8 */
    bool big_endian;
    bool bottom_up; /* the file's first row is the picture's last */
} snow_float_layout;

/* Reads `width` x `height` pixels at the source's position; alpha is 1 if the
 * file has none. */
snow_status snow_image_read_floats(snow_source *source, int64_t width,
                                   int64_t height,
                                   const snow_float_layout *layout,
                                   snow_image **out);

/* Appends all pixels as little-endian 32-bit floats, 3 or 4 per pixel, or 1 for
 * values. */
snow_status snow_image_write_floats(const snow_image *image, int channels,
                                    bool bottom_up, snow_writer *writer);

#endif
