/* classify/path_length.c - opacities and sums of a perspective view: each
 * voxel's own ray has its own length within the voxel's sheet (model, section
 * 6). */
#include "base/exp_log.h"
#include "classify/classify.h"
#include "transform/perspective.h"

/* The length of the ray to entry n of a row block, which lies in row `row`. */
static double path_of(const snow_placement *placement,
                      const snow_row_block *row_block, int64_t row, size_t n) {
    return snow_perspective_path(&placement->eye, (double)row_block->columns[n],
                                 (double)(row_block->first_row + row),
                                 (double)row_block->slice);
}

void snow_scale_by_path_length(const snow_placement *placement,
                               double opacity_length, int channels,
                               snow_row_block *row_block) {
    size_t n = 0;
    for (int64_t row = 0; row < row_block->rows; row++)
        for (; n < row_block->row_end[row]; n++) {
            double path = path_of(placement, row_block, row, n);
            float factor = (float)(path / opacity_length);
            for (int i = 0; i < channels; i++)
                row_block->samples[n * (size_t)channels + (size_t)i] *= factor;
        }
}

void snow_correct_opacity(const snow_placement *placement,
                          double opacity_length, int channels,
                          snow_row_block *row_block) {
    size_t n = 0;
    for (int64_t row = 0; row < row_block->rows; row++)
        for (; n < row_block->row_end[row]; n++) {
            float *sample = row_block->samples + n * (size_t)channels;
            double opacity = (double)sample[channels - 1];
            if (!(opacity > 0))
                continue;
            double path = path_of(placement, row_block, row, n);
            double lengthened =
                snow_opacity_of(snow_clarity(opacity),
                                snow_exponent_within(path / opacity_length));
            float factor = (float)(lengthened / opacity);
            for (int i = 0; i < channels - 1; i++)
                sample[i] *= factor;
            sample[channels - 1] = (float)lengthened;
        }
}
