/* render/shear_warp/encoding_cache.h - when the bands of one look serve
 * another.
 *
 * A look that shows a part of what was encoded can be drawn from it: codes that
 * it does not show have samples of zeros, and the picture has the same bits.
 * So a threshold or a curve that is moved to and fro encodes once, where it
 * shows most.  Voxels that are not shown cost time, however, picture for
 * picture; as long as all of that is less than what another encoding would
 * cost, the old one is kept (the ski rental problem: never more than twice the
 * cost of having known). */
#ifndef SNOW_RENDER_SHEAR_WARP_ENCODING_CACHE_H
#define SNOW_RENDER_SHEAR_WARP_ENCODING_CACHE_H

#include "encode/bands/bands.h"

/* What is known of the bands; zeros at first. */
typedef struct snow_encoding_cache {
    unsigned char *keep; /* per code: whether the bands may hold it */
    uint64_t *held;      /* per code: how many voxels they hold, if counted */
    bool counted;
    int64_t all, shown; /* voxels of the bands; of them, of the last look */
    double wasted;      /* voxels not shown over all, of all pictures */
    size_t keep_capacity, held_capacity; /* bytes */
} snow_encoding_cache;

/* After an encoding with this coder: all is shown.  `between` as it was
 * ordered; voxels of slices between are not counted.  Errors:
 * SNOW_STATUS_NO_MEMORY */
snow_status snow_encoding_cache_begin(snow_context *context,
                                      snow_encoding_cache *encoding_cache,
                                      const snow_bands *bands, bool between,
                                      const snow_quantizer *quantizer);

/* Whether codes are the same for all looks, as those of 8 and 16 bits are. */
static inline bool snow_encoding_cache_knows(const snow_quantizer *quantizer) {
    return snow_type_size(quantizer->type) <= 2;
}

/* Whether another picture is to be made of the bands, with this coder for the
 * same volume, that snow_encoding_cache_knows, and without a gradient opacity.
 * `price` is what an encoding costs, in pictures.  Errors:
 * SNOW_STATUS_NO_MEMORY. */
snow_status snow_encoding_cache_ask(snow_context *context,
                                    snow_encoding_cache *encoding_cache,
                                    const snow_bands *bands, bool between,
                                    const snow_quantizer *quantizer,
                                    double price, bool *serves);

void snow_encoding_cache_fini(snow_context *context,
                              snow_encoding_cache *encoding_cache);

#endif
