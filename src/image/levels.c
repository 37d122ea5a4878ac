/* image/levels.c - rows of a picture as integers of 8 and 16 bits, with the
 * overlay: the contents of PNG, WebP and JPEG files and of movies' frames. */
#include "image/image.h"

#include "image/overlay.h"
#include "image/samples.h"

#include <string.h>

/* Pixels that become levels at once. */
#define SOME 16

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
    uint64_t some = (uint64_t)SOME * (uint64_t)out->samples;
    uint64_t drawn = (uint64_t)image->width * (uint64_t)out->channels;
    SNOW_TRY(SNOW_RESERVE(context, out->row, 0, some));
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

/* Some pixels, of so many channels, which the compiler knows. */
static inline void level_some(snow_levels *l, const float *drawn, int count,
                              int channels, unsigned char *out) {
    const size_t samples = (size_t)count * (size_t)l->samples;
    if (l->background && l->samples == 1)
        snow_flatten_row(drawn, count, channels, l->background, 1, l->row);
    else if (l->background)
        snow_flatten_row(drawn, count, channels, l->background, 3, l->row);
    else
        snow_straighten_row(drawn, count, channels, l->row);
    if (l->bits == 8)
        snow_quantise_8(l->row, samples, out);
    else
        snow_quantise_16(l->row, samples, out);
}

/* Runs of pixels where nothing is are copies of the first one. */
const unsigned char *snow_levels_row(snow_levels *l, int y) {
    static const float nothing[SOME * 4];
    const int width = l->image->width, channels = l->channels;
    const size_t bytes = (size_t)(l->samples * l->bits / 8);
    const unsigned char *blank = NULL;
    snow_image_draw_some(l->image, l->overlay, l->background, y, 0, width,
                         channels, l->drawn);
    for (int x = 0; x < width; x += SOME) {
        const int count = width - x < SOME ? width - x : SOME;
        const float *drawn = l->drawn + (size_t)x * (size_t)channels;
        unsigned char *out = l->bytes + (size_t)x * bytes;
        const bool empty =
            count == SOME &&
            !memcmp(drawn, nothing, (size_t)(SOME * channels) * sizeof *drawn);
        if (empty && blank)
            memcpy(out, blank, SOME * bytes);
        else if (channels == 2)
            level_some(l, drawn, count, 2, out);
        else
            level_some(l, drawn, count, 4, out);
        if (empty)
            blank = out;
    }
    return l->bytes;
}
