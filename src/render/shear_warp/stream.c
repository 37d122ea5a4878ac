/* render/shear_warp/stream.c - lines 04 to 06 of a volume whose voxels stay in
 * their file (volume/stream.h): slab after slab is read, encoded and dropped;
 * what is kept are the bands, the same as of a volume in memory, so that all
 * that follows is the same too.
 *
 *   slices along z: a slab is some slices of all bands
 *   along x and y:  rows lie along z, and a slab is all slices of some bands,
 *                   32 rows each; no less will do
 *
 * What does not fit is counted before it is refused, so that the user knows how
 * far from fitting it is. */
#include "volume/stream.h"
#include "classify/count_interesting.h"
#include "render/shear_warp/internal.h"

#include <stdio.h>
#include <string.h>

/* One pass over the slabs. */
typedef struct reading {
    snow_shear_warp *shear_warp;
    const snow_shear_warp_params *params;
    const snow_encoded_key *key;
    int64_t interesting;
} reading;

static bool along_z(const reading *r) {
    return r->params->placement->slice_axis == 2;
}

/* What a slab is cut like for the encoding. */
static snow_slab_cut cut_of(const reading *r) {
    const snow_encoded_key *key = r->key;
    snow_slab_cut cut = {.step = along_z(r) ? 1 : SNOW_BAND_ROWS,
                         .ghosts = key->shaded || key->with_gradient_opacity};
    if (key->between && along_z(r))
        cut.ghosts++;
    return cut;
}

/* --- slabs to bands ------------------------------------------------------- */

/* Some slices of all bands: those that the slab answers for, each with the one
 * between it and the next. */
static snow_bands_piece slices_of(const reading *r, const snow_extent *part,
                                  snow_bands_params *bands) {
    int64_t own = part->count[2];
    bool last = part->first[2] + own == part->dims[2];
    bands->first_slice = part->first[2] - part->stored[2];
    bands->slice_count = own + (r->key->between && !last);
    return (snow_bands_piece){
        .band_count = r->shear_warp->bands.band_count,
        .slices = r->key->between ? 2 * own - last : own,
    };
}

/* All slices of some bands. */
static snow_bands_piece bands_of(const reading *r, const snow_extent *part) {
    return (snow_bands_piece){
        .first_band = part->first[2] / SNOW_BAND_ROWS,
        .band_count = (part->count[2] + SNOW_BAND_ROWS - 1) / SNOW_BAND_ROWS,
        .first_row = part->first[2] - part->stored[2],
        .slices = r->shear_warp->bands.slices,
    };
}

static snow_status encode_slab(const snow_volume *slab, void *user) {
    const reading *r = user;
    snow_band_tools tools;
    snow_bands_params bands;
    snow_clip clip;
    snow_extent part;
    snow_volume_find_extent(slab, &part);
    snow_clip_make(slab, r->params->placement, &clip);
    SNOW_TRY(snow_shear_warp_bands_params(r->shear_warp, r->params, r->key,
                                          slab, &clip, &tools, &bands));
    snow_bands_piece piece =
        along_z(r) ? slices_of(r, &part, &bands) : bands_of(r, &part);
    return snow_bands_append(&r->shear_warp->bands, &bands, &piece);
}

static snow_status encode_slabs(reading *r) {
    const snow_shear_warp_params *params = r->params;
    snow_bands *encoded = &r->shear_warp->bands;
    snow_slab_cut cut = cut_of(r);
    snow_band_tools tools;
    snow_bands_params bands;
    snow_bands_fini(encoded); /* those of another axis are in the way */
    SNOW_TRY(snow_shear_warp_bands_params(r->shear_warp, params, r->key,
                                          params->volume, &params->clip, &tools,
                                          &bands));
    SNOW_TRY(snow_bands_begin(encoded, &bands));
    SNOW_TRY(snow_slabs_visit(params->volume, &cut, encode_slab, r));
    snow_bands_end(encoded);
    return SNOW_STATUS_OK;
}

/* --- what does not fit ---------------------------------------------------- */

static snow_status count_slab(const snow_volume *slab, void *user) {
    reading *r = user;
    int64_t count;
    SNOW_TRY(snow_count_interesting(slab, r->params->transfer,
                                    r->params->settings->threshold,
                                    r->params->settings->isa, &count));
    r->interesting += count;
    return SNOW_STATUS_OK;
}

/* EA takes about one byte for so many interesting voxels. */
#define PLACE_SHARE 7

static double encoded_bytes(const reading *r) {
    const snow_encoded_key *key = r->key;
    double bytes = r->shear_warp->quantizer.bytes + 1.0 / PLACE_SHARE;
    bytes += 2 * (key->shaded + key->with_gradient_opacity);
    return bytes * (double)r->interesting * (key->between ? 2 : 1);
}

#define MIB 0x1p20

/* A failure's message made one of numbers; it stays as it is where even
 * counting fails. */
static snow_status report_count(reading *r) {
    snow_context *context = r->shear_warp->context;
    const snow_volume *volume = r->params->volume;
    const int64_t *dims = volume->info.dims;
    const snow_slab_cut read = cut_of(r);
    const snow_slab_cut counted = {.step = 1,
                                   .ghosts = r->key->with_gradient_opacity};
    double all = (double)dims[0] * (double)dims[1] * (double)dims[2];
    char before[SNOW_MESSAGE_BYTES], limit[64];
    memcpy(before, context->message, sizeof before);
    snow_bands_fini(&r->shear_warp->bands);
    if (snow_slabs_visit(volume, &counted, count_slab, r) != SNOW_STATUS_OK)
        return snow_fail(context, SNOW_STATUS_NO_MEMORY, "%s", before);
    snow_print_limit(context, limit);
    return snow_fail(
        context, SNOW_STATUS_NO_MEMORY,
        "%s: %lld of %.0f voxels are interesting (%.3g %%) and take about %.1f "
        "MiB "
        "when encoded, which do not fit beside slabs of %.1f MiB%s; %sgive "
        "--crop or more memory",
        volume->path, (long long)r->interesting, all,
        100 * (double)r->interesting / all, encoded_bytes(r) / MIB,
        (double)snow_slab_bytes(volume, &read) / MIB, limit,
        r->params->settings->mode == SNOW_MODE_OVER
            ? "raise --threshold, make more values transparent, "
            : "");
}

snow_status snow_shear_warp_encode_stream(snow_shear_warp *s,
                                          const snow_shear_warp_params *params,
                                          const snow_encoded_key *key) {
    reading r = {.shear_warp = s, .params = params, .key = key};
    snow_status status = encode_slabs(&r);
    return status == SNOW_STATUS_NO_MEMORY ? report_count(&r) : status;
}
