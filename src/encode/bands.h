/* encode/bands.h - the sparse matrix of the sheared method: the paper's EA, IA
 * and PA (section 3), once for each band of rows.
 *
 *        v                      band 1: rows 32 .. 63 of every slice
 *        |  +-----------+       +-- EA, IA, PA[slice] of its own
 *     64 +  |  band 2   |       |
 *        |  +-----------+ <-----+
 *     32 +  |  band 1   |
 *        |  +-----------+       IA: codes (classify/codes.h), and normals
 *      0 +  |  band 0   |           (classify/normals.h) where shading is on,
 *           +-----------+--- u      factors (classify/fade.h) where opacity
 *                                   depends on gradients
 *
 * A thread encodes or reads whole bands, front to back, and meets nobody.  The
 * same three schemes write EA, and they are read as the same spans. */
#ifndef SNOW_BANDS_H
#define SNOW_BANDS_H

#include "classify/codes.h"
#include "classify/normals.h"
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
    bool with_normals, with_fades;
    snow_encoding encoding; /* as chosen */
    uint64_t voxels;        /* interesting ones */
    uint64_t ea_bytes, ia_bytes, pa_bytes;
} snow_bands;

/* What is encoded, and how. */
typedef struct snow_bands_order {
    const snow_volume *volume;
    const snow_placement *placement;
    const snow_coder *coder;
    const snow_normal_maker *maker;   /* NULL: no normals */
    const snow_fader *fader;          /* NULL: no gradient opacity */
    snow_encoding encoding;           /* AUTO: by measured density and runs */
    int64_t first_slice, slice_count; /* the slab; slice 0 of the bands is
                                         first_slice of the volume */
    bool between; /* with a slice half-way between each two: slice n of the
                     bands is slice n/2 of the slab, or for odd n the mean of
                     slices (n-1)/2 and (n+1)/2, of native values (of
                     integers, halves rounded up) as of gradients;
                     2 slice_count - 1 slices in all */
    snow_isa isa; /* resolved */
    int threads;
} snow_bands_order;

/* Encodes anew; buffers are kept from one time to the next.  The bytes are the
 * same for every level and number of threads.  Errors: SNOW_BAD_USAGE (a slice
 * of 2^32 voxels or more), SNOW_NO_MEMORY; then the bands hold nothing to be
 * read, but may be encoded again. */
snow_status snow_bands_encode(snow_bands *bands, const snow_bands_order *order);

/* The same of a volume that is never there as a whole.  A piece of it holds all
 * rows of some bands of some slices:
 *
 *   v        whole slices of some bands      some slices of all bands
 *   |  band 2 +-----------+                  +--+--+-----+
 *   |  band 1 |===========|  append here     |  |==|     |  append here
 *   |  band 0 +-----------+                  +--+--+-----+
 *             +---------------> slices
 *
 * The order of a piece is that of a part of the volume, with more voxels around
 * it where gradients want them; its slice_count has the slice behind the last
 * one too where `between` wants that. */
typedef struct snow_bands_piece {
    int64_t first_band, band_count;
    int64_t first_row; /* of the first of these bands, in the placement of the
                          piece's order */
    int64_t slices;    /* of the bands that are appended to each of them */
} snow_bands_piece;

/* Begins with the order of the whole, of whose volume and placement only the
 * sizes count; AUTO is the bit-map.  Pieces of a band come in the order of
 * slices; a band that is full gives back what its buffers have to spare.  The
 * end adds up the figures.  Bands are the same as by snow_bands_encode. Errors:
 * as there. */
snow_status snow_bands_begin(snow_bands *bands, const snow_bands_order *order);
snow_status snow_bands_append(snow_bands *bands, const snow_bands_order *order,
                              const snow_bands_piece *piece);
void snow_bands_end(snow_bands *bands);

/* Frees the buffers; the record may be all zeros but for its context. */
void snow_bands_fini(snow_bands *bands);

/* Reading: snow_walk_begin(&walk, &bands->bands[band], slice), then
 * snow_walk_row for each row of the band.  `voxel` counts into these. */
static inline const unsigned char *snow_bands_codes(const snow_sparse *band,
                                                    size_t voxel) {
    return band->codes + voxel * (size_t)band->code_bytes;
}

static inline const uint16_t *snow_bands_normals(const snow_sparse *band,
                                                 size_t voxel) {
    return band->normals + voxel;
}

static inline const uint16_t *snow_bands_fades(const snow_sparse *band,
                                               size_t voxel) {
    return band->fades + voxel;
}

#endif
