/* composite/tile.h - splatting and composition of the shear-warp method, in one
 * pass over a tile (R and Cp in figure 7, lines 08 to 13 of figure 8).
 *
 * A tile is SNOW_TILE_COLUMNS columns of the lattice, and up to SNOW_TILE_CELLS
 * rows of it high. A cell is one of these rows: phases lines of the image with
 * phases * SNOW_TILE_COLUMNS pixels each.
 *
 *   windows of voxel samples      combed along u        combed along v
 *   row i   . a b . . . .   --->  filtered row i  --.
 *   row i+1 . . c d . . .   --->  filtered row i+1 --+--> lines of cell i,
 *   ...                                             --'    behind the image's
 *
 * Until an image is finished its alpha channel holds alpha - 1, the negated
 * transparency. Compositing a sample (c a, a) behind a pixel is then one fused
 * operation for all channels,
 *
 *   pixel = pixel - (alpha - 1) * sample. */
#ifndef SNOW_TILE_H
#define SNOW_TILE_H

#include "simd/isa.h"
#include "splat/separable/comb.h"

#define SNOW_TILE_COLUMNS 16
#define SNOW_TILE_CELLS 32
#define SNOW_TILE_ROWS \
    64 /* voxel rows that the cells can need: bits of a mask */

/* The transparency below which a cell is finished (early termination): half a
 * step of an 8-bit picture. Anything behind changes it by less. */
#define SNOW_OPAQUE_ENOUGH (0.5f / 255)

/* One tile of one slice. */
typedef struct snow_tile {
    const snow_lattice *lattice_u, *lattice_v;
    const snow_comb *u, *v;
    int taps_u, taps_v;
    /* Windows: row i begins with the voxel of column comb.offset of the tile's
     * first lattice column; zeros where there is no interesting voxel. */
    const float *samples;
    size_t window;     /* floats from row to row */
    uint64_t held;     /* rows that have a voxel: bit i */
    uint64_t wanted;   /* cells to draw; cell i needs rows i * stride to i *
                          stride + lead + taps_v - 1 */
    float *ring;       /* SNOW_TILE_ROWS filtered rows, not shared */
    const float *zero; /* a filtered row of zeros */
    float *pixels;     /* the tile's first pixel */
    size_t line;       /* floats from line to line */
} snow_tile;

/* Draws the wanted cells; returns those that became opaque. */
typedef uint64_t snow_tile_fn(const snow_tile *tile);

/* The function of an instruction set, for 2 or 4 channels. */
snow_tile_fn *snow_tile_of(snow_isa isa, int channels);

/* snow_tile_clear prepares pixels for the first sample; the second call turns
 * finished ones into alpha. */
void snow_tile_clear(float *pixels, size_t count, int channels);
void snow_tile_finish(float *pixels, size_t count, int channels);

#endif
