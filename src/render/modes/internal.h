/* render/modes/internal.h - what the loops of sums (sums.c) and of largest
 * values (maximum.c) know of a picture on the slices' lattice.
 *
 * Voxels are those of the whole volume here: what a pixel finds of weights does
 * not depend on which part of it a processor has. */
#ifndef SNOW_RENDER_MODES_INTERNAL_H
#define SNOW_RENDER_MODES_INTERNAL_H

#include "composite/projection.h"
#include "render/modes/sums.h"
#include "render/shear_warp/internal.h"
#include "splat/separable/coverage.h"
#include "splat/separable/rows.h"

/* How one slice lies on the lattice. */
typedef struct snow_slice_place {
    const snow_comb *u, *v;
    int64_t first_row;                /* of cell 0, but for leads */
    snow_coverage across[2], down[2]; /* per phase */
    /* Per phase, along u and v: pixels that are the part's own; and along u
     * those of them that find enough for a value. */
    int own[2][2][2], range[2][2];
} snow_slice_place;

/* One picture in the making. */
typedef struct projection_pass {
    const snow_shear_warp_params *params;
    snow_shear_warp *shear_warp;
    bool largest;
    bool hull;    /* largest values have the bounds of splines */
    bool bounded; /* and have bounds at all */
    snow_shear shear;
    snow_scaled_kernel scaled_kernel[2]; /* along u and v */
    int taps[2];
    int64_t slices;    /* that are drawn */
    int64_t stored[2]; /* the first voxel that is encoded, along u and v */
    snow_slice_place *places;
    const snow_decode_fns *windows;
    const snow_row_fns *fns;
    float scale, start; /* of codes */
    int code_bytes;
    int within[2][2]; /* per phase along v: cells within all slices */
    int pixels[2];    /* cells along u and v: pixels of a phase */
    int cells;        /* of a band */
    int64_t bands;
    int columns;   /* of a tile of largest values */
    int64_t tiles; /* of a band of those */
    size_t row;    /* floats of a row of a phase */
    size_t dense;  /* of a row of voxels, pads included */
    size_t ring;   /* rows that are kept; a power of 2 */
    size_t stride; /* floats of a line of the plane */
    size_t scratch_bytes;
    float *plane;
} projection_pass;

/* The part's own pixels of a phase along u that find enough for a value on a
 * line that finds `found` of its weights along v; place->range is that of 1. */
void snow_modes_range(const snow_slice_place *place, int phase, float found,
                      int range[2]);

/* Largest values: the bytes of a worker's memory; one band. */
size_t snow_maximum_scratch(const projection_pass *pass);
void snow_maximum_band(void *pass, int64_t band, int worker);

/* Bounds of the encoded voxels (max_bounds.c), which are kept: whether
 * there are any, and they are those of splines; columns and rows of a slice,
 * and its first. */
snow_status snow_maximum_prepare(projection_pass *pass,
                                 const snow_value_scale *scale);
int64_t snow_block_columns(const snow_bands *bands);
int64_t snow_block_rows(const snow_bands *bands);
uint16_t *snow_maximum_bounds(const projection_pass *pass, int64_t slice);

#endif
