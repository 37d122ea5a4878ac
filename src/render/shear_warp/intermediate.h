/* render/shear_warp/intermediate.h - the intermediate image, as it is combined
 * with those of other processors and warped. */
#ifndef SNOW_RENDER_SHEAR_WARP_INTERMEDIATE_H
#define SNOW_RENDER_SHEAR_WARP_INTERMEDIATE_H

#include "decompose/deterministic.h"

#include <stddef.h>

/* The intermediate image of a part.  Where a tile was not drawn on, its pixels
 * are anything until snow_shear_warp_clear.  A deterministic one has a layer
 * for each of some nodes of the tree of groups (decompose/deterministic.h). */
typedef struct snow_shear_warp_image {
    int width, height, channels; /* 0 x 0: nothing is in view */
    float *pixels;        /* of the frame's, until it draws there again */
    size_t stride;        /* floats from line to line */
    unsigned char *drawn; /* per tile, line of tiles by line of tiles */
    int tile_width, tile_height, tiles; /* pixels; tiles of a line */
    int layers;                         /* 1, or as many as nodes */
    size_t layer_floats, layer_tiles;   /* from layer to layer */
    const struct snow_shear_warp_warping *warping;
} snow_shear_warp_image;

/* Clears what was not drawn on of tiles x0 .. x1 - 1 of tile lines y0 .. y1 - 1
 * of a layer. */
void snow_shear_warp_clear(const snow_shear_warp_image *image, int layer,
                           int x0, int y0, int x1, int y1);

/* Puts `count` packed lines from `first` on, which others made, in their places
 * in an image's first layer. */
void snow_shear_warp_put_lines(const snow_shear_warp_image *image, int first,
                               int count, const float *pixels);

/* Pixels of a line of the picture whose place in the image is in its lines
 * first .. end - 1: x range[0] .. range[1] - 1.  Of lines that follow one
 * another each pixel is in one range. */
void snow_shear_warp_pixels_of(const snow_shear_warp_image *image, int y,
                               int first, int end, int range[2]);

/* The same of a kernel of 4 lines (warping.h). */
#define SNOW_WARP_BEFORE 2
#define SNOW_WARP_BEHIND 3

/* Warps the image, or what was put in its place, to pixels `from` to `to` - 1
 * of line y of the picture, whose pixel 0 is the first of `pixels`.  `spare`
 * has warping->spare_floats. */
void snow_shear_warp_warp(const struct snow_shear_warp_warping *warping, int y,
                          int from, int to, float *spare, float *pixels);

#endif
