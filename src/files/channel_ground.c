/* files/channel_ground.c - snow_channels_ground: whether colours lie on white,
 * as sections in a bright field do. */
#include "base/base.h"

#include <snowglass/channels.h>

#include <math.h>

/* Pixels of a slice's longer side that suffice. */
#define LOOKED 512

/* Such a ground is as bright, and goes so far below its usual brightness, in
 * uneven light, and below its tenth part, in noise. */
#define BRIGHT 0.7
#define UNEVEN 0.1
#define NOISE 0.02
#define BINS 256

/* The values of a slice, one of three of the same size. */
static snow_status draw_part(const snow_volume *part, int64_t index,
                             snow_image **out) {
    snow_settings plain;
    snow_view view;
    int axis;
    snow_view_init(&view);
    snow_settings_init(&plain);
    plain.kernel = SNOW_KERNEL_BOX;
    view.width = view.height = 0;
    snow_status status =
        snow_slice_view(NULL, snow_volume_get_info(part), "z", &view, &axis);
    if (status == SNOW_STATUS_OK &&
        (view.width > LOOKED || view.height > LOOKED)) {
        view.width = view.height = LOOKED;
        status = snow_slice_view(NULL, snow_volume_get_info(part), "z", &view,
                                 &axis);
    }
    return status == SNOW_STATUS_OK
               ? snow_slice_render(part, index, NULL, &view, &plain, out)
               : status;
}

/* The least level of a pixel, 0 to 1; NaN where it has none. */
static double least_level(snow_image *const images[3],
                          const double levels[3][2], size_t pixel) {
    double least = 1;
    for (int c = 0; c < 3; c++) {
        const double value = (double)snow_image_pixels(images[c])[pixel];
        const double share =
            (value - levels[c][0]) / (levels[c][1] - levels[c][0]);
        if (isnan(share))
            return NAN;
        least = fmin(least, share);
    }
    return fmax(least, 0);
}

/* Counts the outermost pixels that have values along a line, by brightness. */
static void count_ends(snow_image *const images[3], const double levels[3][2],
                       size_t first, size_t step, size_t count,
                       uint64_t bins[BINS]) {
    for (int end = 0; end < 2; end++)
        for (size_t n = 0; n < count; n++) {
            const double level = least_level(
                images, levels, first + step * (end ? count - 1 - n : n));
            if (isnan(level))
                continue;
            bins[(int)(level * (BINS - 1))]++;
            break;
        }
}

/* The brightness below which a share of those from a bin on lie. */
static double quantile(const uint64_t bins[BINS], int from, double share) {
    uint64_t all = 0, below = 0;
    for (int n = from; n < BINS; n++)
        all += bins[n];
    for (int n = from; n < BINS; n++) {
        below += bins[n];
        if ((double)below > share * (double)all)
            return (double)n / (BINS - 1);
    }
    return 0;
}

snow_status snow_channels_ground(const snow_volume *const parts[3],
                                 const double levels[3][2], int64_t index,
                                 double *white) {
    snow_image *images[3] = {NULL};
    uint64_t bins[BINS] = {0};
    snow_status status = SNOW_STATUS_OK;
    for (int c = 0; c < 3 && status == SNOW_STATUS_OK; c++)
        status = draw_part(parts[c], index, &images[c]);
    if (status == SNOW_STATUS_OK) {
        const size_t width = (size_t)snow_image_width(images[0]);
        const size_t height = (size_t)snow_image_height(images[0]);
        for (size_t y = 0; y < height; y++)
            count_ends(images, levels, y * width, 1, width, bins);
        for (size_t x = 0; x < width; x++)
            count_ends(images, levels, x, width, height, bins);
        const int bright = (int)(BRIGHT * (BINS - 1));
        const double usual = quantile(bins, bright, 0.5);
        *white =
            quantile(bins, 0, 0.5) < BRIGHT
                ? 0
                : fmax(quantile(bins, bright, 0.1), usual - UNEVEN) - NOISE;
    }
    for (int c = 0; c < 3; c++)
        snow_image_free(images[c]);
    return status;
}
