/* encode/bands/internal.h - what the files of this folder share:
 *
 *   bands.c    the bands of a slab, one work item each
 *   slice.c    a slice of a band
 *   memory.c   the buffers of a band
 *   density.c  which encoding is the smallest */
#ifndef SNOW_ENCODE_BANDS_INTERNAL_H
#define SNOW_ENCODE_BANDS_INTERNAL_H

#include "encode/bands/bands.h"
#include "encode/fetch.h"
#include "encode/rows.h"

#include <stdatomic.h>

/* Source and destination of a band's slices, for all threads. */
typedef struct snow_encode_job {
    snow_bands *bands;
    const snow_bands_params *params;
    snow_bands_piece piece; /* the part of the bands that the params are for */
    bool anew;              /* the bands begin with it */
    const snow_scheme *scheme;
    snow_row_encoder rows;
    unsigned char *scratch;
    size_t scratch_bytes; /* of one thread */
    atomic_int failed;    /* the last failure's snow_status */
} snow_encode_job;

/* The scratch memory of a thread: masks of a slice of a band, columns of a row,
 * and the scratch of snow_fetch. */
typedef struct snow_row_buffers {
    uint64_t *masks;
    uint32_t *columns;
    unsigned char *fetch;
} snow_row_buffers;

snow_row_buffers snow_row_buffers_of(const snow_encode_job *job, int worker);

/* Rows first_row .. first_row + rows - 1 of slices of the volume. */
snow_fetch_params snow_band_fetch_params(const snow_bands_params *params,
                                         int64_t first_slice, int64_t slices,
                                         int64_t first_row, int64_t rows);

/* Encodes a slice behind those that the band has. */
snow_status snow_band_encode_slice(const snow_encode_job *job,
                                   const snow_row_buffers *buffers,
                                   snow_fetch *fetch, snow_sparse *band,
                                   int64_t first_row, int64_t slice);

/* Applies a gradient opacity to voxels that are interesting by value: `rows` of
 * a slice, in bands from `voxel` on. Returns the number that remain
 * interesting. */
size_t snow_band_apply_gradient_opacity(const snow_bands_params *params,
                                        const snow_rows *rows,
                                        const snow_row_buffers *buffers,
                                        snow_sparse *band,
                                        snow_gradient_opacity_row row,
                                        size_t voxel);

/* Reserves IA for a slice of a band in which every voxel is interesting. Bands
 * that are encoded piecewise grow by little. */
snow_status snow_band_reserve(snow_sparse *band, bool piecewise,
                              bool with_normals, bool with_gradient_factors);

/* Frees the unused memory of a full band. */
void snow_band_trim(snow_sparse *band);

/* Measures rows of the slab (without intermediate slices) and chooses its
 * encoding. */
snow_status snow_bands_choose_encoding(snow_encode_job *job);

#endif
