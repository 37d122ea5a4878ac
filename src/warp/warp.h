/* warp/warp.h - the intermediate image of the sheared method to the picture,
 * by one affine or projective resampling: Catmull-Rom (4 x 4 pixels) or
 * bilinear (2 x 2). */
#ifndef SNOW_WARP_H
#define SNOW_WARP_H

#include "simd/isa.h"
#include "transform/scaled.h"
#include "transform/shear.h"

/* The intermediate image: lines of `stride` floats, of which the first
 * width * channels are pixels; premultiplied.  It is cut into blocks, and where
 * a block was not drawn on, its pixels are 0. */
typedef struct snow_plane {
    const float *pixels;
    size_t stride; /* floats */
    int width, height, channels;
    const unsigned char *drawn; /* [line / block_height * blocks + column /
                                   block_width]: 0 where all is 0 */
    int block_width, block_height, blocks; /* pixels; blocks a line */
} snow_plane;

typedef enum snow_filter { SNOW_BILINEAR, SNOW_CATMULL_ROM } snow_filter;

typedef struct snow_warp_line snow_warp_line;

/* Resamples `count` pixels of a line; see lines.tmpl.h. */
typedef void snow_warp_fn(const snow_plane *plane, const snow_warp_line *line,
                          int first, int count, float *pixels);

/* Where pixel x of the picture's line falls: start + x * step, in 2^-32 pixels
 * of the plane, so that the place of a pixel does not depend on where a loop
 * began. */
struct snow_warp_line {
    int64_t start[2], step[2];
};

/* The same for `count` places (x, y) in 2^-32 pixels of the plane. */
typedef void snow_warp_places_fn(const snow_plane *plane,
                                 const int64_t (*places)[2], int count,
                                 float *pixels);

/* The functions of a level. */
snow_warp_fn *snow_warp_of(snow_isa isa, snow_filter filter, int channels);
snow_warp_places_fn *snow_warp_places_of(snow_isa isa, snow_filter filter,
                                         int channels);

/* Fills pixels `from` to `to` - 1 of line y of a picture, whose pixel 0 is the
 * first of `pixels`; 0 where the plane ends. */
void snow_warp_row(const snow_plane *plane, const snow_shear *shear,
                   snow_filter filter, snow_warp_fn *warp, int y, int from,
                   int to, float *pixels);

/* The same in perspective: warp/perspective.c. */
void snow_warp_row_seen(const snow_plane *plane, const snow_scaled *scaled,
                        snow_filter filter, snow_warp_places_fn *warp, int y,
                        int from, int to, float *pixels);

#endif
