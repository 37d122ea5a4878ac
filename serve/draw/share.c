/* share.c - implements share.h: what was counted with an encoding is of the
 * look that it was made for, and later looks are drawn from the same encoding.
 */
#include "draw/share.h"

#include "run/start.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A count of so many takes less than a picture at rest. */
#define COUNTED_MOST (INT64_C(1) << 26)

static bool counts_fast(const drawing *d) {
    const render_state *s = &d->state;
    const snow_volume_info *info = snow_volume_get_info(s->volume);
    snow_look look = {.size = sizeof look};
    return process_ranks() == 1 && !s->channels.list.count &&
           snow_volume_voxels(s->volume) &&
           info->dims[0] * info->dims[1] * info->dims[2] <= COUNTED_MOST &&
           snow_transfer_get_look(s->transfer, &look) == SNOW_STATUS_OK &&
           !look.gradient_opacity_count;
}

static double count(const drawing *d) {
    const render_state *s = &d->state;
    double share;
    return counts_fast(d) && snow_transfer_sparse_ratio(
                                 s->transfer, s->volume, s->settings.threshold,
                                 &share) == SNOW_STATUS_OK
               ? share
               : NAN;
}

/* What the share depends on. */
static char *key_now(const drawing *d) {
    json_t *tree = json_pack("[s?, s?, f]", d->data_key, d->look_key,
                             d->state.settings.threshold);
    char *key = json_dumps(tree, JSON_COMPACT);
    json_decref(tree);
    return key;
}

double share_hidden(drawing *d, bool may_count) {
    const snow_stats *stats = &d->state.stats;
    const bool fresh = stats->encoded ||
                       stats->method != SNOW_METHOD_SHEAR_WARP ||
                       !d->state.volume || !d->state.transfer;
    char *key = key_now(d);
    if (!d->share_key || !key || strcmp(d->share_key, key) != 0)
        d->share = NAN;
    free(d->share_key);
    d->share_key = key;
    if (fresh)
        d->share = stats->sparse_ratio;
    else if (isnan(d->share) && may_count)
        d->share = count(d);
    return d->share;
}
