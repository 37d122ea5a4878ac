/* snowglass/image.h - the picture: float pixels, premultiplied, linear, row 0
 * on top. Two channels are grey and alpha, four red, green, blue and alpha. One
 * is an array of values (modes mean and sum, depths), NaN for none. */
#ifndef SNOWGLASS_IMAGE_H
#define SNOWGLASS_IMAGE_H

#include <snowglass/context.h>

typedef struct snow_image snow_image;
typedef struct snow_overlay snow_overlay; /* snowglass/overlay.h */

/* Transparent, or zeros of 1 channel; 1 to 32768 pixels a side. */
SNOW_API snow_status snow_image_new(snow_context *context, int width,
    int height, int channels, snow_image **out);
SNOW_API void snow_image_free(snow_image *image);
SNOW_API int snow_image_width(const snow_image *image);
SNOW_API int snow_image_height(const snow_image *image);
SNOW_API int snow_image_channels(const snow_image *image);
/* Pixel (x, y) is at [((size_t)y * width + x) * channels]; data: to read. */
SNOW_API float *snow_image_pixels(snow_image *image);
SNOW_API const float *snow_image_data(const snow_image *image);

/* 64-bit FNV-1a of sizes and floats (little endian, -0 as 0, one NaN). */
SNOW_API uint64_t snow_image_checksum(const snow_image *image);

typedef struct snow_image_options {
    size_t size;
    bool flatten;                /* PNG, WebP, JPEG: lay it on `background` */
    double background[3];        /* red, green, blue, 0 to 1 */
    int bits;                    /* PNG: 8 or 16 bits a channel; 0 means 8 */
    bool overwrite;              /* replace an existing file */
    const snow_overlay *overlay; /* PNG, WebP, JPEG: over it, of its size */
    const snow_image *depth;     /* EXR: channel Z; NULL: none, as the others */
    const char *comment;         /* PNG: a text "Snowglass"; it is not drawn */
    bool unsynced;               /* does not wait for the disk */
} snow_image_options;
SNOW_RECORD(snow_image_options);
/* Writes .png, .webp, .jpg, .jpeg (levels; JPEG on black without `flatten`),
 * .npy, .pfm, .exr, .tif, .tiff (floats), or "-", a PNG to standard output,
 * whole or not at all. `options` may be NULL. Errors: BAD_OUTPUT (it exists,
 * without `overwrite`), BAD_USAGE (what the format cannot hold), STOPPED. */
SNOW_API snow_status snow_image_save(const snow_image *image, const char *path,
    const snow_image_options *options);

/* What snow_image_save would refuse, by path, size and options. */
SNOW_API snow_status snow_image_check_path(
    snow_context *context, const char *path, bool overwrite);
SNOW_API snow_status snow_image_check(snow_context *context, const char *path,
    int width, int height, const snow_image_options *options);

/* Of a path's suffix: the most bits a channel, 0 for floats, -1 for none;
 * whether it holds a depth. Suffix `index` (NULL past the end), and if built.
 */
SNOW_API int snow_image_format_bits(const char *path);
SNOW_API bool snow_image_format_has_depth(const char *path);
SNOW_API const char *snow_image_format_suffix(size_t index, bool *built);

/* width * height * 3 bytes, the levels of a PNG of 8 bits on that background;
 * or with all options, on black unless `flatten`. */
SNOW_API snow_status snow_image_to_rgb8(
    const snow_image *image, const double background[3], unsigned char *rgb);
SNOW_API snow_status snow_image_to_rgb8_with(const snow_image *image,
    const snow_image_options *options, unsigned char *rgb);

/* Reads PNG, WebP, JPEG, NPY, PFM, EXR, TIFF, from a file or bytes, to four
 * channels; alpha is 1 where there is none. Errors: BAD_INPUT. */
SNOW_API snow_status snow_image_load(
    snow_context *context, const char *path, snow_image **out);
SNOW_API snow_status snow_image_load_memory(snow_context *context,
    const char *name, const void *bytes, size_t size, snow_image **out);

/* Over four premultiplied channels, three where one is of PFM or JPEG. */
typedef struct snow_image_difference {
    size_t size;
    double largest, mean; /* absolute difference; 0 when equal */
    double psnr;          /* dB for a peak of 1; infinite when equal */
    double ssim; /* of the luma over black, 8x8 windows; 1 when equal */
    int x, y;    /* a pixel of the largest difference */
} snow_image_difference;
SNOW_RECORD(snow_image_difference);
/* NaN equals NaN only, an infinity itself only. Errors: DIFFERENT (sizes). */
SNOW_API snow_status snow_image_compare(
    const snow_image *a, const snow_image *b, snow_image_difference *out);

#endif
