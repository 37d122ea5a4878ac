/* composite/bytes.h - float pixels as bytes for a screen or a file: the levels
 * of a PNG of 8 bits (image/samples.h), with straight alpha, or opaque on a
 * background. */
#ifndef SNOW_BYTES_H
#define SNOW_BYTES_H

#include "image/image.h"
#include "simd/isa.h"

/* Where a picture's bytes go: red, green, blue, alpha of each pixel. */
typedef struct snow_bytes {
    unsigned char *pixels;
    size_t stride;            /* bytes from row to row */
    const double *background; /* red, green, blue; NULL: with alpha */
} snow_bytes;

/* A row of `width` pixels of 2 or 4 channels. */
typedef void snow_bytes_fn(const float *row, int width, int channels,
                           const double *background, unsigned char *rgba);
snow_bytes_fn *snow_bytes_of(snow_isa isa);

/* Row y, and all rows of pictures of 2 or 4 channels. */
static inline unsigned char *snow_bytes_row(const snow_bytes *to, int y) {
    return to->pixels + (size_t)y * to->stride;
}
void snow_bytes_image(const snow_image *image, snow_isa isa,
                      const snow_bytes *to);

/* All rows where nothing is in view. */
void snow_bytes_clear(int width, int height, const snow_bytes *to);

#endif
