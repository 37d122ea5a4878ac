/* classify/paths.c - opacities and sums of a perspective view: each voxel's own
 * ray says how long it stays in the voxel's sheet (model, points 6 and 8). */
#include "base/power.h"
#include "classify/classify.h"
#include "transform/eye.h"

/* The length of the ray to entry n of a strip, in a row of it. */
static double path_of(const snow_placement *placement, const snow_strip *strip,
                      int64_t row, size_t n) {
    return snow_eye_path(&placement->eye, (double)strip->columns[n],
                         (double)(strip->first_row + row),
                         (double)strip->slice);
}

void snow_weigh_strip(const snow_placement *placement, double opacity_length,
                      int channels, snow_strip *strip) {
    size_t n = 0;
    for (int64_t row = 0; row < strip->rows; row++)
        for (; n < strip->row_end[row]; n++) {
            double path = path_of(placement, strip, row, n);
            float factor = (float)(path / opacity_length);
            for (int i = 0; i < channels; i++)
                strip->samples[n * (size_t)channels + (size_t)i] *= factor;
        }
}

void snow_lengthen_strip(const snow_placement *placement, double opacity_length,
                         int channels, snow_strip *strip) {
    size_t n = 0;
    for (int64_t row = 0; row < strip->rows; row++)
        for (; n < strip->row_end[row]; n++) {
            float *sample = strip->samples + n * (size_t)channels;
            double opacity = (double)sample[channels - 1];
            if (!(opacity > 0))
                continue;
            double path = path_of(placement, strip, row, n);
            double lengthened =
                snow_opacity_of(snow_clarity(opacity),
                                snow_exponent_within(path / opacity_length));
            float factor = (float)(lengthened / opacity);
            for (int i = 0; i < channels - 1; i++)
                sample[i] *= factor;
            sample[channels - 1] = (float)lengthened;
        }
}
