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
