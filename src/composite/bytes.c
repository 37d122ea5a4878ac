/* composite/bytes.c - see bytes.h. */
#include "composite/bytes.h"

#include "image/overlay.h"
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

/* --- without alpha, and with shapes -----------------------------------------
 */

/* Pixels per step, with their bytes. */
#define SOME_RGB 256

/* Allocates no memory: frames of a movie are made while others are rendered. */
snow_status snow_image_to_rgb8(const snow_image *image,
                               const snow_image_options *given,
                               unsigned char *rgb) {
    snow_image_options options;
    SNOW_TRY(
        SNOW_RECORD_READ(image->context, snow_image_options, given, &options));
    if (image->channels == 1)
        return snow_fail(image->context, SNOW_STATUS_BAD_USAGE,
                         "the picture holds values, not colours; take "
                         "snow_image_apply_colormap first");
    if (!options.flatten)
        memset(options.background, 0, sizeof options.background);
    for (int i = 0; i < 3; i++)
        if (!(options.background[i] >= 0 && options.background[i] <= 1))
            return snow_fail(image->context, SNOW_STATUS_BAD_USAGE,
                             "the background has a channel of %g; use 0 to 1",
                             options.background[i]);
    const snow_overlay *overlay = options.overlay;
    const int channels = overlay && !overlay->grey ? 4 : image->channels;
    snow_bytes_fn *convert = snow_bytes_of(snow_isa_resolve(SNOW_ISA_AUTO));
    float drawn[4 * SOME_RGB];
    unsigned char rgba[4 * SOME_RGB];
    for (int y = 0; y < image->height; y++)
        for (int x = 0; x < image->width; x += SOME_RGB) {
            int left = image->width - x,
                some = left < SOME_RGB ? left : SOME_RGB;
            snow_image_draw_some(image, overlay, options.background, y, x, some,
                                 channels, drawn);
            convert(drawn, some, channels, options.background, rgba);
            for (int i = 0; i < some; i++, rgb += 3)
                memcpy(rgb, rgba + 4 * i, 3);
        }
    return SNOW_STATUS_OK;
}
