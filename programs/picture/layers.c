/* layers.c - the volume of --overlay: a segmentation, or a second one of
 * values, on the grid of the first. */
#include "picture/layers.h"
#include "commands/commands.h"
#include "picture/outputs.h"
#include "run/log.h"
#include "run/start.h"

#include <math.h>
#include <snowglass/extend.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int layers_check_file(const char *path) {
    return path && is_special(path)
               ? fail_usage("%s: an overlay is read from a file; write it to "
                            "one",
                            path)
               : CONTINUE;
}

int layers_check(const options *opts) {
    if (!opts->overlay && opts->overlay_look.text)
        return fail_usage("--overlay-look: is of an overlay; give --overlay "
                          "FILE too");
    const int done = layers_check_file(opts->overlay);
    if (done != CONTINUE)
        return done;
    if (strcmp(opts->mode, "slice") == 0)
        return CONTINUE;
    if (opts->overlay_look.outline && opts->verbosity >= 0 && process_talks())
        say("note: --overlay-look outline: lines are drawn in slices; a volume "
            "is drawn whole");
    if (opts->overlay && strcmp(opts->mode, "over") != 0)
        return fail_usage("--overlay: needs mode over; remove --mode");
    if (opts->overlay && (strcmp(opts->method, "original") == 0 ||
                          strcmp(opts->method, "footprint") == 0))
        return fail_usage("--overlay: needs method shear-warp or raycast; "
                          "remove --method %s",
                          opts->method);
    if (opts->overlay && (strcmp(opts->kernel, "gauss") == 0 ||
                          strcmp(opts->kernel, "box") == 0))
        return fail_usage("--overlay: needs kernel tent or bspline; remove "
                          "--kernel %s",
                          opts->kernel);
    return CONTINUE;
}

void layers_leave_out(options *opts) {
    if (opts->overlay_picks)
        opts->labels = NULL;
    if (opts->overlay)
        opts->label_table = NULL;
    opts->overlay = NULL;
    opts->overlay_look = (overlay_look_value){.text = NULL};
    opts->overlay_picks = false;
}

/* The opacities of a look, each times the factor; of labels at their numbers.
 * NULL: no memory. */
static snow_opacity_point *scale_points(const snow_transfer *transfer,
                                        double factor, size_t *count) {
    snow_look look = {.size = sizeof look};
    const snow_label *label;
    size_t labels = 0;
    while (snow_transfer_label(transfer, labels))
        labels++;
    if (!labels && snow_transfer_get_look(transfer, &look) != SNOW_STATUS_OK)
        return NULL;
    *count = labels ? labels : look.opacity_count;
    snow_opacity_point *out = malloc((*count + 1) * sizeof *out);
    for (size_t n = 0; out && n < *count; n++)
        if ((label = snow_transfer_label(transfer, n)))
            out[n] =
                (snow_opacity_point){label->value, factor * label->color[3]};
        else
            out[n] = (snow_opacity_point){look.opacities[n].value,
                                          factor * look.opacities[n].opacity};
    return out;
}

/* Values of all steps have the look of the first; labels may be others. */
static snow_status make_look(const options *opts, layers *l) {
    const snow_volume *of = l->own ? l->own : l->volume;
    const overlay_look_value *given = &opts->overlay_look;
    const range_value range = given->range;
    const point_list *asked = &given->opacity;
    const bool factor = points_are_factor(asked);
    snow_look look = {.size = sizeof look,
                      .preset = given->preset,
                      .colormap = *given->colormap ? given->colormap : NULL,
                      .range = range.kind,
                      .low = range.low,
                      .high = range.high,
                      .overlay = true};
    if (l->transfer && (l->own || !snow_transfer_label(l->transfer, 0)))
        return SNOW_STATUS_OK;
    layers_drop_look(l);
    if (asked->count && !factor) {
        look.opacities = asked->points;
        look.opacity_count = asked->count;
    }
    snow_transfer *whole = NULL;
    snow_status status = snow_transfer_new_for_volume(of, &look, &whole);
    if (status != SNOW_STATUS_OK || !factor) {
        l->transfer = whole;
        return status;
    }
    snow_opacity_point *points =
        scale_points(whole, asked->points[0].opacity, &look.opacity_count);
    look.opacities = points;
    status = points ? snow_transfer_new_for_volume(of, &look, &l->transfer)
                    : SNOW_STATUS_NO_MEMORY;
    free(points);
    snow_transfer_free(whole);
    return status;
}

/* The planes of the volume cut its overlay too. */
static snow_status clip(const options *opts, layers *l) {
    static const double none[SNOW_CLIPS_MAX][4];
    snow_volume *made;
    if (memcmp(opts->clip, none, sizeof none) == 0)
        return SNOW_STATUS_OK;
    snow_status status =
        snow_volume_clip(l->volume, opts->clip[0], SNOW_CLIPS_MAX, &made);
    if (status == SNOW_STATUS_OK) {
        snow_volume_close(l->volume);
        l->volume = made;
    }
    return status;
}

/* Labels that there are where none of those of --labels is; 0 is nothing. */
static void note_labels(const options *opts, snow_context *context) {
    const snow_look look = {.size = sizeof look, .preset = "labels"};
    const snow_label *label = NULL;
    char text[200] = "";
    size_t used = 0, n = 0;
    layers all = {.volume = NULL};
    if (snow_volume_open(context, opts->overlay, NULL, &all.volume) ==
            SNOW_STATUS_OK &&
        snow_transfer_new_for_volume(all.volume, &look, &all.transfer) ==
            SNOW_STATUS_OK)
        while ((label = snow_transfer_label(all.transfer, n++)) &&
               used < sizeof text - 32)
            if (label->value < 0 || label->value > 0)
                used +=
                    (size_t)snprintf(text + used, sizeof text - used,
                                     used ? ", %.0f" : "%.0f", label->value);
    say("note: %s: no voxel has a label of --labels %s; there are %s%s",
        opts->overlay, opts->labels, used ? text : "none",
        label ? ", ..." : "");
    layers_close(&all);
}

static bool in_file(const snow_volume *volume) {
    return !snow_volume_voxels(volume);
}

static void note_empty(const options *opts, snow_context *context,
                       const layers *l) {
    snow_volume_statistics s = {.size = sizeof s};
    if (opts->verbosity < 0 || in_file(l->volume) ||
        snow_volume_get_statistics(l->volume, &s) != SNOW_STATUS_OK)
        return;
    if (isnan(s.min))
        say("note: %s: has no value in the volume", opts->overlay);
    else if (opts->overlay_picks && s.min >= 0 && s.max <= 0)
        note_labels(opts, context);
}

static int check_overlay(const options *opts, const snow_context *context,
                         const layers *l, snow_status status) {
    if (status == SNOW_STATUS_OK)
        return CONTINUE;
    if (l->quiet && status == SNOW_STATUS_NO_MEMORY)
        return status;
    if (status != SNOW_STATUS_BAD_USAGE)
        return fail_volume(context, status, opts->overlay);
    return fail_usage("%s: %s", opts->overlay, snow_context_message(context));
}

/* Whether a file gives neither a position nor directions (as src/volume/mask.c
 * says it): its rows may go down as an image's. */
static bool is_unplaced(const snow_volume_info *info) {
    const double(*m)[4] = info->matrix;
    bool given = info->medical || m[0][0] < 0 || (m[1][1] < 0) != (m[2][2] < 0);
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 4; column++)
            given |= row != column && m[row][column] != 0;
    return !given;
}

/* Of standard input only what the crop left is known (`grid`): all of it has as
 * many voxels as the overlay if the crop leaves as many of that. */
static bool guess_whole(const options *opts, const snow_volume_info *grid,
                        const int64_t dims[3], snow_volume_info *out) {
    *out = *grid;
    for (int c = 0; c < 3; c++) {
        const int64_t *crop = opts->crop[c];
        const int64_t end = crop[1] ? crop[1] : dims[c];
        if (end > dims[c] || end - crop[0] != grid->dims[c])
            return false;
        out->dims[c] = dims[c];
        for (int row = 0; row < 3; row++)
            out->matrix[row][3] -= out->matrix[row][c] * (double)crop[0];
    }
    return true;
}

/* The volume before its crop; whose warnings came before. */
static bool find_whole(const options *opts, const snow_volume_info *grid,
                       const int64_t dims[3], snow_volume_info *out) {
    snow_volume_options data = data_options(opts);
    snow_context *context = NULL;
    memset(data.crop, 0, sizeof data.crop);
    snow_volume_info_init(out);
    if (strcmp(opts->operands[0], "-") == 0)
        return guess_whole(opts, grid, dims, out);
    const bool known = snow_context_new(NULL, &context) == SNOW_STATUS_OK &&
                       snow_volume_inspect(context, opts->operands[0], &data,
                                           out) == SNOW_STATUS_OK;
    snow_context_free(context);
    return known;
}

/* Whether the crop of the volume is one of the overlay too: they have the same
 * voxels, but not both a place, by which a part would be found.  *whole is the
 * volume before it. */
static bool shares_crop(const options *opts, const snow_volume_info *grid,
                        const layers *l, snow_volume_info *whole) {
    static const int64_t all[3][2];
    const snow_volume_info *info = snow_volume_get_info(l->volume);
    if (l->whole)
        *whole = *l->whole;
    return memcmp(opts->crop, all, sizeof all) != 0 &&
           (l->whole || find_whole(opts, grid, info->dims, whole)) &&
           memcmp(whole->dims, info->dims, sizeof info->dims) == 0 &&
           (is_unplaced(whole) || is_unplaced(info) ||
            whole->medical != info->medical);
}

/* One that has steps has as many as the volume.  Where that has parts, pictures
 * take what they need of the file, cut as the volume is. */
static int open_step(const options *opts, snow_context *context,
                     const snow_volume_info *base, bool parts, bool cropped,
                     layers *l) {
    snow_volume_options data = {.size = sizeof data,
                                .labels =
                                    opts->overlay_picks ? opts->labels : NULL,
                                .label_table = opts->label_table,
                                .suv = opts->suv,
                                .each_time = true};
    snow_volume_info info;
    snow_volume_info_init(&info);
    snow_status status =
        snow_volume_inspect(context, opts->overlay, &data, &info);
    if (status == SNOW_STATUS_OK && info.times > 1 &&
        info.times != base->times) {
        say("%s: holds %lld time steps, and the volume %lld; give an overlay "
            "of as many, or of one: snowglass convert --time N",
            opts->overlay, (long long)info.times, (long long)base->times);
        return SNOW_STATUS_BAD_INPUT;
    }
    if (info.times > 1)
        data.time = opts->time;
    if (parts)
        memcpy(data.clip, opts->clip, sizeof data.clip);
    if (cropped)
        memcpy(data.crop, opts->crop, sizeof data.crop);
    if (status == SNOW_STATUS_OK)
        status =
            parts ? snow_volume_open_streamed(context, opts->overlay, &data,
                                              l->slab_bytes, &l->volume)
                  : snow_volume_open(context, opts->overlay, &data, &l->volume);
    return check_overlay(opts, context, l, status);
}

/* Whether what is open serves a volume too. */
static bool serves(const layers *l, const snow_volume_info *base, bool parts) {
    if (!l->volume || in_file(l->volume) != parts)
        return false;
    const snow_volume_info *own = snow_volume_get_info(l->volume);
    if (parts)
        return own->times <= 1;
    return own->times <= 1 &&
           memcmp(own->dims, base->dims, sizeof own->dims) == 0 &&
           memcmp(own->matrix, base->matrix, sizeof own->matrix) == 0;
}

/* Reads it, unless it is kept: not where a volume that stays in its file lacks
 * that memory. */
static int read_layer(const options *opts, snow_context *context,
                      const snow_volume_info *grid, bool parts, layers *l) {
    snow_status status = SNOW_STATUS_OK;
    if (parts) {
        snow_volume_close(l->own);
        l->own = NULL;
    }
    int done =
        l->own ? CONTINUE : open_step(opts, context, grid, parts, false, l);
    if (done != CONTINUE || !l->keeps || parts)
        return done;
    if (!l->own) {
        l->own = l->volume;
        l->volume = NULL;
    }
    /* The voxels of what is kept, which the grid of the volume may replace. */
    const snow_volume_info *info = snow_volume_get_info(l->own);
    void *voxels = (void *)(uintptr_t)snow_volume_voxels(l->own);
    status = snow_volume_wrap(context, info, voxels, &l->volume);
    return check_overlay(opts, context, l, status);
}

/* Its look is of the whole, so that only then it is cropped. */
static int crop_layer(const options *opts, snow_context *context,
                      const snow_volume_info *grid, bool parts, layers *l) {
    snow_volume_info whole;
    if (!shares_crop(opts, grid, l, &whole))
        return CONTINUE;
    if (!l->whole && strcmp(opts->operands[0], "-") == 0 &&
        opts->verbosity >= 0 && process_talks())
        say("note: %s: has no place, and is taken to have as many voxels as "
            "standard input before its crop",
            opts->overlay);
    layers_drop_volume(l);
    const int done = open_step(opts, context, grid, parts, true, l);
    if (done != CONTINUE)
        return done;
    /* The box of the volume: both have offsets now, which look like places. */
    for (int row = 0; row < 3; row++)
        for (int c = 0; c < 3; c++)
            whole.matrix[row][3] +=
                whole.matrix[row][c] * (double)opts->crop[c][0];
    return check_overlay(opts, context, l,
                         snow_volume_set_whole(l->volume, &whole));
}

/* On the grid of a volume in memory, cut as it is.  Labels lie there by their
 * nearest voxels, so that another look may need it anew. */
static int place(const options *opts, snow_context *context,
                 const snow_volume *base, bool first, layers *l) {
    const snow_volume_info *grid = snow_volume_get_info(base);
    const bool nearest = snow_transfer_label(l->transfer, 0);
    int done = CONTINUE;
    if (l->placed && nearest == l->nearest)
        return CONTINUE;
    if (l->placed) {
        layers_drop_volume(l);
        done = read_layer(opts, context, grid, false, l);
        if (done == CONTINUE)
            done = crop_layer(opts, context, grid, false, l);
    }
    if (done != CONTINUE)
        return done;
    snow_status status = snow_volume_regrid(&l->volume, base, nearest);
    if (status == SNOW_STATUS_OK && first && !l->keeps)
        note_empty(opts, context, l);
    if (status == SNOW_STATUS_OK)
        status = clip(opts, l);
    l->placed = status == SNOW_STATUS_OK;
    l->nearest = nearest;
    return check_overlay(opts, context, l, status);
}

int layers_open(const options *opts, snow_context *context,
                const snow_volume *base, layers *l) {
    const snow_volume_info *grid = snow_volume_get_info(base);
    const bool first = !l->transfer;
    const bool parts = (process_ranks() > 1 && !l->alone) || in_file(base);
    const bool stays = serves(l, grid, parts) && !(parts && first);
    int done = CONTINUE;
    if (!opts->overlay || (stays && !first))
        return CONTINUE;
    if (!stays) {
        layers_drop_volume(l);
        done = read_layer(opts, context, grid, parts, l);
    }
    if (done != CONTINUE)
        return done;
    done = check_overlay(opts, context, l, make_look(opts, l));
    if (done == CONTINUE && !stays)
        done = crop_layer(opts, context, grid, parts, l);
    if (done == CONTINUE && !parts)
        done = place(opts, context, base, first, l);
    if (done == CONTINUE && opts->verbosity >= 0 && first && !l->keeps)
        say("overlay %s: %s", opts->overlay,
            snow_transfer_description(l->transfer));
    return done;
}

const snow_transfer *layers_legend(const layers *l, bool steps) {
    const bool named = l->volume && snow_transfer_label(l->transfer, 0);
    return steps && named && snow_volume_get_info(l->volume)->times > 1
               ? NULL
               : l->transfer;
}

void layers_drop_volume(layers *l) {
    snow_volume_close(l->volume);
    l->volume = NULL;
    l->placed = false;
}

void layers_drop_look(layers *l) {
    snow_transfer_free(l->transfer);
    l->transfer = NULL;
}

snow_status layers_set(const layers *l, const channel_set *c,
                       snow_frame *frame) {
    snow_layer all[SNOW_LAYERS_MAX + 1];
    int count = 0;
    for (int n = 1; n < c->list.count; n++)
        all[count++] = (snow_layer){c->volumes[n], c->looks[n], true};
    if (l->volume)
        all[count++] = (snow_layer){l->volume, l->transfer, false};
    return snow_frame_set_layers(frame, all, count);
}

void layers_close(layers *l) {
    layers_drop_look(l);
    layers_drop_volume(l);
    snow_volume_close(l->own);
    *l = (layers){.keeps = l->keeps, .alone = l->alone, .whole = l->whole};
}
