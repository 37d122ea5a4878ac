/* channels.c - see channels.h. */
#include "picture/channels.h"
#include "commands/commands.h"
#include "picture/outputs.h"
#include "run/log.h"
#include "run/memory.h"
#include "run/start.h"

#include <math.h>
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

/* A look that was asked for is of one volume. */
static bool asks_one(const options *opts) {
    return opts->preset || opts->tf || opts->colormap || opts->component ||
           opts->labels || options_given(opts, "channel");
}

void channels_note(const options *opts, const snow_volume_info *info,
                   const char *why) {
    if (opts->verbosity >= 0 && process_talks())
        say("note: channel 0 of %lld (counted from 0) is used; --channel N "
            "selects another%s%s",
            (long long)info->channels, why ? "; " : "", why ? why : "");
}

int channels_choose(const options *opts, const snow_volume_info *info,
                    const char *why, channel_set *out) {
    const channel_list *asked = &opts->channels;
    const int64_t there = info->channels > 1 ? info->channels : 1;
    channel_list list = *asked;
    char room[128];
    if (out->chosen)
        return CONTINUE;
    if (!asked->count && !asks_one(opts))
        channels_of_file(info, &list);
    if (!why && list.count > 1 &&
        !memory_holds(opts, info, list.count, room, sizeof room))
        why = room;
    if (asked->count && (opts->preset || opts->tf))
        return fail_usage("--channel: a list has colours of its own; remove "
                          "--preset and --tf, or give one channel");
    if (asked->count && why) {
        const int done = fail_usage("--channel: %s; give one channel, such as "
                                    "--channel %lld",
                                    why, (long long)asked->picks[0].index);
        return why == room ? SNOW_STATUS_NO_MEMORY : done;
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
    channels_fill(&list, info, opts->colormap);
    out->list = list;
    out->chosen = true;
    return CONTINUE;
}

/* --- looks ---------------------------------------------------------------- */

/* The least brightness in mode over, where what is dim is transparent. */
#define DIM 0.5

typedef struct channel_colors {
    snow_color_point colors[2];
    snow_opacity_point opacities[4];
} channel_colors;

/* Red, green and blue of a colour, or of a map from black to one. */
static bool find_rgb(const char *color, double rgb[3]) {
    snow_color_point points[SNOW_COLORMAP_POINTS_MAX];
    if (channels_rgb(color, rgb))
        return true;
    if (snow_colormap_points((size_t)snow_colormap_from_name(color), points,
                             SNOW_COLORMAP_POINTS_MAX) != 2 ||
        points[0].red + points[0].green + points[0].blue > 0)
        return false;
    memcpy(rgb, &points[1].red, 3 * sizeof *rgb);
    return true;
}

/* Colours and, where no histogram is asked, opacities: those of a projection,
 * and of voxels that are colours: faint enough that the colour is not that of
 * the border, where values are between. */
static void take_color(const options *opts, const snow_channel *of,
                       const channel_pick *pick, channel_colors *room,
                       snow_look *look) {
    static const snow_opacity_point own[] = {
        {0, 0}, {0.04, 0}, {0.15, 0.25}, {1, 0.3}};
    const bool flat = mode_is_projection(opts->mode);
    const double dim = flat || of->own ? 0 : DIM;
    double rgb[3];
    if (find_rgb(pick->color, rgb)) {
        room->colors[0] =
            (snow_color_point){0, dim * rgb[0], dim * rgb[1], dim * rgb[2]};
        room->colors[1] = (snow_color_point){1, rgb[0], rgb[1], rgb[2]};
        look->colors = room->colors;
        look->color_count = 2;
        look->domain = SNOW_DOMAIN_RANGE;
    } else {
        look->colormap = pick->color;
        look->preset = flat ? "linear" : NULL;
        return;
    }
    memcpy(room->opacities, own, sizeof own);
    if (flat)
        room->opacities[1] = (snow_opacity_point){1, 1};
    if (flat || of->own)
        look->opacities = room->opacities;
    look->opacity_count = flat ? 2 : of->own ? 4 : 0;
}

/* Of the list, of all, of the file, or to be chosen. */
static range_value range_of(const options *opts, const snow_channel *of,
                            const channel_pick *pick) {
    if (pick->range.kind != SNOW_RANGE_AUTO)
        return pick->range;
    if (options_range(opts).kind != SNOW_RANGE_AUTO)
        return options_range(opts);
    if (of->window[0] < of->window[1])
        return (range_value){SNOW_RANGE_VALUES, of->window[0], of->window[1]};
    return (range_value){mode_is_projection(opts->mode) ? SNOW_RANGE_ROBUST
                                                        : SNOW_RANGE_AUTO,
                         0, 0};
}

/* The same colours with other opacities. */
static snow_status replace(snow_comm *comm, const options *opts, double factor,
                           const snow_volume *volume,
                           snow_transfer **transfer) {
    snow_look look = {.size = sizeof look};
    snow_opacity_point points[POINTS_MAX];
    snow_transfer *made;
    snow_status status = snow_transfer_get_look(*transfer, &look);
    if (status != SNOW_STATUS_OK)
        return status;
    const snow_opacity_point *from =
        opts->opacities.count ? opts->opacities.points : look.opacities;
    size_t count =
        opts->opacities.count ? opts->opacities.count : look.opacity_count;
    count = count < POINTS_MAX ? count : POINTS_MAX;
    for (size_t n = 0; n < count; n++)
        points[n] =
            (snow_opacity_point){from[n].value, factor * from[n].opacity};
    look.opacities = points;
    look.opacity_count = count;
    status = snow_ranks_new_transfer(comm, volume, &look, &made);
    if (status != SNOW_STATUS_OK)
        return status;
    snow_transfer_free(*transfer);
    *transfer = made;
    return SNOW_STATUS_OK;
}

snow_status channels_look(snow_comm *comm, const options *opts,
                          const snow_volume_info *info, channel_pick *pick,
                          const snow_volume *volume, snow_transfer **out) {
    static const snow_channel unknown = {.color = {-1, -1, -1}};
    const snow_channel *of = pick->index < SNOW_CHANNELS_MAX
                                 ? &info->channel[pick->index]
                                 : &unknown;
    const range_value range = range_of(opts, of, pick);
    channel_colors room;
    snow_look look = {.size = sizeof look,
                      .range = range.kind,
                      .low = range.low,
                      .high = range.high,
                      .log = opts->log,
                      .symlog = opts->symlog};
    take_color(opts, of, pick, &room, &look);
    if (opts->gradient_opacities.count) {
        look.gradient_opacities = opts->gradient_opacities.points;
        look.gradient_opacity_count = opts->gradient_opacities.count;
    }
    snow_transfer *made = NULL;
    snow_status status = snow_ranks_new_transfer(comm, volume, &look, &made);
    if (status == SNOW_STATUS_OK &&
        pick->range.kind != SNOW_RANGE_PERCENTILES) {
        pick->range.kind = SNOW_RANGE_VALUES;
        snow_transfer_domain(made, &pick->range.low, &pick->range.high);
        if (!(pick->range.low < pick->range.high))
            pick->range.kind = SNOW_RANGE_AUTO;
    }
    if (status == SNOW_STATUS_OK &&
        (pick->opacity < 1 || opts->opacities.count))
        status = replace(comm, opts, pick->opacity, volume, &made);
    if (status != SNOW_STATUS_OK) {
        snow_transfer_free(made);
        return status;
    }
    *out = made;
    return SNOW_STATUS_OK;
}

snow_volume_options channels_data(const options *opts,
                                  const channel_pick *pick) {
    snow_volume_options data = data_options(opts);
    data.channel = pick->index;
    data.channel_given = true;
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

/* --- pictures that are added ---------------------------------------------- */

/* A picture of black and clear pixels of four channels. */
static snow_status begin_sum(snow_context *context, const snow_image *one,
                             snow_image **sum) {
    return snow_image_new(context, snow_image_width(one),
                          snow_image_height(one), 4, sum);
}

snow_status channels_add(snow_context *context, const snow_image *one,
                         double share, snow_image **sum) {
    snow_status status = *sum ? SNOW_STATUS_OK : begin_sum(context, one, sum);
    if (status != SNOW_STATUS_OK)
        return status;
    const int channels = snow_image_channels(one);
    const size_t count =
        (size_t)snow_image_width(one) * (size_t)snow_image_height(one);
    const float *from = snow_image_pixels((snow_image *)(uintptr_t)one);
    float *to = snow_image_pixels(*sum);
    for (size_t n = 0; n < count; n++, from += channels, to += 4) {
        to[3] = fmaxf(to[3], from[channels - 1]);
        for (int c = 0; c < 3; c++)
            to[c] += (float)share * from[channels == 4 ? c : 0];
    }
    return SNOW_STATUS_OK;
}

void channels_limit(snow_image *sum) {
    const size_t count =
        (size_t)snow_image_width(sum) * (size_t)snow_image_height(sum);
    float *at = snow_image_pixels(sum);
    for (size_t n = 0; n < count; n++, at += 4)
        for (int c = 0; c < 3; c++)
            at[c] = fminf(at[c], at[3]);
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
    *c = (channel_set){.chosen = c->chosen};
}
