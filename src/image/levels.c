/* image/levels.c - rows of a picture as integers of 8 and 16 bits, with the
 * overlay: the contents of PNG, WebP and JPEG files and of movies' frames. */
#include "image/image.h"

#include "image/overlay.h"
#include "image/samples.h"

#include <string.h>

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

void snow_image_draw_some(const snow_image *image, const snow_overlay *overlay,
                          const double *background, int y, int x, int count,
                          int channels, float *out) {
    size_t first = (size_t)y * (size_t)image->width + (size_t)x;
    if (channels == image->channels)
        memcpy(out, image->pixels + first * (size_t)channels,
               (size_t)count * (size_t)channels * sizeof *out);
    else
        for (int i = 0; i < count; i++)
            snow_image_rgba(image, first + (size_t)i, out + 4 * i);
    /* Dark letters are read better on light, by the luma of BT.709. */
    const double *b = background;
    const bool light = b && 0.2126 * b[0] + 0.7152 * b[1] + 0.0722 * b[2] > 0.5;
    if (overlay)
        snow_overlay_draw(overlay, light, y, x, count, channels, out);
}

const unsigned char *snow_levels_row(snow_levels *l, int y) {
    int width = l->image->width;
    size_t count = (size_t)width * (size_t)l->samples;
    snow_image_draw_some(l->image, l->overlay, l->background, y, 0, width,
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
