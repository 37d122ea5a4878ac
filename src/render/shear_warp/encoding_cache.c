/* render/shear_warp/encoding_cache.c - the bookkeeping of encoding_cache.h. */
#include "render/shear_warp/encoding_cache.h"

#include <string.h>

/* Voxels of a band, without those of slices between. */
static int64_t count_band(const snow_bands *bands, const snow_sparse *band,
                          bool between) {
    int64_t count = 0;
    for (int64_t n = 0; between && n < bands->slices; n += 2)
        count += (int64_t)(band->pa[n + 1].ia - band->pa[n].ia);
    return between ? count : (int64_t)band->ia_voxels;
}

snow_status snow_encoding_cache_begin(snow_context *context,
                                      snow_encoding_cache *encoding_cache,
                                      const snow_bands *bands, bool between,
                                      const snow_quantizer *quantizer) {
    encoding_cache->counted = false;
    encoding_cache->wasted = 0;
    encoding_cache->all = 0;
    for (int64_t n = 0; n < bands->band_count; n++)
        encoding_cache->all += count_band(bands, &bands->bands[n], between);
    encoding_cache->shown = encoding_cache->all;
    if (!snow_encoding_cache_knows(quantizer))
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_reserve(context, &encoding_cache->keep,
                          &encoding_cache->keep_capacity, 0, quantizer->codes));
    memcpy(encoding_cache->keep, quantizer->keep, quantizer->codes);
    return SNOW_STATUS_OK;
}

static void count_codes(const unsigned char *codes, size_t voxels, int bytes,
                        uint64_t *held) {
    for (size_t n = 0; n < voxels; n++) {
        uint16_t code = codes[n];
        if (bytes == 2)
            memcpy(&code, codes + 2 * n, sizeof code);
        held[code]++;
    }
}

static snow_status count_held(snow_context *context,
                              snow_encoding_cache *encoding_cache,
                              const snow_bands *bands, bool between,
                              size_t codes) {
    SNOW_TRY(snow_reserve(context, &encoding_cache->held,
                          &encoding_cache->held_capacity, 0,
                          codes * sizeof *encoding_cache->held));
    memset(encoding_cache->held, 0, codes * sizeof *encoding_cache->held);
    for (int64_t n = 0; n < bands->band_count; n++) {
        const snow_sparse *band = &bands->bands[n];
        for (int64_t slice = 0; slice < bands->slices; slice += 1 + between)
            count_codes(snow_bands_codes(band, band->pa[slice].ia),
                        (size_t)(band->pa[slice + 1].ia - band->pa[slice].ia),
                        bands->code_bytes, encoding_cache->held);
    }
    encoding_cache->counted = true;
    return SNOW_STATUS_OK;
}

/* Whether the bands hold all that a coder keeps; *same: and no more. */
static bool holds(const snow_encoding_cache *encoding_cache,
                  const snow_quantizer *quantizer, bool *same) {
    int lacks = 0, differs = 0;
    for (size_t code = 0; code < quantizer->codes; code++) {
        lacks |= quantizer->keep[code] & ~encoding_cache->keep[code];
        differs |= quantizer->keep[code] ^ encoding_cache->keep[code];
    }
    *same = !differs;
    return !lacks;
}

snow_status snow_encoding_cache_ask(snow_context *context,
                                    snow_encoding_cache *encoding_cache,
                                    const snow_bands *bands, bool between,
                                    const snow_quantizer *quantizer,
                                    double price, bool *serves) {
    bool same;
    *serves = holds(encoding_cache, quantizer, &same);
    if (!*serves)
        return SNOW_STATUS_OK;
    if (!same && !encoding_cache->counted)
        SNOW_TRY(count_held(context, encoding_cache, bands, between,
                            quantizer->codes));
    encoding_cache->shown = same ? encoding_cache->all : 0;
    for (size_t code = 0; code < quantizer->codes && !same; code++)
        if (quantizer->keep[code])
            encoding_cache->shown += (int64_t)encoding_cache->held[code];
    if (encoding_cache->shown < encoding_cache->all)
        encoding_cache->wasted +=
            1 - (double)encoding_cache->shown / (double)encoding_cache->all;
    *serves = same || encoding_cache->wasted <= price;
    return SNOW_STATUS_OK;
}

void snow_encoding_cache_fini(snow_context *context,
                              snow_encoding_cache *encoding_cache) {
    snow_release(context, encoding_cache->keep);
    snow_release(context, encoding_cache->held);
    *encoding_cache = (snow_encoding_cache){0};
}
