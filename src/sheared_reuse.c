/* sheared_reuse.c - the bookkeeping of sheared_reuse.h. */
#include "sheared_reuse.h"

#include <string.h>

/* Voxels of a band, without those of slices between. */
static int64_t count_band(const snow_bands *bands, const snow_sparse *band,
                          bool between) {
    int64_t count = 0;
    for (int64_t n = 0; between && n < bands->slices; n += 2)
        count += (int64_t)(band->pa[n + 1].ia - band->pa[n].ia);
    return between ? count : (int64_t)band->ia_voxels;
}

snow_status snow_reuse_begin(snow_context *context, snow_reuse *reuse,
                             const snow_bands *bands, bool between,
                             const snow_coder *coder) {
    reuse->counted = false;
    reuse->wasted = 0;
    reuse->all = 0;
    for (int64_t n = 0; n < bands->band_count; n++)
        reuse->all += count_band(bands, &bands->bands[n], between);
    reuse->shown = reuse->all;
    if (!snow_reuse_knows(coder))
        return SNOW_OK;
    SNOW_TRY(snow_reserve(context, &reuse->keep, &reuse->keep_capacity, 0,
                          coder->codes));
    memcpy(reuse->keep, coder->keep, coder->codes);
    return SNOW_OK;
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

static snow_status count_held(snow_context *context, snow_reuse *reuse,
                              const snow_bands *bands, bool between,
                              size_t codes) {
    SNOW_TRY(snow_reserve(context, &reuse->held, &reuse->held_capacity, 0,
                          codes * sizeof *reuse->held));
    memset(reuse->held, 0, codes * sizeof *reuse->held);
    for (int64_t n = 0; n < bands->band_count; n++) {
        const snow_sparse *band = &bands->bands[n];
        for (int64_t slice = 0; slice < bands->slices; slice += 1 + between)
            count_codes(snow_bands_codes(band, band->pa[slice].ia),
                        (size_t)(band->pa[slice + 1].ia - band->pa[slice].ia),
                        bands->code_bytes, reuse->held);
    }
    reuse->counted = true;
    return SNOW_OK;
}

/* Whether the bands hold all that a coder keeps; *same: and no more. */
static bool holds(const snow_reuse *reuse, const snow_coder *coder,
                  bool *same) {
    int lacks = 0, differs = 0;
    for (size_t code = 0; code < coder->codes; code++) {
        lacks |= coder->keep[code] & ~reuse->keep[code];
        differs |= coder->keep[code] ^ reuse->keep[code];
    }
    *same = !differs;
    return !lacks;
}

snow_status snow_reuse_ask(snow_context *context, snow_reuse *reuse,
                           const snow_bands *bands, bool between,
                           const snow_coder *coder, double price,
                           bool *serves) {
    bool same;
    *serves = holds(reuse, coder, &same);
    if (!*serves)
        return SNOW_OK;
    if (!same && !reuse->counted)
        SNOW_TRY(count_held(context, reuse, bands, between, coder->codes));
    reuse->shown = same ? reuse->all : 0;
    for (size_t code = 0; code < coder->codes && !same; code++)
        if (coder->keep[code])
            reuse->shown += (int64_t)reuse->held[code];
    if (reuse->shown < reuse->all)
        reuse->wasted += 1 - (double)reuse->shown / (double)reuse->all;
    *serves = same || reuse->wasted <= price;
    return SNOW_OK;
}

void snow_reuse_fini(snow_context *context, snow_reuse *reuse) {
    snow_release(context, reuse->keep);
    snow_release(context, reuse->held);
    *reuse = (snow_reuse){0};
}
