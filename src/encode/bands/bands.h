/* encode/bands/bands.h - the sparse matrix of the shear-warp method: the
 * paper's EA, IA and PA (section 3), once for each band of rows.
 *
 *        v                      band 1: rows 32 .. 63 of every slice
 *        |  +-----------+       +-- its own EA, IA, PA[slice]
 *     64 +  |  band 2   |       |
 *        |  +-----------+ <-----+
 *     32 +  |  band 1   |
 *        |  +-----------+       IA: codes (classify/codes.h); with shading,
 *      0 +  |  band 0   |           normals (classify/shading/normals.h); with
 *           +-----------+--- u      gradient opacity, factors
 *                                   (classify/gradient_opacity.h)
 *
 * A thread encodes or reads whole bands, front to back, so no two threads share
 * data. The same three schemes write EA, and all are read as the same spans. */
#ifndef SNOW_BANDS_H
#define SNOW_BANDS_H

#include "classify/codes.h"
#include "classify/shading/normals.h"
#include "encode/encode.h"

#define SNOW_BAND_ROWS 32

typedef struct snow_bands {
    snow_context *context;
    snow_sparse *bands;
    int64_t band_count;     /* ceil(rows / SNOW_BAND_ROWS) */
    size_t capacity;        /* of bands, bytes */
    unsigned char *scratch; /* of the threads, while encoding */
    size_t scratch_capacity;
    int64_t columns, rows, slices;
    int code_bytes;
    bool with_normals, with_gradient_factors;
    snow_encoding encoding; /* as chosen */
    uint64_t voxels;        /* number of interesting voxels */
    uint64_t ea_bytes, ia_bytes, pa_bytes;
} snow_bands;

/* The input of an encoding, and its options. */
typedef struct snow_bands_params {
    const snow_volume *volume;
    const snow_placement *placement;
    const snow_quantizer *quantizer;
    const snow_normal_maker *maker; /* NULL: no normals */
    const snow_gradient_opacity
        *gradient_opacity;  /* NULL: no gradient opacity */
    snow_encoding encoding; /* AUTO: chosen by measured density and runs */
    int64_t first_slice, slice_count; /* the slab; slice 0 of the bands is
                                         first_slice of the volume */
    bool between; /* with a slice half-way between each two: slice n of the
                     bands is slice n/2 of the slab, or for odd n the mean of
                     slices (n-1)/2 and (n+1)/2: of native values (integers:
                     halves rounded up) and of gradients; 2 slice_count - 1
                     slices in all */
    snow_isa isa; /* resolved */
    int threads;
} snow_bands_params;

/* Encodes a slab; the buffers of an earlier encoding are reused. The bytes do
 * not depend on the instruction set or the number of threads. Errors:
 * SNOW_STATUS_BAD_USAGE (a slice of 2^32 voxels or more),
 * SNOW_STATUS_NO_MEMORY; then the bands cannot be read, but may be encoded
 * again. */
snow_status snow_bands_encode(snow_bands *bands,
                              const snow_bands_params *params);

/* The same for a volume that is never in memory as a whole. A piece of it holds
 * all rows of some bands in some slices:
 *
 *   v        whole slices of some bands      some slices of all bands
 *   |  band 2 +-----------+                  +--+--+-----+
 *   |  band 1 |===========|  append here     |  |==|     |  append here
 *   |  band 0 +-----------+                  +--+--+-----+
 *             +---------------> slices
 *
 * The params of a piece are those of a part of the volume, with more voxels
 * around it where gradients need them. With `between`, slice_count includes the
 * slice after the last one. */
typedef struct snow_bands_piece {
    int64_t first_band, band_count;
    int64_t first_row; /* of the first of these bands, in the placement of the
                          piece's params */
    int64_t slices;    /* number of slices appended to each of these bands */
} snow_bands_piece;

/* Begins with the params of the whole volume; of its volume and placement only
 * the sizes are used, and AUTO means the bit-map. Pieces of a band are added in
 * the order of slices; a full band frees its unused memory. snow_bands_end adds
 * up the figures. The bands equal those of snow_bands_encode. Errors: as there.
 */
snow_status snow_bands_begin(snow_bands *bands,
                             const snow_bands_params *params);
snow_status snow_bands_append(snow_bands *bands,
                              const snow_bands_params *params,
                              const snow_bands_piece *piece);
void snow_bands_end(snow_bands *bands);

/* Frees the buffers; the record may be all zeros except for its context. */
void snow_bands_fini(snow_bands *bands);

/* To read: snow_walk_begin(&walk, &bands->bands[band], slice), then
 * snow_walk_row for each row of the band. `voxel` is an index into these
 * arrays. */
static inline const unsigned char *snow_bands_codes(const snow_sparse *band,
                                                    size_t voxel) {
    return band->codes + voxel * (size_t)band->code_bytes;
}

static inline const uint16_t *snow_bands_normals(const snow_sparse *band,
                                                 size_t voxel) {
    return band->normals + voxel;
}

static inline const uint16_t *
snow_bands_gradient_factors(const snow_sparse *band, size_t voxel) {
    return band->gradient_factors + voxel;
}

#endif
