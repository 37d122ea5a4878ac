/* insitu/enlarge.c - a picture that was drawn smaller, at the size that was
 * asked for: bilinear; premultiplied colours may be averaged as they are. */
#include "insitu/internal.h"

#include <math.h>

/* Where pixel `at` of `to` lies among `from` pixels: between `low` and the next
 * one, `share` of the way. */
static int place_pixel(int at, int to, int from, float *share) {
    double place = (at + 0.5) * from / to - 0.5;
    double low = fmin(fmax(floor(place), 0), fmax(from - 2, 0));
    *share = (float)fmin(fmax(place - low, 0), from > 1 ? 1 : 0);
    return (int)low;
}

/* `share` of the way from a to b; the nearer one where one of them is no
 * number, as those of rays that meet nothing are in modes mean and sum. */
static float between(float a, float b, float share) {
    if (isnan(a) || isnan(b))
        return share < 0.5f ? a : b;
    return a + share * (b - a);
}

/* One line of the large picture, between two lines of the small one. */
static void enlarge_line(const float *a, const float *b, float share, int from,
                         int to, int channels, float *out) {
    for (int x = 0; x < to; x++) {
        float across;
        int n = place_pixel(x, to, from, &across) * channels;
        int next = from > 1 ? channels : 0;
        for (int c = 0; c < channels; c++) {
            float top = between(a[n + c], a[n + next + c], across);
            float low = between(b[n + c], b[n + next + c], across);
            *out++ = between(top, low, share);
        }
    }
}

snow_status snow_insitu_enlarge(snow_insitu *insitu, snow_image **image,
                                int width, int height) {
    snow_image *small = *image, *large;
    if (!small || (snow_image_width(small) == width &&
                   snow_image_height(small) == height))
        return SNOW_STATUS_OK;
    int columns = snow_image_width(small), rows = snow_image_height(small);
    int channels = snow_image_channels(small);
    INSITU_TRY(
        snow_image_new(insitu->context, width, height, channels, &large));
    size_t line = (size_t)columns * (size_t)channels;
    float *out = snow_image_pixels(large);
    for (int y = 0; y < height; y++) {
        float share;
        int n = place_pixel(y, height, rows, &share);
        const float *a = snow_image_pixels(small) + (size_t)n * line;
        enlarge_line(a, rows > 1 ? a + line : a, share, columns, width,
                     channels, out);
        out += (size_t)width * (size_t)channels;
    }
    snow_image_free(small);
    *image = large;
    return SNOW_STATUS_OK;
}
