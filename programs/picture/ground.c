/* ground.c - whether colours of voxels lie on a white ground, as sections in a
 * bright field do: its voxels are clear in a volume.
 *
 * The middle slice of the file is read for it before the volume is, so that it
 * is the same for slabs, for ranks and for what a viewer shows. */
#include "commands/commands.h"
#include "picture/channels.h"
#include "picture/light.h"

#include <string.h>

bool channels_are_picture(const snow_volume_info *info) {
    const int64_t *n = info->dims;
    for (int i = 0; i < 3; i++)
        if (n[i] <= 5 && n[(i + 1) % 3] >= (n[i] > 1 ? 16 * n[i] : 2) &&
            n[(i + 2) % 3] >= (n[i] > 1 ? 16 * n[i] : 2))
            return true;
    return false;
}

/* Red, green and blue of the voxels alone, as parts of a volume that has an
 * inside; opacities that are asked for stay as they are. */
static bool may_have_ground(const options *opts, const snow_volume_info *info,
                            const channel_list *list) {
    bool own = list->count == 3 && !channels_are_picture(info) &&
               !opts->opacities.count && strcmp(opts->mode, "over") == 0;
    int64_t parts = 0;
    for (int n = 0; n < list->count && own; n++) {
        const int64_t index = list->picks[n].index;
        own = index < 3 && info->channel[index].own;
        parts |= INT64_C(1) << index;
    }
    return own && parts == 7;
}

/* What cannot be read is said where the volume is. */
static double look_at_middle(const options *opts,
                             const snow_volume_info *info) {
    snow_context *context = NULL;
    snow_volume *parts[3] = {NULL};
    double levels[3][2], white = 0;
    snow_volume_options data = data_options(opts);
    data.channel_given = true;
    data.crop[2][0] += info->dims[2] / 2;
    data.crop[2][1] = data.crop[2][0] + 1;
    bool fine = snow_context_new(NULL, &context) == SNOW_STATUS_OK;
    for (int c = 0; c < 3 && fine; c++) {
        data.channel = c;
        memcpy(levels[c], info->channel[c].window, sizeof levels[c]);
        fine = snow_volume_open(context, opts->operands[0], &data, &parts[c]) ==
               SNOW_STATUS_OK;
    }
    if (fine)
        fine = light_find_ground((const snow_volume *const *)parts,
                                 (const double(*)[2])levels, 0,
                                 &white) == SNOW_STATUS_OK;
    for (int c = 0; c < 3; c++)
        snow_volume_close(parts[c]);
    snow_context_free(context);
    return fine ? white : 0;
}

void channels_find_ground(const options *opts, const snow_volume_info *info,
                          channel_set *c) {
    const bool may = may_have_ground(opts, info, &c->list);
    if (may && !c->ground.known)
        c->ground = (channels_ground){true, look_at_middle(opts, info)};
    for (int n = 0; n < c->list.count; n++)
        c->list.picks[n].white = may ? c->ground.white : 0;
}
