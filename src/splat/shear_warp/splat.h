/* splat/shear_warp/splat.h - shear-warp's inner loops: resampled slices of
 * values are sampled tile by tile, coloured slab by slab, and composited.
 *
 * A tile is 30 x 32 cells of the lattice, one voxel wide each, over the whole
 * depth; a cell has one or more samples, the phases.  For each slab between two
 * resampled slices, front to back, and each phase:
 *
 *   masks   which samples of the slab can be seen, and something shines through
 *   sample  the values of both resampled slices there and beside, and their
 *           differences
 *   queue   the samples that are visible, packed
 *   colour  by the table of the slab, and light
 *   blend   behind what is in the tile
 *
 * All instruction sets give the same bits. */
#ifndef SNOW_SPLAT_SHEAR_WARP_SPLAT_H
#define SNOW_SPLAT_SHEAR_WARP_SPLAT_H

#include "classify/shear_warp/labels.h"
#include "encode/shear_warp/store.h"

#define SNOW_VALUE_COLUMNS 30 /* of a tile; 32 lanes with those beside */
#define SNOW_VALUE_PHASES 128 /* the most in a cell */

/* Where a resampled slice is: a slice, or between it and the next one. */
typedef struct snow_resampled_slice {
    double at;                    /* slices */
    int64_t slice, before, after; /* the latter for differences */
    bool between, between_across; /* of the slice; of those two */
    bool one_sided;               /* the difference is of one step, not two */
    int16_t toward; /* from half way on to the next slice, of 32768; below 0
                       back to this one */
} snow_resampled_slice;

/* A phase of the cells on a resampled slice: cell i has its sample at i + at,
 * that is between voxels i + whole and i + whole + 1. */
typedef struct snow_value_place {
    double at[2]; /* along u and v */
    int32_t whole[2];
    int16_t weight[2]; /* of 32768 */
} snow_value_place;

/* Perspective: how the samples of a phase lie along an axis of a resampled
 * slice.  Lane n is between voxels first + at[n] and first + at[n] + 1; lane 0
 * is the cell before the first one of a tile. */
#define SNOW_VALUE_LANES (SNOW_VALUE_ROWS + 2)
#define SNOW_VALUE_MASK_WORDS 10 /* that 32 of them may need */
/* The most times that samples of the last resampled slice are farther apart
 * than those of the first. */
#define SNOW_VALUE_SPREAD_MOST 8
typedef struct snow_value_lanes {
    double start; /* of lane 0, voxels */
    int32_t first, word;
    int16_t at[SNOW_VALUE_LANES], weight[SNOW_VALUE_LANES]; /* of 32768 */
    /* Their bits in words of a mask (encode/shear_warp/store.h), from `word`
     * on. */
    uint32_t select[SNOW_VALUE_MASK_WORDS];
} snow_value_lanes;

/* Perspective: how far apart samples are on a resampled slice. */
typedef struct snow_value_spread {
    double step;  /* voxels a cell of the front resampled slice's voxels */
    int apart[2]; /* samples from one to those of its gradient, along u and v */
    int16_t stretch[2]; /* what these lack to two voxels: a difference's factor
                           less 1, of 32768 */
} snow_value_spread;

/* Perspective: every sample has its own ray.  A ray moves (du, dv, 1) voxels
 * from one slice to the next. */
typedef struct snow_value_rays {
    const snow_value_lanes *lanes[2]; /* [(resampled slice * phases + phase) *
                                         tiles + tile], along u and v */
    const snow_value_spread *resampled_slices;
    int64_t stored[2];       /* the first voxel of the store */
    int phases[2], tiles[2]; /* of a cell, of the image */
    int cells[2], middles;   /* samples a voxel; 2: of a quincunx */
    int line;                /* phases from one to that a cell on along v */
    uint8_t cell[SNOW_VALUE_PHASES][2]; /* of a phase, along u and v; and its */
    uint8_t spot[SNOW_VALUE_PHASES][2]; /* place among the phases of an axis */
    double slope[2][2]; /* du and dv of phase 0 of cell 0, and from there to
                           the next phase */
    float metric[6];    /* squared length of a ray's way: as snow_value_light */
    float usual;        /* 1 / the length that the table is for */
    float toward;       /* 1 where slices fall away from the eye, else -1 */
    float aside[3];     /* the way's part along the distant light */
} snow_value_rays;

/* Light from gradients (gu, gv, gp) in index space, of any length: of a distant
 * light and of a head light, one of which may have no share. */
typedef struct snow_value_light {
    float light[3], eye[3], half[3]; /* n . l times |g| */
    float metric[6];                 /* |g|^2: uu vv pp uv up vp */
    bool distant, head;              /* which of them there are */
    bool square;                     /* the last three of metric are 0 */
    bool bright;                     /* ambient + diffuse are more than 1 */
    float ambient, diffuse[2], specular[2]; /* of the distant, of the head */
    uint32_t power;                         /* shininess * 2^SNOW_VALUE_ROOTS */
    float least;                            /* n . h below it does not shine */
} snow_value_light;
#define SNOW_VALUE_ROOTS 8

/* Gradient opacity: factors of the opacity of a reference length. */
typedef struct snow_value_fade {
    const snow_transfer *transfer;
    const snow_value_scale14 *scale;
    bool log;        /* values are logarithms; labels have none */
    float metric[6]; /* |gradient|^2 in data units: uu vv pp uv up vp */
    float share;     /* a slab's length, in reference lengths */
} snow_value_fade;

/* An opaque surface where quantized values reach `at`; the table hides what is
 * below. */
typedef struct snow_value_surface {
    float at;
    int16_t color[4]; /* of 32767; of two channels the first and the last */
} snow_value_surface;

/* What becomes of the slabs of a ray. */
typedef enum snow_value_reduction {
    SNOW_VALUE_OVER,     /* colours */
    SNOW_VALUE_LARGEST,  /* of the values at their ends */
    SNOW_VALUE_SMALLEST, /* the same, of quantized values SNOW_VALUE_MOST - V */
    SNOW_VALUE_SUM       /* of both ends' values by their lengths */
} snow_value_reduction;

/* A picture. */
typedef struct snow_value_splat {
    const snow_value_store *store;
    const snow_value_table *table;
    const snow_value_light *light;     /* NULL: unshaded */
    const snow_value_fade *fade;       /* NULL: none */
    const snow_value_surface *surface; /* NULL: colours by the table */
    const snow_resampled_slice *resampled_slices;
    const snow_value_place *places; /* [resampled * phases + phase] */
    const snow_value_rays *rays;    /* perspective; NULL: places are used */
    int resampled_count, phases;
    int channels;           /* 2 or 4 */
    int16_t closed;         /* alpha that ends a pixel, of 32767 */
    int64_t first[2];       /* cell of the lattice: lane 1 of tile 0; row 0 */
    int64_t cells[2];       /* of the lattice */
    double low[2], high[2]; /* the field's ends along u and v */
    const snow_value_labels *labels; /* NULL: values */
    bool labels_nearest;             /* not by membership */
    const double (*clips)[4]; /* seen is where a u + b v + c slice <= d */
    size_t clip_count;
    int slabs[2]; /* that are drawn: slab n is between resampled slices n and n
                     + 1 */
    bool parted;  /* only samples of slabs whose front resampled slice has them
                    within  own[0][0] <= u < own[0][1], and so along v */
    double own[2][2];
    bool resumes; /* the planes hold what is in front; of over only */
    snow_value_reduction reduction;
    bool leans;   /* samples are lit by the border of a mask */
    bool borders; /* there is room for such, of this or of layers */
    bool floats;  /* planes are of floats: the table is faint, or of sums, or
                     there are several layers */
} snow_value_splat;

/* Pixels of a tile: planes of 15 bits, of which channels are used; of floats
 * where `floats` says so.  Extremes have quantized values in the
 * first plane, below 0 where there is none; sums 2 V in the first one, and the
 * lengths, in those that the table is for, in the last. */
typedef int16_t snow_value_plane[4][SNOW_VALUE_ROWS][32];
typedef float snow_value_faint_plane[4][SNOW_VALUE_ROWS][32];

/* Bytes of the planes of all phases. */
static inline size_t snow_value_planes_bytes(const snow_value_splat *splat) {
    return (size_t)splat->phases * (splat->floats
                                        ? sizeof(snow_value_faint_plane)
                                        : sizeof(snow_value_plane));
}

/* Bytes of a worker's memory. */
size_t snow_value_splat_bytes(const snow_value_splat *splat);

/* The slabs of a tile that have cells that no interval hides, in perspective
 * all: the indices of their front resampled slices, front to back; returns how
 * many. */
int snow_value_list(const snow_value_splat *splat, const int tile[2],
                    int32_t *out);

/* Draws tile (x, y); false: nothing is there.  `sloped`: with gradients, for
 * light or gradient opacity.  `scratch` is aligned to 64; the
 * planes of each phase are in it from its beginning on. */
typedef bool snow_value_tile_fn(const snow_value_splat *splat, int x, int y,
                                void *scratch);
snow_value_tile_fn *snow_value_tile_of(snow_isa isa, int channels, bool sloped,
                                       bool perspective);
/* The same of reductions other than over. */
snow_value_tile_fn *snow_value_projection_of(snow_isa isa,
                                             snow_value_reduction reduction,
                                             bool perspective);

#endif
