/* composite/tile_perspective.h - splatting and composition of the shear-warp
 * method in perspective, in one pass over a tile: as composite/tile.h, but each
 * pixel column has its own first voxel and weights along u, and each line its
 * own along v (splat/separable/rake.h). */
#ifndef SNOW_COMPOSITE_TILE_PERSPECTIVE_H
#define SNOW_COMPOSITE_TILE_PERSPECTIVE_H

#include "composite/tile.h"
#include "splat/separable/rake.h"

#define SNOW_PERSPECTIVE_TILE_COLUMNS 32 /* pixels, or half as many */
#define SNOW_PERSPECTIVE_TILE_LINES 64   /* at most: bits of a mask */

/* Weights along one axis, of the pixels of a tile or the lines of a band. */
typedef struct snow_teeth {
    const int32_t *first;
    const float *weights; /* tap m of pixel n: weights[m * stride + n] */
    size_t stride;
    int taps;
} snow_teeth;

/* One tile of one slice. */
typedef struct snow_perspective_tile {
    snow_teeth u, v;
    int columns; /* pixels, a multiple of 16 */
    bool dense;  /* neighbouring pixels are at most a voxel apart along u */
    int64_t row; /* the voxel row of window 0 */
    /* Windows: row i begins with the voxel of column u.first[0]; zeros where
     * there is no interesting voxel.  A vector beyond the last may be read. */
    const float *samples;
    size_t window;     /* floats from row to row */
    uint64_t held;     /* rows that have a voxel and are needed: bit i */
    uint64_t wanted;   /* lines to draw */
    float *ring;       /* SNOW_TILE_ROWS filtered rows, not shared */
    const float *zero; /* a filtered row of zeros */
    float *pixels;     /* the tile's first pixel */
    size_t line;       /* floats from line to line */
} snow_perspective_tile;

/* Draws the wanted lines; returns those that became opaque. */
typedef uint64_t snow_perspective_tile_fn(const snow_perspective_tile *tile);

/* The function of an instruction set, for 2 or 4 channels. */
snow_perspective_tile_fn *snow_perspective_tile_of(snow_isa isa, int channels);

#endif
