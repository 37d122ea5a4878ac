/* composite/over.c - "composite successive slices to produce the local image"
 * (line 13 of figure 8); Porter and Duff 1984. */
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

void snow_over_row(float *front, const float *back, size_t count,
                   int channels) {
    if (channels == 2)
        over_grey(front, back, count);
    else
        over_rgba(front, back, count);
}

void snow_composite_sheet(float *image, snow_sheet *sheet) {
    size_t channels = (size_t)sheet->channels;
    if (sheet->x0 < sheet->x1) {
        size_t count = (size_t)(sheet->x1 - sheet->x0);
        for (int y = sheet->y0; y < sheet->y1; y++) {
            size_t at = ((size_t)y * (size_t)sheet->width + (size_t)sheet->x0) *
                        channels;
            snow_over_row(image + at, sheet->pixels + at, count,
                          sheet->channels);
            memset(sheet->pixels + at, 0,
                   count * channels * sizeof *sheet->pixels);
        }
    }
    snow_sheet_unmark(sheet);
}
