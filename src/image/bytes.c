/* image/bytes.c - a picture as rows of bytes, which encoders of movies and
 * screens take: what a PNG of 8 bits on the same background stores. */
#include "image/image.h"
#include "image/samples.h"

/* Pixels at a time: their samples stay in the first-level cache. */
#define SOME 256

void snow_image_bytes(const snow_image *image, const double background[3],
                      unsigned char *rgb) {
    size_t left = (size_t)image->width * (size_t)image->height;
    const float *pixels = image->pixels;
    double samples[3 * SOME];
    while (left) {
        int some = left < SOME ? (int)left : SOME;
        size_t count = 3 * (size_t)some;
        snow_flatten_row(pixels, some, image->channels, background, 3, samples);
        snow_quantise_8(samples, count, rgb);
        pixels += some * image->channels;
        rgb += count;
        left -= (size_t)some;
    }
}
