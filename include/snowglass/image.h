/* snowglass/image.h - a picture of floats, and its files.
 *
 * Pixels are rows of floats, row 0 on top. Four channels are red, green, blue
 * and alpha, two are grey and alpha; colours are multiplied by alpha
 * (premultiplied) and linear as stored. One channel is an array of values, as
 * of modes mean and sum and of depths, where NaN stands for none. */
#ifndef SNOWGLASS_IMAGE_H
#define SNOWGLASS_IMAGE_H

#include <snowglass/context.h>

typedef struct snow_image snow_image;
typedef struct snow_overlay snow_overlay; /* snowglass/overlay.h */

/* Makes a transparent picture, or zeros where there is one channel. Sides are 1
 * to 32768 pixels, and channels 1, 2 or 4. */
SNOW_API snow_status snow_image_new(snow_context *context, int width,
    int height, int channels, snow_image **out);
SNOW_API void snow_image_free(snow_image *image);

/* Return the size in pixels, and the floats of a pixel. */
SNOW_API int snow_image_width(const snow_image *image);
SNOW_API int snow_image_height(const snow_image *image);
SNOW_API int snow_image_channels(const snow_image *image);

/* Return the pixels: to write, or only to read. Pixel (x, y) begins at
 * [((size_t)y * width + x) * channels]. */
SNOW_API float *snow_image_pixels(snow_image *image);
SNOW_API const float *snow_image_data(const snow_image *image);

/* Returns a hash of sizes and pixels: the 64-bit FNV-1a of their bytes in
 * little endian, where -0 counts as 0 and all NaN as one. Equal pictures have
 * equal hashes on all machines. */
SNOW_API uint64_t snow_image_checksum(const snow_image *image);

/* How a picture is written. */
typedef struct snow_image_options {
    size_t size;
    bool flatten;                /* PNG, WebP, JPEG: composite on background */
    double background[3];        /* red, green, blue, 0 to 1 */
    int bits;                    /* PNG: 8 or 16 bits a channel; 0 means 8 */
    bool overwrite;              /* replace an existing file */
    const snow_overlay *overlay; /* PNG, WebP, JPEG: over it, of its size */
    const snow_image *depth;     /* EXR: channel Z; NULL: none, as the others */
    const char *comment;         /* PNG: a text "Snowglass"; it is not drawn */
    bool unsynced;               /* does not wait for the disk */
} snow_image_options;
SNOW_RECORD(snow_image_options);

/* Writes a picture to a file, whole or not at all. The suffix gives the format:
 * .png, .webp, .jpg and .jpeg hold levels (JPEG on black, unless `flatten`);
 * .npy, .pfm, .exr, .tif and .tiff hold floats. "-" is a PNG to standard
 * output. Errors: BAD_OUTPUT (the file exists, without `overwrite`, or cannot
 * be written), BAD_USAGE (what the format cannot hold), STOPPED. */
SNOW_API snow_status snow_image_save(const snow_image *image, const char *path,
    const snow_image_options *options);

/* Checks what snow_image_save would refuse, before the picture is made; its
 * sides are 1 where they are not known yet. Errors: those of snow_image_save.
 */
SNOW_API snow_status snow_image_check(snow_context *context, const char *path,
    int width, int height, const snow_image_options *options);

/* Returns the most bits a channel that the format of a path's suffix holds: 0
 * for floats, -1 where the suffix is of no format. */
SNOW_API int snow_image_format_bits(const char *path);

/* Returns whether the format of a path's suffix holds a depth, too. */
SNOW_API bool snow_image_format_has_depth(const char *path);

/* Returns suffix `index` (from 0) of those that can be written, NULL past the
 * end. *built: whether this build has what the format needs. */
SNOW_API const char *snow_image_format_suffix(size_t index, bool *built);

/* Fills width * height * 3 bytes with the levels of red, green and blue that a
 * PNG of 8 bits has, with the overlay and the background of `options`, on black
 * unless `flatten`. Errors: BAD_USAGE (a picture of one channel, which is
 * values; a background beyond 0 to 1). */
SNOW_API snow_status snow_image_to_rgb8(const snow_image *image,
    const snow_image_options *options, unsigned char *rgb);

/* Reads a PNG, WebP, JPEG, NPY, PFM, EXR or TIFF as a picture of four channels;
 * alpha is 1 where the file has none. Errors: BAD_INPUT. */
SNOW_API snow_status snow_image_load(
    snow_context *context, const char *path, snow_image **out);

/* The same from bytes in memory, which messages call `name`. */
SNOW_API snow_status snow_image_load_memory(snow_context *context,
    const char *name, const void *bytes, size_t size, snow_image **out);

/* How two pictures differ, over four premultiplied channels, or three where one
 * comes of a file without alpha (PFM, JPEG). */
typedef struct snow_image_difference {
    size_t size;
    double largest, mean; /* absolute difference; 0 when equal */
    double psnr;          /* dB for a peak of 1; infinite when equal */
    double ssim; /* of the luma over black, 8x8 windows; 1 when equal */
    int x, y;    /* a pixel of the largest difference */
} snow_image_difference;
SNOW_RECORD(snow_image_difference);

/* Compares two pictures of one size. OK says that they were compared, not that
 * they are equal: see `largest`. NaN equals NaN only, an infinity itself only.
 * Errors: DIFFERENT (the sizes differ; *out is not filled). */
SNOW_API snow_status snow_image_compare(
    const snow_image *a, const snow_image *b, snow_image_difference *out);

#endif
