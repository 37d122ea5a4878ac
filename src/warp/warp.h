/* warp/warp.h - resamples the intermediate image of the shear-warp method to
 * the picture, once, by an affine or projective map, with a Catmull-Rom (4 x 4
 * pixels) or bilinear (2 x 2) filter. */
#ifndef SNOW_WARP_H
#define SNOW_WARP_H

#include "simd/isa.h"
#include "transform/shear.h"
#include "transform/shear_perspective.h"

/* The intermediate image: lines of `stride` floats, of which the first width *
 * channels are pixels; premultiplied. It is divided into blocks; where a block
 * was not drawn on, its pixels are 0. */
typedef struct snow_intermediate_view {
    const float *pixels;
    size_t stride; /* floats */
    int width, height, channels;
    const unsigned char *drawn; /* [line / block_height * blocks + column /
                                   block_width]: 0 where all is 0 */
    int block_width, block_height, blocks; /* pixels; blocks a line */
} snow_intermediate_view;

typedef enum snow_filter { SNOW_BILINEAR, SNOW_CATMULL_ROM } snow_filter;

typedef struct snow_warp_line snow_warp_line;

/* Resamples `count` pixels of a line; see lines.tmpl.h. */
typedef void snow_warp_fn(const snow_intermediate_view *plane,
                          const snow_warp_line *line, int first, int count,
                          float *pixels);

/* Pixel x of the picture's line is at start + x * step, in 2^-32 pixels of the
 * intermediate image, so that the place of a pixel does not depend on where a
 * loop began. */
struct snow_warp_line {
    int64_t start[2], step[2];
};

/* The same for `count` places (x, y) in 2^-32 pixels of the intermediate image.
 */
typedef void snow_warp_places_fn(const snow_intermediate_view *plane,
                                 const int64_t (*places)[2], int count,
                                 float *pixels);

/* The functions of an instruction set. */
snow_warp_fn *snow_warp_of(snow_isa isa, snow_filter filter, int channels);
snow_warp_places_fn *snow_warp_places_of(snow_isa isa, snow_filter filter,
                                         int channels);

/* Computes pixels `from` to `to` - 1 of line y of a picture into `pixels`,
 * whose first is pixel 0; 0 outside of the intermediate image. */
void snow_warp_row(const snow_intermediate_view *plane, const snow_shear *shear,
                   snow_filter filter, snow_warp_fn *warp, int y, int from,
                   int to, float *pixels);

/* The same in perspective: warp/perspective.c. */
void snow_warp_row_perspective(const snow_intermediate_view *plane,
                               const snow_perspective_shear *scaled,
                               snow_filter filter, snow_warp_places_fn *warp,
                               int y, int from, int to, float *pixels);

#endif
