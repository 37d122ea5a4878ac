/* image/levels.c - rows of a picture as integers of 8 and 16 bits, with the
 * overlay: the contents of PNG, WebP and JPEG files and of movies' frames. */
#include "image/image.h"

#include "image/overlay.h"
#include "image/samples.h"

#include <string.h>

/* Pixels per step: their samples stay in the first-level cache. */
#define SOME 256

/* A grey picture is written in colour if its background or its overlay has
 * colour, or if the file format has no grey. */
static void plan(const snow_image *image, const snow_image_options *options,
                 bool colored, snow_levels *out) {
    const double *b = options->flatten ? options->background : NULL;
    const snow_overlay *overlay = options->overlay;
    bool grey = image->channels == 2 && !colored && (!overlay || overlay->grey);
    *out = (snow_levels){.image = image,
                         .overlay = overlay,
                         .background = b,
                         .bits = options->bits == 16 ? 16 : 8,
                         .channels = grey ? 2 : 4};
    if (b && (b[0] != b[1] || b[1] != b[2]))
        grey = false; /* snow_flatten_row copies grey to all three */
    out->samples = (grey ? 1 : 3) + (b ? 0 : 1);
}

snow_status snow_levels_begin(const snow_image *image,
                              const snow_image_options *options, bool colored,
                              snow_levels *out) {
    snow_context *context = image->context;
    plan(image, options, colored, out);
    uint64_t count = (uint64_t)image->width * (uint64_t)out->samples;
    uint64_t drawn = (uint64_t)image->width * (uint64_t)out->channels;
    SNOW_TRY(SNOW_RESERVE(context, out->row, 0, count));
    SNOW_TRY(SNOW_RESERVE(context, out->bytes, 0, 2 * count));
    return SNOW_RESERVE(context, out->drawn, 0, drawn);
}

void snow_levels_end(snow_levels *levels) {
    snow_context *context = levels->image->context;
    snow_release(context, levels->drawn);
    snow_release(context, levels->bytes);
    snow_release(context, levels->row);
}

/* Whether dark letters are read better than white ones: by the luma of BT.709.
 */
static bool is_light(const double *b) {
    return b && 0.2126 * b[0] + 0.7152 * b[1] + 0.0722 * b[2] > 0.5;
}

/* Converts some pixels from (x, y) on, with the shapes over them. */
static void draw_some(const snow_image *image, const snow_overlay *overlay,
                      bool light, int y, int x, int count, int channels,
                      float *out) {
    size_t first = (size_t)y * (size_t)image->width + (size_t)x;
    if (channels == image->channels)
        memcpy(out, image->pixels + first * (size_t)channels,
               (size_t)count * (size_t)channels * sizeof *out);
    else
        for (int i = 0; i < count; i++)
            snow_image_rgba(image, first + (size_t)i, out + 4 * i);
    if (overlay)
        snow_overlay_draw(overlay, light, y, x, count, channels, out);
}

const unsigned char *snow_levels_row(snow_levels *l, int y) {
    int width = l->image->width;
    size_t count = (size_t)width * (size_t)l->samples;
    draw_some(l->image, l->overlay, is_light(l->background), y, 0, width,
              l->channels, l->drawn);
    if (l->background)
        snow_flatten_row(l->drawn, width, l->channels, l->background,
                         l->samples, l->row);
    else
        snow_straighten_row(l->drawn, width, l->channels, l->row);
    if (l->bits == 8)
        snow_quantise_8(l->row, count, l->bytes);
    else
        snow_quantise_16(l->row, count, l->bytes);
    return l->bytes;
}

/* Allocates no memory: frames of a movie are made while others are rendered. */
snow_status snow_image_to_rgb8_with(const snow_image *image,
                                    const snow_image_options *given,
                                    unsigned char *rgb) {
    static const double black[3] = {0, 0, 0};
    snow_image_options options;
    SNOW_TRY(
        SNOW_RECORD_READ(image->context, snow_image_options, given, &options));
    const double *background = options.flatten ? options.background : black;
    float drawn[4 * SOME];
    double samples[3 * SOME];
    for (int y = 0; y < image->height; y++)
        for (int x = 0; x < image->width; x += SOME) {
            int some = image->width - x < SOME ? image->width - x : SOME;
            draw_some(image, options.overlay, is_light(background), y, x, some,
                      4, drawn);
            snow_flatten_row(drawn, some, 4, background, 3, samples);
            snow_quantise_8(samples, 3 * (size_t)some, rgb);
            rgb += 3 * some;
        }
    return SNOW_STATUS_OK;
}

void snow_image_to_rgb8(const snow_image *image, const double background[3],
                        unsigned char *rgb) {
    snow_image_options options = {.size = sizeof options, .flatten = true};
    memcpy(options.background, background, sizeof options.background);
    snow_image_to_rgb8_with(image, &options, rgb);
}
