/* composite/over.c - composites sheets front to back: "composite successive
 * slices to produce the local image" (line 13 of figure 8); Porter and Duff
 * 1984. */
#include "composite/over.h"

#include <string.h>

static void over_grey(float *restrict front, const float *restrict back,
                      size_t count) {
    for (size_t i = 0; i < count; i++) {
        float left = 1 - front[2 * i + 1];
        front[2 * i] += left * back[2 * i];
        front[2 * i + 1] += left * back[2 * i + 1];
    }
}

static void over_rgba(float *restrict front, const float *restrict back,
                      size_t count) {
    for (size_t i = 0; i < count; i++) {
        float left = 1 - front[4 * i + 3];
        for (size_t c = 0; c < 4; c++)
            front[4 * i + c] += left * back[4 * i + c];
    }
}

snow_composite_fn *snow_over_of(int channels) {
    return channels == 2 ? over_grey : over_rgba;
}

void snow_composite_sheet(float *image, snow_sheet *sheet,
                          snow_composite_fn *composite) {
    size_t channels = (size_t)sheet->channels;
    if (sheet->x0 < sheet->x1) {
        size_t count = (size_t)(sheet->x1 - sheet->x0);
        for (int y = sheet->y0; y < sheet->y1; y++) {
            size_t width = (size_t)sheet->width, x = (size_t)sheet->x0;
            size_t line = (size_t)(y - sheet->top);
            float *back = sheet->pixels + (line * width + x) * channels;
            composite(image + ((size_t)y * width + x) * channels, back, count);
            memset(back, 0, count * channels * sizeof *back);
        }
    }
    snow_sheet_unmark(sheet);
}

/* --- projection ----------------------------------------------------------- */

/* Without branches, so that compilers can vectorize it. Values are never
 * negative; an image begins as zeros. */
void snow_keep_largest(float *restrict image, const float *restrict sheet,
                       size_t count) {
    for (size_t i = 0; i < count; i++) {
        bool known = sheet[2 * i + 1] >= SNOW_WEIGHT_ENOUGH;
        float weight = known ? sheet[2 * i + 1] : 1;
        float value = known ? sheet[2 * i] / weight : 0;
        image[2 * i] = value > image[2 * i] ? value : image[2 * i];
        image[2 * i + 1] = known ? 1 : image[2 * i + 1];
    }
}

void snow_add_up(float *restrict image, const float *restrict sheet,
                 size_t count) {
    for (size_t i = 0; i < 2 * count; i++)
        image[i] += sheet[i];
}

snow_composite_fn *snow_projection_op_of(snow_mode mode) {
    return mode == SNOW_MODE_MIP || mode == SNOW_MODE_MINIP ? snow_keep_largest
                                                            : snow_add_up;
}
