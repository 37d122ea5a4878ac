/* snowglass/image.h - the picture: float pixels, premultiplied, linear.
 *
 * Row 0 is the top.  Grey pictures have two channels (grey, alpha), colour
 * pictures four (red, green, blue, alpha).  One channel is no picture yet but
 * an array of values in data units (modes mean and sum, depths), NaN where
 * there is none. */
#ifndef SNOWGLASS_IMAGE_H
#define SNOWGLASS_IMAGE_H

#include <snowglass/context.h>
#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct snow_image snow_image;
typedef struct snow_overlay snow_overlay; /* snowglass/overlay.h */

/* A transparent picture of 1 to 32768 pixels a side with 2 or 4 channels, or
 * an array of zeros with 1.
 * Errors: SNOW_STATUS_BAD_USAGE, SNOW_STATUS_NO_MEMORY.  Free with
 * snow_image_free. */
SNOW_API snow_status snow_image_new(snow_context *context, int width,
                                    int height, int channels, snow_image **out);

SNOW_API void snow_image_free(snow_image *image);

SNOW_API int snow_image_width(const snow_image *image);
SNOW_API int snow_image_height(const snow_image *image);
SNOW_API int snow_image_channels(const snow_image *image);

/* Pixel (x, y) has its channels at [(y * width + x) * channels]; owned by the
 * image. */
SNOW_API float *snow_image_pixels(snow_image *image);

/* A 64-bit FNV-1a hash of the size, the channels and the bytes of all float
 * pixels (of the little-endian form, -0 as 0, every NaN as 0x7fc00000): equal
 * pictures, equal sums. */
SNOW_API uint64_t snow_image_checksum(const snow_image *image);

typedef struct snow_image_options {
    size_t size;
    bool flatten;         /* PNG, WebP: lay the picture on `background` */
    double background[3]; /* red, green, blue, 0 to 1 */
    int bits;             /* PNG: 8 or 16 bits a channel; 0 means 8 */
    bool overwrite;       /* replace an existing file */
    const snow_overlay *overlay; /* PNG, WebP: drawn over the picture, whose
                                    size it has; NULL: nothing */
    const snow_image *depth;     /* EXR: an array of the picture's size, channel
                                    Z beside the picture; NULL: none */
} snow_image_options;
SNOW_RECORD(snow_image_options);

/* Writes a picture in the format of the path's suffix; "-" is standard output,
 * as PNG.
 *   .png  straight alpha, round(255 x) or round(65535 x), x limited to 0 to 1;
 *         pixels with a NaN are transparent; without alpha when flattened; grey
 *         when the picture has two channels (and the background no colour)
 *   .npy  float32 (height, width, 4), premultiplied RGBA; values (height,
 *         width)
 *   .pfm  float32 RGB, premultiplied, without alpha; values as grey
 *   .exr  OpenEXR: float32 RGBA, premultiplied, packed without loss (ZIP);
 *         values as channel Y; options->depth as channel Z
 *   .tif  TIFF: float32 RGBA, premultiplied (associated alpha), packed without
 *         loss (Deflate); values as one sample; also .tiff
 *   .webp straight alpha as in PNG, 8 bits, packed without loss; at most 16383
 *         pixels a side
 * The last three need libraries that a build may lack
 * (snow_image_format_suffix). Values are no colours: a PNG or WebP of them is
 * refused (snow_image_apply_colormap in render.h makes colours of them). The
 * file is written aside and renamed, so that it is whole or absent; an existing
 * one is kept, and an error, unless options->overwrite.  `options` may be NULL.
 * Errors: SNOW_STATUS_BAD_OUTPUT, SNOW_STATUS_BAD_USAGE (unknown suffix, or one
 * that this build lacks; a background, bits or an overlay for floats; values
 * into levels; a depth for other formats than EXR, or of another size),
 * SNOW_STATUS_NO_MEMORY. */
SNOW_API snow_status snow_image_save(const snow_image *image, const char *path,
                                     const snow_image_options *options);

/* The most bits a channel that the format of a path's suffix has for levels: 16
 * for .png and "-", 8 for .webp; 0 where it holds floats, which takes neither
 * bits, a background nor an overlay; -1: none that snow_image_save writes. */
SNOW_API int snow_image_format_bits(const char *path);

/* Whether the format of a path's suffix has a channel for a depth beside the
 * picture (snow_image_options): .exr. */
SNOW_API bool snow_image_format_has_depth(const char *path);

/* The suffix of picture format `index` (from 0), and whether this build writes
 * and reads it, and has beside it what it must load for that; NULL past the
 * end. */
SNOW_API const char *snow_image_format_suffix(size_t index, bool *built);

/* The picture on a background (red, green, blue, 0 to 1) as rows of bytes, red,
 * green, blue for each pixel: width * height * 3 of them, with the levels that
 * a PNG of 8 bits on that background stores. */
SNOW_API void snow_image_to_rgb8(const snow_image *image,
                                 const double background[3],
                                 unsigned char *rgb);

/* The same with all options: the background where `flatten`, black elsewhere,
 * and the overlay. */
SNOW_API snow_status snow_image_to_rgb8_with(const snow_image *image,
                                             const snow_image_options *options,
                                             unsigned char *rgb);

/* Whether a path's suffix (or "-") is one that snow_image_save writes: asked
 * before a long rendering.  Errors: SNOW_STATUS_BAD_USAGE,
 * SNOW_STATUS_BAD_OUTPUT (it exists and `overwrite` is false; its folder is
 * missing or not writable). */
SNOW_API snow_status snow_image_check_path(snow_context *context,
                                           const char *path, bool overwrite);

/* The same of all that snow_image_save would refuse for a picture of a size
 * with these options, which may be NULL.  Errors: SNOW_STATUS_BAD_USAGE,
 * SNOW_STATUS_BAD_OUTPUT. */
SNOW_API snow_status snow_image_check(snow_context *context, const char *path,
                                      int width, int height,
                                      const snow_image_options *options);

/* Reads a picture: PNG (8 or 16 bits, grey or colour, with or without alpha;
 * straight alpha is multiplied in), WebP, NPY (float32 or float64, (h, w) or
 * (h, w, 1 to 4)), PFM, EXR (scan lines; R, G, B, A or Y), TIFF (8 or 16 bits,
 * or floats; strips).  It has four channels; alpha is 1 where the file has
 * none. Errors: SNOW_STATUS_BAD_INPUT, SNOW_STATUS_NO_MEMORY. */
SNOW_API snow_status snow_image_load(snow_context *context, const char *path,
                                     snow_image **out);

/* The same on a file's bytes in memory. */
SNOW_API snow_status snow_image_load_memory(snow_context *context,
                                            const char *name, const void *bytes,
                                            size_t size, snow_image **out);

/* How far two pictures differ, over all four premultiplied channels; the three
 * of colour where one was read from a PFM file, which has no alpha. */
typedef struct snow_image_difference {
    size_t size;
    double largest; /* largest absolute difference; 0 when equal */
    double mean;    /* mean absolute difference */
    double psnr;    /* dB for a peak of 1; infinite when equal */
    double ssim;    /* structural similarity of the luma over black, 8x8
                       windows; 1 when equal */
    int x, y;       /* a pixel of the largest difference */
} snow_image_difference;
SNOW_RECORD(snow_image_difference);

/* Compares two pictures of one size (1 and 2 channels count as grey).  NaN
 * equals NaN only, an infinity itself only: else they are infinitely far apart.
 * Errors: SNOW_STATUS_DIFFERENT when the sizes differ (the message gives them),
 * SNOW_STATUS_NO_MEMORY. */
SNOW_API snow_status snow_image_compare(const snow_image *a,
                                        const snow_image *b,
                                        snow_image_difference *out);

#ifdef __cplusplus
}
#endif
#endif
