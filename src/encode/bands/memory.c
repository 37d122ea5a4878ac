/* encode/bands/memory.c - the buffers of a band, which grow as it is encoded.
 */
#include "encode/bands/internal.h"

#include <string.h>

/* Replaces a buffer by one of `bytes` bytes; the first `keep` are copied. */
static snow_status replace_buffer(snow_context *context, void *block_pointer,
                                  size_t *capacity, size_t keep, size_t bytes) {
    void *old, *copy = snow_allocate(context, bytes);
    if (!copy)
        return SNOW_STATUS_NO_MEMORY;
    memcpy(&old, block_pointer, sizeof old);
    if (keep)
        memcpy(copy, old, keep);
    snow_release(context, old);
    memcpy(block_pointer, &copy, sizeof copy);
    *capacity = bytes;
    return SNOW_STATUS_OK;
}

/* As snow_reserve. Bands that are encoded piecewise grow together, by an eighth
 * each, so that they have little unused memory in sum. */
static snow_status reserve(snow_context *context, bool piecewise,
                           void *block_pointer, size_t *capacity, size_t keep,
                           size_t bytes) {
    if (!piecewise)
        return snow_reserve(context, block_pointer, capacity, keep, bytes);
    if (bytes <= *capacity)
        return SNOW_STATUS_OK;
    size_t wanted = *capacity + *capacity / 8;
    return replace_buffer(context, block_pointer, capacity, keep,
                          wanted > bytes ? wanted : bytes);
}

snow_status snow_band_reserve(snow_sparse *band, bool piecewise,
                              bool with_normals, bool with_gradient_factors) {
    snow_context *context = band->context;
    size_t voxels = (size_t)band->columns * (size_t)band->rows;
    size_t size = (size_t)band->code_bytes, word = sizeof(uint16_t);
    size_t begin = band->ia_voxels, end = band->ia_voxels + voxels;
    SNOW_TRY(reserve(context, piecewise, &band->codes, &band->codes_capacity,
                     begin * size, end * size + SNOW_ROW_MARGIN));
    if (with_normals)
        SNOW_TRY(reserve(context, piecewise, &band->normals,
                         &band->normals_capacity, begin * word,
                         end * word + SNOW_ROW_MARGIN));
    if (with_gradient_factors)
        SNOW_TRY(reserve(context, piecewise, &band->gradient_factors,
                         &band->gradient_factors_capacity, begin * word,
                         end * word + SNOW_ROW_MARGIN));
    return SNOW_STATUS_OK;
}

/* Shrinks a buffer to the `bytes` that it holds if it is more than an eighth
 * longer. Without memory for the copy it stays as it is. */
static void trim(snow_context *context, void *block_pointer, size_t *capacity,
                 size_t bytes) {
    if (bytes<*capacity && * capacity - bytes> * capacity / 8)
        (void)replace_buffer(context, block_pointer, capacity, bytes, bytes);
}

void snow_band_trim(snow_sparse *band) {
    snow_context *context = band->context;
    size_t voxels = band->ia_voxels, words = voxels * sizeof(uint16_t);
    trim(context, &band->ea, &band->ea_capacity,
         band->ea_bytes + SNOW_EA_MARGIN);
    trim(context, &band->codes, &band->codes_capacity,
         voxels * (size_t)band->code_bytes + SNOW_ROW_MARGIN);
    trim(context, &band->normals, &band->normals_capacity,
         words + SNOW_ROW_MARGIN);
    trim(context, &band->gradient_factors, &band->gradient_factors_capacity,
         words + SNOW_ROW_MARGIN);
}
