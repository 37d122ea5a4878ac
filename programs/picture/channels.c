/* channels.c - see channels.h. */
#include "picture/channels.h"
#include "commands/commands.h"
#include "picture/light.h"
#include "picture/outputs.h"
#include "run/log.h"
#include "run/memory.h"
#include "run/start.h"

#include <snowglass/channels.h>
#include <stdio.h>
#include <string.h>

const char *channels_hinder(const options *opts) {
    const char *path = opts->operands[0];
    if (opts->one_channel)
        return "only pictures mix them";
    if (is_special(path))
        return "each is read in turn, and this input can be read once";
    if (strcmp(opts->mode, "slice") == 0)
        return NULL;
    if (strcmp(opts->mode, "over") != 0 && strcmp(opts->mode, "mip") != 0 &&
        strcmp(opts->mode, "minip") != 0)
        return "several need mode over, mip or minip";
    if (strcmp(opts->method, "original") == 0 ||
        strcmp(opts->method, "footprint") == 0)
        return "several need method shear-warp or raycast";
    if (strcmp(opts->kernel, "gauss") == 0 || strcmp(opts->kernel, "box") == 0)
        return "several need kernel tent or bspline";
    if (opts->depth || opts->depth_darkening > 0 || opts->occlusion > 0)
        return "depths and what is made of them are of one volume";
    return NULL;
}

void channels_note(const options *opts, const snow_volume_info *info,
                   const char *why) {
    if (opts->verbosity >= 0 && process_talks())
        say("note: channel 0 of %lld (counted from 0) is used; --channel N "
            "selects another%s%s",
            (long long)info->channels, why ? "; " : "", why ? why : "");
}

/* Light that passes through is shown only alone. */
static void note_others(const options *opts, const snow_volume_info *info) {
    const bool tells = opts->verbosity >= 0 && process_talks();
    for (int64_t n = 0; n < info->channels && tells && info->light; n++)
        if (!(info->light >> n & 1))
            say("note: channel %lld is of transmitted light and is left out; "
                "--channel %lld draws it",
                (long long)n, (long long)n);
}

static void note_directions(const options *opts) {
    if (opts->verbosity >= 0 && process_talks())
        say("note: directions of vectors are in colours, red |x|, green |y|, "
            "blue |z|, as bright as vectors are long; --colormap viridis shows "
            "lengths alone");
}

/* --- a white ground ---------------------------------------------------------
 *
 * Colours of voxels that lie on one, as sections in a bright field do, are
 * clear there.  The middle slice of the file is read for it before the volume
 * is, so that it is the same for slabs, for ranks and for what a viewer shows.
 */

/* Red, green and blue of the voxels alone, as parts of a volume that has an
 * inside; opacities that are asked for stay as they are. */
static bool may_have_ground(const options *opts, const snow_volume_info *info,
                            const channel_list *list) {
    bool own = list->count == 3 && !snow_channels_are_flat(info) &&
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
        fine = snow_channels_ground((const snow_volume *const *)parts,
                                    (const double(*)[2])levels, 0,
                                    &white) == SNOW_STATUS_OK;
    for (int c = 0; c < 3; c++)
        snow_volume_close(parts[c]);
    snow_context_free(context);
    return fine ? white : 0;
}

static void find_ground(const options *opts, const snow_volume_info *info,
                        channel_set *c) {
    const bool may = may_have_ground(opts, info, &c->list);
    if (may && !c->ground.known)
        c->ground = (channels_ground){true, look_at_middle(opts, info)};
    for (int n = 0; n < c->list.count; n++)
        c->list.picks[n].white = may ? c->ground.white : 0;
}

/* --- which are drawn ---------------------------------------------------------
 */

int channels_choose(const options *opts, const snow_volume_info *info,
                    const char *why, channel_set *out) {
    const channel_list *asked = &opts->channels;
    const int64_t there = info->channels > 1 ? info->channels : 1;
    channel_list list = *asked;
    char scratch[128];
    if (out->chosen)
        return CONTINUE;
    /* A look that was asked for is of one volume. */
    const bool one = opts->preset || opts->tf || opts->colormap ||
                     opts->component || opts->labels ||
                     options_given(opts, "channel");
    const bool directed = info->directions && strcmp(opts->mode, "slice") == 0;
    if (!asked->count && !one)
        directed ? channels_of_directions(&list)
                 : channels_of_file(info, &list);
    for (int n = 0; n < list.count; n++)
        list.picks[n].absolute = directed;
    if (!why && list.count > 1 &&
        !memory_holds(opts, info, list.count, scratch, sizeof scratch))
        why = scratch;
    if (asked->count && (opts->preset || opts->tf))
        return fail_usage("--channel: a list has colours of its own; remove "
                          "--preset and --tf, or give one channel");
    if (asked->count && why) {
        const int done = fail_usage("--channel: %s; give one channel, such as "
                                    "--channel %lld",
                                    why, (long long)asked->picks[0].index);
        return why == scratch ? SNOW_STATUS_NO_MEMORY : done;
    }
    for (int n = 0; n < asked->count; n++)
        if (asked->picks[n].index >= there)
            return fail_usage("--channel: channel %lld does not exist; the "
                              "voxels have %lld, counted from 0",
                              (long long)asked->picks[n].index,
                              (long long)there);
    if (!asked->count && (why || !list.count)) {
        if (info->channels > 1 && !options_given(opts, "channel") &&
            !opts->component)
            channels_note(opts, info, list.count ? why : NULL);
        list.count = 0;
    }
    if (!asked->count && list.count && info->channels > SNOW_CHANNELS_MAX &&
        opts->verbosity >= 0 && process_talks())
        say("note: the file has %lld channels, of which the first %d are "
            "taken; --channel 0,%lld shows others",
            (long long)info->channels, SNOW_CHANNELS_MAX,
            (long long)info->channels - 1);
    if (!asked->count && list.count)
        directed ? note_directions(opts) : note_others(opts, info);
    const bool light =
        (strcmp(opts->mode, "mip") == 0 || strcmp(opts->mode, "slice") == 0) &&
        channels_are_light(&list, info);
    for (int n = 0; n < list.count; n++)
        list.picks[n].light = light;
    channels_fill(&list, info, opts->colormap);
    out->list = list;
    out->chosen = true;
    find_ground(opts, info, out);
    return CONTINUE;
}

/* --- looks ---------------------------------------------------------------- */

/* Of the list, of all, of the file, or to be chosen. */
static range_value range_of(const options *opts, const snow_channel *of,
                            const channel_pick *pick) {
    if (pick->range.kind != SNOW_RANGE_AUTO)
        return pick->range;
    if (options_range(opts).kind != SNOW_RANGE_AUTO)
        return options_range(opts);
    if (of->window[0] < of->window[1])
        return (range_value){SNOW_RANGE_VALUES, of->window[0], of->window[1]};
    return (range_value){pick->light ? SNOW_RANGE_SIGNAL
                         : mode_is_projection(opts->mode)
                             ? automatic_range(opts)
                             : SNOW_RANGE_AUTO,
                         0, 0};
}

snow_status channels_look(snow_comm *comm, const options *opts,
                          const snow_volume_info *info, channel_pick *pick,
                          const snow_volume *volume, snow_transfer **out) {
    static const snow_channel unknown = {.color = {-1, -1, -1}};
    const snow_channel *of = pick->index < SNOW_CHANNELS_MAX
                                 ? &info->channel[pick->index]
                                 : &unknown;
    const range_value range = range_of(opts, of, pick);
    const bool flat = mode_is_projection(opts->mode);
    double rgb[3];
    /* A colour, or a map from black to one. */
    const bool plain =
        channels_rgb(pick->color, rgb) ||
        light_of_colormap((size_t)snow_colormap_from_name(pick->color), rgb);
    snow_look look = {.size = sizeof look,
                      .colormap = plain ? NULL : pick->color,
                      .range = range.kind,
                      .low = range.low,
                      .high = range.high,
                      .log = opts->scale.log,
                      .symlog = opts->scale.symlog,
                      .white = pick->white};
    if (opts->gradient_opacities.count) {
        look.gradient_opacities = opts->gradient_opacities.points;
        look.gradient_opacity_count = opts->gradient_opacities.count;
    }
    snow_transfer *made = NULL;
    snow_status status =
        snow_channels_look(comm, volume, info, pick->index, flat,
                           plain ? rgb : NULL, &look, &made);
    if (status == SNOW_STATUS_OK &&
        pick->range.kind != SNOW_RANGE_PERCENTILES) {
        pick->range.kind = SNOW_RANGE_VALUES;
        snow_transfer_domain(made, &pick->range.low, &pick->range.high);
        if (!(pick->range.low < pick->range.high))
            pick->range.kind = SNOW_RANGE_AUTO;
    }
    if (status != SNOW_STATUS_OK) {
        snow_transfer_free(made);
        return status;
    }
    const snow_transfer *whole = made;
    if (pick->opacity < 1 || opts->opacities.count) {
        status =
            light_fade(comm, whole, volume, pick->opacity,
                       opts->opacities.count ? opts->opacities.points : NULL,
                       opts->opacities.count, &made);
        snow_transfer_free((snow_transfer *)(uintptr_t)whole);
    }
    if (status == SNOW_STATUS_OK)
        *out = made;
    return status;
}

snow_volume_options channels_data(const options *opts,
                                  const channel_pick *pick) {
    static const char *const directions[] = {"|x|", "|y|", "|z|"};
    snow_volume_options data = data_options(opts);
    data.channel_given = true;
    if (pick->absolute && pick->index < 3)
        data.component = directions[pick->index];
    data.channel = data.component ? 0 : pick->index;
    return data;
}

snow_status channels_open(const options *opts, snow_context *context,
                          const char *path, bool in_file, uint64_t slab_bytes,
                          channel_set *c) {
    snow_status status = SNOW_STATUS_OK;
    for (int n = 1; n < c->list.count && status == SNOW_STATUS_OK; n++) {
        channel_pick *pick = &c->list.picks[n];
        const snow_volume_options data = channels_data(opts, pick);
        if (c->volumes[n])
            continue;
        status = in_file
                     ? snow_volume_open_streamed(context, path, &data,
                                                 slab_bytes, &c->volumes[n])
                     : snow_volume_open(context, path, &data, &c->volumes[n]);
        if (status == SNOW_STATUS_OK && !c->looks[n])
            status =
                channels_look(NULL, opts, snow_volume_get_info(c->volumes[n]),
                              pick, c->volumes[n], &c->looks[n]);
    }
    return status;
}

/* Their light is added up, as in a composite of Fiji. */
snow_status channels_add_slices(const channel_set *c, snow_context *context,
                                int64_t index, const snow_view *view,
                                const snow_settings *settings,
                                snow_image **image) {
    snow_image *sum = NULL;
    snow_status status =
        light_add(context, *image, c->list.picks[0].opacity, &sum);
    for (int n = 1; n < c->list.count && status == SNOW_STATUS_OK; n++) {
        snow_image_free(*image);
        *image = NULL;
        status = snow_slice_render(c->volumes[n], index, c->looks[n], view,
                                   settings, image);
        if (status == SNOW_STATUS_OK)
            status = light_add(context, *image, c->list.picks[n].opacity, &sum);
    }
    if (sum)
        light_limit(sum);
    snow_image_free(*image);
    *image = sum;
    return status;
}

/* --- reports -------------------------------------------------------------- */

void channels_describe(const channel_set *c, char *out, size_t size) {
    size_t used =
        (size_t)snprintf(out, size, "channel%s", c->list.count > 1 ? "s" : "");
    for (int n = 0; n < c->list.count && used < size; n++) {
        const channel_pick *pick = &c->list.picks[n];
        const bool named =
            strspn(pick->name, "0123456789") < strlen(pick->name) &&
            strcmp(pick->name, pick->color) != 0;
        char range[64] = "", opacity[32] = "";
        if (pick->range.kind == SNOW_RANGE_VALUES)
            snprintf(range, sizeof range, " %g..%g", pick->range.low,
                     pick->range.high);
        if (pick->opacity < 1)
            snprintf(opacity, sizeof opacity, " opacity %g", pick->opacity);
        used += (size_t)snprintf(
            out + used, size - used, "%s%lld%s%s%s%s%s%s", n ? ", " : " ",
            (long long)pick->index, named ? " " : "", named ? pick->name : "",
            *pick->color ? " " : "", pick->color, range, opacity);
    }
    if (c->list.count && c->list.picks[0].white > 0 && used < size)
        snprintf(out + used, size - used,
                 "; white ground clear (the border is brighter than %.2g)",
                 c->list.picks[0].white);
}

void channels_close_volumes(channel_set *c) {
    for (int n = 0; n < SNOW_CHANNELS_MAX; n++) {
        snow_volume_close(c->volumes[n]);
        c->volumes[n] = NULL;
    }
}

void channels_close(channel_set *c) {
    channels_close_volumes(c);
    for (int n = 0; n < SNOW_CHANNELS_MAX; n++)
        snow_transfer_free(c->looks[n]);
    *c = (channel_set){.chosen = c->chosen, .ground = c->ground};
}
