/* composite/bytes.c - see bytes.h. */
#include "composite/bytes.h"

#include "image/samples.h"

#include <string.h>

/* Pixels whose levels stay in the first-level cache. */
#define SOME 64

#define TEMPLATE "composite/bytes.tmpl.h"
#include "simd/each_isa.h"

snow_bytes_fn *snow_bytes_of(snow_isa isa) {
    return SNOW_OF_ISA(isa, bytes);
}

void snow_bytes_image(const snow_image *image, snow_isa isa,
                      const snow_bytes *to) {
    const size_t row = (size_t)(image->width * image->channels);
    for (int y = 0; y < image->height; y++)
        snow_bytes_of(isa)(image->pixels + (size_t)y * row, image->width,
                           image->channels, to->background,
                           snow_bytes_row(to, y));
}

void snow_bytes_clear(int width, int height, const snow_bytes *to) {
    static const float nothing[4] = {0, 0, 0, 0};
    for (int x = 0; x < width; x++)
        bytes_scalar(nothing, 1, 4, to->background, to->pixels + 4 * x);
    for (int y = 1; y < height; y++)
        memcpy(snow_bytes_row(to, y), to->pixels, 4 * (size_t)width);
}
